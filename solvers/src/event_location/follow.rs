//! Guards that move faster than the states: which do, and where they fall.

use super::GuardWatch;
use super::graze::Touch;
use super::march::{self, Found};
use super::shape::cubic_at;
use crate::dense::hermite;
use crate::error::Error;
use crate::step::Step;
use crate::system::System;

/// Fractions of a step at which the guards are compared with their cubics. No two distances between them have a simple
/// ratio, so that no sine of many periods has the values of a cubic at all of them.
#[allow(clippy::approx_constant, reason = "0.318 is not meant to be 1/π")]
const PROBES: [f64; 5] = [0.14, 0.318, 0.53, 0.69, 0.91];
/// A guard strays where it differs from its cubic by more than this fraction of its size. A sine that is as large as its
/// range is seen to follow its cubic over 3.3 radians at most, where the middle of the step is a zero of it.
const STRAYS: f64 = 1.0 / 64.0;
/// Guards are compared with their cubics anew on a step longer than the last one on which they followed by this factor. So no
/// sine is searched for by the polynomial of degree six over more than three quarters of a period.
const LONGER: f64 = 4.0 / 3.0;

/// An end of a step: a state and its slope.
type End<'a, Y> = (&'a Y, &'a Y);

impl<P: System> GuardWatch<P> {
    /// Whether the guards need not be compared with their cubics on a step of size `h`.
    pub(crate) fn is_verified_for(&self, h: f64) -> bool {
        h.abs() <= LONGER * self.verified_step
    }

    /// Whether guard `i` was seen to stray from its cubic on the present step, of size `h`.
    pub(super) fn is_straying(&self, i: usize, h: f64) -> bool {
        self.straying[i] && !self.is_verified_for(h)
    }

    /// Whether all guards follow their cubics on a step from `t0` to `t1`: between its ends, each a state and its slope, they
    /// differ from them by little. The states between are those of the cubic of the states, so that a guard which moves with
    /// the states does not stray.
    #[cold]
    #[inline(never)]
    pub(super) fn all_follow(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t0, t1): (f64, f64),
        [start, end]: [End<'_, P::State<f64>>; 2],
    ) -> bool {
        let h = t1 - t0;
        self.find_bounds(problem, mode.clone(), (t1, end.0), 0.0);
        self.straying.fill(false);
        let mut also_near = true;
        for theta in PROBES {
            hermite(theta, h, start, end, &mut self.y);
            problem.guards(mode.clone(), t0 + theta * h, &self.y, &mut self.values);
            for (i, value) in self.values.as_ref().iter().enumerate() {
                let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
                let slopes = [g0.eps * h, g1.eps * h];
                let off = (value - cubic_at(theta, [g0.re, g1.re], slopes)).abs();
                let size = g0.re.abs().max(g1.re.abs()).max(value.abs());
                let range = (value - g0.re).abs().max((value - g1.re).abs());
                let within = |allowed: f64| off <= STRAYS * allowed + self.bounds.as_ref()[i];
                // A guard that is not a number strays.
                self.straying[i] |= !within(size);
                also_near &= within(range);
            }
        }
        let all = !self.straying.contains(&true);
        if all && also_near {
            self.verified_step = h.abs();
        }
        all
    }

    /// Position of the maximum of guard `i` before its first dip inside the step, and of a point where it is then
    /// violated, in fractions of the step. Without a dip, the position of the maximum after the last minimum, and
    /// `None`.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`], and [`Error::UnresolvedGuard`] for a guard that cannot be followed.
    pub(super) fn first_dip(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
    ) -> Result<(f64, Option<f64>), Error> {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        if self.is_straying(i, h) {
            return self.march(problem, mode, step, i);
        }
        let (top, dip) = self.dip(problem, mode.clone(), step, i);
        let falls = dip.is_some() || self.end.as_ref()[i].re < -self.bounds.as_ref()[i];
        let is_level = top == 0.0 && self.start.as_ref()[i].eps * h <= 0.0;
        // The polynomial may have passed over a maximum that is low beside the range of the guard.
        if falls
            && !is_level
            && self.clearance_on(problem, mode.clone(), step, i, t0 + top * h) <= 0.0
        {
            return self.march(problem, mode, step, i);
        }
        Ok((top, dip))
    }

    /// The same as [`first_dip`](Self::first_dip) in intervals short enough to follow the guard.
    #[cold]
    fn march(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
    ) -> Result<(f64, Option<f64>), Error> {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let first = march::first_width([g0.re, g1.re], [g0.eps * h, g1.eps * h]);
        let (bound, from) = (self.bounds.as_ref()[i], self.disproved.up_to(i));
        let margin = 0.5 * bound + self.doubts.as_ref()[i];
        let mut touches = std::mem::take(&mut self.touches.noted);
        let limit = self.touches.limits().as_ref()[i];
        let g =
            |theta: f64| self.clearance_on(problem, mode.clone(), step, i, t0 + theta * h) + margin;
        let slopes = (from == 0.0 && g0.eps * h < 0.0, g1.eps * h > 0.0);
        let turned = |theta: f64, above: f64| {
            let touch = Touch::new(i, t0 + theta * h, above - margin - 0.5 * bound);
            if touch.height < limit {
                touches.push(touch);
            }
        };
        let found = march::first_fall(g, from, first, bound, slopes, turned);
        self.touches.noted = touches;
        match found {
            Found::Fall(top, below) => {
                self.disproved.found(i, below);
                Ok((top, Some(below)))
            }
            Found::Nothing(top) => Ok((top, None)),
            Found::NotFinite => {
                Err(Error::NonFiniteGuard { t: step.t1(), mode: format!("{mode:?}"), guard: i })
            }
            Found::Lost => {
                Err(Error::UnresolvedGuard { t: t0, h, mode: format!("{mode:?}"), guard: i })
            }
        }
    }
}
