//! Which order serves a tolerance, and how far a series reaches.

use super::rows::MAX_ORDER;
use crate::system::Vector;
use crate::tolerance::Tolerance;

/// The order of runs with a fixed step.
pub const FIXED_STEP_ORDER: usize = 8;
/// The least order that a tolerance is served with.
const LEAST_ORDER: usize = 5;
/// Fraction of the reach of the last two terms that a step takes.
const SAFETY: f64 = 0.9;
/// Where the term of this order is tolerated too, the high ones are not the ones to trust.
const LOW: usize = 3;

/// `⌈−½ ln rtol⌉ + 1`, between 5 and [`MAX_ORDER`]: where the work of a series grows with the square
/// of its order, a step is then cheapest by its length, at `e⁻²` of the radius of convergence.
///
/// À. Jorba, M. Zou, "A software package for the numerical integration of ODEs by means of high-order
/// Taylor methods", Exp. Math. 14(1), 99–117 (2005), §3.
pub fn order_for(rtol: f64) -> usize {
    let order = (-0.5 * libm::log(rtol)).ceil() + 1.0;
    (order.max(0.0) as usize).clamp(LEAST_ORDER, MAX_ORDER)
}

/// A step, and the degree of the polynomial that it is taken with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Degree.
    pub degree: usize,
    /// Step size, above zero; infinite where the terms that limit it are zero.
    pub h: f64,
}

/// How far the series with these coefficients reaches: where its last two terms are tolerated.
///
/// ```text
/// h = 0.9 min(‖y_N‖^(−1/N), ‖y_(N−1)‖^(−1/(N−1)))      ‖·‖ in units of the tolerance
/// ```
///
/// Jorba and Zou, §3.2.1. Near a singular point of the right-hand side the high terms grow without
/// bound or are not finite: the series is then cut at the degree that reaches farthest. None where
/// not even two terms beyond the first are finite.
pub fn reach<Y: Vector<f64>>(y: &[Y], tolerance: &Tolerance) -> Option<Reach> {
    let order = y.len() - 1;
    let norm_sq = |k: usize| tolerance.norm_sq(y[k].as_ref(), y[0].as_ref(), y[0].as_ref());
    // ln h of the last two terms; not a number where they are not.
    let of_last = |n: usize| {
        let (a, b) = (log_root(norm_sq(n - 1), n - 1), log_root(norm_sq(n), n));
        if a < b || a.is_nan() { a } else { b }
    };
    let log_h = of_last(order);
    // Where already a low term is tolerated, the high ones do not converge.
    let is_high = |log_h: f64| log_h < log_root(norm_sq(LOW), LOW) - 0.5;
    if log_h > f64::NEG_INFINITY && (log_h == f64::INFINITY || !is_high(log_h)) {
        return Some(Reach { degree: order, h: SAFETY * exp(log_h) });
    }
    let mut best: Option<(usize, f64)> = None;
    for n in LOW..=order {
        let log_h = of_last(n);
        if log_h.is_nan() {
            break;
        }
        if best.is_none_or(|(_, log_best)| log_h > log_best) {
            best = Some((n, log_h));
        }
    }
    let (n, log_h) = best.filter(|(_, log_h)| *log_h > f64::NEG_INFINITY)?;
    Some(Reach { degree: if n < order { n - 2 } else { n }, h: SAFETY * exp(log_h) })
}

/// `ln x^(−1/2k)` for the square of a norm: infinite for zero.
fn log_root(norm_sq: f64, k: usize) -> f64 {
    -0.5 / k as f64 * libm::log(norm_sq)
}

/// A step size needs few digits.
fn exp(x: f64) -> f64 {
    f64::from(libm::expf(x as f32))
}

/// The degree to which a series is worth evaluating at `h`, whatever the tolerance: the last three
/// terms of some state growing by factors of two and more, it is cut where they began to.
pub fn convergent_degree<Y: Vector<f64>>(y: &[Y], h: f64) -> usize {
    let order = y.len() - 1;
    let n_states = y[0].as_ref().len();
    let is_growing = |k: usize, i: usize| {
        let (before, term) = (y[k - 1].as_ref()[i].abs(), (y[k].as_ref()[i] * h).abs());
        // What is not a number grows.
        term > 2.0 * before || term.is_nan()
    };
    let is_bad = |i: usize| {
        let last = y[order].as_ref()[i];
        !last.is_finite()
            || (order >= 3
                && (order - 2..=order).all(|k| is_growing(k, i) && y[k - 1].as_ref()[i] != 0.0))
    };
    let cut = |i: usize| {
        let mut degree = order;
        while degree > 1 && is_growing(degree, i) {
            degree -= 1;
        }
        degree
    };
    (0..n_states).filter(|&i| is_bad(i)).map(cut).min().unwrap_or(order)
}
