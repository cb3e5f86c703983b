//! The first fall of a guard within a step: guards are searched one after the other on the dense output.

use super::shape::{cubic_root, cubic_slope};
use super::{GuardCrossing, GuardWatch};
use crate::error::Error;
use crate::root::{Bracket, find_root, root_near};
use crate::step::Step;
use crate::system::System;
use crate::tolerance::Tolerance;

/// The search around a guess begins at this fraction of the way from the last maximum to the guess.
const LEAST: f64 = 0.25;

/// Where a fall is looked for.
struct Search {
    /// It falls between these times.
    bracket: Bracket,
    /// Where its cubic falls, if that is known.
    guess: Option<CubicFall>,
    /// How closely it is located, as a fraction of the step.
    precision: f64,
}

/// Where the cubic of a guard falls on a step.
struct CubicFall {
    /// As a fraction of the step.
    theta: f64,
    /// Its slope there, over the step.
    slope: f64,
}

impl<P: System> GuardWatch<P> {
    /// The guard that falls first on a step that [`is_clear`](Self::is_clear) could not clear. The time is located to
    /// within `precision` of the step, or, where a cubic tells it, of about its distance from the start, or the spacing of `f64`.
    /// Returns `None` where no guard falls; the end then becomes the start of the next step. Where a tolerance is
    /// given, in `doubt`, a dip counts only if it is deeper than the error of the guard that the tolerance allows.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`], and [`Error::UnresolvedGuard`] for a guard that cannot be followed.
    pub fn first_to_fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        precision: f64,
        doubt: Option<&Tolerance>,
    ) -> Result<Option<GuardCrossing>, Error> {
        let (t0, t1) = (step.t0(), step.t1());
        let h = t1 - t0;
        self.touches.begin_search();
        self.doubts.as_mut().fill(0.0);
        if let Some(tolerance) = doubt {
            let y = step.y1().as_ref();
            self.doubt(problem, mode.clone(), step, &|i| tolerance.allowed(i, y));
        }
        self.look_at_quarters(problem, mode.clone(), step);
        self.find_bounds(problem, mode.clone(), (t1, step.y1()), 0.0);
        for (value, end) in self.values.as_mut().iter_mut().zip(self.end.as_ref()) {
            *value = end.re;
        }
        self.first_violated(mode.clone(), t1)?;
        let mut first: Option<GuardCrossing> = None;
        // Time at which `at_first` was evaluated.
        let mut looked_at = f64::NAN;
        for guard in 0..self.end.as_ref().len() {
            let is_violated = self.end.as_ref()[guard].re < -self.bounds.as_ref()[guard];
            self.note_jump(guard, t0, h);
            if !self.is_straying(guard, h) && !is_violated && self.holds(guard, h) {
                self.note_turn(guard, t0, h);
                continue;
            }
            let (top, dip) = self.first_dip(problem, mode.clone(), step, guard)?;
            let violated_at = match dip {
                Some(theta) => t0 + theta * h,
                None if is_violated => t1,
                None => continue,
            };
            if let (Some(first), None) = (first, dip) {
                if looked_at != first.t {
                    step.interpolate(first.t, &mut self.y);
                    problem.guards(mode.clone(), first.t, &self.y, &mut self.at_first);
                    looked_at = first.t;
                }
                // This guard is not yet violated at the first fall, so it falls later or together with it. It needs
                // no search; that saves many searches where many guards fall alike.
                if self.at_first.as_ref()[guard] >= -self.bounds.as_ref()[guard] {
                    continue;
                }
            }
            let bracket = Bracket { above: t0 + top * h, below: violated_at };
            let guess = if dip.is_none() { self.fall_of_cubic(guard, h) } else { None };
            let search = Search { bracket, guess, precision };
            let t = self.fall(problem, mode.clone(), step, guard, search);
            if first.is_none_or(|other| (t - t0).abs() < (other.t - t0).abs()) {
                first = Some(GuardCrossing { guard, t, violated_at });
            }
        }
        if first.is_none() {
            self.advance();
        }
        Ok(first)
    }

    /// Evaluates all guards at the quarters of `step`.
    fn look_at_quarters(&mut self, problem: &P, mode: P::Mode, step: &dyn Step<P::State<f64>>) {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        for (quarter, values) in (1..).zip(&mut self.quarters) {
            let t = t0 + 0.25 * f64::from(quarter) * h;
            step.interpolate(t, &mut self.y);
            problem.guards(mode.clone(), t, &self.y, values);
        }
    }

    /// When guard `i` falls on the dense output: near the guess, if that is where it falls, and else by a search of the whole
    /// bracket.
    fn fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        Search { bracket, guess, precision }: Search,
    ) -> f64 {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        let near = guess.and_then(|CubicFall { theta, slope }| {
            let t = t0 + theta * h;
            // Beside the start a guard that begins on its surface is nothing but rounding.
            let above = bracket.above + LEAST * (t - bracket.above);
            // Without the bound, which is that of the end of the step: the guard may not rise as high.
            let g = |t| self.value_on(problem, mode.clone(), step, i, t);
            let tolerance = precision * (t - t0).abs();
            root_near((t, slope / h), g, Bracket { above, ..bracket }, tolerance)
        });
        near.unwrap_or_else(|| {
            let g = |t| self.clearance_on(problem, mode.clone(), step, i, t);
            find_root(g, bracket, precision * h.abs())
        })
    }

    /// Where guard `i`, violated at the end of a step of size `h`, falls on the cubic through values and rates at both ends.
    /// What rises from within the bound at the end, or from below, rises from zero.
    fn fall_of_cubic(&self, i: usize, h: f64) -> Option<CubicFall> {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let is_above = g0.re > self.bounds.as_ref()[i] || g0.re > 0.0 && g0.eps * h < 0.0;
        let from = if is_above { g0.re } else { 0.0 };
        let (values, slopes) = ([from, g1.re], [g0.eps * h, g1.eps * h]);
        let theta = cubic_root(values, slopes)?;
        Some(CubicFall { theta, slope: cubic_slope(theta, values, slopes) })
    }
}
