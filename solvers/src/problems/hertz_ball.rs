//! A ball that flies into a wall whose force grows as a power of the penetration.

use super::{ROUNDING, StopMode};
use crate::real::Real;
use crate::system::{ModeOfState, Next, System};

/// A ball without gravity or losses that hits one wall, by Hertz or by another power law.
///
/// ```text
/// m δ̈ = 0  for δ < 0,     m δ̈ = −K δⁿ  for δ ≥ 0
///
/// δ_max = ((n + 1) m u²/(2 K))^(1/(n + 1))
/// T     = 2 √π Γ(1 + p)/Γ(½ + p) δ_max/u,   p = 1/(n + 1)
/// ```
///
/// `δ` is the penetration, below zero minus the clearance [m], `m` the mass [kg], `K` the stiffness
/// [N/mⁿ], `n` the exponent, `u` the speed of approach, with which the ball also leaves [m/s],
/// `T` the duration of the contact [s]: `2.9433 δ_max/u` for n = 3/2, `π δ_max/u` for n = 1.
///
/// Derived here: by energy `δ̇² = u² (1 − (δ/δ_max)ⁿ⁺¹)`, and `T = 2 ∫ dδ/δ̇` from 0 to δ_max is
/// twice a beta function. For n = 3/2 see K. L. Johnson, *Contact Mechanics*, Cambridge University
/// Press (1985), chapter "Dynamic effects and impact".
///
/// Past the surface, in a step that will be cut, the force is `K δ |δ|ⁿ⁻¹`. Where n is no integer a
/// derivative of δⁿ is infinite at δ = 0, the second one for n = 3/2: a step that begins or ends there
/// errs by hⁿ⁺¹, even where the event is located, and no method has a higher order.
///
/// Valid for n ≥ 1 and a start at δ ≤ 0 with a velocity above zero. Within the contact there is no
/// elementary form but at its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzBall {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness K [N/mⁿ].
    pub stiffness: f64,
    /// Exponent n, at least 1.
    pub exponent: f64,
    /// State at t = 0: δ [m], at most zero, and δ̇ [m/s], above zero.
    pub start: [f64; 2],
}

impl HertzBall {
    /// Time at which the contact begins [s].
    pub fn entry_time(&self) -> f64 {
        -self.start[0] / self.start[1]
    }

    /// Time of the greatest penetration [s].
    pub fn turning_time(&self) -> f64 {
        self.entry_time() + 0.5 * self.contact_time()
    }

    /// Time at which the contact ends [s].
    pub fn exit_time(&self) -> f64 {
        self.entry_time() + self.contact_time()
    }

    /// Greatest penetration δ_max [m].
    pub fn greatest_penetration(&self) -> f64 {
        let (n, u) = (self.exponent, self.start[1]);
        libm::pow(0.5 * (n + 1.0) * self.mass * u * u / self.stiffness, 1.0 / (n + 1.0))
    }

    /// Duration of the contact T [s].
    pub fn contact_time(&self) -> f64 {
        let p = 1.0 / (self.exponent + 1.0);
        let beta = std::f64::consts::PI.sqrt() * libm::tgamma(1.0 + p) / libm::tgamma(0.5 + p);
        2.0 * beta * self.greatest_penetration() / self.start[1]
    }

    /// State at `t ≥ 0` outside the contact; none within.
    pub fn state(&self, t: f64) -> Option<[f64; 2]> {
        let (entry, exit, u) = (self.entry_time(), self.exit_time(), self.start[1]);
        if t <= entry {
            Some([self.start[0] + u * t, u])
        } else if t >= exit {
            Some([-u * (t - exit), -u])
        } else {
            None
        }
    }

    /// Force of the wall `K δ |δ|ⁿ⁻¹` [N], at a penetration δ.
    pub fn force<S: Real>(&self, delta: S) -> S {
        self.odd_power(delta) * self.stiffness
    }

    /// `δ |δ|ⁿ⁻¹`: δⁿ, continued as an odd function.
    fn odd_power<S: Real>(&self, delta: S) -> S {
        if self.exponent == 1.0 {
            delta
        } else if delta.value() < 0.0 {
            -(-delta).powf(self.exponent)
        } else {
            delta.powf(self.exponent)
        }
    }
}

impl System for HertzBall {
    type Mode = StopMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> StopMode {
        self.mode_of_state(t, y)
    }

    fn rhs<S: Real>(&self, mode: StopMode, _t: S, &[delta, rate]: &[S; 2], dydt: &mut [S; 2]) {
        let force = match mode {
            StopMode::Free => S::cst(0.0),
            StopMode::Contact => -self.force(delta),
        };
        *dydt = [rate, force / self.mass];
    }

