//! One run after the other: its configuration, the run, its row.

use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use deltazero_solvers::Outcome;
use deltazero_study::Part;
use deltazero_study::brief::Brief;
use deltazero_study::run::{Limit, Limits, Price};
use serde_json::Value;

use super::Sweep;
use super::columns::{Cell, cells};
use crate::config::{Config, Variants};
use crate::report::{exact, field};
use crate::run::setting;

/// The status of a run that came to its end.
pub(super) const OK: &str = "ok";

/// Runs are let end; what ends a sweep waits for them.
static NEVER: AtomicBool = AtomicBool::new(false);

/// Makes runs of a sweep, on one thread.
pub struct Runner<'a> {
    sweep: &'a Sweep,
    variants: Variants,
    indices: Vec<u64>,
    values: Vec<Value>,
    cells: Vec<Cell>,
    /// Time that the integrations took so far.
    pub took: Duration,
}

impl<'a> Runner<'a> {
    pub(super) fn new(sweep: &'a Sweep) -> Self {
        let variants = sweep.variants.clone();
        let (indices, values, cells) = Default::default();
        Self { sweep, variants, indices, values, cells, took: Duration::ZERO }
    }

    /// Makes the run number `run` and adds its row to `rows`; whether it came to its end.
    pub fn row(&mut self, run: u64, rows: &mut String) -> bool {
        let Self { sweep, .. } = *self;
        sweep.plan.indices(run, &mut self.indices);
        sweep.plan.values(run, &self.indices, &mut self.values);
        let _ = write!(rows, "{run}");
        for value in &self.values {
            rows.push(',');
            write_value(rows, value);
        }
        let ran = catch_unwind(AssertUnwindSafe(|| self.run()));
        let status = ran.unwrap_or_else(|panic| {
            self.cells.clear();
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(format!("panic, a mistake in this program: {}", text.unwrap_or("no message")))
        });
        rows.push(',');
        match &status {
            Ok(()) => rows.push_str(OK),
            Err(error) => rows.push_str(&field(&in_a_line(error))),
        }
        self.write_cells(rows);
        rows.push('\n');
        status.is_ok()
    }

    /// Makes the run and fills the cells; why it did not come to its end.
    fn run(&mut self) -> Result<(), String> {
        self.cells.clear();
        let config = self.variants.set(&self.values).map_err(|error| error.to_string())?;
        let (parts, status) = brief(config, self.sweep.plan.audit)?;
        self.took += parts.iter().map(|(_, brief)| brief.run.took.cpu).sum::<Duration>();
        cells(&parts, &mut self.cells);
        let expected = self.sweep.layout.n_cells(&self.sweep.plan, &self.indices);
        if expected != Some(self.cells.len()) {
            self.cells.clear();
            return Err(
                "it tells of other columns than the plan; make a plan of it alone".to_owned()
            );
        }
        status
    }

    fn write_cells(&self, rows: &mut String) {
        let places = self.sweep.layout.cells(&self.sweep.plan, &self.indices);
        for column in 0..self.sweep.layout.heads.len() {
            rows.push(',');
            let place = places.and_then(|places| places[column]);
            match place.and_then(|place| self.cells.get(place)) {
                None => {}
                Some(Cell::Number(x)) => write_number(rows, *x),
                Some(Cell::Count(n)) => drop(write!(rows, "{n}")),
                Some(Cell::Text(text)) => rows.push_str(&field(text)),
            }
        }
    }
}

/// A run: its parts, and why it did not come to its end, if it did not.
type Ran = (Vec<(Part, Brief)>, Result<(), String>);

/// What became of each part of a configuration; or why there is no run.
fn brief(config: &Config, audit: bool) -> Result<Ran, String> {
    let setting = setting(config).ok_or_else(|| format!("no method {}", config.solver.method))?;
    let (max_rhs, max_seconds) = (config.study.max_rhs, config.study.max_seconds);
    let whole = Limits { max_rhs, max_seconds, stop: &NEVER };
    let (mut left, price) = (whole, Price::of_setting(&setting));
    let mut status = Ok(());
    let mut parts = Vec::new();
    for part in config.mechanism.subject(config).parts {
        let mut watch = left.watch(price);
        let brief = part.brief(&setting, config.run.t_end, audit, &mut watch);
        left = left.after(&brief.run, price);
        let of_part = status_of(&part, &brief, watch.cut, whole);
        status = status.and(of_part);
        parts.push((part, brief));
    }
    Ok((parts, status))
}

/// Why a part did not come to its end.
fn status_of(
    part: &Part,
    brief: &Brief,
    cut: Option<Limit>,
    limits: Limits<'_>,
) -> Result<(), String> {
    let name = if part.name.is_empty() { String::new() } else { format!("{}: ", part.name) };
    match (&brief.run.outcome, cut) {
        (Err(error), _) => Err(format!("{name}{error}")),
        (Ok(Outcome::Interrupted), Some(limit)) => {
            Err(format!("{name}cut at t = {:e} s: {}", brief.run.t, limits.told(limit)))
        }
        (Ok(Outcome::Interrupted), None) => Err(format!("{name}interrupted")),
        (Ok(_), _) => Ok(()),
    }
}

/// What is wrong, in one line, as a run is: of a report on a model what it says and where, without the text there.
fn in_a_line(error: &str) -> String {
    let lines = error.lines().map(str::trim).take_while(|line| *line != "|");
    lines.collect::<Vec<_>>().join(" ").replace('\r', " ")
}

fn write_value(rows: &mut String, value: &Value) {
    match value {
        Value::String(word) => rows.push_str(&field(word)),
        Value::Number(number) if number.is_f64() => write_number(rows, number.as_f64()),
        other => rows.push_str(&field(&other.to_string())),
    }
}

fn write_number(rows: &mut String, x: Option<f64>) {
    // A run that diverges may end with what is no number.
    rows.push_str(&exact(x.filter(|x| x.is_finite())));
}
