//! A rigid block that rocks from one corner to the other.

mod entry;

use std::f64::consts::{FRAC_PI_4, PI};
use std::fmt;

use deltazero_solvers::rounding::ROUNDING;
use deltazero_solvers::{Error, Next, Outcome, Real, Record, System};
use deltazero_study::problem::{
    EndName, Energy, Group, Power, Problem, Quantity, Role, Touch, each_a_group,
};
use deltazero_study::run::{OwnRun, extended};
use serde::Deserialize;

pub(super) use entry::ROCKING_BLOCK;

/// A corner of the base, and a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// The corner that carries the block while θ < 0.
    Left,
    /// The corner that carries the block while θ > 0.
    Right,
}

impl Corner {
    /// The sign of θ on this corner.
    fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// What the block does.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Stands on both corners.
    AtRest,
    /// Turns about this corner.
    Rocks(Corner),
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtRest => "at rest",
            Self::Rocks(Corner::Left) => "on the left corner",
            Self::Rocks(Corner::Right) => "on the right corner",
        })
    }
}

/// The first guard: rocking, the other corner above the ground, `σθ > 0`; at rest, `a_g > −g tan α`.
///
/// The second: rocking, not overturned, `σθ < α + π/4`; at rest, `a_g < g tan α`. The third: rocking, the corner
/// presses on the ground, `N/(m g) > 0`.
const GUARD_GROUND: usize = 0;

/// Housner's rigid, solid, rectangular block on a rigid base that may shake.
///
/// ```text
/// θ̈ = −σ p² (sin β + σ (a_g/g) cos β),   β = α − σθ,   σ = sign θ,   a_g = A sin ψ,   ψ̇ = Ω
/// p² = 3g/(4R),   R = √(b² + h²),   tan α = b/h
/// θ̇⁺ = r θ̇⁻                              at θ = 0
/// θ = 0                                   at rest, while |a_g| ≤ g tan α
/// N = m g (1 − ¾ sin β (sin β + σ (a_g/g) cos β) − (R/g) cos β θ̇²)
/// ```
///
/// `θ` is the tilt [rad], positive to the right, when the right corner carries the block; `b` and `h` are half the
/// width and half the height [m], `m` the mass [kg], `g` gravity [m/s²], `a_g` the acceleration of the base to the
/// right [m/s²] and `ψ` its phase [rad], `r` the ratio of the angular velocities, `N` the normal force of the corner
/// [N], which follows from the height `R cos β` of the centre. The phase is a state because N depends on it.
///
/// The angular momentum about the corner that lands is the same before and after the impact:
///
/// ```text
/// I_0 θ̇⁺ = I_0 θ̇⁻ − 2 m R² sin²α θ̇⁻,   I_0 = (4/3) m R²:   r = 1 − (3/2) sin²α
/// ```
///
/// Housner's own symbol r is the ratio of the kinetic energies, the square of this one. Between impacts without
/// shaking `θ̇²/2 + p² cos β` is constant, so the amplitudes θ_n after n impacts obey, exactly and for slender blocks,
///
/// ```text
/// cos(α − θ_n) − cos α = r²ⁿ (cos(α − θ_0) − cos α),     1 − (1 − θ_n/α)² = r²ⁿ (1 − (1 − θ_0/α)²)
/// ```
///
/// and for slender blocks a quarter of a period lasts `T/4 = (1/p) acosh(1/(1 − θ_0/α))`.
///
/// Impacts of decaying rocking accumulate, and the block comes to [rest](System::accumulation). It has overturned,
/// and the run ends, at `|θ| = α + π/4`: no base acceleration below g pushes a block back from there. A run in which
/// the corner stops to press, N = 0, ends in an error, because flight is not in the model.
///
/// G. W. Housner, "The behavior of inverted pendulum structures during earthquakes", Bull. Seismol. Soc. Am. 53(2),
/// 403–417 (1963). The original was not at hand; all equations are derived here, and tests hold them.
///
/// Valid for 0 ≤ r ≤ 1 and corners that neither slide nor bounce.
///
/// | key | default | unit | |
/// |---|---|---|---|
/// | `mass` | 1000 | kg | m; the motion does not depend on it |
/// | `half_width` | 0.2 | m | b |
/// | `half_height` | 0.8 | m | h; α = 0.245 rad, r = 0.912 |
/// | `gravity` | 9.81 | m/s² | g |
/// | `restitution` | Housner's | | r; a number replaces `1 − (3/2) sin²α` |
/// | `base_amplitude` | 0 | m/s² | A |
/// | `base_frequency` | 6 | rad/s | Ω |
/// | `start_angle` | 0.15 | rad | θ at t = 0; 0.61 of α |
/// | `start_velocity` | 0 | rad/s | θ̇ at t = 0 |
///
/// All values but gravity are our choice.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RockingBlock {
    /// Mass m [kg].
    pub mass: f64,
    /// Half the width, b [m].
    pub half_width: f64,
    /// Half the height, h [m].
    pub half_height: f64,
    /// Gravity g [m/s²].
    pub gravity: f64,
    /// Ratio r of the angular velocities after and before an impact; Housner's where none is given.
    pub restitution: Option<f64>,
    /// Amplitude A of the base's acceleration [m/s²].
    pub base_amplitude: f64,
    /// Angular frequency Ω of the base [rad/s].
    pub base_frequency: f64,
    /// Tilt θ at t = 0 [rad].
    pub start_angle: f64,
    /// Angular velocity θ̇ at t = 0 [rad/s].
    pub start_velocity: f64,
}

