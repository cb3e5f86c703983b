//! A study of any subject, with all its files.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::{fs, io};

use deltazero_study::reference::ReferenceError;
use deltazero_study::steps::StepTables;
use deltazero_study::work_precision::WorkPrecision;
use deltazero_study::{Plan, Subject, work_precision};

use crate::figures::{self, Drawing};
use crate::report::{self, About, Provenance};
use crate::study::machine::Machine;

/// A study that is done.
#[derive(Clone, Debug)]
pub struct Studied {
    /// What its files say of the subject.
    pub about: About,
    /// What was run.
    pub plan: Plan,
    /// What was measured.
    pub table: WorkPrecision,
    /// The figures.
    pub drawings: Vec<Drawing>,
    steps: StepTables,
}

impl Studied {
    /// Makes the reference of `subject`, runs all that `plan` asks for, and draws the figures.
    ///
    /// # Errors
    /// [`ReferenceError`] where the subject contradicts itself, or the reference cannot be made.
    pub fn new(about: About, subject: &Subject, plan: Plan) -> Result<Self, ReferenceError> {
        let stop = AtomicBool::new(false);
        let table = work_precision(subject, &plan, &[], &stop, &|_| {})?;
        let steps = StepTables::new(subject, &plan, &table, plan.limits(&stop));
        let drawings = figures::of_study(&table, &steps);
        Ok(Self { about, plan, table, drawings, steps })
    }

    /// The cheapest run at each accuracy, as a table in Markdown.
    pub fn answer(&self) -> String {
        report::answer(&self.table)
    }

    /// Writes `study.csv`, `study.md`, `report.html`, the tables of steps and `figures/` into `dir`, which is made
    /// where there is none.
    ///
    /// # Errors
    /// Those of the file system, and where a figure cannot be drawn.
    pub fn write(&self, dir: impl AsRef<Path>) -> io::Result<()> {
        let dir = dir.as_ref();
        let provenance = Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            machine: Some(Machine::here()),
            time: None,
        };
        let Self { about, plan, table, drawings, steps } = self;
        let files = report::study_files(about, plan, table, &provenance, drawings)
            .map_err(|(name, error)| io::Error::other(format!("cannot draw {name}: {error}")))?;
        fs::create_dir_all(dir.join("figures"))?;
        for file in files {
            fs::write(dir.join(file.name), file.content)?;
        }
        let tables = report::steps::files(steps, None).into_iter();
        // Of the limit of stability nothing is known here.
        tables
            .filter(|(name, _)| *name != "rk4_stability.csv")
            .try_for_each(|(name, text)| fs::write(dir.join(name), text))
    }
}
