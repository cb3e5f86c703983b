//! How does the step size of each method follow flight, contact and events?

use deltazero_solvers::{Method, Work};
use serde::{Deserialize, Serialize};

pub use crate::accepted::{ModeKind, StepRow};

use crate::accepted::Steps;
use crate::part::{Part, Subject};
use crate::plan::Plan;
use crate::run::{Events, Limits, Price, Setting};
use crate::selection::work;
use crate::work_precision::{Row, WorkPrecision};

/// Error at which methods are compared: each at its cheapest setting that reaches it with all events.
pub const ACCURACY: f64 = 1e-6;

/// The steps of one method on one part, events located.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepHistory {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// Error `e` of that setting in the study, all parts together.
    pub e: f64,
    /// Number of the part, from 1.
    pub part: usize,
    /// Its name.
    pub name: String,
    /// Sites of it that step together.
    pub n_sites: usize,
    /// [Names](crate::Problem::named_modes) of the modes, where they have any.
    pub modes: Vec<String>,
    /// Accepted steps, in the order of the run.
    pub steps: Vec<StepRow>,
    /// Times of the events [s].
    pub events: Vec<f64>,
    /// Evaluations of the right-hand side.
    pub n_rhs: u64,
    /// Of those, the ones that began phases.
    pub n_rhs_restart: u64,
    /// Of those, the ones that located events.
    pub n_rhs_location: u64,
}

impl StepHistory {
    /// Method and setting.
    pub fn title(&self) -> String {
        format!("{}, {}", self.method, self.setting)
    }

    /// The mode of a step: by its name, where modes have names, else by what the site does.
    pub fn mode_name(&self, step: &StepRow) -> &str {
        let own = self.modes.get(usize::from(step.mode_number));
        own.map_or(step.kind().name(), String::as_str)
    }

    /// Whether two steps are in one mode.
    pub fn is_same_mode(&self, a: &StepRow, b: &StepRow) -> bool {
        let is_same = self.modes.is_empty() || a.mode_number == b.mode_number;
        a.kind() == b.kind() && is_same
    }

    /// What a step is part of: the mode by its name, else a contact, whatever its modes, or a flight.
    pub fn stay_name(&self, step: &StepRow) -> &str {
        if !self.modes.is_empty() {
            self.mode_name(step)
        } else if step.kind().is_contact() {
            "contact"
        } else {
            "flight"
        }
    }

    /// Whether a step and the next are part of one stay. A mode with a name is stayed in from one event to the next.
    pub fn is_same_stay(&self, step: &StepRow, next: &StepRow) -> bool {
        if self.modes.is_empty() {
            return step.kind().is_contact() == next.kind().is_contact();
        }
        self.is_same_mode(step, next) && next.since_restart > 1
    }
}

/// The accepted steps of every method of the study on every part, part by part, at the
/// located setting of `table` of least [`work`] with `e` at most [`ACCURACY`] and the events of the reference, or the
/// most accurate one where there is none; a method without a finished run is left out.
pub fn step_histories(
    subject: &Subject,
    plan: &Plan,
    table: &WorkPrecision,
    limits: Limits<'_>,
) -> Vec<StepHistory> {
    let mut methods: Vec<&str> = Vec::new();
    for setting in &plan.settings {
        if !methods.contains(&setting.method.name) {
            methods.push(setting.method.name);
        }
    }
    let mut histories = Vec::new();
    for (i, part) in subject.parts.iter().enumerate() {
        for method in &methods {
            let chosen = comparable(&table.rows, method).and_then(|row| {
                let setting = plan.settings.iter().find(|setting| row.is_of(setting))?;
                Some(history((i + 1, part), setting, row, plan.t_end, limits))
            });
            histories.extend(chosen);
        }
    }
    histories
}

/// The located run of a method at which it is compared with others: that of the least [`work`], which does not
/// change from one measurement to the next, and counts a series for what it costs.
fn comparable<'a>(rows: &'a [Row], method: &str) -> Option<&'a Row> {
    let own = || {
        let located = |row: &&Row| row.method == method && row.events == Events::Located;
        rows.iter().filter(located).filter_map(|row| Some((row, row.e?)))
    };
    let reaching = own().filter(|(row, e)| *e <= ACCURACY && row.events_are_right());
    let cheapest = reaching.min_by(|a, b| cost(a.0).total_cmp(&cost(b.0)));
    let chosen = cheapest.or_else(|| own().min_by(|a, b| a.1.total_cmp(&b.1)));
    chosen.map(|(row, _)| row)
}

/// The work of a row; see [`work`].
fn cost(row: &Row) -> f64 {
    let Some(method) = Method::named(&row.method) else { return f64::INFINITY };
    let (n_rhs, n_lin_solves) = (row.n_rhs, row.n_lin_solves);
    // A row does not tell which were series. A method of series takes nothing else.
    let n_series = if method.chooses() { 0 } else { n_rhs };
    work(method, row.rtol, &Work { n_rhs, n_series, n_lin_solves, ..Work::default() })
}

fn history(
    (number, part): (usize, &Part),
    setting: &Setting,
    row: &Row,
    t_end: f64,
    limits: Limits<'_>,
) -> StepHistory {
    let mut watch = limits.watch(Price::of_setting(setting));
    let (run, Steps { steps, events, .. }) = part.runs.steps(setting, t_end, &mut watch);
    StepHistory {
        method: row.method.clone(),
        setting: setting.accuracy.to_string(),
        e: row.e.unwrap_or(f64::NAN),
        part: number,
        name: part.name.clone(),
        n_sites: part.sites.len(),
        modes: part.modes.clone(),
        steps,
        events,
        n_rhs: run.stats.work.n_rhs,
        n_rhs_restart: run.stats.restart.n_rhs,
        n_rhs_location: run.stats.location.n_rhs,
    }
}
