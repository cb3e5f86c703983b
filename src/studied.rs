//! A study of any subject, with all its files.

use std::fmt::Write as _;
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use deltazero_study::digits::{as_meant, in_short};
use deltazero_study::map::Map;
use deltazero_study::motion::Motion;
use deltazero_study::plan::sample_times;
use deltazero_study::recommend::{Recommendation, recommend};
use deltazero_study::reference::ReferenceError;
use deltazero_study::selection::Rules;
use deltazero_study::steps::StepTables;
use deltazero_study::work_precision::{WorkPrecision, in_doubt};
use deltazero_study::{Plan, Subject, work_precision};

use crate::atomic_file;
use crate::figures::{self, Drawing, Picture};
use crate::report::simulation::motion_csv;
use crate::report::{self, About};
use crate::study::machine::Machine;
use crate::study::record::Provenance;

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
    motion: Option<Motion>,
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
        let motion = Motion::new(subject, plan.t_end, plan.limits(&stop));
        let drawings = figures::of_study(&table, &steps, motion.as_ref(), &[], None);
        Ok(Self { about, plan, table, drawings, steps, motion })
    }

    /// The cheapest run at each accuracy, as a table in Markdown.
    pub fn answer(&self) -> String {
        report::answer(&self.table)
    }

    /// Writes `study.csv`, `study.md`, `report.html`, `motion.csv`, the tables of steps and `figures/` into `dir`, which is made
    /// where there is none; each file [whole](atomic_file) or not at all.
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
        let Self { about, plan, table, drawings, steps, motion } = self;
        let files = report::study_files(about, plan, table, &provenance, drawings)
            .map_err(|(name, error)| io::Error::other(format!("cannot draw {name}: {error}")))?;
        for file in files {
            write(dir, &file.name, &file.content)?;
        }
        if let Some(motion) = motion {
            write(dir, "motion.csv", motion_csv(motion).as_bytes())?;
        }
        let mut tables = report::steps::files(steps, None);
        tables.try_for_each(|(name, text)| write(dir, name, text.as_bytes()))
    }
}

/// The method and setting for `subject`, to `t_end` [s], at an error of at most `accuracy`, with the measured reason.
pub fn recommended(subject: Subject, t_end: f64, accuracy: f64) -> Recommendation {
    let stop = AtomicBool::new(false);
    let span = (t_end, sample_times(None, t_end));
    let limits = Plan::new(t_end).limits(&stop);
    recommend(subject, span, accuracy, &Rules::default(), limits, Vec::new(), &|_| {})
}

/// The winner of every cell of a map, as a table in Markdown.
pub fn map_table(map: &Map) -> String {
    let [x, y] = map.axes.each_ref().map(|axis| axis.label());
    let mut text = format!(
        "| {x} | {y} | e at most | winner | setting | its e | time [ms] | compared to [s] |\n"
    );
    text += "|---|---|---|---|---|---|---|---|\n";
    for cell in &map.cells {
        let ([x, y], contest) = (cell.at.map(in_short), &cell.contest);
        let near = contest.within_noise();
        let t_end = contest.t_end_s.map_or_else(String::new, as_meant);
        let _ = write!(text, "| {x} | {y} | {:e} | ", contest.accuracy);
        let _ = match contest.winner() {
            Some(first) => writeln!(
                text,
                "{} {}{} | {} | {:.1e} | {:.3} | {t_end} |",
                first.method,
                first.events,
                in_doubt(near.iter().map(|entry| (&*entry.method, entry.events))),
                first.setting(),
                first.e,
                1e3 * first.time_s()
            ),
            None => writeln!(text, "{} | | | | {t_end} |", contest.status.name()),
        };
    }
    for cell in &map.cells {
        if let Some(cut_short) = cell.contest.cut_short() {
            let ([x, y], e) = (cell.at.map(in_short), cell.contest.accuracy);
            let _ = write!(text, "\n{x}, {y}, {e:e}: {cut_short}.\n");
        }
    }
    text
}

/// Writes `map.md` and the picture of the winners into `dir`, which is made where there is none.
///
/// # Errors
/// Those of the file system, and where the figure cannot be drawn.
pub fn write_map(map: &Map, dir: impl AsRef<Path>) -> io::Result<()> {
    let (dir, drawing) = (dir.as_ref(), figures::map::winners(map));
    let picture = drawing.picture().map_err(io::Error::other)?;
    write(dir, "figures/winners.svg", picture.svg.as_bytes())?;
    write(dir, "figures/winners.png", &picture.png)?;
    write(dir, "map.md", map_markdown(map, &[picture]).as_bytes())
}

/// Writes a file of `dir`, whole or not at all.
fn write(dir: &Path, name: &str, content: &[u8]) -> io::Result<()> {
    atomic_file::write(&dir.join(name), content).map_err(io::Error::other)
}

/// `map.md`: pictures of a map, and its table.
pub fn map_markdown(map: &Map, pictures: &[Picture]) -> String {
    let picture = |Picture { name, title, caption, .. }: &Picture| {
        format!("![{title}](figures/{name}.png)\n\n{caption}\n\n")
    };
    let pictures: String = pictures.iter().map(picture).collect();
    format!("# The fastest method\n\n{pictures}{}", map_table(map))
}
