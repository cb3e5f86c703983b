//! Tolerances, and the norm in which errors are measured.

use crate::error::Error;
use crate::real::{Ordered, Over, Real};

/// The accuracy required of each step.
///
/// ```
/// use deltazero_solvers::Tolerance;
///
/// let tolerance = Tolerance { rtol: 1e-3, atol: vec![1e-3, 1.0] };
/// // Each error is half of what is allowed: 1e-3 + 1e-3·1, and 1 + 1e-3·1000.
/// assert!((tolerance.norm(&[1e-3, 1.0], &[1.0, 0.0], &[0.0, 1000.0]) - 0.5).abs() < 1e-15);
/// assert!(tolerance.check(3).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tolerance {
    /// Relative tolerance.
    pub rtol: f64,
    /// Absolute tolerance of each state, in its unit.
    pub atol: Vec<f64>,
}

impl Tolerance {
    /// Checks that the tolerance is valid for a system of `n` states.
    ///
    /// # Errors
    /// [`Error::BadTolerance`] unless `rtol` is finite and above zero and `atol` has `n` such
    /// entries.
    pub fn check(&self, n: usize) -> Result<(), Error> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if positive(self.rtol) && self.atol.len() == n && self.atol.iter().all(|&a| positive(a)) {
            Ok(())
        } else {
            Err(Error::BadTolerance { rtol: self.rtol, atol: self.atol.clone(), n })
        }
    }

    /// The error of state `i` that is allowed at `y`, `atol_i + rtol |y_i|`.
    pub(crate) fn allowed(&self, i: usize, y: &[f64]) -> f64 {
        self.atol[i] + self.rtol * y[i].abs()
    }

    /// Root mean square of `error_i / (atol_i + rtol · max(|y0_i|, |y1_i|))`. It is at most one for an error within
    /// the tolerance, and NaN where an error is NaN.
    ///
    /// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, (II.4.11).
    pub fn norm(&self, error: &[f64], y0: &[f64], y1: &[f64]) -> f64 {
        self.norm_sq(error, y0, y1).sqrt()
    }

    /// Writes `1/(atol_i + rtol |y_i|)` to `weights`. The [norm](Self::norm) of an error at `y` is the root mean
    /// square of the products of errors and weights.
    ///
    /// # Panics
    /// Where `atol` is shorter than `y`; [`check`](Self::check) rejects such a tolerance.
    #[inline]
    pub fn weights(&self, y: &[f64], weights: &mut [f64]) {
        weigh((self.rtol, &self.atol), y, weights);
    }

    /// The square of [`norm`](Self::norm).
    ///
    /// # Panics
    /// Where `atol` is shorter than `error`; [`check`](Self::check) rejects such a tolerance.
    #[inline]
    pub fn norm_sq(&self, error: &[f64], y0: &[f64], y1: &[f64]) -> f64 {
        norm_sq((self.rtol, &self.atol), error, y0, y1)
    }
}

/// [`Tolerance::weights`] for the tolerances `rtol` and `atol` of one run or of several at once.
///
/// # Panics
/// Where `atol` is shorter than `y`.
#[inline]
pub(crate) fn weigh<T: Ordered + Over<C>, C: Copy>(
    (rtol, atol): (C, &[C]),
    y: &[T],
    weights: &mut [T],
) {
    let atol = &atol[..y.len()];
    for ((weight, y), atol) in weights.iter_mut().zip(y).zip(atol) {
        *weight = T::cst(1.0) / (y.abs() * rtol + *atol);
    }
}

/// The mean square of `y_i weight_i`.
#[inline]
pub(crate) fn weighed_sq<T: Real>(y: &[T], weights: &[T]) -> T {
    let squares = y.iter().zip(weights).map(|(y, weight)| (*y * *weight) * (*y * *weight));
    squares.fold(T::cst(0.0), |sum, square| sum + square) / y.len() as f64
}

/// The square of the [norm](Tolerance::norm) for the tolerances `rtol` and `atol` of one run or of several at once.
///
/// # Panics
/// Where `atol` is shorter than `error`.
#[inline]
pub(crate) fn norm_sq<T: Ordered + Over<C>, C: Copy>(
    (rtol, atol): (C, &[C]),
    error: &[T],
    y0: &[T],
    y1: &[T],
) -> T {
    let mut sum = T::cst(0.0);
    let atol = &atol[..error.len()];
    for (((e, atol), y0), y1) in error.iter().zip(atol).zip(y0).zip(y1) {
        let ratio = *e / (y0.abs().larger(y1.abs()) * rtol + *atol);
        sum = sum + ratio * ratio;
    }
    sum * (1.0 / error.len() as f64)
}
