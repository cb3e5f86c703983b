//! Penetration and normal force of a pin in its bush.
//!
//! A law is a row of [`laws`](crate::laws); here it gets the numbers of a configuration.

mod guards;

use deltazero_solvers::Real;
use deltazero_solvers::real::{Length, Over};

use super::mode::delta_bound;
use crate::keys::{Contact, Curvature, Joint};
use crate::laws::Relation;
use crate::laws::elastic::{Cylinders, Elastic};

pub use guards::{Bounds, Rounding};

/// Normal force law: an elastic relation F(δ) and what it loses, by viscous damping or by hysteresis.
///
/// ```text
/// F_N = F(δ) + D δ̇        or        F_N = F(δ) (1 + χ δ̇/δ̇₋)
/// ```
///
/// with δ̇₋ the speed at which this contact began. The first with `F = K δⁿ` is that of Eqs. 3 and 5 of the
/// paper, there with n = 1. A law loses `D δ̇²` or `F χ δ̇²/δ̇₋` [W].
#[derive(Clone, Debug, PartialEq)]
pub struct NormalLaw {
    /// `F(δ)`.
    pub elastic: Elastic,
    /// `D` [N s/m]; zero for a law with hysteresis.
    pub damping: f64,
    /// `χ`; zero for a law without.
    pub hysteresis: f64,
    /// The least `δ̇₋` [m/s].
    pub impact_speed_floor: f64,
    /// Whether contact lasts until δ = 0, pulling before it, as printed; or ends at F_N = 0.
    pub adhesion: bool,
}

/// What a contact mode carries: how the contact began, and where its sliding is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// `δ̇₋`, not below the floor [m/s]; infinite for a law that does not ask for it.
    pub impact_speed: f64,
    /// The piece of its law of friction that it slides in.
    pub piece: u8,
}

impl Onset {
    /// Of a law without hysteresis, and friction in its first piece.
    pub const PLAIN: Self = Self { impact_speed: f64::INFINITY, piece: 0 };
}

impl NormalLaw {
    /// The law of a configuration.
    pub fn new(contact: &Contact, joint: &Joint) -> Self {
        let hysteresis = contact.law.hysteresis_factor(contact.restitution);
        Self {
            elastic: elastic(contact, joint),
            damping: if hysteresis.is_some() { 0.0 } else { contact.damping },
            hysteresis: hysteresis.unwrap_or(0.0),
            impact_speed_floor: contact.impact_speed_floor,
            adhesion: contact.adhesion,
        }
    }

    /// The same without losses.
    pub fn undamped(&self) -> Self {
        Self { damping: 0.0, hysteresis: 0.0, ..self.clone() }
    }

    /// What a contact keeps that begins at the speed `delta_dot` [m/s].
    pub fn onset(&self, delta_dot: f64) -> Onset {
        if self.hysteresis == 0.0 {
            Onset::PLAIN
        } else {
            Onset { impact_speed: delta_dot.max(self.impact_speed_floor), piece: 0 }
        }
    }

    /// `1 + χ δ̇/δ̇₋`, by which a law with hysteresis multiplies F(δ).
    #[inline(always)]
    pub fn factor<S: Real>(&self, delta_dot: S, onset: Onset) -> S {
        delta_dot * (self.hysteresis / onset.impact_speed) + 1.0
    }

    /// `F_N` [N], past δ = 0 too.
    #[inline(always)]
    pub fn force<S: Real>(&self, delta: S, delta_dot: S, onset: Onset) -> S {
        let elastic = self.elastic.force(delta);
        if self.hysteresis == 0.0 {
            elastic + delta_dot * self.damping
        } else {
            elastic * self.factor(delta_dot, onset)
        }
    }

    /// `∂F_N/∂δ` [N/m] and `∂F_N/∂δ̇` [N s/m].
    pub fn gradient(&self, delta: f64, delta_dot: f64, onset: Onset) -> [f64; 2] {
        let rate = self.hysteresis / onset.impact_speed;
        let by_speed = self.damping + self.elastic.force(delta) * rate;
        [self.elastic.slope(delta) * (1.0 + rate * delta_dot), by_speed]
    }

