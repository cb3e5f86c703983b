//! Elastic force of a contact over its penetration.

use std::f64::consts::{PI, SQRT_2};

use deltazero_solvers::Real;
use deltazero_solvers::real::Function;

/// An elastic relation between force F [N] and penetration δ [m], odd in δ: it is continued past the surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Elastic {
    /// `F = K δ`.
    Linear {
        /// `K` [N/m].
        stiffness: f64,
    },
    /// `F = K δⁿ`.
    Power {
        /// `K` [N/mⁿ].
        stiffness: f64,
        /// `n > 1`.
        exponent: f64,
    },
    /// `δ = A F ln(C/F)`.
    Logarithmic(Logarithmic),
    /// `F = k δ √(δ/(2(Δ + δ)))`.
    Conformal(Conformal),
}

impl Elastic {
    /// `K δⁿ`, `n ≥ 1`.
    pub fn power(stiffness: f64, exponent: f64) -> Self {
        if exponent == 1.0 {
            Self::Linear { stiffness }
        } else {
            Self::Power { stiffness, exponent }
        }
    }

    /// `F(δ)` [N].
    #[inline(always)]
    pub fn force<S: Real>(&self, delta: S) -> S {
        match self {
            Self::Linear { stiffness } => delta * *stiffness,
            _ => delta.outlined(self),
        }
    }

    /// `dF/dδ` [N/m].
    pub fn slope(&self, delta: f64) -> f64 {
        let depth = delta.abs();
        match self {
            Self::Linear { stiffness } => *stiffness,
            Self::Power { stiffness, exponent } => {
                exponent * stiffness * libm::pow(depth, exponent - 1.0)
            }
            Self::Logarithmic(law) => law.slope(depth),
            Self::Conformal(law) => law.slope(depth),
        }
    }

    /// Elastic energy `∫ F dδ` [J].
    pub fn energy(&self, delta: f64) -> f64 {
        let depth = delta.abs();
        match self {
            Self::Linear { stiffness } => stiffness * libm::pow(depth, 2.0) / 2.0,
            Self::Power { stiffness, exponent } => {
                stiffness * libm::pow(depth, exponent + 1.0) / (exponent + 1.0)
            }
            Self::Logarithmic(law) => law.energy(depth),
            Self::Conformal(law) => law.energy(depth),
        }
    }

    /// `1 − δ/δ_max` of a relation that holds to δ_max, the [deepest](Self::deepest).
    #[inline(always)]
    pub fn before_deepest<S: Real>(&self, delta: S) -> Option<S> {
        self.deepest().map(|deepest| -(delta / deepest) + 1.0)
    }

    /// The largest δ [m] that the relation holds for, if there is one.
    #[inline(always)]
    pub fn deepest(&self) -> Option<f64> {
        match self {
            Self::Logarithmic(law) => Some(law.deepest),
            _ => None,
        }
    }

    /// The force there [N].
    pub fn strongest(&self) -> f64 {
        match self {
            Self::Logarithmic(law) => law.force_there,
            _ => f64::INFINITY,
        }
    }
}

impl Function for Elastic {
    fn of<S: Real>(&self, delta: S) -> S {
        // Odd, and asked for δ ≥ 0 alone.
        if delta.value() < 0.0 {
            return -self.of(-delta);
        }
        match self {
            Self::Linear { stiffness } => delta * *stiffness,
            Self::Power { stiffness, exponent } => delta.powf(*exponent) * *stiffness,
            Self::Logarithmic(law) => law.of(delta),
            Self::Conformal(law) => law.of(delta),
        }
    }
}

/// Two cylinders, a pin and its bush or others, of one material, as the laws of cylinders have them.
#[derive(Clone, Copy, Debug)]
pub struct Cylinders {
    /// `k = 2(1 − ν²)/(π E)` [1/Pa].
    pub k: f64,
    /// `E* = 1/(π k)` [Pa].
    pub modulus: f64,
    /// Length L of the line along which they touch [m].
    pub length: f64,
    /// `ΔR`: `R₂ − R₁` inside each other, `R₁ + R₂` beside each other [m].
    pub gap: f64,
    /// `R = R₁R₂/ΔR` [m].
    pub radius: f64,
    /// A penetration within the rounding of δ, above zero [m].
    pub least: f64,
}

impl Cylinders {
    /// `δ = (k/L) F (ln(B/F) + s)`, which is `A F ln(C/F)` with `A = k/L`, `C = B eˢ`.
    pub fn logarithmic(&self, b: f64, s: f64) -> Elastic {
        Elastic::Logarithmic(Logarithmic::new(self.k / self.length, b * libm::exp(s), self.least))
    }
}

