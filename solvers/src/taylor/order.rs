//! The order of a series for a tolerance, and the step size that a series allows.

use super::rows::MAX_ORDER;
use crate::magnitude::{exp2, log2};
use crate::system::Vector;
use crate::tolerance::{Tolerance, weighed_sq};

/// Order of runs with a fixed step.
pub const FIXED_STEP_ORDER: usize = 8;
/// Smallest order for a tolerance. A lower order costs more additional steps than it saves.
const LEAST_ORDER: usize = 8;
/// Safety factor on the step size at which the last two terms are within the tolerance.
const SAFETY: f64 = 0.9;
/// Order of the low term that is compared with the last two. If it too is within the tolerance there, the high terms
/// do not decrease and cannot be trusted.
pub(super) const LOW: usize = 3;
/// Factor on the step size at which the low term is tested, `e^½`.
const FARTHER: f64 = 1.648_721_270_700_128;

/// `⌈−0.7 ln rtol⌉`, between 8 and [`MAX_ORDER`].
///
/// If the work of a series grew with the square of its order, steps would be cheapest at the order `−½ ln rtol`. Here
/// the work grows little faster than the order, and the work of a step beside its series favours higher orders. The
/// factor 0.7 was measured on the paper's Table 1 (`benches/README.md`).
///
/// À. Jorba, M. Zou, "A software package for the numerical integration of ODEs by means of high-order
/// Taylor methods", Exp. Math. 14(1), 99–117 (2005), §3.1.
///
/// ```
/// use deltazero_solvers::taylor::{MAX_ORDER, order_for};
///
/// assert_eq!([1e-3, 1e-9, 1e-12].map(order_for), [8, 15, 20]);
/// assert_eq!(order_for(1e-28), MAX_ORDER);
/// ```
pub fn order_for(rtol: f64) -> usize {
    let order = (-0.7 * libm::log(rtol)).ceil();
    (order.max(0.0) as usize).clamp(LEAST_ORDER, MAX_ORDER)
}

/// A step size, and the degree of the polynomial that the step is taken with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Degree.
    pub degree: usize,
    /// Step size, above zero; infinite where the terms that limit it are zero.
    pub h: f64,
}

/// The step size at which the last two terms of the series with these coefficients are within the tolerance.
///
/// ```text
/// h = 0.9 min(‖y_N‖^(−1/N), ‖y_(N−1)‖^(−1/(N−1)))      ‖·‖ in units of the tolerance
/// ```
///
/// Jorba and Zou, §3.2.1. Near a singular point of the right-hand side the high terms grow without bound or are not
/// finite. The series is then cut at the degree that allows the longest step. Returns `None` where not even two terms
/// beyond the first are finite, and for fewer than four coefficients.
///
/// `weights` is workspace of the length of a state.
pub fn reach<Y: Vector<f64>>(y: &[Y], tolerance: &Tolerance, weights: &mut Y) -> Option<Reach> {
    if y.len() <= LOW {
        return None;
    }
    tolerance.weights(y[0].as_ref(), weights.as_mut());
    let weights = weights.as_ref();
    let weighed = |k: usize| y[k].as_ref().iter().zip(weights).map(|(y, weight)| y * weight);
    reach_by(y.len() - 1, |k| weighed_sq(y[k].as_ref(), weights), weighed)
}

