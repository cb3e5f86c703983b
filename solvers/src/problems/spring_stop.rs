//! A mass on a spring that hits an elastic stop: every arc of its motion is harmonic.

use super::{ROUNDING, StopMode};
use crate::real::Real;
use crate::system::{ModeOfState, Next, System};

/// A mass on a spring, with an elastic stop on one side.
///
/// ```text
/// m ẍ = −k x − K max(δ, 0),   δ = x − c
///
/// x = x_c + A cos θ,  θ̇ = ω,     free:        x_c = 0,             ω = √(k/m)
///                                in contact:  x_c = K c/(k + K),   ω = √((k + K)/m)
///
/// α = atan2(s/ω, c − x_c):  free from θ = α to 2π − α,  in contact from −α to α
/// lasting                   2 (π − α)/ω                 2 α/ω,   δ_max = A − (c − x_c)
/// ```
///
/// `x` is the position, zero where the spring is at rest [m], `m` the mass [kg], `k` the stiffness
/// of the spring and `K` that of the stop [N/m], `c` the gap [m], `δ` the penetration [m], `θ` the
/// phase [rad], `s` the speed at which the mass passes the surface of the stop [m/s]: the same
/// every time, as nothing is lost.
///
/// Derived here: each mode is a harmonic oscillator about its own centre, and at the surface
/// `A cos θ = c − x_c` and `A ω |sin θ| = s`. With no gap it is the problem SDND101 of code_aster's
/// validation manual (document V5.01.101).
///
/// Valid for m, k, K > 0, a gap of at least zero and any start; a mass with too little energy to
/// reach the stop never touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringStop {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness of the spring k [N/m].
    pub stiffness: f64,
    /// Stiffness of the stop K [N/m].
    pub stop_stiffness: f64,
    /// Gap c between the rest of the spring and the stop [m].
    pub gap: f64,
    /// State at t = 0: position [m] and velocity [m/s].
    pub start: [f64; 2],
}

impl SpringStop {
    /// Stiffness of all springs at work in `mode` [N/m].
    fn total_stiffness(&self, mode: StopMode) -> f64 {
        match mode {
            StopMode::Free => self.stiffness,
            StopMode::Contact => self.stiffness + self.stop_stiffness,
        }
    }

    /// Angular frequency ω of `mode` [rad/s].
    fn omega(&self, mode: StopMode) -> f64 {
        (self.total_stiffness(mode) / self.mass).sqrt()
    }

    /// Position of the stop c − x_c [m], counted from the centre of `mode`.
    fn level(&self, mode: StopMode) -> f64 {
        // c − K c/(k + K) = k c/(k + K)
        self.gap * self.stiffness / self.total_stiffness(mode)
    }

    /// Speed s at the surface of the stop [m/s]; zero where the mass does not reach beyond it.
    pub fn surface_speed(&self) -> f64 {
        let [x, v] = self.start;
        let mode = self.mode_of_state(0.0, &self.start);
        let (omega, level) = (self.omega(mode), self.level(mode));
        // ½ m (v² − s²) = work of the springs from the start to the surface.
        let depth = x - self.gap;
        (v * v + omega * omega * depth * (depth + 2.0 * level)).max(0.0).sqrt()
    }

    /// Phase α at which the mass passes the surface [rad].
    fn surface_phase(&self, mode: StopMode) -> f64 {
        libm::atan2(self.surface_speed() / self.omega(mode), self.level(mode))
    }

    /// Duration of a contact [s].
    pub fn contact_time(&self) -> f64 {
        2.0 * self.surface_phase(StopMode::Contact) / self.omega(StopMode::Contact)
    }

    /// Duration of a free arc between two contacts [s].
    pub fn free_time(&self) -> f64 {
        let mode = StopMode::Free;
        2.0 * (std::f64::consts::PI - self.surface_phase(mode)) / self.omega(mode)
    }

    /// Greatest penetration δ_max [m].
    pub fn greatest_penetration(&self) -> f64 {
        let level = self.level(StopMode::Contact);
        let reach = self.surface_speed() / self.omega(StopMode::Contact);
        // √(level² + reach²) − level, without cancellation.
        reach * (reach / (libm::hypot(level, reach) + level))
    }

