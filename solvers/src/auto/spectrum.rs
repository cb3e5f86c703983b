//! The spectral radius of a Jacobian, the rate of the fastest motion.

use crate::linear::Jacobian;
use crate::system::System;

/// Products with the Jacobian before growth is measured, in which slower motions decay.
const SETTLING: usize = 4;
/// Number of square roots by which growth is averaged, over 2³ products. The number of products must be even: states
/// are lengths and velocities, and only two products together return to the same unit.
const ROOTS: u32 = 3;
const AVERAGED: usize = 1 << ROOTS;

/// Estimates the spectral radius of Jacobians of one system.
pub(super) struct Spectrum {
    jacobian: Jacobian,
    v: Vec<f64>,
    product: Vec<f64>,
}

impl Spectrum {
    /// Workspace for `n` states.
    pub(super) fn new(n: usize) -> Self {
        Self { jacobian: Jacobian::new(n), v: vec![0.0; n], product: vec![0.0; n] }
    }

    /// The spectral radius ρ of `∂f/∂y` in `mode` at `(t, y)`, by power iteration:
    ///
    /// ```text
    /// ρ ≈ (|J¹² v| / |J⁴ v|)^(1/8),   v = (1, 1/2, 1/3, …)
    /// ```
    ///
    /// Exact to about ten per cent where one motion is much faster than the others. Returns zero where the Jacobian
    /// is not finite.
    pub(super) fn radius<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> f64 {
        if self.jacobian.evaluate(problem, mode, t, y).is_some() {
            return 0.0;
        }
        for (i, v) in self.v.iter_mut().enumerate() {
            *v = 1.0 / (i + 1) as f64;
        }
        let mut growth = 1.0;
        for n in 0..SETTLING + AVERAGED {
            self.product.fill(0.0);
            self.jacobian.add_product(&self.v, &mut self.product);
            let size = self.product.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            if size == 0.0 {
                return 0.0;
            }
            let inverse = 1.0 / size;
            for (v, product) in self.v.iter_mut().zip(&self.product) {
                *v = product * inverse;
            }
            if n >= SETTLING {
                growth *= (0..ROOTS).fold(size, |root, _| root.sqrt());
            }
        }
        growth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{SpringStop, StopMode};

    #[test]
    fn the_radius_of_an_oscillator_is_its_angular_frequency() {
        for stop_stiffness in [1.0, 1e4, 1e12] {
            let stop = SpringStop {
                mass: 0.2,
                stiffness: 3.0,
                stop_stiffness,
                gap: 1.0,
                start: [1.5, 0.1],
            };
            let radius = Spectrum::new(2).radius(&stop, StopMode::Contact, 0.0, &stop.start);
            let omega = ((3.0 + stop_stiffness) / 0.2).sqrt();
            // Measured: 2.2e-16.
            assert!((radius / omega - 1.0).abs() < 1e-15, "{radius} for {omega}");
        }
    }
}
