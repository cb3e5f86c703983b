//! Landing on an event: the step is retaken until it ends just past the surface of the guard that falls first.

use super::{OneStep, OneStepSolver};
use crate::error::Error;
use crate::event_location::{GuardCrossing, cubic_root};
use crate::root::Bracket;
use crate::step::Step;
use crate::system::System;
use crate::work::Stats;

/// An event is far where Newton's iteration changes the step by more than this fraction, and not for the first time. Where the guard
/// rises from its surface and falls back, two roots seem one from there, and the distance is halved at a time.
const FAR: f64 = 0.1;
/// Number of retaken steps after which every other one is a bisection.
const MOST_RETAKES: usize = 16;
/// The search ends where the bracket is no wider than the rounding of the time, and than this fraction of the step.
const NARROW: f64 = 1e-14;

/// The guard at the end of a retaken step.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Size of the step.
    h: f64,
    /// What the guard is above the value at which events are located; at the start, where the bound may be far off, above its
    /// surface.
    clearance: f64,
    rate: f64,
}

impl End {
    /// The size of the step that Newton's iteration takes next.
    fn by_newton(&self) -> f64 {
        self.h - self.clearance / self.rate
    }
}

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
    /// Newton's iteration on `g(y(t₀ + h))`, with `dg/dh` from the slope at the end, inside a bracket; where it is [far](FAR) or leaves the
    /// bracket, the root of the cubic through values and rates at both ends of that. It ends where
    /// the guard is at or below zero but within its rounding bound, or where the bracket has no width that counts.
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
        let (mut ends, mut n) = ([None::<End>; 2], 0);
        loop {
            h = bracket.inside(h);
            let closed = bracket.is_closed() || is_narrow(bracket, t0);
            if closed {
                h = bracket.below;
            }
            let violated = self.retake(problem, mode.clone(), t0 + h, h, stats)?;
            bracket.narrow(h, if violated.is_some() { -1.0 } else { 1.0 });
            let is_past = violated.is_some() && is_narrow(bracket, t0);
            let is_on = violated.is_none() && self.watch.is_past(guard);
            if closed || is_past || is_on {
                return Ok(violated.or(Some(guard)));
            }
            let (next, end) = self.first_by_newton(problem, mode.clone(), guard, h);
            if next != guard {
                (guard, ends) = (next, [None; 2]);
            }
            ends[usize::from(violated.is_some())] = Some(end);
            n += 1;
            h = end.by_newton();
            if n > MOST_RETAKES && n % 2 == 0 {
                h = bracket.middle();
            } else if n > 1 && (h - end.h).abs() > FAR * end.h.abs() || bracket.inside(h) != h {
                if bracket.above == 0.0 && ends[0].is_none() {
                    ends[0] = Some(self.start(problem, mode.clone(), guard));
                }
                h = between(ends).unwrap_or(h);
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
        self.watch.violated_beside(problem, mode, (t1, h), self.method.step().y1())
    }

    /// Among the guards violated at the end of the last attempt, of size `h` (or `guard` if none is), the one whose event
    /// Newton's iteration estimates to be the first, and its end.
    fn first_by_newton(
        &mut self,
        problem: &P,
        mode: P::Mode,
        guard: usize,
        h: f64,
    ) -> (usize, End) {
        let (t1, y1) = (self.method.step().t1(), self.method.step().y1());
        let slope1 = self.method.step().slope1();
        self.watch.rates(problem, mode, t1, y1, slope1);
        let end =
            |i: usize| End { h, clearance: self.watch.clearance(i), rate: self.watch.rate(i) };
        let estimate = |end: &End| end.by_newton().abs();
        (0..problem.n_guards())
            .filter(|&i| self.watch.is_violated(i))
            .map(|i| (i, end(i)))
            .min_by(|a, b| estimate(&a.1).total_cmp(&estimate(&b.1)))
            .unwrap_or_else(|| (guard, end(guard)))
    }

    /// Guard `i` at the start of the step, as the end of a step without size. What is within rounding of the surface is zero there.
    fn start(&mut self, problem: &P, mode: P::Mode, i: usize) -> End {
        let step = self.method.step();
        self.watch.rates(problem, mode, step.t0(), step.y0(), step.slope0());
        let g = self.watch.end_value(i);
        let clearance = if g > self.watch.bound(i) { g } else { 0.0 };
        End { h: 0.0, clearance, rate: self.watch.rate(i) }
    }
}

/// Whether a bracket of step sizes from `t0` has no width that counts: at most ε times the time there, and [`NARROW`] of the step.
fn is_narrow(bracket: Bracket, t0: f64) -> bool {
    let Bracket { above, below } = bracket;
    let width = (below - above).abs();
    width <= f64::EPSILON * (t0 + below).abs() && width <= NARROW * below.abs()
}

/// The size of the step at which the cubic through both ends falls; `None` where one is not known, or it does not fall.
fn between([above, below]: [Option<End>; 2]) -> Option<f64> {
    let (above, below) = (above?, below?);
    let h = below.h - above.h;
    let theta = cubic_root([above.clearance, below.clearance], [above.rate * h, below.rate * h])?;
    Some(above.h + theta * h)
}
