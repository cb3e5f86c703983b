//! How friction goes with the speed of sliding.

use deltazero_solvers::Real;
use deltazero_solvers::real::Function;

use super::contact::Onset;
use crate::keys::{Friction, FrictionLaw};

/// Speeds v_S beyond which `exp(−(s/v_S)²)` is a rounding error of one: e⁻³⁶ = 2.3e-16. What a law does below them
/// is a piece of its own, as it is too narrow to be seen from afar: all terms of its series at 30 v_S are zero, and
/// a step would pass over it.
const STRIBECK_SETTLED: f64 = 6.0;
/// Speeds v_r beyond which so is `1 − tanh(s/v_r)`: 2 e⁻³⁸ = 6e-17. Its series fades more slowly and to the same end.
const TANH_SETTLED: f64 = 19.0;

/// Friction of a slip, `F_T = −σ m F_N` [N] with σ the sign of the tangential velocity v_T and `m(s)` of its
/// size s = |v_T| [m/s]: smooth piece by piece, each piece a mode.
///
/// Coulomb's and Stribeck's laws stick at s = 0, below `m(0)`. The others have m(0) = 0 and creep instead, or
/// bend their [`Bristles`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `m = μ`. Eq. (4) of the paper.
    Constant,
    /// `m = μ + (μ_s − μ) exp(−(s/v_S)²)` to 6 v_S, `μ` beyond. R. Stribeck, Z. VDI 46 (1902); the Gaussian by L. C. Bo, D. Pavelescu,
    /// Wear 82, 277–289 (1982).
    Stribeck {
        /// `μ_s − μ`.
        excess: f64,
        /// `v_S` [m/s].
        speed: f64,
    },
    /// `m = μ tanh(s/v_r)` to 19 v_r, `μ` beyond; odd and smooth through zero.
    Tanh {
        /// `v_r` [m/s].
        speed: f64,
    },
    /// `m = 0` to v_0, `μ (s − v_0)/(v_r − v_0)` to v_r, `μ` beyond. J. A. C. Ambrósio, "Impact of rigid and
    /// flexible multibody systems: deformation description and contact models" (2003).
    Ambrosio {
        /// `v_0` [m/s].
        dead: f64,
        /// `v_r` [m/s].
        speed: f64,
    },
    /// `m = μ (1 − exp(−3 s/v_r))` to v_r, `μ (1 − e⁻³)` beyond, which is printed as 0.95 μ. R. Threlfall, "The
    /// inclusion of Coulomb friction in mechanisms programs with particular reference to DRAM", Mech. Mach.
    /// Theory 13, 475–483 (1978).
    Threlfall {
        /// `v_r` [m/s].
        speed: f64,
    },
    /// `m = g(s) + σ2 s` where the speed is held: what [`Bristles`] bend to.
    Lugre(Bristles),
}

/// Friction by bristles that bend before they slide, the LuGre law, here by a normal force that varies:
///
/// ```text
/// F_T = −F_N (σ0 z + σ1 ż + σ2 v_T)   [N]
/// ż = v_T − σ0 |v_T| z/g(|v_T|)       [m/s]
/// g(s) = μ + (μ_s − μ) exp(−(s/v_S)²) to 6 v_S, μ beyond
/// ```
///
/// z the deflection of the bristles [m]: zero where a contact begins, to ±g/σ0 where it slides. It does not stick,
/// it bends.
///
/// C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems with friction",
/// IEEE Trans. Autom. Control 40(3), 419–425 (1995), has forces for a constant load: `F = σ0 z + σ1 ż + σ2 v`, `ż =
/// v − σ0 |v| z/g(v)`, `g = F_C + (F_S − F_C) exp(−(v/v_S)²)`. Here the load is a factor, as contacts need it; so C.
/// Canudas de Wit, P. Tsiotras, "Dynamic tire friction models for vehicle traction control", Proc. 38th IEEE CDC
/// (1999), with another exponent in g.
///
/// Unbent bristles at v_T above μ_s/σ1, as where a contact begins fast, give more than μ_s F_N. With F_N held and
/// `½ σ0 z²` stored, `F v − σ0 z ż = (σ0 z)² |v|/g + σ1 v ż + σ2 v²`, and as `v ż ≥ −v² (μ_s − μ)/μ` for |z| ≤ μ_s/σ0 the
/// law is passive if σ2 ≥ σ1 (μ_s − μ)/μ; else it may give energy where a speed changes fast. The energy balance counts
/// all that friction takes as dissipated, what bends bristles too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristles {
    /// `σ0` [1/m].
    pub stiffness: f64,
    /// `σ1` [s/m].
    pub damping: f64,
    /// `σ2` [s/m].
    pub viscosity: f64,
    /// `μ_s − μ`.
    pub excess: f64,
    /// `v_S` [m/s].
    pub speed: f64,
}

