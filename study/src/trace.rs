//! A run as plain values, whatever the problem: samples, and the events that runs are compared by.

use deltazero_solvers::{System, Trajectory};

use crate::problem::{Problem, changes};
use crate::run::ModeChange;

/// Samples and events of a problem, in its own states and modes.
pub type OwnTrajectory<P> = Trajectory<<P as System>::State<f64>, <P as System>::Mode>;

/// Samples and events of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// States there.
    pub states: Vec<Vec<f64>>,
    /// The counted events of each site.
    pub changes: Vec<Vec<ModeChange>>,
}

impl Trace {
    /// What was kept of a run of `problem`.
    pub fn of<P: Problem>(problem: &P, run: &OwnTrajectory<P>) -> Self {
        Self {
            times: run.samples.iter().map(|sample| sample.t).collect(),
            states: run.samples.iter().map(|sample| sample.y.as_ref().to_vec()).collect(),
            changes: changes(problem, &run.events),
        }
    }
}
