//! The increments of the states at which the iteration of a step begins.

use crate::system::Vector;

/// A polynomial of the increments: that of the step before, extrapolated, or that of an earlier attempt from the same start.
pub(super) struct StartingGuess<Y> {
    /// Its coefficients: `g₁ x + g₂ x² + g₃ x³` at the time `t0 + x h`.
    pub(super) polynomial: [Y; 3],
    /// Step size that it belongs to; `None` at the start of a phase, where there is no guess.
    pub(super) h: Option<f64>,
    /// Whether it extrapolates the step before.
    pub(super) is_extrapolated: bool,
    /// The increment that it gave at the end of the present step.
    pub(super) end: Y,
    /// Square of the norm of the error estimated from that end; zero where it is not.
    pub(super) error_sq: f64,
}

impl<Y: Vector<f64>> StartingGuess<Y> {
    /// No guess yet, of `n` states.
    pub(super) fn new(n: usize) -> Self {
        let zero = || Y::from_fn(n, |_| 0.0);
        Self {
            polynomial: std::array::from_fn(|_| zero()),
            h: None,
            is_extrapolated: false,
            end: zero(),
            error_sq: 0.0,
        }
    }

    /// Forgets it at the start of a phase.
    pub(super) fn forget(&mut self) {
        (self.h, self.is_extrapolated) = (None, false);
    }

    /// Guesses that the states go on along `slope`.
    pub(super) fn follow(&mut self, slope: &Y) {
        self.h = Some(1.0);
        let [linear, others @ ..] = &mut self.polynomial;
        linear.clone_from(slope);
        others.iter_mut().for_each(|all| all.as_mut().fill(0.0));
    }
}
