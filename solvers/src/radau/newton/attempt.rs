//! A step of the method from its start to its end, as the loop of the one-step methods asks for it.

use num_complex::Complex;

use super::{FULL_STEPS, RadauMethod};
use crate::error::Error;
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::one_step::{OneStep, PREDICTION};
use crate::radau::RadauStep;
use crate::radau::convergence::Iteration;
use crate::system::System;
use crate::tolerance::Tolerance;
use crate::work::Stats;

impl<P: System> OneStep<P> for RadauMethod<P::State<f64>> {
    type Step = RadauStep<P::State<f64>>;

    fn embedded_order(&self) -> Option<usize> {
        Some(self.tableau.embedded_order)
    }

    fn restart(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        stats: &mut Stats,
    ) {
        let step = &mut self.step;
        (step.t0, step.t1, step.h) = (t, t, 0.0);
        step.y0.clone_from(y);
        step.y1.clone_from(y);
        problem.rhs(mode, t, y, &mut step.slope0);
        stats.work.n_rhs += 1;
        (self.is_linearised, self.is_completed) = (false, false);
        (self.eta, self.n_full) = (1.0, 0);
        (self.least_diverged, self.error_before_sq) = (f64::INFINITY, f64::NAN);
        self.guess.forget();
        if self.starts_on_slow_solution {
            self.guess.follow(&self.step.slope0);
        }
    }

    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        let tableau = self.tableau;
        (self.step.t1, self.step.h) = (t1, h);
        self.guess.error_sq = 0.0;
        if !std::mem::replace(&mut self.is_linearised, true) {
            let non_finite =
                self.jacobian.evaluate(problem, mode.clone(), self.step.t0, &self.step.y0);
            stats.work.n_jac += 1;
            if let Some(component) = non_finite {
                (self.is_linearised, self.has_converged) = (false, true);
                return self.step.spoil(component);
            }
        }
        self.real.factorise(&self.jacobian, tableau.real, h);
        stats.work.n_factorisations += 1;
        let mut end = Iteration::Diverged;
        if self.n_full == 0 {
            let shift = Complex::new(tableau.complex[0], tableau.complex[1]);
            self.complex.factorise(&self.jacobian, shift, h);
            stats.work.n_factorisations += 1;
            end = self.iterate(problem, mode.clone(), stats);
            if matches!(end, Iteration::Diverged) && self.full_pays() {
                (self.n_full, self.eta) = (FULL_STEPS, 1.0);
            }
        }
        if self.n_full > 0 {
            end = self.iterate(problem, mode.clone(), stats);
        }
        self.has_converged = !matches!(end, Iteration::Diverged);
        match end {
            Iteration::Diverged => return,
            Iteration::NotFinite(component) => return self.step.spoil(component),
            Iteration::Converged => self.finish(),
        }
        self.slope.clone_from(&self.step.slope0);
        self.estimate(stats);
        let is_above = |tolerance: &Tolerance| self.step.norm_sq(tolerance) > 1.0;
        if self.estimate_tolerance.as_ref().is_some_and(is_above) {
            self.estimate_again(problem, mode, stats);
        }
        if self.n_full > 0 && self.guess.is_extrapolated {
            self.estimate_from_guess();
        }
    }

    fn has_converged(&self) -> bool {
        self.has_converged
    }

    fn repeats(&self) -> bool {
        self.estimate_tolerance.is_none()
    }

    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        let step = &mut self.step;
        problem.rhs(mode, step.t1, &step.y1, &mut step.slope1);
        stats.work.n_rhs += 1;
        if !std::mem::replace(&mut self.is_completed, true) {
            self.keep_polynomial();
            self.guess.is_extrapolated = false;
        }
    }

    fn first_to_fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        watch: &mut GuardWatch<P>,
        _stats: &mut Stats,
    ) -> Result<Option<GuardCrossing>, Error> {
        if watch.is_clear(problem, mode.clone(), &self.step) {
            return Ok(None);
        }
        // A guard that a stiff force holds near zero is far nearer than the error of the dense output. The stages, which
        // solve the equations, are held as near as the ends.
        self.set_stages();
        let [t1, t2, _] = self.stage_times();
        let [y1, y2, _] = &self.y_stages;
        let ends = (self.step.t0, self.step.t1);
        let is_clear = watch.is_clear_between(problem, mode.clone(), ends, [(t1, y1), (t2, y2)]);
        let doubt = self.run_tolerance.as_ref().filter(|_| is_clear);
        watch.first_to_fall(problem, mode, &self.step, PREDICTION, doubt)
    }

    fn advance(&mut self) {
        self.keep_polynomial();
        self.shift_guess();
        self.guess.is_extrapolated = true;
        if self.n_full == 0 && self.step.h.abs() > self.least_diverged {
            self.least_diverged = f64::INFINITY;
        }
        self.n_full = self.n_full.saturating_sub(1);
        if let Some(tolerance) = &self.estimate_tolerance {
            self.error_before_sq = self.error_sq(tolerance);
        }
        let step = &mut self.step;
        step.t0 = step.t1;
        std::mem::swap(&mut step.y0, &mut step.y1);
        std::mem::swap(&mut step.slope0, &mut step.slope1);
        (self.is_linearised, self.is_completed) = (false, false);
    }

    fn step(&self) -> &Self::Step {
        &self.step
    }

    fn error(&self) -> &P::State<f64> {
        &self.step.error
    }

    fn error_norm_sq(&self, tolerance: &Tolerance) -> f64 {
        self.error_sq(self.estimate_tolerance.as_ref().unwrap_or(tolerance))
    }
}
