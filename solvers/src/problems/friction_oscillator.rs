//! A spring-mass oscillator that rubs on a fixed surface until it sticks.

use super::ROUNDING;
use crate::real::Real;
use crate::system::{Next, System};

/// Which way the mass slides, if it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionMode {
    /// Slides with v > 0.
    SlipPlus,
    /// Slides with v < 0.
    SlipMinus,
    /// Does not slide.
    Stick,
}

/// An oscillator with Coulomb friction on a fixed surface, released from rest.
///
/// ```text
/// m ẍ + k x = ∓μN   while ẋ ≷ 0,     ẋ = 0  while |k x| ≤ μN
///
/// |x_n| = |x_0| − 2 n μN/k   at  t_n = n π/ω,   ω = √(k/m)
/// ```
///
/// `x` is the displacement [m], `m` the mass [kg], `k` the stiffness [N/m], `μN` the friction
/// [N], sliding and sticking alike, `x_n` the turning points [m] and `t_n` their times [s]. The
/// mass sticks for good at the first turning point with |k x_n| ≤ μN.
///
/// J. P. Den Hartog, *Mechanical Vibrations*, 4th ed., McGraw-Hill (1956), section 8.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionOscillator {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness k [N/m].
    pub stiffness: f64,
    /// Friction μN [N].
    pub friction: f64,
    /// Displacement x_0 at release [m].
    pub release: f64,
}

impl FrictionOscillator {
    /// State at t = 0: displacement [m] and velocity [m/s].
    pub fn start(&self) -> [f64; 2] {
        [self.release, 0.0]
    }

    /// Angular frequency ω [rad/s].
    pub fn omega(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// Number of half periods until the mass sticks.
    pub fn n_half_periods(&self) -> usize {
        let ratio = self.stiffness * self.release.abs() / self.friction;
        (0.5 * (ratio - 1.0)).ceil().max(0.0) as usize
    }

    /// State at `t ≥ 0`.
    pub fn state(&self, t: f64) -> [f64; 2] {
        let omega = self.omega();
        let half_period = std::f64::consts::PI / omega;
        let n = ((t / half_period) as usize).min(self.n_half_periods());
        // Half a swing, about a centre that friction shifts towards the side of release.
        let shift = self.friction / self.stiffness;
        let side = self.release.signum() * if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        let turning = side * (self.release.abs() - 2.0 * n as f64 * shift);
        if n == self.n_half_periods() {
            return [turning, 0.0];
        }
        let centre = side * shift;
        let (sin, cos) = libm::sincos(omega * (t - n as f64 * half_period));
        let amplitude = turning - centre;
        [centre + amplitude * cos, -omega * amplitude * sin]
    }

    /// The mode of a mass at rest at `x`.
    fn mode_at_rest(&self, x: f64) -> FrictionMode {
        let pull = -self.stiffness * x;
        if pull > self.friction {
            FrictionMode::SlipPlus
        } else if pull < -self.friction {
            FrictionMode::SlipMinus
        } else {
            FrictionMode::Stick
        }
    }
}

impl System for FrictionOscillator {
    type Mode = FrictionMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, &[x, v]: &[f64; 2]) -> FrictionMode {
        if v > 0.0 {
            FrictionMode::SlipPlus
        } else if v < 0.0 {
            FrictionMode::SlipMinus
        } else {
            self.mode_at_rest(x)
        }
    }

    fn rhs<S: Real>(&self, mode: FrictionMode, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        let friction = match mode {
            FrictionMode::SlipPlus => -self.friction,
            FrictionMode::SlipMinus => self.friction,
            FrictionMode::Stick => {
                *dydt = [S::cst(0.0); 2];
                return;
            }
        };
        *dydt = [v, (-x * self.stiffness + friction) / self.mass];
    }

    fn guards<S: Real>(&self, mode: FrictionMode, _t: S, &[x, v]: &[S; 2], g: &mut [S; 2]) {
        let unused = S::cst(1.0);
        let pull = -x * self.stiffness;
        *g = match mode {
            FrictionMode::SlipPlus => [v, unused],
            FrictionMode::SlipMinus => [-v, unused],
            FrictionMode::Stick => [-pull + self.friction, pull + self.friction],
        };
    }

    fn guard_bounds(&self, mode: FrictionMode, _t: f64, &[x, v]: &[f64; 2], bounds: &mut [f64; 2]) {
        let bound = match mode {
            FrictionMode::Stick => self.stiffness * x.abs() + self.friction,
            _ => v.abs() + self.omega() * x.abs(),
        };
        *bounds = [ROUNDING * bound; 2];
    }

    fn transition<S: Real>(
        &self,
        mode: FrictionMode,
        guard: usize,
        _t: S,
        y: &mut [S; 2],
    ) -> Next<FrictionMode> {
        y[1] = S::cst(0.0);
        Next::Mode(match (mode, guard) {
            (FrictionMode::Stick, 0) => FrictionMode::SlipPlus,
            (FrictionMode::Stick, _) => FrictionMode::SlipMinus,
            _ => self.mode_at_rest(y[0].value()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_points_decay_linearly_and_the_last_one_sticks() {
        let oscillator =
            FrictionOscillator { mass: 2.0, stiffness: 50.0, friction: 5.0, release: -1.0 };
        let half_period = std::f64::consts::PI / oscillator.omega();
        assert_eq!(oscillator.n_half_periods(), 5);
        for (n, turning) in [-1.0, 0.8, -0.6, 0.4, -0.2].into_iter().enumerate() {
            let [x, v] = oscillator.state((n as f64 + 1e-12) * half_period);
            // Measured: 6e-17 m and 2e-11 m/s, which is 1e-12 of a half period.
            assert!((x - turning).abs() < 6e-16 && v.abs() < 2e-10, "{x} {v}");
        }
        let [x, v] = oscillator.state(100.0);
        assert!(x.abs() < 1e-15 && v == 0.0);
    }

    #[test]
    fn it_sticks_while_friction_holds_the_spring_on_both_sides() {
        let oscillator =
            FrictionOscillator { mass: 2.0, stiffness: 50.0, friction: 5.0, release: -1.0 };
        for (mode, y, guards, bound) in [
            // Friction less the pull of the spring, 2 N, to the right and to the left.
            (FrictionMode::Stick, [0.04, 0.0], [7.0, 3.0], 7.0),
            (FrictionMode::Stick, [-0.04, 0.0], [3.0, 7.0], 7.0),
            (FrictionMode::SlipPlus, [0.04, 0.3], [0.3, 1.0], 0.5),
            (FrictionMode::SlipMinus, [-0.04, -0.3], [0.3, 1.0], 0.5),
        ] {
            let [mut own, mut bounds] = [[0.0; 2]; 2];
            oscillator.guards(mode, 0.0, &y, &mut own);
            oscillator.guard_bounds(mode, 0.0, &y, &mut bounds);
            assert_eq!((own, bounds), (guards, [bound * ROUNDING; 2]), "{mode:?} {y:?}");
        }
    }
}
