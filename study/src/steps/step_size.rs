//! How does the step size of each method follow flight, contact and events?

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Method, Needs, Record, Work};
use serde::{Deserialize, Serialize};

use crate::part::{Part, Subject};
use crate::plan::Plan;
use crate::problem::{Problem, leading_site};
use crate::run::{Brake, Braked, Events, Limits, PartRun, Price, Setting, integrate};
use crate::selection::work;
use crate::work_precision::{Row, WorkPrecision};

/// Error at which methods are compared: each at its cheapest setting that reaches it with all events.
pub const ACCURACY: f64 = 1e-6;

/// What a site does in a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModeKind {
    /// Free, or held.
    Flight,
    /// In contact, the surfaces sliding.
    Slip,
    /// In contact, the surfaces rolling on each other.
    Stick,
}

impl ModeKind {
    /// All, in the order of figures.
    pub const ALL: [Self; 3] = [Self::Flight, Self::Slip, Self::Stick];

    /// Of a mode as the files write it: 0 free, ±1 slip, 2 stick.
    pub fn of(mode: i8) -> Self {
        match mode {
            0 => Self::Flight,
            2 => Self::Stick,
            _ => Self::Slip,
        }
    }

    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flight => "flight",
            Self::Slip => "slip",
            Self::Stick => "stick",
        }
    }

    /// Whether a contact force acts.
    pub fn is_contact(self) -> bool {
        self != Self::Flight
    }
}

/// An accepted step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRow {
    /// Its start [s].
    pub t_s: f64,
    /// Its size [s].
    pub h_s: f64,
    /// Its mode: 0 free, ±1 slip, 2 stick; of several sites that of the [leading](leading_site) one.
    pub mode: i8,
    /// The [number](Problem::mode_number) of its mode.
    pub mode_number: u16,
    /// Its number since the last event, or the start of the run, from 1.
    pub since_restart: usize,
    /// Steps rejected since the one before it.
    pub n_rejected: u64,
    /// Whether it was cut short to land on an event.
    pub lands: bool,
}

impl StepRow {
    /// Its end [s].
    pub fn end(&self) -> f64 {
        self.t_s + self.h_s
    }

    /// What the site does in it.
    pub fn kind(&self) -> ModeKind {
        ModeKind::of(self.mode)
    }
}

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
    /// [Names](Problem::named_modes) of the modes, where they have any.
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

/// The steps of `problem` to `t_end`.
pub(crate) fn steps<P: Problem>(
    problem: &P,
    setting: &Setting,
    t_end: f64,
    brake: &mut dyn Brake,
) -> (PartRun, Steps) {
    let mut record = (StepsOf { problem, kept: Steps::default() }, Braked(brake));
    let run = integrate(problem, setting, problem.start(), t_end, &mut record);
    (run.plain(), record.0.kept)
}

/// Every step and event of a run.
#[derive(Default)]
pub(crate) struct Steps {
    steps: Vec<StepRow>,
    events: Vec<f64>,
    since_restart: usize,
    n_rejected: u64,
}

/// A recorder of steps.
struct StepsOf<'a, P> {
    problem: &'a P,
    kept: Steps,
}

impl<P: Problem> Record<P> for StepsOf<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let (t0, t1) = (accepted.step.t0(), accepted.step.t1());
        // A guard that falls by rounding at the start of a step is landed on there, and such a step has no size.
        if t1 == t0 {
            return ControlFlow::Continue(());
        }
        let n_rejected = accepted.stats.n_rejected;
        let site = leading_site(self.problem, &accepted.mode);
        let kept = &mut self.kept;
        kept.since_restart += 1;
        kept.steps.push(StepRow {
            t_s: t0,
            h_s: t1 - t0,
            mode: self.problem.code(&accepted.mode, site),
            mode_number: self.problem.mode_number(&accepted.mode),
            since_restart: kept.since_restart,
            n_rejected: n_rejected - kept.n_rejected,
            lands: accepted.landed_on.is_some(),
        });
        kept.n_rejected = n_rejected;
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.kept.events.push(event.t);
        self.kept.since_restart = 0;
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}
