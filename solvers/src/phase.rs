//! The contract of a method: it integrates one smooth phase, from a point to the first event.

pub use crate::point::Point;

use crate::error::Error;
use crate::record::Record;
use crate::system::System;
use crate::work::Stats;

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
