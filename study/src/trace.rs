//! A run as plain values, whatever the problem: samples, and the events that runs are compared by.

use deltazero_solvers::{System, Trajectory};

use crate::errors::near_end;
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
    /// The events of each site that runs are compared by; see [`changes`].
    pub changes: Vec<Vec<ModeChange>>,
    /// Times of the events at which a state jumps [s].
    pub jumps: Vec<f64>,
    /// The end of the run [s].
    pub t_end: f64,
}

impl Trace {
    /// What was kept of a run of `problem` to `t_end` [s].
    pub fn of<P: Problem>(problem: &P, run: &OwnTrajectory<P>, t_end: f64) -> Self {
        Self {
            times: run.samples.iter().map(|sample| sample.t).collect(),
            states: run.samples.iter().map(|sample| sample.y.as_ref().to_vec()).collect(),
            changes: changes(problem, &run.events),
            jumps: jumps(problem, run),
            t_end,
        }
    }

    /// Its samples.
    pub fn samples(&self) -> Samples<'_> {
        Samples { times: &self.times, states: &self.states, jumps: self.jumps() }
    }

    /// Its jumps.
    pub fn jumps(&self) -> Jumps<'_> {
        Jumps { at: &self.jumps, t_end: self.t_end }
    }
}

/// Samples of a run, and what is to be known to compare them.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Their times [s].
    pub times: &'a [f64],
    /// States there.
    pub states: &'a [Vec<f64>],
    /// Where a state jumps.
    pub jumps: Jumps<'a>,
}

/// Jumps of a run.
#[derive(Clone, Copy, Debug)]
pub struct Jumps<'a> {
    /// Times of the events at which a state jumps [s].
    pub at: &'a [f64],
    /// The end of the run [s].
    pub t_end: f64,
}

impl<'a> Samples<'a> {
    /// Those of this run and another at the same times [s] that can be compared: all but those between a jump of one run
    /// and the same jump of the other, `window` [s] apart at most. There the states are of different sides of the jump, and
    /// their difference is the jump, however near the runs are. The other jump may lie beyond the end of both.
    pub fn pairs(
        self,
        other: Samples<'a>,
        window: f64,
    ) -> impl Iterator<Item = (f64, &'a [f64], &'a [f64])> {
        let pairs = self.times.iter().zip(self.states.iter().zip(other.states));
        let jumps = [self.jumps, other.jumps];
        let pairs = pairs.filter(move |(t, _)| !is_between(jumps, window, **t));
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

/// Whether `t` lies between a jump of one run and the same jump of another, `window` apart at most, which may be beyond the end
/// of both. The state at a jump is the one after it.
pub(crate) fn is_between([own, other]: [Jumps<'_>; 2], window: f64, t: f64) -> bool {
    let end = own.t_end.max(other.t_end);
    let of_one = |[ahead, behind]: [Jumps<'_>; 2]| {
        // A partner is looked for twice as far back as a jump whose partner may be beyond the end.
        let [ahead, behind] = [ahead, behind].map(|jumps| {
            let [from, to] = [t - 2.0 * window, t].map(|t| jumps.at.partition_point(|at| *at <= t));
            &jumps.at[from..to]
        });
        let lacked = ahead.get(behind.len()..).unwrap_or_default();
        !lacked.is_empty() && lacked.iter().all(|at| at + near_end(window, end) > end)
    };
    is_to_come(own.at, other.at, window, t) || of_one([own, other]) || of_one([other, own])
}

/// Whether one run has jumped more often in the `window` before `t`, and these jumps of the other are about to come.
fn is_to_come(own: &[f64], other: &[f64], window: f64, t: f64) -> bool {
    let lately = |jumps: &'_ [f64]| {
        let [from, to] = [t - window, t].map(|t| jumps.partition_point(|at| *at <= t));
        (to - from, to)
    };
    let [(n_own, own_to), (n_other, other_to)] = [own, other].map(lately);
    let n = n_own.abs_diff(n_other);
    let ((ahead, to), (behind, from)) = if n_own > n_other {
        ((own, own_to), (other, other_to))
    } else {
        ((other, other_to), (own, own_to))
    };
    let to_come = behind[from..].iter().take(n);
    let mut pairs = ahead[to - n..to].iter().zip(to_come.clone());
    n > 0 && to_come.len() == n && pairs.all(|(a, b)| (a - b).abs() <= window)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_between_jumps_if_one_run_has_jumped_and_the_other_is_about_to() {
        let (own, other) = ([1.0, 2.0, 3.0], [1.01, 2.0, 2.9]);
        let is_between = |own: &[f64], other: &[f64], t| {
            is_between([own, other].map(|at| Jumps { at, t_end: 100.0 }), 0.05, t)
        };
        let judged = |t| is_between(&own, &other, t);
        for (t, expected) in [
            (0.99, false),
            (1.0, true),
            (1.005, true),
            (1.01, false),
            (2.0, false),
            // Further apart than the window.
            (2.95, false),
            (2.97, false),
            (3.0, false),
        ] {
            assert_eq!(judged(t), expected, "{t}");
            assert_eq!(is_between(&other, &own, t), expected, "{t}");
        }
        // A jump that the other run does not have is an error.
        assert!(!is_between(&[1.0], &[], 1.0));
        assert!(is_between(&[1.0, 1.0], &[1.01, 1.01], 1.005));
        // Nor does it part the later ones.
        assert!(is_between(&[1.0, 2.0, 3.0], &[1.0, 1.5, 2.0, 3.01], 3.005));
        // Where both end, it may come to it a moment later,
        for (own, expected) in [(100.0, true), (99.96, true), (99.94, false)] {
            assert_eq!(is_between(&[own], &[], 100.0), expected, "{own}");
            assert_eq!(is_between(&[], &[own], 100.0), expected, "{own}");
        }
        // but not one that it has had.
        assert!(!is_between(&[99.951], &[99.949], 100.0));
        // One that ends the run of each is behind both.
        let ends = |at, t_end| Jumps { at, t_end };
        assert!(!super::is_between(
            [ends(&[1.0], 1.0), ends(&[1.0 + 1e-9], 1.0 + 1e-9)],
            0.05,
            1.0 + 1e-9
        ));
    }
}
