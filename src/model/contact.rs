//! Penetration and normal force of a pin in its bush.

use deltazero_solvers::Real;

use crate::config::Contact;

/// Normal force law `F_N = K δⁿ + D δ̇` (Eqs. 3 and 5 of the paper, there with n = 1).
#[derive(Clone, Debug, PartialEq)]
pub struct NormalLaw {
    /// `K` [N/mⁿ].
    pub stiffness: f64,
    /// `D` [N s/m].
    pub damping: f64,
    /// `n ≥ 1`.
    pub exponent: f64,
    /// Whether contact lasts until δ = 0, pulling before it, as printed; or ends at F_N = 0.
    pub adhesion: bool,
}

impl NormalLaw {
    /// The law of a configuration.
    pub fn new(contact: &Contact) -> Self {
        Self {
            stiffness: contact.stiffness,
            damping: contact.damping,
            exponent: contact.exponent,
            adhesion: contact.adhesion,
        }
    }

    /// `K δ|δ|ⁿ⁻¹ + D δ̇` [N]: the law, continued past δ = 0 by the odd extension of δⁿ.
    #[inline(always)]
    pub fn force<S: Real>(&self, delta: S, delta_dot: S) -> S {
        self.odd_power(delta) * self.stiffness + delta_dot * self.damping
    }

    #[inline(always)]
    fn odd_power<S: Real>(&self, delta: S) -> S {
        if self.exponent == 1.0 {
            delta
        } else if delta.value() < 0.0 {
            -(-delta).powf(self.exponent)
        } else {
            delta.powf(self.exponent)
        }
    }

    /// `∂F_N/∂δ = n K |δ|ⁿ⁻¹` [N/m].
    pub fn slope(&self, delta: f64) -> f64 {
        if self.exponent == 1.0 {
            self.stiffness
        } else {
            self.exponent * self.stiffness * libm::pow(delta.abs(), self.exponent - 1.0)
        }
    }

    /// Elastic energy `K |δ|ⁿ⁺¹/(n + 1)` [J].
    pub fn elastic_energy(&self, delta: f64) -> f64 {
        let n = self.exponent + 1.0;
        self.stiffness * libm::pow(delta.abs(), n) / n
    }
}

/// How the pin stands in its bush: position and velocity in polar form.
#[derive(Clone, Copy, Debug)]
pub struct PinPose<S> {
    /// Unit vector from the bush's centre to the pin's.
    pub n: [S; 2],
    /// `ρ`, the pin's distance from the bush's centre [m].
    pub rho: S,
    /// `δ = ρ − c` [m].
    pub delta: S,
    /// `δ̇ = n·v` [m/s].
    pub delta_dot: S,
}

impl<S: Real> PinPose<S> {
    /// Of a pin at `d` [m] moving at `v` [m/s] in a bush of clearance `c` [m]; not a number where
    /// `d` is zero, the one place without a direction.
    #[inline(always)]
    pub fn new(d: [S; 2], v: [S; 2], c: f64) -> Self {
        let rho = (d[0] * d[0] + d[1] * d[1]).sqrt();
        let per_rho = S::cst(1.0) / rho;
        let n = [d[0] * per_rho, d[1] * per_rho];
        Self { n, rho, delta: rho - c, delta_dot: (d[0] * v[0] + d[1] * v[1]) * per_rho }
    }

    /// `t·v`, `t = (n_Y, −n_X)`: tangential velocity [m/s] of the pin's centre, which moves at `v`.
    #[inline(always)]
    pub fn w(&self, v: [S; 2]) -> S {
        self.n[1] * v[0] - self.n[0] * v[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(exponent: f64) -> NormalLaw {
        NormalLaw { stiffness: 1e7, damping: 100.0, exponent, adhesion: true }
    }

    #[test]
    fn slope_and_energy_are_derivative_and_integral_of_the_force() {
        for law in [law(1.0), law(1.5), law(2.2)] {
            let (delta, h) = (3e-6, 1e-10);
            let force = |delta: f64| law.force(delta, 0.0);
            let slope = (force(delta + h) - force(delta - h)) / (2.0 * h);
            assert!((slope / law.slope(delta) - 1.0).abs() < 1e-7);
            let gained = law.elastic_energy(delta + h) - law.elastic_energy(delta - h);
            assert!((gained / (2.0 * h) / force(delta) - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn the_force_is_odd_past_the_surface_for_any_exponent() {
        for exponent in [1.0, 1.5, 3.0] {
            assert_eq!(law(exponent).force(-2e-6, 0.0), -law(exponent).force(2e-6, 0.0));
        }
    }

    #[test]
    fn polar_velocity_is_the_velocity() {
        let (d, v) = ([3e-5, -8e-5], [2e-3, 1e-3]);
        let pose = PinPose::new(d, v, 1e-4);
        let t = [pose.n[1], -pose.n[0]];
        for i in 0..2 {
            assert!((pose.n[i] * pose.delta_dot + t[i] * pose.w(v) - v[i]).abs() < 1e-18);
        }
    }
}