    /// Time from a phase in `mode` to the phase at which the mode ends [s].
    fn time_left(&self, mode: StopMode, theta: f64) -> f64 {
        let two_pi = 2.0 * std::f64::consts::PI;
        let alpha = self.surface_phase(mode);
        let left = match mode {
            StopMode::Free => two_pi - alpha - if theta < 0.0 { theta + two_pi } else { theta },
            StopMode::Contact => alpha - theta,
        };
        left / self.omega(mode)
    }

    /// State `tau` after the one with phase `theta` and amplitude `a` in `mode`.
    fn arc(&self, mode: StopMode, a: f64, theta: f64, tau: f64) -> [f64; 2] {
        let omega = self.omega(mode);
        let (sin, cos) = libm::sincos(theta + omega * tau);
        [self.gap - self.level(mode) + a * cos, -a * omega * sin]
    }

    /// State at `t ≥ 0`, and the times of all events up to then [s]: entries and exits in turn.
    pub fn solution(&self, t: f64) -> ([f64; 2], Vec<f64>) {
        let mut events = Vec::new();
        let mut mode = self.mode_of_state(0.0, &self.start);
        let (omega, level) = (self.omega(mode), self.level(mode));
        let from_centre = self.start[0] - self.gap + level;
        let quadrature = -self.start[1] / omega;
        let mut a = libm::hypot(from_centre, quadrature);
        let mut theta = libm::atan2(quadrature, from_centre);
        if self.surface_speed() == 0.0 {
            return (self.arc(mode, a, theta, t), events);
        }
        let (mut t0, mut end) = (0.0, self.time_left(mode, theta));
        while end < t {
            events.push(end);
            let duration;
            (mode, theta, duration) = match mode {
                StopMode::Free => {
                    let mode = StopMode::Contact;
                    (mode, -self.surface_phase(mode), self.contact_time())
                }
                StopMode::Contact => {
                    let mode = StopMode::Free;
                    (mode, self.surface_phase(mode), self.free_time())
                }
            };
            a = libm::hypot(self.level(mode), self.surface_speed() / self.omega(mode));
            (t0, end) = (end, end + duration);
        }
        (self.arc(mode, a, theta, t - t0), events)
    }
}

impl System for SpringStop {
    type Mode = StopMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> StopMode {
        self.mode_of_state(t, y)
    }

    fn rhs<S: Real>(&self, mode: StopMode, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        let spring = -x * self.stiffness;
        let force = match mode {
            StopMode::Free => spring,
            StopMode::Contact => spring - (x - self.gap) * self.stop_stiffness,
        };
        *dydt = [v, force / self.mass];
    }

    fn guards<S: Real>(&self, mode: StopMode, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        let delta = y[0] - self.gap;
        *g = match mode {
            StopMode::Free => [-delta],
            StopMode::Contact => [delta],
        };
    }