/// [`reach`] of a series of `order`, at least [`LOW`], from the squares of the norms of its coefficients, and their weighed
/// entries.
#[inline]
pub(crate) fn reach_by<I: ExactSizeIterator<Item = f64> + Clone>(
    order: usize,
    norm_sq: impl Fn(usize) -> f64,
    weighed: impl Fn(usize) -> I,
) -> Option<Reach> {
    let log_norm_sq = |k: usize| match norm_sq(k) {
        square if square.is_normal() => log2(square),
        _ => log_mean_sq(weighed(k)),
    };
    // log₂ h from the terms n − 1 and n; NaN where one of them is.
    let log_root = |k: usize| -0.5 / k as f64 * log_norm_sq(k);
    let of_last = |n: usize| {
        let (a, b) = (log_root(n - 1), log_root(n));
        if a < b || a.is_nan() { a } else { b }
    };
    let log_h = of_last(order);
    let h = exp2(log_h);
    // If the low term is within the tolerance there too, the high terms do not converge.
    let far = FARTHER * h;
    let low = norm_sq(LOW) * (far * far * far) * (far * far * far);
    let is_high =
        if low.is_normal() { low < 1.0 } else { log_norm_sq(LOW) + 6.0 * log2(far) < 0.0 };
    if log_h > f64::NEG_INFINITY && (log_h == f64::INFINITY || !is_high) {
        return Some(Reach { degree: order, h: SAFETY * h });
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
    Some(Reach { degree: if n < order { n - 2 } else { n }, h: SAFETY * exp2(log_h) })
}

/// `log₂` of the mean square of these numbers, also where their squares leave the range of numbers: the coefficients of order k of fast
/// and of slow motions go with the k-th power of the unit of time.
#[cold]
fn log_mean_sq(numbers: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let n = numbers.len() as f64;
    let most = numbers.clone().map(f64::abs).fold(0.0, worse);
    if most == 0.0 || !most.is_finite() {
        return libm::log2(most);
    }
    let squares = numbers.map(|x| (x / most) * (x / most));
    2.0 * libm::log2(most) + libm::log2(squares.sum::<f64>() / n)
}

/// The larger of two numbers that are not negative; NaN where one of them is.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The degree to which a series is worth evaluating at `h`, regardless of the tolerance. Where each of the last three
/// terms of some state is more than twice the one before, the series is cut where this growth began.
pub fn convergent_degree<Y: Vector<f64>>(y: &[Y], h: f64) -> usize {
    let order = y.len() - 1;
    let n_states = y[0].as_ref().len();
    let is_growing = |k: usize, i: usize| {
        let (before, term) = (y[k - 1].as_ref()[i].abs(), (y[k].as_ref()[i] * h).abs());
        // NaN counts as growth.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_grows_as_the_tolerance_falls() {
        let rtols = [1e-3, 1e-6, 1e-9, 1e-12, 1e-13, 1e-15];
        assert_eq!(rtols.map(order_for), [8, 10, 15, 20, 21, 25]);
        assert_eq!([f64::NAN, 1.0, 2.0].map(order_for), [LEAST_ORDER; 3]);
        assert_eq!(order_for(1e-30), MAX_ORDER);
    }

    /// The reach of a series with these coefficients at an absolute tolerance of 1e-6.
    fn reach_of(coefficient: impl Fn(usize) -> f64) -> Option<Reach> {
        let y: Vec<[f64; 1]> = (0..=10).map(|k| [coefficient(k)]).collect();
        reach(&y, &Tolerance { rtol: 1e-30, atol: vec![1e-6] }, &mut [0.0])
    }

    #[test]
    fn a_geometric_series_reaches_where_its_last_two_terms_are_tolerated() {
        let reach = reach_of(|k| f64::powi(3.0, k as i32)).unwrap();
        let exact = 0.9 * f64::powf(1e-6, 1.0 / 9.0) / 3.0;
        // Measured: 1.6e-4, from the approximate logarithm and power.
        assert!(reach.degree == 10 && (reach.h / exact - 1.0).abs() < 1e-3, "{reach:?}");
    }

    #[test]
    fn a_series_is_cut_where_its_terms_cease_to_fall() {
        // From order 6 on each coefficient is a thousand times the one before, or NaN.
        for beyond in [1e3, f64::NAN] {
            let reach = reach_of(|k| if k < 6 { 1.0 } else { f64::powi(beyond, k as i32) });
            assert!(reach.is_some_and(|reach| reach.degree < 6 && reach.h > 0.0), "{reach:?}");
        }
        assert_eq!(reach_of(|k| if k < 2 { 1.0 } else { f64::NAN }), None);
        let three = [[1.0]; 3];
        assert_eq!(reach(&three, &Tolerance { rtol: 1e-6, atol: vec![1e-6] }, &mut [0.0]), None);
        assert!(
            reach_of(|k| if k < 2 { 1.0 } else { 0.0 }).is_some_and(|reach| reach.h.is_infinite())
        );
    }

    /// `ẏ = −y/T` with y = 1, whatever T.
    #[test]
    fn the_reach_does_not_depend_on_the_unit_of_time() {
        let reach_in = |unit: f64| {
            let mut y = vec![[1.0]];
            for k in 1..=20 {
                y.push([-y[k - 1][0] / (k as f64 * unit)]);
            }
            reach(&y, &Tolerance { rtol: 1e-12, atol: vec![0.0] }, &mut [0.0]).unwrap()
        };
        let one = reach_in(1.0);
        for unit in [1e-12, 1e-9, 1e-3, 1e3, 1e9, 1e12] {
            let Reach { degree, h } = reach_in(unit);
            // Measured: 1.1e-4.
            assert!(degree == one.degree && (h / unit / one.h - 1.0).abs() < 1e-3, "{unit}: {h}");
        }
    }
}
