//! Step sizes from outside, for a method that is one of several in a run.

use super::{OneStep, OneStepSolver};
use crate::phase::PhaseSolver;
use crate::system::System;

/// A solver whose step sizes can be set or limited from outside between phases.
pub(crate) trait Paced<P: System>: PhaseSolver<P> {
    /// Begins the next phase with a step of size `h`, unless the method proposes a size.
    fn begin_with(&mut self, h: f64);

    /// Takes no step longer than `longest` from the next phase on.
    fn keep_below(&mut self, longest: f64);
}

impl<P: System, M: OneStep<P>> Paced<P> for OneStepSolver<P, M> {
    fn begin_with(&mut self, h: f64) {
        self.next_h = Some(h);
    }

    fn keep_below(&mut self, longest: f64) {
        self.longest_now = longest.min(self.longest_of_run);
    }
}