    // The extent of the present arc, as the position may be anywhere on it.
    fn guard_bounds(&self, mode: StopMode, _t: f64, &[x, v]: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [ROUNDING * (x.abs() + self.gap + v.abs() / self.omega(mode))];
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

impl ModeOfState for SpringStop {
    fn mode_of_state<S: Real>(&self, _t: S, y: &[S; 2]) -> StopMode {
        StopMode::at(y[0].value() - self.gap, y[1].value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The problem SDND101 of code_aster.
    const SDND101: SpringStop = SpringStop {
        mass: 100.0,
        stiffness: 1e4,
        stop_stiffness: 1e6,
        gap: 0.0,
        start: [0.0, 1.0],
    };

    #[test]
    fn the_problem_of_code_aster_has_its_reference_values() {
        let problem = SDND101;
        let delta = problem.greatest_penetration();
        let ([x, v], events) = problem.solution(0.04);
        // Its values to seven digits.
        assert!((delta - 9.950372e-3).abs() < 5e-10, "{delta}");
        assert!((problem.stop_stiffness * delta - 9950.372).abs() < 5e-4);
        assert!((problem.contact_time() - 31.26002e-3).abs() < 5e-9);
        assert_eq!(events, [problem.contact_time()]);
        assert!(x < 0.0 && v < 0.0);
        let at_exit = problem.solution(problem.contact_time()).0;
        // Measured: 6.1e-19 m and 1.1e-16 m/s.
        assert!(at_exit[0].abs() < 6e-18 && (at_exit[1] + 1.0).abs() < 1e-15, "{at_exit:?}");
    }

    /// Starts free, touching and on the surface, with and without a gap.
    fn cases() -> impl Iterator<Item = SpringStop> {
        let starts =
            [[0.0, 1.0], [-0.3, 0.4], [0.0, -2.0], [0.06, -0.2], [0.05, 0.7], [0.05, -0.7]];
        let gaps = [0.0, 0.05];
        gaps.into_iter().flat_map(move |gap| {
            starts.map(|start| SpringStop { stop_stiffness: 2e4, gap, start, ..SDND101 })
        })
    }

    #[test]
    fn energy_is_kept_and_the_depth_is_reached_in_contact_alone() {
        for problem in cases() {
            let energy = |[x, v]: [f64; 2]| {
                let delta = (x - problem.gap).max(0.0);
                let springs = problem.stiffness * x * x + problem.stop_stiffness * delta * delta;
                0.5 * (problem.mass * v * v + springs)
            };
            let starts_in_contact = problem.initial_mode(0.0, &problem.start) == StopMode::Contact;
            let mut deepest: f64 = 0.0;
            for n in 0..=2000 {
                let (y, events) = problem.solution(1e-3 * f64::from(n));
                let error = (energy(y) / energy(problem.start) - 1.0).abs();
                // Measured: 7.8e-16.
                assert!(error < 5e-15, "{problem:?}: {error:e}");
                let delta = y[0] - problem.gap;
                let touches = starts_in_contact ^ (events.len() % 2 == 1);
                // Measured: 1.2e-17 m.
                let outside = if touches { -delta } else { delta };
                assert!(outside < 1e-16, "{problem:?}: {outside:e}");
                deepest = deepest.max(delta);
            }
            // Samples are 1 ms apart at ω = 17 rad/s. Measured: 3.2e-5.
            let missed = 1.0 - deepest / problem.greatest_penetration();
            assert!((-1e-15..2e-4).contains(&missed), "{problem:?}: {missed:e}");
        }
    }

    #[test]
    fn the_mass_is_on_the_surface_at_its_events() {
        for problem in cases() {
            let (_, events) = problem.solution(2.0);
            assert!(events.len() >= 6, "{problem:?}: {events:?}");
            for t in events {
                let [x, v] = problem.solution(t).0;
                let (off, v) = ((x - problem.gap).abs(), v.abs() - problem.surface_speed());
                // Measured: 4.9e-16 m and 8.9e-16 m/s.
                assert!(off < 4e-15 && v.abs() < 8e-15, "{problem:?}: {off:e} {v:e}");
            }
        }
    }

    #[test]
    fn the_closed_form_solves_the_equation() {
        for problem in cases() {
            for n in 1..200 {
                let (t, h) = (0.01 * f64::from(n), 1e-5);
                let [before, here, after] = [t - h, t, t + h].map(|t| problem.solution(t).0);
                let mut slope = [0.0; 2];
                problem.rhs(problem.mode_of_state(t, &here), t, &here, &mut slope);
                for i in 0..2 {
                    let quotient = (after[i] - before[i]) / (2.0 * h);
                    // Measured: 2.6e-7.
                    let error = (quotient - slope[i]).abs();
                    assert!(error < 2e-6, "{problem:?} at {t}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn a_mass_that_does_not_reach_the_stop_swings_freely() {
        let problem = SpringStop { gap: 0.2, start: [0.1, 0.0], ..SDND101 };
        let (y, events) = problem.solution(0.05 * std::f64::consts::PI);
        assert!(events.is_empty());
        // A quarter of a period. Measured: 6e-18 m and 0.
        assert!(y[0].abs() < 6e-17 && (y[1] + 1.0).abs() < 1e-15, "{y:?}");
    }
}
