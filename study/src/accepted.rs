//! The accepted steps of one run.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Needs, Record};
use serde::{Deserialize, Serialize};

use crate::problem::{Problem, leading_site};
use crate::run::{Brake, Braked, PartRun, Setting, integrate};

/// What a site does in a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModeKind {
    /// Free, or held.
    Flight,
    /// In contact; where there is friction, the surfaces slide.
    #[serde(alias = "slip")]
    Contact,
    /// In contact, the surfaces rolling on each other.
    Stick,
}

impl ModeKind {
    /// All, in the order of figures.
    pub const ALL: [Self; 3] = [Self::Flight, Self::Contact, Self::Stick];

    /// Of a mode as the files write it: 0 free, 2 stick, any other in contact.
    pub fn of(mode: i8) -> Self {
        match mode {
            0 => Self::Flight,
            2 => Self::Stick,
            _ => Self::Contact,
        }
    }

    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flight => "flight",
            Self::Contact => "contact",
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
    pub(crate) steps: Vec<StepRow>,
    pub(crate) events: Vec<f64>,
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

#[cfg(test)]
mod tests {
    use super::ModeKind;

    #[test]
    fn codes_of_files_have_names_and_tell_a_contact() {
        let kinds = [0, 1, -1, 2].map(ModeKind::of);
        assert_eq!(kinds.map(ModeKind::name), ["flight", "contact", "contact", "stick"]);
        assert_eq!(kinds.map(ModeKind::is_contact), [false, true, true, true]);
    }
}