    /// What damping and hysteresis take [W].
    pub fn loss(&self, delta: f64, delta_dot: f64, onset: Onset) -> f64 {
        let [_, by_speed] = self.gradient(delta, delta_dot, onset);
        by_speed * delta_dot * delta_dot
    }
}

/// The elastic part of a law.
fn elastic(contact: &Contact, joint: &Joint) -> Elastic {
    match contact.law.relation {
        Relation::Power => Elastic::power(contact.stiffness, contact.exponent),
        Relation::Line(of) | Relation::Point(of) => of(&cylinders(contact, joint)),
    }
}

/// Pin and bush: `R₁` the pin's radius, `R₂ = R₁ + c`.
fn cylinders(contact: &Contact, joint: &Joint) -> Cylinders {
    let (e, nu) = (contact.young_modulus, contact.poisson_ratio);
    let (pin, bush) = (joint.pin_radius, joint.pin_radius + joint.clearance);
    let gap = match contact.curvature {
        Curvature::Internal => joint.clearance,
        Curvature::External => pin + bush,
    };
    Cylinders {
        k: 2.0 * (1.0 - nu * nu) / (std::f64::consts::PI * e),
        modulus: e / (2.0 * (1.0 - nu * nu)),
        length: contact.length,
        gap,
        radius: pin * bush / gap,
        least: delta_bound(joint.clearance).max(f64::MIN_POSITIVE),
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
    /// Of a pin at `d` [m] moving at `v = ḋ` [m/s] in a bush of clearance `c` [m]; not a number where
    /// `d` is zero, the one place without a direction.
    #[inline(always)]
    pub fn new<C>(d: [S; 2], v: [S; 2], c: C) -> Self
    where
        S: Over<C>,
    {
        let Length { rho, rate: delta_dot } = S::length(d, v);
        let n = [d[0].over(&rho), d[1].over(&rho)];
        Self { n, rho: rho.value, delta: rho.value - c, delta_dot }
    }

    /// `t·v`, `t = (n_Y, −n_X)`: tangential velocity [m/s] of the pin's centre, which moves at `v`.
    #[inline(always)]
    pub fn w(&self, v: [S; 2]) -> S {
        self.n[1] * v[0] - self.n[0] * v[1]
    }
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;

    #[test]
    fn the_gradient_of_a_law_is_its_derivative() {
        for (damping, hysteresis) in [(100.0, 0.0), (0.0, 0.6)] {
            let law = NormalLaw {
                elastic: Elastic::power(1e10, 1.5),
                damping,
                hysteresis,
                impact_speed_floor: 1e-6,
                adhesion: true,
            };
            let (delta, delta_dot, onset) = (3e-6, -4e-3, law.onset(1e-2));
            let force = |i: usize| {
                let seed = |j: usize| if i == j { 1.0 } else { 0.0 };
                law.force(Dual64::new(delta, seed(0)), Dual64::new(delta_dot, seed(1)), onset).eps
            };
            for (i, own) in law.gradient(delta, delta_dot, onset).iter().enumerate() {
                assert!((own / force(i) - 1.0).abs() < 1e-15, "{own} against {}", force(i));
            }
        }
    }

    #[test]
    fn a_slow_touch_counts_as_one_at_the_floor() {
        let law = NormalLaw {
            elastic: Elastic::power(1e7, 1.0),
            damping: 0.0,
            hysteresis: 0.5,
            impact_speed_floor: 1e-6,
            adhesion: true,
        };
        assert_eq!(law.onset(1e-9).impact_speed, 1e-6);
        assert_eq!(law.onset(2e-3).impact_speed, 2e-3);
        assert_eq!(law.undamped().onset(2e-3), Onset::PLAIN);
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
