//! The size of the very first step.

use super::{OneStep, OneStepSolver};
use crate::point::Point;
use crate::step::Step;
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;

impl<P: System, M: OneStep<P>> OneStepSolver<P, M> {
    /// A first step size, at which the local error is about one per cent of the tolerance, estimated from the slope
    /// and its change over a trial step.
    ///
    /// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, II.4.
    pub(super) fn first_step(
        &self,
        tolerance: &Tolerance,
        problem: &P,
        point: &Point<P>,
        t_end: f64,
        stats: &mut Stats,
    ) -> f64 {
        let (y, slope) = (point.y.as_ref(), self.method.step().slope0().as_ref());
        let span = t_end - point.t;
        let (d0, d1) = (tolerance.norm(y, y, y), tolerance.norm(slope, y, y));
        let tiny = 1e-6 * span.abs();
        let h0 = if d0 < 1e-5 || d1 < 1e-5 { tiny } else { 0.01 * d0 / d1 };
        let h0 = h0.min(span.abs()).copysign(span);
        let ahead = P::State::from_fn(y.len(), |i| y[i] + h0 * slope[i]);
        let mut slope_ahead = ahead.clone();
        problem.rhs(point.mode.clone(), point.t + h0, &ahead, &mut slope_ahead);
        stats.work.n_rhs += 1;
        let change: P::State<f64> =
            Vector::from_fn(y.len(), |i| (slope_ahead.as_ref()[i] - slope[i]) / h0);
        let d2 = tolerance.norm(change.as_ref(), y, y);
        let steepest = d1.max(d2);
        let h1 = if steepest <= 1e-15 {
            tiny.max(1e-3 * h0.abs())
        } else {
            libm::pow(0.01 / steepest, 1.0 / self.error_order as f64)
        };
        h1.min(100.0 * h0.abs()).copysign(span)
    }
}
