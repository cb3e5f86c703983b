//! The state of a phase between two attempts of a step.

use std::fmt::Debug;

use crate::error::Error;
use crate::point::Point;
use crate::record::Record;
use crate::system::System;
use crate::work::Stats;

/// State of a phase: its end, and the size of the step to try next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhaseState {
    pub(crate) t_end: f64,
    /// Factor by which the last step may be longer than the chosen size.
    pub(super) stretch: f64,
    /// Size of the step to try next; zero until that of the first one is chosen.
    pub(crate) h: f64,
    /// Set while the size of the next step is still to be chosen.
    pub(crate) due: Option<Due>,
}

/// Which step's size is to be chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Due {
    /// The first step of a phase.
    First {
        /// Smallest size that the time resolves.
        least: f64,
    },
    /// A later step, of a method that proposes step sizes.
    Next,
}

impl PhaseState {
    /// The end time and the size of the step to attempt from `point`; `None` at the end of the phase.
    #[inline(always)]
    pub(crate) fn next<P: System>(&self, point: &Point<P>) -> Result<Option<(f64, f64)>, Error> {
        if point.t == self.t_end {
            return Ok(None);
        }
        let last = (self.t_end - point.t).abs() <= self.stretch * self.h.abs();
        let t1 = if last { self.t_end } else { point.t + self.h };
        if t1 == point.t {
            return Err(underflow(point.t, &point.mode, self.h));
        }
        // The size is the difference of the rounded times, so that t and y stay consistent.
        Ok(Some((t1, t1 - point.t)))
    }
}

/// The system that a phase belongs to, the present point, and who counts and records.
pub(crate) struct PhaseContext<'a, P: System> {
    pub(crate) problem: &'a P,
    pub(crate) point: &'a mut Point<P>,
    pub(crate) stats: &'a mut Stats,
    pub(crate) record: &'a mut dyn Record<P>,
}

/// [`Error::StepUnderflow`] for a step of size `h` that is below the resolution of the time `t`.
pub(super) fn underflow(t: f64, mode: &impl Debug, h: f64) -> Error {
    Error::StepUnderflow { t, h, mode: format!("{mode:?}") }
}