/// Cylinders that touch along a line: `δ = A F ln(C/F)`.
///
/// The relation rises to its turning point `δ* = A C/e`, `F* = C/e`, and has one inverse below it: with
/// `L = ln(C/F)`,
///
/// ```text
/// L − ln L = −ln(δ/(A C)),   L > 1   (L = −W₋₁(−δ/(A C)), Lambert's function),   F = δ/(A L)
/// ```
///
/// It is used up to `L = 1.1`, where δ is `1.1 e^(−0.1) = 0.9953` of δ*: beyond, its slope grows without
/// bound. Past that penetration the force is continued along its tangent, for steps that are cut there.
///
/// At δ = 0 the slope is zero and its derivatives are infinite. Below a penetration `δ_min` that is within the
/// rounding of δ the force is the chord `F = δ F(δ_min)/δ_min`, which has derivatives of all orders.
#[derive(Clone, Debug, PartialEq)]
pub struct Logarithmic {
    /// `A` [m/N].
    compliance: f64,
    /// `A C` [m].
    depth: f64,
    /// The largest penetration [m], and force [N] and slope [N/m] there.
    deepest: f64,
    force_there: f64,
    slope_there: f64,
    /// The penetration below which the force is a chord [m], and the chord's slope [N/m].
    least: f64,
    slope_least: f64,
}

/// `ln(C/F)` at the largest penetration.
const LEAST_LOG: f64 = 1.1;

impl Logarithmic {
    /// The relation of `A` [m/N] and `C` [N], a chord below the penetration `least` [m], above zero.
    pub fn new(a: f64, c: f64, least: f64) -> Self {
        let force_there = c * libm::exp(-LEAST_LOG);
        let law = Self {
            compliance: a,
            depth: a * c,
            deepest: a * force_there * LEAST_LOG,
            force_there,
            slope_there: 1.0 / (a * (LEAST_LOG - 1.0)),
            least,
            slope_least: 0.0,
        };
        Self { slope_least: 1.0 / (a * law.log(least)), ..law }
    }

    /// `δ(F)` [m].
    pub fn penetration(&self, force: f64) -> f64 {
        self.compliance * force * libm::log(self.depth / (self.compliance * force))
    }

    /// `ln(C/F)` at a penetration above zero, by Newton's iteration.
    ///
    /// The start is the upper one of the bounds `1 + √(2u) + 2u/3 < L < 1 + √(2u) + u`, `u = −ln(δ/δ*)`, from
    /// where it descends; I. Chatzigeorgiou, "Bounds for the Lambert function and their application to the
    /// outage analysis of user cooperation", IEEE Commun. Lett. 17(8), 1505–1508 (2013).
    fn log(&self, delta: f64) -> f64 {
        let target = -libm::log(delta / self.depth);
        let u = (target - 1.0).max(0.0);
        let mut l = 1.0 + (2.0 * u).sqrt() + u;
        loop {
            let next = l - (l - libm::log(l) - target) / (1.0 - 1.0 / l);
            // Where δ is not a number no iterate is below another, and the loop would not end.
            if next >= l || next.is_nan() {
                return l;
            }
            l = next;
        }
    }

    fn slope(&self, delta: f64) -> f64 {
        if delta > self.deepest {
            self.slope_there
        } else if delta < self.least {
            self.slope_least
        } else {
            1.0 / (self.compliance * (self.log(delta) - 1.0))
        }
    }

    /// `∫ F dδ = F δ/2 − A F²/4` [J].
    fn energy(&self, delta: f64) -> f64 {
        let within = delta.min(self.deepest);
        let (force, beyond) = (self.of(within), delta - within);
        let under_tangent = beyond * (self.force_there + 0.5 * self.slope_there * beyond);
        0.5 * force * within - 0.25 * self.compliance * force * force + under_tangent
    }
}

impl Function for Logarithmic {
    fn of<S: Real>(&self, delta: S) -> S {
        if delta.value() > self.deepest {
            return (delta - self.deepest) * self.slope_there + self.force_there;
        }
        if delta.value() < self.least {
            return delta * self.slope_least;
        }
        let mut l = S::cst(self.log(delta.value()));
        let target = -(delta / self.depth).ln();
        for _ in 0..S::NEWTON_STEPS {
            l = l - (l - l.ln() - target) * l / (l - 1.0);
        }
        delta / (l * self.compliance)
    }
}

/// A pin that its bush holds: `F = k δ √(δ/(2(Δ + δ)))`.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformal {
    /// `k` [N/m].
    pub stiffness: f64,
    /// `Δ`, difference of the radii [m].
    pub gap: f64,
}

