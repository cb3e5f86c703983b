//! A driven mass on a spring that hits a rigid stop.

mod entry;

use std::f64::consts::PI;
use std::fmt;

use deltazero_solvers::rounding::ROUNDING;
use deltazero_solvers::{Next, Real, Record, System};
use deltazero_study::problem::{Energy, Power, Problem, Quantity, Role, Touch};
use deltazero_study::run::{OwnRun, extended};
use serde::Deserialize;

pub(super) use entry::IMPACT_OSCILLATOR;

/// What the mass does.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Moves free of the stop, or touches it for an instant.
    Free,
    /// Is pressed against the stop and rests there.
    AtStop,
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Free => "free",
            Self::AtStop => "at the stop",
        })
    }
}

/// A mass on a spring and a dashpot under a harmonic force, with a rigid stop on one side.
///
/// ```text
/// m ü + c u̇ + k (u + d) = F cos ωt     while u ≤ 0
/// u̇⁺ = −e u̇⁻                           at u = 0
/// u = 0                                 at the stop, while F cos ωt ≥ k d
/// ```
///
/// `x = u + d` is the displacement from the rest of the spring and `u` the position counted from the stop [m], `d` the
/// gap [m], `m` the mass [kg], `c` the damping [N s/m], `k` the stiffness [N/m], `F` and `ω` the amplitude [N] and the
/// angular frequency [rad/s] of the force, `e` the restitution. The state is (u, u̇) and not (x, ẋ): impacts may
/// accumulate at the stop, and then heights over the stop are smaller than the last digit of d.
///
/// Between impacts the motion is that of a linear oscillator: below the critical damping `2√(k m)`, and with
/// `ω_0² = k/m`, `σ = c/2m`, `ω_d² = ω_0² − σ²`,
///
/// ```text
/// x = B cos(ωt − β) + e^(−σs) (a cos ω_d s + b sin ω_d s),   s = t − t_0
/// B = F/√((k − mω²)² + (cω)²),   β = atan2(cω, k − mω²)
/// ```
///
/// Where impacts accumulate the mass comes to [rest](System::accumulation) at the stop, until the load
/// `F cos ωt − k d` no longer presses. For e = 0 it rests
/// from any impact on at which the load presses.
///
/// S. W. Shaw, P. J. Holmes, "A periodically forced piecewise linear oscillator", J. Sound Vib. 90(1), 129–155 (1983),
/// there the limit of a rigid stop; grazing: A. B. Nordmark, J. Sound Vib. 145(2), 279–297 (1991).
///
/// Valid for m, k > 0, c ≥ 0, d ≥ 0, 0 ≤ e ≤ 1 and a start at u ≤ 0. Energies are
/// `½ m u̇² + ½ k (u + d)²`; the work is that of the force.
///
/// | key | default | unit | |
/// |---|---|---|---|
/// | `mass` | 1 | kg | m |
/// | `damping` | 1 | N s/m | c; 0.05 of the critical one |
/// | `stiffness` | 100 | N/m | k; ω_0 = 10 rad/s |
/// | `amplitude` | 10 | N | F; by itself it bends the spring by the gap |
/// | `frequency` | 6 | rad/s | ω |
/// | `gap` | 0.1 | m | d |
/// | `restitution` | 0.6 | | e |
/// | `start_position` | −0.1 | m | u at t = 0; the spring is at rest |
/// | `start_velocity` | 0 | m/s | u̇ at t = 0 |
///
/// All values are our choice: three impacts in two periods of the force.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImpactOscillator {
    /// Mass m [kg].
    pub mass: f64,
    /// Damping c [N s/m].
    pub damping: f64,
    /// Stiffness k [N/m].
    pub stiffness: f64,
    /// Amplitude F of the force [N].
    pub amplitude: f64,
    /// Angular frequency ω of the force [rad/s].
    pub frequency: f64,
    /// Gap d between the rest of the spring and the stop [m].
    pub gap: f64,
    /// Restitution e.
    pub restitution: f64,
    /// Position u at t = 0, counted from the stop [m].
    pub start_position: f64,
    /// Velocity u̇ at t = 0 [m/s].
    pub start_velocity: f64,
}

impl Default for ImpactOscillator {
    fn default() -> Self {
        Self {
            mass: 1.0,
            damping: 1.0,
            stiffness: 100.0,
            amplitude: 10.0,
            frequency: 6.0,
            gap: 0.1,
            restitution: 0.6,
            start_position: -0.1,
            start_velocity: 0.0,
        }
    }
}

/// What is nothing beside the gap and the steady motion: a bounce that is lower has no size of its own.
const LEAST: f64 = 1e-9;

