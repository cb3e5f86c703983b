//! The contract of a method: it integrates one smooth phase, from a point to the first event.

use crate::error::Error;
use crate::record::Record;
use crate::stats::Stats;
use crate::system::System;

/// Time, state and mode of an integration.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Integration, Point};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let rest = Point { t: 0.0, y: [0.0; 2], mode: BouncingMode::Rest };
/// assert_eq!(Integration::at(&ball, rest).point.mode, BouncingMode::Rest);
/// ```
#[derive(Clone, Debug)]
pub struct Point<P: System> {
    /// Time.
    pub t: f64,
    /// State.
    pub y: P::State<f64>,
    /// Mode.
    pub mode: P::Mode,
}

/// How a phase ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseEnd {
    /// At the end of the run's time.
    EndOfTime,
    /// Just past the surface of this guard.
    Guard(usize),
    /// Where the recorder asked for the end of the run.
    Interrupted,
}

/// A method applied to one system.
pub trait PhaseSolver<P: System> {
    /// Advances `point` in its mode to `t_end`, or to just past the first violated guard, and
    /// shows `record` the accepted steps that it needs.
    ///
    /// # Errors
    /// Any [`Error`] of a step; `point` is then at the end of the last accepted step.
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error>;
}

/// [`Error::NonFinite`] if a state of `y` is infinite or not a number.
pub(crate) fn check_finite<P: System>(point: &Point<P>, y: &P::State<f64>) -> Result<(), Error> {
    match y.as_ref().iter().position(|y| !y.is_finite()) {
        None => Ok(()),
        Some(component) => {
            Err(Error::NonFinite { t: point.t, mode: format!("{:?}", point.mode), component })
        }
    }
}
