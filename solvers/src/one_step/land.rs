//! Landing on an event: the step is retaken until it ends just past the surface of the guard that falls first.

use super::{OneStep, OneStepSolver};
use crate::error::Error;
use crate::event_location::GuardCrossing;
use crate::root::Bracket;
use crate::step::Step;
use crate::system::System;
use crate::work::Stats;

/// Number of retaken steps by Newton's iteration after which every other one is a bisection.
const NEWTON_RETAKES: usize = 8;

impl<P: System, M: OneStep<P>> OneStepSolver<P, M> {
    /// Lands on the guard that falls first on the completed step and returns it; `None` where no guard falls.
    ///
    /// # Errors
    /// [`Error::UnresolvedGuard`] where the dense output shows one dip after another that is none, beside those of the
    /// method.
    pub(super) fn locate(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) -> Result<Option<usize>, Error> {
        loop {
            let crossing =
                self.method.first_to_fall(problem, mode.clone(), &mut self.watch, stats)?;
            let Some(crossing) = crossing else { return Ok(None) };
            self.note_error(problem, mode.clone());
            if let Some(guard) = self.land(problem, mode.clone(), crossing, stats)? {
                return Ok(Some(guard));
            }
            let step = self.method.step();
            let of_step = (step.t0(), step.t1() - step.t0());
            self.watch.disprove_dip(crossing.guard, of_step, &mode)?;
        }
    }

    /// Retakes the step so that it ends just past the surface of the guard that falls first, and returns that guard.
    /// Returns `None` where the dense output showed a dip of the guard that the retaken step does not show; the step
    /// is then taken again in full.
    ///
    /// Newton's iteration on `g(y(t₀ + h))`, with `dg/dh` from the slope at the end, inside a bracket. It ends where
    /// the guard is at or below zero but within its rounding bound, or where the bracket contains no further number.
    fn land(
        &mut self,
        problem: &P,
        mode: P::Mode,
        crossing: GuardCrossing,
        stats: &mut Stats,
    ) -> Result<Option<usize>, Error> {
        let (t0, t1) = (self.method.step().t0(), self.method.step().t1());
        let mut bracket = Bracket { above: 0.0, below: crossing.violated_at - t0 };
        if (crossing.violated_at != t1 || !self.method.repeats())
            && self
                .retake(problem, mode.clone(), t0 + bracket.below, bracket.below, stats)?
                .is_none()
        {
            let (step, h) = (self.method.step(), t1 - t0);
            self.watch.note_discarded(problem, mode.clone(), step, crossing.guard, h);
            self.retake(problem, mode, t1, t1 - t0, stats)?;
            return Ok(None);
        }
        let (mut guard, mut h) = (crossing.guard, crossing.t - t0);
        let mut n = 0;
        loop {
            h = bracket.inside(h);
            let closed = bracket.is_closed();
            if closed {
                h = bracket.below;
            }
            let violated = self.retake(problem, mode.clone(), t0 + h, h, stats)?;
            if closed || (violated.is_none() && self.watch.is_past(guard)) {
                return Ok(violated.or(Some(guard)));
            }
            bracket.narrow(h, if violated.is_some() { -1.0 } else { 1.0 });
            (guard, h) = self.newton(problem, mode.clone(), guard, h);
            n += 1;
            if n > NEWTON_RETAKES && n % 2 == 0 {
                h = bracket.middle();
            }
        }
    }

    /// Takes the step again with another size, and returns the first guard violated at its end.
    #[inline(never)]
    fn retake(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t1: f64,
        h: f64,
        stats: &mut Stats,
    ) -> Result<Option<usize>, Error> {
        self.method.attempt(problem, mode.clone(), t1, h, stats);
        if !self.method.has_converged() {
            let (t, mode) = (self.method.step().t0(), format!("{mode:?}"));
            return Err(Error::NoConvergence { t, h, mode });
        }
        self.method.complete(problem, mode.clone(), stats);
        stats.n_retaken += 1;
        self.watch.violated(problem, mode, t1, self.method.step().y1())
    }

    /// Chooses the next retaken step by Newton's iteration: among the guards violated at the end of the last attempt
    /// (or `guard` if none is), the guard whose estimated step size is the smallest, and that step size.
    fn newton(&mut self, problem: &P, mode: P::Mode, guard: usize, h: f64) -> (usize, f64) {
        let (t1, y1) = (self.method.step().t1(), self.method.step().y1());
        let slope1 = self.method.step().slope1();
        self.watch.rates(problem, mode, t1, y1, slope1);
        let estimate = |i: usize| h - self.watch.clearance(i) / self.watch.rate(i);
        (0..problem.n_guards())
            .filter(|&i| self.watch.is_violated(i))
            .map(|i| (i, estimate(i)))
            .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .unwrap_or_else(|| (guard, estimate(guard)))
    }
}
