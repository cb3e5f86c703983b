//! How does the step size of each method follow flight, contact and events?

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Method, Needs, Record, Work};
use serde::{Deserialize, Serialize};

use crate::config::{Config, Events};
use crate::contest::work;
use crate::model::{Jointed, Mechanism, Part};
use crate::run::{Accuracy, Integrable, Limits, Price, Setting, integrate};
use crate::study::work_precision::{Row, WorkPrecision};

/// Error at which methods are compared: each at its cheapest setting that reaches it with all events.
pub const ACCURACY: f64 = 1e-6;

/// What a joint does in a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModeKind {
    /// Free, or held without clearance.
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
    /// Its mode: 0 free, ±1 slip, 2 stick; of several joints that of [`Jointed::foremost`].
    pub mode: i8,
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

    /// What the joint does in it.
    pub fn kind(&self) -> ModeKind {
        ModeKind::of(self.mode)
    }
}

/// The steps of one method on one joint, events located.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepHistory {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// Error `e` of that setting in the study, all joints together.
    pub e: f64,
    /// Joint, 1 or 2.
    pub joint: usize,
    /// Bays of it that step together.
    #[serde(default = "one_bay")]
    pub bays: usize,
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

/// Of histories that were written without a number.
fn one_bay() -> usize {
    1
}

impl StepHistory {
    /// Method and setting.
    pub fn title(&self) -> String {
        format!("{}, {}", self.method, self.setting)
    }
}

/// The accepted steps of every method of the study on every part, part by part, at the
/// located setting of `table` of least [`work`] with `e` at most [`ACCURACY`] and the events of the reference, or the
/// most accurate one where there is none; a method without a finished run is left out.
pub fn step_histories(
    config: &Config,
    table: &WorkPrecision,
    limits: Limits<'_>,
) -> Vec<StepHistory> {
    let mechanism = Mechanism::new(config);
    let mut histories = Vec::new();
    for part in &mechanism.parts {
        for name in &config.study.methods {
            let chosen = comparable(&table.rows, name).and_then(|row| {
                let (setting, t_end) = (setting(row, config)?, config.run.t_end);
                Some(match part {
                    Part::Block(block) => history(block, &setting, row, t_end, limits),
                    Part::Chain(chain) => history(chain, &setting, row, t_end, limits),
                })
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
    let counts = Work { n_rhs: row.n_rhs, n_lin_solves: row.n_lin_solves, ..Work::default() };
    Method::named(&row.method).map_or(f64::INFINITY, |method| work(method, row.rtol, &counts))
}

/// The setting of a row.
fn setting(row: &Row, config: &Config) -> Option<Setting> {
    let accuracy = Accuracy::of_columns(row.rtol, row.step, config.solver.atol)?;
    Some(Setting { method: Method::named(&row.method)?, events: row.events, accuracy })
}

fn history<P: Integrable>(
    part: &P,
    setting: &Setting,
    row: &Row,
    t_end: f64,
    limits: Limits<'_>,
) -> StepHistory {
    let mut record = (Steps::default(), limits.watch(Price::of_setting(setting)));
    let run = integrate(part, setting, part.start(), t_end, &mut record);
    let Steps { steps, events, .. } = record.0;
    StepHistory {
        method: row.method.clone(),
        setting: setting.accuracy.to_string(),
        e: row.e.unwrap_or(f64::NAN),
        joint: run.joint,
        bays: part.n_joints(),
        steps,
        events,
        n_rhs: run.stats.work.n_rhs,
        n_rhs_restart: run.stats.restart.n_rhs,
        n_rhs_location: run.stats.location.n_rhs,
    }
}

/// A recorder of steps.
#[derive(Default)]
struct Steps {
    steps: Vec<StepRow>,
    events: Vec<f64>,
    since_restart: usize,
    n_rejected: u64,
}

impl<P: Jointed> Record<P> for Steps {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let (t0, t1) = (accepted.step.t0(), accepted.step.t1());
        let n_rejected = accepted.stats.n_rejected;
        self.since_restart += 1;
        self.steps.push(StepRow {
            t_s: t0,
            h_s: t1 - t0,
            mode: P::foremost(&accepted.mode).code(),
            since_restart: self.since_restart,
            n_rejected: n_rejected - self.n_rejected,
            lands: accepted.landed_on.is_some(),
        });
        self.n_rejected = n_rejected;
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.events.push(event.t);
        self.since_restart = 0;
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

/// Quantile of `values`, which it sorts: the element nearest below the fraction of its length.
pub(crate) fn quantile(values: &mut [f64], fraction: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((fraction * last as f64 + 0.5) as usize).copied()
}
