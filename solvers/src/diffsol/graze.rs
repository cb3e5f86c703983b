//! Grazing guards of accepted steps, and bounces too low to resolve.

use super::{DiffsolSolver, SolverStep};
use crate::event_location::{ERROR_GROWTH, FullStep, Graze};
use crate::record::Record;
use crate::step::Step;
use crate::system::System;

/// Number of steps after which errors of guards are found anew.
const RENEWED: u64 = 64;

/// What grazing needs to know of a step.
pub(super) struct Place {
    /// The guard that it landed on, if any.
    pub(super) landed_on: Option<usize>,
    /// Its size before it landed.
    pub(super) h: f64,
    /// The start of its phase.
    pub(super) phase_from: f64,
    /// Number of steps so far.
    pub(super) n_steps: u64,
}

impl<P: System> DiffsolSolver<P> {
    /// Tells `record` of the guards that graze in an accepted step, and returns their number.
    #[inline(always)]
    pub(super) fn tell_grazing(
        &mut self,
        of: (&P, &P::Mode),
        step: &SolverStep<'_, impl Fn(f64, &mut P::State<f64>), P::State<f64>>,
        at: Place,
        record: &mut dyn Record<P>,
    ) -> u64 {
        if at.n_steps.is_power_of_two() || at.n_steps.is_multiple_of(RENEWED) {
            // Their errors add up.
            self.watch.touches.watch(at.phase_from);
        }
        if at.landed_on.is_some() || self.watch.touches.are_noted() {
            self.graze(of, step, at, record)
        } else {
            0
        }
    }

    /// The methods do not extrapolate, so that their errors add up: they were up to half of what the tolerance allows in
    /// each step so far.
    #[cold]
    #[inline(never)]
    fn graze(
        &mut self,
        (problem, mode): (&P, &P::Mode),
        step: &SolverStep<'_, impl Fn(f64, &mut P::State<f64>), P::State<f64>>,
        Place { landed_on, h, phase_from, n_steps }: Place,
        record: &mut dyn Record<P>,
    ) -> u64 {
        let y = step.y1.as_ref();
        let allowed = |i: usize| self.tolerance.allowed(i, y);
        let many = ERROR_GROWTH.max(n_steps as f64);
        let (mut n, mut is_told) = (0, false);
        let mut told = |graze: Graze| {
            (n, is_told) = (n + 1, is_told || graze.is_event);
            record.grazing(&graze.in_mode(mode.clone()));
        };
        let error = |i: usize| many * allowed(i);
        // The slope at the end is that of the interpolant.
        let mut slope1 = step.slope1.clone();
        problem.rhs(mode.clone(), step.t1, &step.y1, &mut slope1);
        let (slope0, y1) = (step.slope0.clone(), step.y1.clone());
        let interpolant = |t: f64, y: &mut P::State<f64>| step.interpolate(t, y);
        let (t0, y0, t1) = (step.t0, step.y0, step.t1);
        let smooth = SolverStep { interpolant, t0, t1, y0, y1, slope0, slope1 };
        let full = FullStep { h, landed_on };
        self.watch.graze(problem, mode.clone(), &smooth, full, &error, &mut told);
        if let Some(guard) = landed_on
            && !is_told
        {
            // The norm of the error is a root mean square.
            let most = (y.len() as f64).sqrt();
            let error = |i: usize| most * allowed(i);
            let span = step.t1 - phase_from;
            let (height, error) = self.watch.arc(problem, mode.clone(), step, guard, span, &error);
            if height <= error {
                let (t, depth, error) = (step.t1, -height, error * many / most);
                record.grazing(
                    &Graze { guard, t, depth, error, is_event: true }.in_mode(mode.clone()),
                );
                n += 1;
            }
        }
        n
    }
}
