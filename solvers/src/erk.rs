//! The stage loop of explicit tableau methods.

use crate::dense::combine;
use crate::one_step::OneStep;
use crate::stats::Stats;
use crate::step::TableauStep;
use crate::system::{System, Vector};
use crate::tableau::Tableau;

/// An explicit tableau method at work on one system: its tableau and the memory of one step.
#[derive(Debug)]
pub struct ExplicitRk<Y, const S: usize> {
    tableau: &'static Tableau<S>,
    first_same_as_last: bool,
    /// Weights of the error estimate, `b − b̂`.
    error_weights: Option<[f64; S]>,
    y_stage: Y,
    zero: Y,
    step: TableauStep<Y, S>,
}

impl<Y: Vector<f64>, const S: usize> ExplicitRk<Y, S> {
    /// The method of `tableau` for systems of `n` states.
    pub fn new(tableau: &'static Tableau<S>, n: usize) -> Self {
        let error_weights =
            tableau.b_hat.map(|b_hat| std::array::from_fn(|i| tableau.b[i] - b_hat[i]));
        Self {
            tableau,
            first_same_as_last: tableau.first_same_as_last(),
            error_weights,
            y_stage: Y::from_fn(n, |_| 0.0),
            zero: Y::from_fn(n, |_| 0.0),
            step: TableauStep::new(n, &tableau.dense),
        }
    }
}

impl<P: System, const S: usize> OneStep<P> for ExplicitRk<P::State<f64>, S> {
    type Step = TableauStep<P::State<f64>, S>;

    fn embedded_order(&self) -> Option<usize> {
        self.error_weights.map(|_| self.tableau.embedded_order)
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
        stats.n_rhs += 1;
    }

    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        let (tableau, step) = (self.tableau, &mut self.step);
        (step.t1, step.h) = (t1, h);
        for i in 1..S {
            combine(&step.y0, h, tableau.a[i], &step.k, &mut self.y_stage);
            problem.rhs(mode, step.t0 + tableau.c[i] * h, &self.y_stage, &mut step.k[i]);
        }
        stats.n_rhs += (S - 1) as u64;
        if self.first_same_as_last {
            step.y1.clone_from(&self.y_stage);
        } else {
            combine(&step.y0, h, &tableau.b, &step.k, &mut step.y1);
        }
        if let Some(weights) = &self.error_weights {
            combine(&self.zero, h, weights, &step.k, &mut step.error);
        }
    }

    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        let step = &mut self.step;
        if self.first_same_as_last {
            step.slope1.clone_from(&step.k[S - 1]);
        } else {
            problem.rhs(mode, step.t1, &step.y1, &mut step.slope1);
            stats.n_rhs += 1;
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
}