impl Default for RockingBlock {
    fn default() -> Self {
        Self {
            mass: 1000.0,
            half_width: 0.2,
            half_height: 0.8,
            gravity: 9.81,
            restitution: None,
            base_amplitude: 0.0,
            base_frequency: 6.0,
            start_angle: 0.15,
            start_velocity: 0.0,
        }
    }
}

/// The part of α that is nothing beside it: rocking that is lower has no size of its own.
const LEAST: f64 = 1e-9;

impl RockingBlock {
    /// Distance R from a corner to the centre [m].
    pub fn radius(&self) -> f64 {
        libm::hypot(self.half_width, self.half_height)
    }

    /// Slenderness α: the angle between the diagonal and the vertical side [rad].
    pub fn slenderness(&self) -> f64 {
        libm::atan2(self.half_width, self.half_height)
    }

    /// Frequency parameter `p = √(3g/(4R))` [rad/s].
    pub fn frequency(&self) -> f64 {
        (0.75 * self.gravity / self.radius()).sqrt()
    }

    /// Ratio r of the angular velocities.
    pub fn velocity_ratio(&self) -> f64 {
        let sin = self.half_width / self.radius();
        self.restitution.unwrap_or(1.0 - 1.5 * sin * sin)
    }

    /// The angle at which it has overturned [rad].
    pub fn overturned_at(&self) -> f64 {
        self.slenderness() + FRAC_PI_4
    }

    /// `g tan α`, which the base must exceed to tilt a block at rest [m/s²].
    pub fn least_to_tilt(&self) -> f64 {
        self.gravity * self.half_width / self.half_height
    }

    /// Sine and cosine of `β = α − σθ`, and `sin β + σ (a_g/g) cos β`.
    fn pose<S: Real>(&self, sigma: f64, y: &[S; 3]) -> [S; 3] {
        let (sin, cos) = (-(y[0] * sigma) + self.slenderness()).sin_cos();
        let shaking = y[2].sin_cos().0 * (sigma * self.base_amplitude / self.gravity);
        [sin, cos, sin + shaking * cos]
    }

    /// `N/(m g)` on the corner of the sign `sigma`.
    fn pressure<S: Real>(&self, sigma: f64, y: &[S; 3]) -> S {
        let [sin, cos, moment] = self.pose(sigma, y);
        let turning = cos * y[1] * y[1] * (self.radius() / self.gravity);
        -(sin * moment) * 0.75 - turning + 1.0
    }

    /// `a_g` [m/s²].
    fn base<S: Real>(&self, psi: S) -> S {
        psi.sin_cos().0 * self.base_amplitude
    }
}

impl System for RockingBlock {
    type Mode = Mode;
    /// θ [rad], θ̇ [rad/s], ψ [rad].
    type State<S: Real> = [S; 3];
    type Guards<S: Real> = [S; 3];