impl Bristles {
    /// `σ0 z + σ1 ż + σ2 v_T` and `ż` [m/s] in a piece of g, where v_T has the sign `sigma`, past zero too.
    #[inline(always)]
    pub(super) fn bent<S: Real>(&self, (mu, piece): (f64, u8), sigma: f64, v_t: S, z: S) -> (S, S) {
        let s = v_t * sigma;
        let g =
            s.outlined(&Piece { shape: self.without_viscosity(), mu, piece: Self::of_g(piece) });
        let z_dot = v_t - z * s * self.stiffness / g;
        (z * self.stiffness + z_dot * self.damping + v_t * self.viscosity, z_dot)
    }

    /// `g/σ0` at rest [m].
    pub(super) fn most_deflection(&self, mu: f64) -> f64 {
        (mu + self.excess.max(0.0)) / self.stiffness
    }

    /// The piece of g that a piece of the whole is: two of the latter divide the first of the former.
    fn of_g(piece: u8) -> u8 {
        piece.saturating_sub(1)
    }

    /// g as a shape.
    fn without_viscosity(&self) -> Shape {
        Shape::Stribeck { excess: self.excess, speed: self.speed }
    }
}

impl Shape {
    /// The shape of a configuration.
    pub fn new(friction: &Friction) -> Self {
        let speed = friction.regularisation_speed;
        let excess = friction.static_coefficient - friction.coefficient;
        match friction.law {
            FrictionLaw::Coulomb => Self::Constant,
            FrictionLaw::Stribeck => Self::Stribeck { excess, speed: friction.stribeck_speed },
            FrictionLaw::Lugre => Self::Lugre(Bristles {
                stiffness: friction.bristle_stiffness,
                damping: friction.bristle_damping,
                viscosity: friction.viscosity,
                excess,
                speed: friction.stribeck_speed,
            }),
            FrictionLaw::Tanh => Self::Tanh { speed },
            FrictionLaw::Ambrosio => Self::Ambrosio { dead: friction.dead_ratio * speed, speed },
            FrictionLaw::Threlfall => Self::Threlfall { speed },
        }
    }

    /// Whether it can hold at s = 0.
    pub fn sticks(&self) -> bool {
        matches!(self, Self::Constant | Self::Stribeck { .. })
    }

    /// What it keeps of its sliding, where it does.
    pub fn bristles(&self) -> Option<Bristles> {
        match self {
            Self::Lugre(bristles) => Some(*bristles),
            _ => None,
        }
    }

    /// `m(0)` of a law that sticks.
    pub fn at_rest(&self, mu: f64) -> f64 {
        match self {
            Self::Stribeck { excess, .. } => mu + excess,
            _ => mu,
        }
    }

    /// The speeds at which one piece ends and the next begins [m/s]; infinite where there is none.
    fn ends(&self) -> [f64; 2] {
        match *self {
            Self::Ambrosio { dead, speed } => [dead, speed],
            Self::Threlfall { speed } => [speed, f64::INFINITY],
            Self::Stribeck { excess, speed } if excess != 0.0 => {
                [STRIBECK_SETTLED * speed, f64::INFINITY]
            }
            Self::Tanh { speed } => [TANH_SETTLED * speed, f64::INFINITY],
            // g enters ż with a factor |v_T|, so a step from 6 v_S to v_T = 0 sees nothing of it at either end.
            Self::Lugre(own) if own.excess != 0.0 => [own.speed, STRIBECK_SETTLED * own.speed],
            _ => [f64::INFINITY; 2],
        }
    }

    /// `onset` in the piece of a speed `s`.
    pub(super) fn begun_at(&self, s: f64, onset: Onset) -> Onset {
        let piece = self.ends().iter().filter(|end| s >= **end).count() as u8;
        Onset { piece, ..onset }
    }

    /// The speeds between which a piece lies [m/s].
    pub(super) fn span(&self, piece: u8) -> [f64; 2] {
        let [first, second] = self.ends();
        match piece {
            0 => [0.0, first],
            1 => [first, second],
            _ => [second, f64::INFINITY],
        }
    }

    /// `m` at `s` in a piece, past its ends and below zero too.
    #[inline(always)]
    pub(super) fn ratio<S: Real>(&self, mu: f64, piece: u8, s: S) -> S {
        if matches!(self, Self::Constant) {
            return S::cst(mu);
        }
        s.outlined(&Piece { shape: *self, mu, piece })
    }

