//! A run as plain values, whatever the problem: samples, and the events that runs are compared by.

use deltazero_solvers::{System, Trajectory};

use crate::problem::{Problem, changes, scales};
use crate::run::ModeChange;

/// A state that changes by less at an event, in its natural size, is only put onto a surface.
const LEAST_JUMP: f64 = 1e-9;

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
    /// Times of the events at which a state jumps [s].
    pub jumps: Vec<f64>,
}

impl Trace {
    /// What was kept of a run of `problem`.
    pub fn of<P: Problem>(problem: &P, run: &OwnTrajectory<P>) -> Self {
        Self {
            times: run.samples.iter().map(|sample| sample.t).collect(),
            states: run.samples.iter().map(|sample| sample.y.as_ref().to_vec()).collect(),
            changes: changes(problem, &run.events),
            jumps: jumps(problem, run),
        }
    }

    /// The samples of this run and another, with their times [s], that can be compared: all but those
    /// [between](is_between_jumps) a jump of one and that of the other, `window` [s] apart at most.
    pub fn pairs<'a>(
        &'a self,
        other: &'a Self,
        window: f64,
    ) -> impl Iterator<Item = (f64, &'a [f64], &'a [f64])> {
        let pairs = self.times.iter().zip(self.states.iter().zip(&other.states));
        let is_between = move |t: f64| is_between_jumps(&self.jumps, &other.jumps, window, t);
        let pairs = pairs.filter(move |(t, _)| !is_between(**t));
        pairs.map(|(t, (own, other))| (*t, own.as_slice(), other.as_slice()))
    }
}

/// Times of the events at which a state changes by more than [`LEAST_JUMP`] natural sizes [s].
fn jumps<P: Problem>(problem: &P, run: &OwnTrajectory<P>) -> Vec<f64> {
    let scales = scales(problem);
    let is_jump = |[before, after]: &[P::State<f64>; 2]| {
        let sides = before.as_ref().iter().zip(after.as_ref());
        sides.zip(&scales).any(|((a, b), scale)| (a - b).abs() > LEAST_JUMP * scale)
    };
    let events = run.events.iter().zip(&run.sides);
    events.filter(|(_, sides)| is_jump(sides)).map(|(event, _)| event.t).collect()
}

/// Whether `t` lies between a jump of one run and the same jump of another, `window` [s] apart at most: their states there
/// are of different sides of it, so their difference is the jump, however near the runs are. The k-th jumps are the same.
pub fn is_between_jumps(own: &[f64], other: &[f64], window: f64, t: f64) -> bool {
    // The state at a jump is the one after it.
    let [a, b] = [own, other].map(|jumps| jumps.partition_point(|at| *at <= t));
    let mut apart = own.iter().zip(other).skip(a.min(b)).take(a.abs_diff(b));
    a != b
        && own.len().min(other.len()) >= a.max(b)
        && apart.all(|(own, other)| (own - other).abs() <= window)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_between_jumps_if_one_run_has_jumped_and_the_other_is_about_to() {
        let (own, other) = ([1.0, 2.0, 3.0], [1.01, 2.0, 2.9]);
        let is_between = |t| is_between_jumps(&own, &other, 0.05, t);
        for (t, expected) in [
            (0.99, false),
            (1.0, true),
            (1.005, true),
            (1.01, false),
            (2.0, false),
            // Further apart than the window.
            (2.95, false),
            (3.0, false),
        ] {
            assert_eq!(is_between(t), expected, "{t}");
            assert_eq!(is_between_jumps(&other, &own, 0.05, t), expected, "{t}");
        }
        // A jump that the other run does not have is an error.
        assert!(!is_between_jumps(&[1.0], &[], 0.05, 1.0));
        assert!(is_between_jumps(&[1.0, 1.0], &[1.01, 1.01], 0.05, 1.005));
    }
}