    fn guards<S: Real>(&self, mode: StopMode, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = match mode {
            StopMode::Free => [-y[0]],
            StopMode::Contact => [y[0]],
        };
    }

    fn guard_bounds(&self, _: StopMode, _t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        let extent = self.start[0].abs() + self.greatest_penetration();
        *bounds = [ROUNDING * (y[0].abs() + extent)];
    }

    fn transition<S: Real>(
        &self,
        mode: StopMode,
        _guard: usize,
        _t: S,
        _y: &mut [S; 2],
    ) -> Next<StopMode> {
        Next::Mode(mode.other())
    }
}

impl ModeOfState for HertzBall {
    fn mode_of_state<S: Real>(&self, _t: S, y: &[S; 2]) -> StopMode {
        StopMode::at(y[0].value(), y[1].value())
    }
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;

    fn ball(exponent: f64) -> HertzBall {
        HertzBall { mass: 2.0, stiffness: 3e4, exponent, start: [-0.3, 1.5] }
    }

    #[test]
    fn all_energy_is_in_the_wall_at_the_greatest_penetration() {
        for n in [1.0, 1.5, 2.2, 3.0] {
            let ball = ball(n);
            // ∫ K δⁿ dδ = K δⁿ⁺¹/(n + 1)
            let delta = ball.greatest_penetration();
            let elastic = ball.stiffness * libm::pow(delta, n + 1.0) / (n + 1.0);
            // Measured: 4.4e-16 of 2.25 J.
            assert!((elastic / 2.25 - 1.0).abs() < 2e-15, "{n}: {elastic}");
        }
    }

    #[test]
    fn the_duration_agrees_with_a_quadrature_of_the_energy_balance() {
        for n in [1.0, 1.5, 2.2, 3.0] {
            let ball = ball(n);
            // T = 2 δ_max/u ∫₀¹ ds/√(1 − sⁿ⁺¹), smooth in w where s = 1 − w²; Simpson's rule.
            let integrand = |w: f64| {
                let s = 1.0 - w * w;
                let rest = 1.0 - libm::pow(s, n + 1.0);
                if w == 0.0 { 2.0 / (n + 1.0).sqrt() } else { 2.0 * w / rest.sqrt() }
            };
            let intervals = 1000;
            let weight = |i: u32| match i {
                i if i == 0 || i == intervals => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let at = |i| f64::from(i) / f64::from(intervals);
            let sum: f64 = (0..=intervals).map(|i| weight(i) * integrand(at(i))).sum();
            let integral = sum / (3.0 * f64::from(intervals));
            let expected = 2.0 * ball.greatest_penetration() / ball.start[1] * integral;
            let relative = ball.contact_time() / expected - 1.0;
            // Measured: 2.5e-12, for n = 3/2, where the integrand is no polynomial at w = 1.
            assert!(relative.abs() < 2e-11, "{n}: {relative:e}");
        }
    }

    #[test]
    fn the_duration_has_the_known_factors() {
        for (n, factor) in [(1.0, std::f64::consts::PI), (1.5, 2.943_275)] {
            let ball = ball(n);
            let found = ball.contact_time() * ball.start[1] / ball.greatest_penetration();
            // The factor of Hertz to seven digits.
            assert!((found - factor).abs() < 5e-7, "{n}: {found}");
        }
    }

    #[test]
    fn the_ball_leaves_as_it_came() {
        let ball = ball(1.5);
        assert_eq!(ball.state(0.0), Some(ball.start));
        assert_eq!(ball.state(ball.turning_time()), None);
        let mirrored = ball.exit_time() + ball.entry_time();
        let [delta, rate] = ball.state(mirrored).unwrap();
        // Measured: 5.6e-17 m and 0.
        assert!((delta + 0.3).abs() < 5e-16 && rate == -1.5);
    }

    #[test]
    fn the_force_is_odd_and_its_derivative_a_number_on_the_surface() {
        for n in [1.0, 1.5, 2.0, 3.0] {
            let ball = ball(n);
            assert_eq!(ball.odd_power(-2e-6), -ball.odd_power(2e-6));
            for delta in [-2e-6, -0.0, 0.0, 2e-6] {
                let slope = ball.odd_power(Dual64::new(delta, 1.0)).eps;
                let expected = n * libm::pow(f64::abs(delta), n - 1.0);
                assert!((slope - expected).abs() <= 1e-15 * expected, "{n} at {delta}: {slope}");
            }
        }
    }
}