    fn initial_mode(&self, _t: f64, y: &[f64; 3]) -> Mode {
        let side = if y[0] == 0.0 { y[1] } else { y[0] };
        if side == 0.0 {
            Mode::AtRest
        } else {
            Mode::Rocks(if side > 0.0 { Corner::Right } else { Corner::Left })
        }
    }

    fn rhs<S: Real>(&self, mode: Mode, _t: S, y: &[S; 3], dydt: &mut [S; 3]) {
        let psi_dot = S::cst(self.base_frequency);
        *dydt = match mode {
            Mode::AtRest => [S::cst(0.0), S::cst(0.0), psi_dot],
            Mode::Rocks(corner) => {
                let [_, _, moment] = self.pose(corner.sign(), y);
                let p = self.frequency();
                [y[1], moment * (-corner.sign() * p * p), psi_dot]
            }
        };
    }

    fn guards<S: Real>(&self, mode: Mode, _t: S, y: &[S; 3], g: &mut [S; 3]) {
        *g = match mode {
            Mode::AtRest => {
                let base = self.base(y[2]);
                [base + self.least_to_tilt(), -base + self.least_to_tilt(), S::cst(1.0)]
            }
            Mode::Rocks(corner) => {
                let tilt = y[0] * corner.sign();
                let pressure = self.pressure(corner.sign(), y);
                [tilt, -tilt + self.overturned_at(), pressure]
            }
        };
    }

    // The tilt of the present arc: low rocking has small rounding errors.
    fn guard_bounds(&self, mode: Mode, _t: f64, y: &[f64; 3], bounds: &mut [f64; 3]) {
        let shaking = self.base_amplitude.abs() * (1.0 + y[2].abs());
        *bounds = match mode {
            Mode::AtRest => {
                let bound = ROUNDING * (self.least_to_tilt() + shaking);
                [bound, bound, ROUNDING]
            }
            Mode::Rocks(corner) => {
                let [_, cos, moment] = self.pose(corner.sign(), y);
                let p = self.frequency();
                let arc = (y[1].abs() / p).min(0.5 * y[1] * y[1] / (p * p * moment.abs()));
                let ground = ROUNDING * (y[0].abs() + arc).max(LEAST * self.slenderness());
                let turning = (self.radius() / self.gravity * cos * y[1] * y[1]).abs();
                let pressure = ROUNDING * (2.0 + turning + shaking / self.gravity);
                [ground, ROUNDING * self.overturned_at(), pressure]
            }
        };
    }

    fn transition<S: Real>(&self, mode: Mode, guard: usize, _t: S, y: &mut [S; 3]) -> Next<Mode> {
        let zero = S::cst(0.0);
        match (mode, guard) {
            (Mode::Rocks(corner), GUARD_GROUND) => {
                let r = self.velocity_ratio();
                *y = [zero, y[1] * r, y[2]];
                Next::Mode(if r == 0.0 { Mode::AtRest } else { Mode::Rocks(corner.other()) })
            }
            (Mode::Rocks(_), _) => Next::Stop,
            (Mode::AtRest, GUARD_GROUND) => Next::Mode(Mode::Rocks(Corner::Right)),
            (Mode::AtRest, _) => Next::Mode(Mode::Rocks(Corner::Left)),
        }
    }

    fn accumulation(&self, _: Mode, _guard: usize, _t: f64, y: &mut [f64; 3]) -> Option<Mode> {
        [y[0], y[1]] = [0.0; 2];
        Some(Mode::AtRest)
    }
}

/// The corner that is a site.
fn corner(site: usize) -> Corner {
    [Corner::Left, Corner::Right][site]
}

/// The sites are the left corner and the right one.
impl Problem for RockingBlock {
    fn check(&self) -> Result<(), Error> {
        let r = self.velocity_ratio();
        if (0.0..=1.0).contains(&r) {
            return Ok(());
        }
        let reason = format!(
            "the angular velocity ratio r = {r} is not between 0 and 1; take a more slender block, or give \
             the restitution"
        );
        Err(Error::Refused { reason })
    }

    fn start(&self) -> [f64; 3] {
        [self.start_angle, self.start_velocity, 0.0]
    }

    fn states(&self) -> Vec<Quantity> {
        let angle = self.slenderness();
        vec![
            Quantity::new("theta", "rad", angle),
            Quantity::new("omega", "rad/s", angle * self.frequency()),
            Quantity::new("psi", "rad", 2.0 * PI),
        ]
    }

