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
/// ```text
/// θ_k = ‖ΔZ_k‖/‖ΔZ_(k−1)‖,   η_k = θ_k/(1 − θ_k)
/// converged:  η_k ‖ΔZ_k‖ ≤ κ
/// diverged:   θ_k ≥ 1,  or  θ_k^(k_max − k)/(1 − θ_k) ‖ΔZ_k‖ > κ
/// ```
///
/// with the corrections ΔZ_k, counted from one, in units of the tolerance. From the third one on θ_k is the geometric mean of
/// the last two quotients. The iteration is taken to diverge from θ_k = 0.99 on. Under a tolerance the first correction is judged by
/// `η₁ = max(η, ε)^0.8`, with the η of the previous iteration. Hairer & Wanner, IV.8, and RADAU5. Beyond these, the first
/// corrections may be allowed to grow.
pub(super) struct Convergence {
    /// Largest number of iterations.
    pub(super) most: usize,
    /// κ: the error that the iteration may leave.
    tolerance: f64,
    pub(super) is_to_rounding: bool,
    /// Number of corrections that may grow under a tolerance.
    patience: usize,
    /// η: the error after a correction as a fraction of the correction.
    pub(super) eta: f64,
    first: f64,
    last: f64,
    last_ratio: f64,
}

impl Convergence {
    /// The test of an iteration that continues to rounding.
    pub(super) fn to_rounding() -> Self {
        Self {
            most: ITERATIONS_TO_ROUNDING,
            tolerance: f64::EPSILON,
            is_to_rounding: true,
            patience: 0,
            eta: f64::INFINITY,
            first: f64::NAN,
            last: f64::NAN,
            last_ratio: f64::NAN,
        }
    }

    /// The test of an iteration to an error of `tolerance`; `eta` is that of the iteration before, and the first
    /// `patience` corrections may grow.
    pub(super) fn to_tolerance(tolerance: f64, eta: f64, patience: usize) -> Self {
        Self {
            most: ITERATIONS,
            tolerance,
            is_to_rounding: false,
            patience,
            eta: libm::pow(eta.max(f64::EPSILON), 0.8),
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
                self.eta = rate / (1.0 - rate);
                // The iteration is given up early where the remaining iterations cannot suffice.
                let to_come = n + 1..self.most;
                let in_the_end = to_come.fold(self.eta * size, |error, _| error * rate);
                if in_the_end > self.tolerance && n > self.patience && !self.is_to_rounding {
                    return Some(Iteration::Diverged);
                }
            } else if self.is_to_rounding && size <= NOISE {
                // Rounding is reached.
                return Some(Iteration::Converged);
            } else if n <= self.patience {
                self.eta = f64::INFINITY;
            } else if !self.is_to_rounding {
                return Some(Iteration::Diverged);
            }
        }
        if !size.is_finite() || size > GROWTH * self.first {
            return Some(Iteration::Diverged);
        }
        self.last = size;
        (self.eta * size <= self.tolerance).then_some(Iteration::Converged)
    }
}