impl ImpactOscillator {
    /// Period of the force [s].
    pub fn period(&self) -> f64 {
        2.0 * PI / self.frequency
    }

    /// `F cos ωt − k d`, what presses on the stop [N].
    fn load<S: Real>(&self, t: S) -> S {
        (t * self.frequency).sin_cos().1 * self.amplitude - self.stiffness * self.gap
    }

    /// A length of the motion [m].
    fn extent(&self) -> f64 {
        self.gap + self.amplitude / self.stiffness
    }
}

impl System for ImpactOscillator {
    type Mode = Mode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> Mode {
        if *y == [0.0, 0.0] && self.load(t) >= 0.0 { Mode::AtStop } else { Mode::Free }
    }

    fn rhs<S: Real>(&self, mode: Mode, t: S, &[u, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = match mode {
            Mode::Free => {
                let force = self.load(t) - u * self.stiffness - v * self.damping;
                [v, force / self.mass]
            }
            Mode::AtStop => [S::cst(0.0); 2],
        };
    }

    fn guards<S: Real>(&self, mode: Mode, t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = match mode {
            Mode::Free => [-y[0]],
            Mode::AtStop => [self.load(t)],
        };
    }

    // The height of the present arc: small bounces have small rounding errors.
    fn guard_bounds(&self, mode: Mode, t: f64, &[u, v]: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = match mode {
            Mode::Free => {
                let acceleration = self.load(t).abs() / self.mass;
                let swing = v.abs() * (self.mass / self.stiffness).sqrt();
                let bounce = swing.min(0.5 * v * v / acceleration);
                [ROUNDING * (u.abs() + bounce).max(LEAST * self.extent())]
            }
            Mode::AtStop => {
                let phase = 1.0 + (self.frequency * t).abs();
                [ROUNDING * (self.amplitude * phase + self.stiffness * self.gap)]
            }
        };
    }

    fn transition<S: Real>(&self, mode: Mode, _guard: usize, t: S, y: &mut [S; 2]) -> Next<Mode> {
        if mode == Mode::AtStop {
            return Next::Mode(Mode::Free);
        }
        *y = [S::cst(0.0), -y[1] * self.restitution];
        let is_held = self.restitution == 0.0 && self.load(t).value() > 0.0;
        Next::Mode(if is_held { Mode::AtStop } else { Mode::Free })
    }

    fn accumulation(&self, _: Mode, _guard: usize, _t: f64, y: &mut [f64; 2]) -> Option<Mode> {
        *y = [0.0, 0.0];
        Some(Mode::AtStop)
    }
}

impl Problem for ImpactOscillator {
    fn start(&self) -> [f64; 2] {
        [self.start_position, self.start_velocity]
    }

    fn states(&self) -> Vec<Quantity> {
        let length = self.extent();
        let speed = length * (self.stiffness / self.mass).sqrt();
        vec![Quantity::new("u", "m", length), Quantity::new("v", "m/s", speed)]
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        match mode {
            Mode::Free => Role::Free,
            Mode::AtStop => Role::Contact,
        }
    }

    /// The spring's counts as kinetic.
    fn energies(&self, _mode: &Mode, _t: f64, &[u, v]: &[f64; 2]) -> Option<Energy> {
        let x = u + self.gap;
        let kinetic = 0.5 * (self.mass * v * v + self.stiffness * x * x);
        Some(Energy { kinetic, elastic: 0.0 })
    }

    fn powers(&self, _mode: &Mode, t: f64, &[_, v]: &[f64; 2]) -> Option<Power> {
        let drive = self.amplitude * libm::cos(self.frequency * t) * v;
        Some(Power { drive, damping: self.damping * v * v, friction: 0.0 })
    }

    /// Every impact.
    fn takes_energy(&self, before: &Mode, _after: &Mode) -> bool {
        *before == Mode::Free
    }

    /// Where it bounces at once.
    fn starts_on_surface(&self) -> bool {
        self.start_position == 0.0 && self.start_velocity > 0.0
    }

    /// The force of the stop on a mass that rests there; an impact has none that is finite.
    fn touch<S: Real>(&self, mode: &Mode, t: S, &[u, v]: &[S; 2], _: usize) -> Option<Touch<S>> {
        let force = match mode {
            Mode::Free => S::cst(0.0),
            Mode::AtStop => self.load(t),
        };
        Some(Touch { depth: u, rate: v, force })
    }

    fn unit_of_time(&self) -> f64 {
        self.period()
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: [f64; 2],
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

#[cfg(test)]
mod tests;
