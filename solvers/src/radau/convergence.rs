//! Convergence of the Newton iteration of a Radau step, judged by its corrections.

/// Largest number of iterations under a tolerance. RADAU5.
const ITERATIONS: usize = 7;
/// Largest number of iterations where the iteration continues to rounding.
const ITERATIONS_TO_ROUNDING: usize = 50;
/// Growth of the corrections, from the first one, beyond which the iteration has diverged.
const GROWTH: f64 = 1e3;
/// Largest correction, as a fraction of the states, that is taken for rounding once corrections no longer shrink, where
/// the iteration continues to rounding.
const NOISE: f64 = 1e-8;

/// How a Newton iteration ended.
pub(super) enum Iteration {
    Converged,
    Diverged,
    /// The slope of this state at a stage is not finite.
    NotFinite(usize),
}

/// The test of convergence, with what it remembers of the corrections so far.
///
/// If corrections shrink by the factor θ, the error after one is θ/(1 − θ) of it. Under a tolerance the first
/// correction is judged by the factor of the previous iteration. RADAU5. Beyond it, the first corrections may be
/// allowed to grow.
pub(super) struct Convergence {
    /// Largest number of iterations.
    pub(super) most: usize,
    /// Error that the iteration may leave.
    rest: f64,
    pub(super) is_to_rounding: bool,
    /// Number of corrections that may grow under a tolerance.
    patience: usize,
    /// `η = θ/(1 − θ)`: the error after a correction as a fraction of the correction.
    pub(super) left: f64,
    first: f64,
    last: f64,
    last_ratio: f64,
}

impl Convergence {
    /// The test of an iteration that continues to rounding.
    pub(super) fn to_rounding() -> Self {
        Self {
            most: ITERATIONS_TO_ROUNDING,
            rest: f64::EPSILON,
            is_to_rounding: true,
            patience: 0,
            left: f64::INFINITY,
            first: f64::NAN,
            last: f64::NAN,
            last_ratio: f64::NAN,
        }
    }

    /// The test of an iteration to an error of `rest`; `left` is that of the iteration before, and the first
    /// `patience` corrections may grow.
    pub(super) fn to_tolerance(rest: f64, left: f64, patience: usize) -> Self {
        Self {
            most: ITERATIONS,
            rest,
            is_to_rounding: false,
            patience,
            left: libm::pow(left.max(f64::EPSILON), 0.8),
            ..Self::to_rounding()
        }
    }

    /// Judges correction number `n`, counted from one, by its size. Returns how the iteration ended, if it did.
    #[inline]
    pub(super) fn judge(&mut self, n: usize, size: f64) -> Option<Iteration> {
        if size == 0.0 {
            return Some(Iteration::Converged);
        }
        if n == 1 {
            self.first = size;
        } else {
            let ratio = size / self.last;
            let rate = if n == 2 { ratio } else { (ratio * self.last_ratio).sqrt() };
            self.last_ratio = ratio;
            if rate < 0.99 {
                self.left = rate / (1.0 - rate);
                // The iteration is given up early where the remaining iterations cannot suffice.
                let to_come = n + 1..self.most;
                let in_the_end = to_come.fold(self.left * size, |error, _| error * rate);
                if in_the_end > self.rest && n > self.patience && !self.is_to_rounding {
                    return Some(Iteration::Diverged);
                }
            } else if self.is_to_rounding && size <= NOISE {
                // Rounding is reached.
                return Some(Iteration::Converged);
            } else if n <= self.patience {
                self.left = f64::INFINITY;
            } else if !self.is_to_rounding {
                return Some(Iteration::Diverged);
            }
        }
        if !size.is_finite() || size > GROWTH * self.first {
            return Some(Iteration::Diverged);
        }
        self.last = size;
        (self.left * size <= self.rest).then_some(Iteration::Converged)
    }
}
