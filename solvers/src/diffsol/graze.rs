//! Grazing guards of accepted steps.

use super::{DiffsolSolver, SolverStep};
use crate::event::{Graze, STEPS};
use crate::record::Record;
use crate::step::Step;
use crate::system::System;
use crate::tolerance::Tolerance;

/// What grazing needs to know of a step.
pub(super) struct Place {
    /// The guard that it landed on, if any.
    pub(super) landed_on: Option<usize>,
    /// Its size before it landed.
    pub(super) h: f64,
    /// Number of steps so far.
    pub(super) n_steps: u64,
}

impl<P: System> DiffsolSolver<P> {
    /// Tells `record` of the guards that graze in `step`, if one came near, and returns their number. The next step goes on
    /// with their arcs.
    pub(super) fn tell_grazing(
        &mut self,
        of: (&P, &P::Mode),
        step: &SolverStep<'_, impl Fn(f64, &mut P::State<f64>), P::State<f64>>,
        at: Place,
        record: &mut dyn Record<P>,
    ) -> u64 {
        let told = if self.watch.came_near() { self.graze(of, step, at, record) } else { 0 };
        self.watch.follow_arcs();
        told
    }

    /// Tells `record` of the guards that graze in `step`, and returns their number. The methods do not extrapolate, so
    /// that their errors add up: they were up to half of what the tolerance allows in each step so far.
    #[cold]
    fn graze(
        &mut self,
        (problem, mode): (&P, &P::Mode),
        step: &SolverStep<'_, impl Fn(f64, &mut P::State<f64>), P::State<f64>>,
        Place { landed_on, h, n_steps }: Place,
        record: &mut dyn Record<P>,
    ) -> u64 {
        let mut told = Vec::new();
        let slope = |t: f64, y: &P::State<f64>| {
            let mut slope = y.clone();
            problem.rhs(mode.clone(), t, y, &mut slope);
            slope
        };
        // Slopes of interpolants jump between the steps, and a guard may turn there.
        let smooth = SolverStep {
            interpolant: |t: f64, y: &mut P::State<f64>| step.interpolate(t, y),
            t0: step.t0,
            t1: step.t1,
            y0: step.y0,
            y1: step.y1.clone(),
            slope0: slope(step.t0, step.y0),
            slope1: slope(step.t1, &step.y1),
        };
        let (Tolerance { rtol, atol }, y) = (&self.tolerance, step.y1.as_ref());
        let allowed = |i: usize| atol[i] + rtol * y[i].abs();
        let many = STEPS.max(n_steps as f64);
        if self.watch.may_graze(problem, mode.clone(), &smooth, landed_on, h) {
            let error = |i: usize| many * allowed(i);
            self.watch.graze(problem, mode.clone(), &smooth, (landed_on, h), error, |graze| {
                told.push(graze)
            });
        }
        if let Some(guard) = landed_on
            && !told.iter().any(|graze| graze.is_event)
        {
            // The norm of the error is a root mean square.
            let most = (y.len() as f64).sqrt();
            let (height, error) =
                self.watch.arc(problem, mode.clone(), &smooth, guard, |i| most * allowed(i));
            if height <= error {
                let (t, depth, error) = (step.t1, -height, error * many / most);
                told.push(Graze { guard, t, depth, error, is_event: true });
            }
        }
        self.watch.start_at(problem, mode.clone(), step.t1, &step.y1, &step.slope1);
        for graze in &told {
            record.grazing(&graze.in_mode(mode.clone()));
        }
        told.len() as u64
    }
}
