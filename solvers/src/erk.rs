//! The stage loop of explicit tableau methods.

use crate::dense::{add, combine};
use crate::one_step::OneStep;
use crate::stats::Stats;
use crate::step::TableauStep;
use crate::system::{System, Vector};
use crate::tableau::Tableau;
use crate::tolerance::Tolerance;

/// An explicit tableau method at work on one system: its tableau and the memory of one step.
#[derive(Debug)]
pub struct ExplicitRk<Y, const S: usize> {
    tableau: &'static Tableau<S>,
    first_same_as_last: bool,
    /// Weights of the error estimate, `b − b̂`.
    error_weights: Option<[f64; S]>,
    /// The same of the second embedded solution, and its error.
    low_weights: Option<[f64; S]>,
    low_error: Y,
    y_stage: Y,
    zero: Y,
    step: TableauStep<Y, S>,
    /// Whether the extra stages of its dense output are evaluated.
    is_dense: bool,
}

impl<Y: Vector<f64>, const S: usize> ExplicitRk<Y, S> {
    /// The method of `tableau` for systems of `n` states.
    pub fn new(tableau: &'static Tableau<S>, n: usize) -> Self {
        let weights = |b_hat: [f64; S]| std::array::from_fn(|i| tableau.b[i] - b_hat[i]);
        Self {
            tableau,
            first_same_as_last: tableau.first_same_as_last(),
            error_weights: tableau.b_hat.map(weights),
            low_weights: tableau.b_hat_low.map(|(b_hat, _)| weights(b_hat)),
            low_error: Y::from_fn(n, |_| 0.0),
            y_stage: Y::from_fn(n, |_| 0.0),
            zero: Y::from_fn(n, |_| 0.0),
            step: TableauStep::new(n, &tableau.dense),
            is_dense: false,
        }
    }
}

impl<P: System, const S: usize> OneStep<P> for ExplicitRk<P::State<f64>, S> {
    type Step = TableauStep<P::State<f64>, S>;

    fn embedded_order(&self) -> Option<usize> {
        self.error_weights.map(|_| self.tableau.error_order() - 1)
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
        problem.rhs(mode, t, y, &mut step.k[0]);
        stats.work.n_rhs += 1;
    }

    #[inline(always)]
    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        let (tableau, step) = (self.tableau, &mut self.step);
        (step.t1, step.h) = (t1, h);
        self.is_dense = false;
        for i in 1..S {
            combine(&step.y0, h, tableau.a[i], &step.k, &mut self.y_stage);
            problem.rhs(mode.clone(), step.t0 + tableau.c[i] * h, &self.y_stage, &mut step.k[i]);
        }
        stats.work.n_rhs += (S - 1) as u64;
        if self.first_same_as_last {
            step.y1.clone_from(&self.y_stage);
        } else {
            combine(&step.y0, h, &tableau.b, &step.k, &mut step.y1);
        }
        if let Some(weights) = &self.error_weights {
            combine(&self.zero, h, weights, &step.k, &mut step.error);
        }
        if let Some(weights) = &self.low_weights {
            combine(&self.zero, h, weights, &step.k, &mut self.low_error);
        }
    }

    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        let step = &mut self.step;
        if self.first_same_as_last {
            step.slope1.clone_from(&step.k[S - 1]);
        } else {
            problem.rhs(mode, step.t1, &step.y1, &mut step.slope1);
            stats.work.n_rhs += 1;
        }
    }

    fn densify(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        if std::mem::replace(&mut self.is_dense, true) {
            return;
        }
        let step = &mut self.step;
        for (i, (c, a)) in step.dense.extra_stages().iter().enumerate() {
            self.y_stage.clone_from(&step.y0);
            for (a, slope) in a.iter().zip(step.slopes()) {
                add(&mut self.y_stage, step.h * a, slope);
            }
            problem.rhs(mode.clone(), step.t0 + c * step.h, &self.y_stage, &mut step.extra[i]);
            stats.work.n_rhs += 1;
        }
    }

    fn advance(&mut self) {
        let step = &mut self.step;
        step.t0 = step.t1;
        std::mem::swap(&mut step.y0, &mut step.y1);
        std::mem::swap(&mut step.k[0], &mut step.slope1);
    }

    fn step(&self) -> &Self::Step {
        &self.step
    }

    fn error(&self) -> &P::State<f64> {
        &self.step.error
    }

    #[inline]
    fn error_norm_sq(&self, tolerance: &Tolerance) -> f64 {
        let (y0, y1) = (self.step.y0.as_ref(), self.step.y1.as_ref());
        let error_sq = tolerance.norm_sq(self.step.error.as_ref(), y0, y1);
        if self.low_weights.is_none() || error_sq == 0.0 {
            return error_sq;
        }
        let low_sq = tolerance.norm_sq(self.low_error.as_ref(), y0, y1);
        error_sq * (error_sq / (error_sq + 0.01 * low_sq))
    }
}