impl Conformal {
    /// Liu's of two cylinders of the reduced modulus `E*` [Pa] over a length [m].
    pub fn new(modulus: f64, length: f64, gap: f64) -> Self {
        Self { stiffness: 0.5 * PI * length * modulus, gap }
    }

    fn slope(&self, delta: f64) -> f64 {
        let part = delta / (self.gap + delta);
        self.stiffness * (0.5 * part).sqrt() * (1.5 - 0.5 * part)
    }

    /// With `s = √δ`, `r = √(Δ + δ)`:
    ///
    /// ```text
    /// ∫ F dδ = k/√2 (s r (2 s² − 3 Δ)/4 + ¾ Δ² arsinh(s/√Δ))
    /// ```
    fn energy(&self, delta: f64) -> f64 {
        let (s, r) = (delta.sqrt(), (self.gap + delta).sqrt());
        let log = libm::asinh((delta / self.gap).sqrt());
        let area = s * r * (2.0 * delta - 3.0 * self.gap) / 4.0 + 0.75 * self.gap * self.gap * log;
        self.stiffness / SQRT_2 * area
    }
}

impl Function for Conformal {
    fn of<S: Real>(&self, delta: S) -> S {
        // The root of δ alone has no slope at δ = 0; this power has.
        delta.powf(1.5) / ((delta + self.gap) * 2.0).sqrt() * self.stiffness
    }
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;

    /// The penetration below which a relation is a chord [m].
    const LEAST: f64 = 1e-19;

    fn relations() -> [Elastic; 5] {
        [
            Elastic::power(1e7, 1.0),
            Elastic::power(1e10, 1.5),
            Elastic::power(1e12, 2.2),
            Elastic::Logarithmic(Logarithmic::new(1.4e-10, 1e6, LEAST)),
            Elastic::Conformal(Conformal::new(1.1e11, 0.02, 1e-4)),
        ]
    }

    #[test]
    fn slope_and_energy_are_derivative_and_integral_of_the_force() {
        for law in relations() {
            for (delta, h) in [(3e-6, 1e-10), (-3e-6, 1e-10), (6e-5, 1e-9)] {
                let force = |delta: f64| law.force(delta);
                let slope = (force(delta + h) - force(delta - h)) / (2.0 * h);
                assert!((slope / law.slope(delta) - 1.0).abs() < 1e-6, "{law:?}: {slope}");
                let gained = (law.energy(delta + h) - law.energy(delta - h)) / (2.0 * h);
                assert!((gained / force(delta) - 1.0).abs() < 1e-6, "{law:?}: {gained}");
                let dual = law.force(Dual64::new(delta, 1.0)).eps;
                // Measured: 6.7e-16.
                assert!((dual / law.slope(delta) - 1.0).abs() < 6e-15, "{law:?}: {dual}");
                assert_eq!(force(-delta), -force(delta));
            }
        }
    }

    #[test]
    fn the_force_of_cylinders_gives_back_their_penetration_over_the_whole_range() {
        let law = Logarithmic::new(1.4e-10, 1e6, LEAST);
        let turning = law.depth / std::f64::consts::E;
        assert!((law.deepest / turning - 0.9953).abs() < 1e-4);
        for k in 0..=700 {
            let delta = law.deepest * libm::pow(10.0, -0.02 * f64::from(k));
            let back = law.penetration(law.of(delta));
            assert!((back / delta - 1.0).abs() < 1e-14, "{delta:e}: {:e}", back / delta - 1.0);
        }
    }

    #[test]
    fn every_relation_has_a_finite_force_and_slope_at_the_surface() {
        for law in relations() {
            for delta in [0.0, 1e-300, 1e-25, 0.5 * LEAST, 2.0 * LEAST] {
                let force = law.force(Dual64::new(delta, 1.0));
                let is_finite = force.re.is_finite() && force.eps.is_finite();
                assert!(is_finite && law.slope(delta).is_finite(), "{law:?} at {delta:e}: {force}");
                assert!((0.0..=1e-8).contains(&force.re), "{law:?} at {delta:e}: {force}");
            }
        }
    }

    #[test]
    fn a_penetration_that_is_not_a_number_gives_no_number() {
        for law in relations() {
            assert!(law.force(f64::NAN).is_nan(), "{law:?}");
            assert!(!law.slope(f64::NAN).is_finite() || matches!(law, Elastic::Linear { .. }));
        }
    }

    #[test]
    fn a_chord_meets_its_relation_where_it_ends() {
        let law = Logarithmic::new(1.4e-10, 1e6, LEAST);
        let [below, above] = [LEAST.next_down(), LEAST].map(|delta| law.of(delta));
        // Measured: 1.2e-16.
        assert!((below / above - 1.0).abs() < 1e-15, "{below:e} and {above:e}");
    }
}