    /// `dm/ds` [s/m] there.
    pub(super) fn slope(&self, mu: f64, piece: u8, s: f64) -> f64 {
        match (*self, piece) {
            (Self::Stribeck { excess, speed }, 0) => {
                let part = s / speed;
                -2.0 * excess * part / speed * libm::exp(-part * part)
            }
            (Self::Lugre(own), piece) => {
                own.without_viscosity().slope(mu, Bristles::of_g(piece), s) + own.viscosity
            }
            (Self::Tanh { speed }, 0) => {
                let cosh = libm::cosh(s / speed);
                mu / (speed * cosh * cosh)
            }
            (Self::Ambrosio { dead, speed }, 1) => mu / (speed - dead),
            (Self::Threlfall { speed }, 0) => 3.0 * mu / speed * libm::exp(-3.0 * s / speed),
            _ => 0.0,
        }
    }
}

/// One piece of a shape, a function of s.
struct Piece {
    shape: Shape,
    mu: f64,
    piece: u8,
}

impl Function for Piece {
    fn of<S: Real>(&self, s: S) -> S {
        let Self { shape, mu, piece } = *self;
        match (shape, piece) {
            (Shape::Stribeck { excess, speed }, 0) => {
                let part = s / speed;
                (-(part * part)).exp() * excess + mu
            }
            (Shape::Lugre(own), piece) => {
                let (shape, piece) = (own.without_viscosity(), Bristles::of_g(piece));
                Self { shape, mu, piece }.of(s) + s * own.viscosity
            }
            (Shape::Tanh { speed }, 0) => {
                // Of the argument's size: no power overflows.
                let sign = if s.value() < 0.0 { -1.0 } else { 1.0 };
                let falls = (s * (-2.0 * sign / speed)).exp();
                (-falls + 1.0) / (falls + 1.0) * (sign * mu)
            }
            (Shape::Ambrosio { .. }, 0) => S::cst(0.0),
            (Shape::Ambrosio { dead, speed }, 1) => (s - dead) * (mu / (speed - dead)),
            (Shape::Threlfall { speed }, 0) => (-(s * (-3.0 / speed)).exp() + 1.0) * mu,
            (Shape::Threlfall { .. }, _) => S::cst(mu * -libm::expm1(-3.0)),
            (
                Shape::Constant
                | Shape::Stribeck { .. }
                | Shape::Tanh { .. }
                | Shape::Ambrosio { .. },
                _,
            ) => S::cst(mu),
        }
    }
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;

    const BRISTLES: Bristles =
        Bristles { stiffness: 1e5, damping: 10.0, viscosity: 2.0, excess: 0.05, speed: 1e-3 };

    const SHAPES: [Shape; 6] = [
        Shape::Lugre(BRISTLES),
        Shape::Constant,
        Shape::Stribeck { excess: 0.05, speed: 1e-3 },
        Shape::Tanh { speed: 1e-4 },
        Shape::Ambrosio { dead: 1e-5, speed: 1e-4 },
        Shape::Threlfall { speed: 1e-4 },
    ];

    #[test]
    fn bristles_that_no_longer_bend_give_the_friction_of_their_speed() {
        for (sigma, s) in [(1.0, 2e-3), (-1.0, 5e-4)] {
            let g = Shape::Lugre(BRISTLES).ratio(0.1, 0, s) - BRISTLES.viscosity * s;
            let (v_t, z) = (sigma * s, sigma * g / BRISTLES.stiffness);
            let (ratio, z_dot) = BRISTLES.bent((0.1, 0), sigma, v_t, z);
            assert!(z_dot.abs() < 1e-15 * s, "{z_dot:e}");
            let steady = sigma * (g + BRISTLES.viscosity * s);
            assert!((ratio / steady - 1.0).abs() < 1e-15, "{ratio} against {steady}");
        }
    }

    #[test]
    fn friction_is_continuous_where_its_pieces_meet_and_its_slope_is_its_derivative() {
        for shape in SHAPES {
            for piece in 0..2 {
                let [_, end] = shape.span(piece);
                if end.is_finite() {
                    let [below, above] = [piece, piece + 1].map(|p| shape.ratio(0.1, p, end));
                    assert!((below - above).abs() < 1e-16, "{shape:?}: {below} and {above}");
                }
                for s in [-2e-6, 0.0, 3e-6, 5e-5, 2e-4] {
                    let dual = shape.ratio(0.1, piece, Dual64::new(s, 1.0)).eps;
                    let slope = shape.slope(0.1, piece, s);
                    // Measured: 1.5e-12 of 1000.
                    assert!(
                        (dual - slope).abs() <= 1e-14 * slope.abs().max(1e3),
                        "{shape:?} at {s}"
                    );
                }
            }
            let onset = Onset::PLAIN;
            let piece = |s| shape.begun_at(s, onset).piece;
            for s in [0.0, 5e-6, 1e-5, 5e-5, 1e-4, 1.0] {
                let [low, high] = shape.span(piece(s));
                assert!(low <= s && s < high, "{shape:?} at {s}");
            }
        }
    }
}