    /// The tilt and its rate; the phase has no error.
    fn groups(&self) -> Vec<Group> {
        each_a_group(self.states().into_iter().take(2))
    }

    fn n_sites(&self) -> usize {
        2
    }

    fn site_name(&self, site: usize) -> String {
        ["left corner", "right corner"][site].to_owned()
    }

    /// The corner that lands or leaves the ground.
    fn site_of_guard(&self, mode: &Mode, guard: usize) -> usize {
        match (mode, guard) {
            (Mode::Rocks(Corner::Right), GUARD_GROUND) | (Mode::AtRest, GUARD_GROUND) => 0,
            (Mode::Rocks(Corner::Left), GUARD_GROUND) | (Mode::AtRest, _) => 1,
            (Mode::Rocks(corner), _) => usize::from(*corner == Corner::Right),
        }
    }

    fn role(&self, mode: &Mode, site: usize) -> Role {
        match mode {
            Mode::Rocks(carrier) if *carrier != corner(site) => Role::Free,
            _ => Role::Contact,
        }
    }

    fn unit_of_time(&self) -> f64 {
        1.0 / self.frequency()
    }

    /// At rest the base presses at the corners alone: `N = m (g ∓ a_g h/b)/2` on the right and on the left.
    fn touch<S: Real>(&self, mode: &Mode, _t: S, y: &[S; 3], site: usize) -> Option<Touch<S>> {
        let (zero, sigma) = (S::cst(0.0), corner(site).sign());
        let weight = self.mass * self.gravity;
        Some(match mode {
            Mode::Rocks(carrier) if *carrier == corner(site) => {
                Touch { depth: zero, rate: zero, force: self.pressure(sigma, y) * weight }
            }
            Mode::Rocks(_) => {
                let (sin, cos) = y[0].sin_cos();
                let width = 2.0 * self.half_width * sigma;
                Touch { depth: sin * width, rate: cos * y[1] * width, force: zero }
            }
            Mode::AtRest => {
                let part = self.base(y[2]) * (-sigma / self.least_to_tilt()) + 1.0;
                Touch { depth: zero, rate: zero, force: part * (0.5 * weight) }
            }
        })
    }

    /// Seen from the base: `½ I_0 θ̇² + m g R (cos β − cos α)`.
    fn energies(&self, mode: &Mode, _t: f64, y: &[f64; 3]) -> Option<Energy> {
        let Mode::Rocks(corner) = mode else { return Some(Energy::default()) };
        let ([_, cos, _], radius) = (self.pose(corner.sign(), y), self.radius());
        let turning = 2.0 / 3.0 * radius * radius * y[1] * y[1];
        let height = radius * cos - self.half_height;
        Some(Energy { kinetic: self.mass * (turning + self.gravity * height), elastic: 0.0 })
    }

    /// The work is that of the force `−m a_g` at the centre.
    fn powers(&self, mode: &Mode, _t: f64, y: &[f64; 3]) -> Option<Power> {
        let Mode::Rocks(corner) = mode else { return Some(Power::default()) };
        let [_, cos, _] = self.pose(corner.sign(), y);
        let drive = -self.mass * self.radius() * self.base(y[2]) * cos * y[1];
        Some(Power { drive, damping: 0.0, friction: 0.0 })
    }

    /// Every impact.
    fn takes_energy(&self, before: &Mode, _after: &Mode) -> bool {
        *before != Mode::AtRest
    }

    fn end_name(&self) -> EndName {
        EndName { key: "overturned", words: "overturned" }
    }

    fn judged(
        &self,
        outcome: Result<Outcome, Error>,
        t: f64,
        mode: &Mode,
        y: &[f64; 3],
    ) -> Result<Outcome, Error> {
        let Mode::Rocks(corner) = mode else { return outcome };
        let pressure = self.pressure(corner.sign(), y);
        if outcome != Ok(Outcome::Stopped) || pressure > ROUNDING {
            return outcome;
        }
        let reason = format!(
            "the corner no longer presses on the ground at θ = {} rad: the block would fly; take a weaker \
             shaking or a slower start",
            y[0]
        );
        Err(Error::OutsideModel { t, mode: format!("{mode:?}"), reason })
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: [f64; 3],
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

#[cfg(test)]
mod tests;
