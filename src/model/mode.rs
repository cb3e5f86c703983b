//! Free, slip+, slip−, stick: the discrete states of a joint, their guards and transitions.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use deltazero_solvers::{Next, Real};

use super::block::{Block, State};

/// Guard: θ below 90°, where the struts line up.
pub const GUARD_90: usize = 0;
/// Guard: on this side of the contact surface.
pub const GUARD_CONTACT: usize = 1;
/// Guard: slipping, v_T keeps its sign; sticking, F_T < μ F_N; relaxing, δ > 0.
pub const GUARD_UPPER: usize = 2;
/// Guard: sticking, F_T > −μ F_N.
pub const GUARD_LOWER: usize = 3;

/// Mode of a joint.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mode {
    /// No clearance: the pin is held at the centre of its bush.
    Pinned,
    /// Free, pin and bush apart: δ < 0.
    Apart,
    /// Free, the bush still dented: δ > 0 but F_N ≤ 0 without adhesion.
    Relaxing,
    /// Contact, v_T > 0.
    SlipPlus,
    /// Contact, v_T < 0.
    SlipMinus,
    /// Contact, v_T = 0.
    Stick,
}

impl Mode {
    /// As the files write it: 0 free, 1 and −1 the sign of v_T while slipping, 2 stick.
    pub fn code(self) -> i8 {
        match self {
            Self::Pinned | Self::Apart | Self::Relaxing => 0,
            Self::SlipPlus => 1,
            Self::SlipMinus => -1,
            Self::Stick => 2,
        }
    }

    /// What it is, when work is counted: `pinned`, `flight`, `contact` (slipping) or `stick`.
    pub fn phase(self) -> &'static str {
        match self {
            Self::Pinned => "pinned",
            Self::Apart | Self::Relaxing => "flight",
            Self::SlipPlus | Self::SlipMinus => "contact",
            Self::Stick => "stick",
        }
    }

    /// Whether a contact force acts.
    pub fn is_contact(self) -> bool {
        matches!(self, Self::SlipPlus | Self::SlipMinus | Self::Stick)
    }

    /// σ, the sign of v_T while slipping.
    pub fn sigma(self) -> Option<f64> {
        match self {
            Self::SlipPlus => Some(1.0),
            Self::SlipMinus => Some(-1.0),
            _ => None,
        }
    }

    /// The slipping mode with the sign of `v_t`.
    pub fn slip(v_t: f64) -> Self {
        if v_t < 0.0 { Self::SlipMinus } else { Self::SlipPlus }
    }
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pinned => "pinned",
            Self::Apart => "free",
            Self::Relaxing => "free (relaxing)",
            Self::SlipPlus => "slip+",
            Self::SlipMinus => "slip-",
            Self::Stick => "stick",
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

impl Block {
    /// The guards of `mode`: positive inside it, one where it does not use them.
    #[inline(always)]
    pub(super) fn guards_of<S: Real>(&self, mode: Mode, y: &State<S>) -> [S; 4] {
        let mut g = [S::cst(1.0); 4];
        g[GUARD_90] = self.below_90(y);
        match mode {
            Mode::Pinned => {}
            // (ρ + c)(c − ρ): smooth at the bush's centre too.
            Mode::Apart => {
                let rho_sq = y[0] * y[0] + y[1] * y[1];
                g[GUARD_CONTACT] = -(rho_sq - self.clearance * self.clearance);
            }
            // (ρ + c) δ and ρ v_T: guards are evaluated at every step, and quotients are dear.
            Mode::SlipPlus | Mode::SlipMinus if self.normal.adhesion => {
                let rho_sq = y[0] * y[0] + y[1] * y[1];
                let rho_v_t = y[1] * y[3] - y[0] * y[4] + rho_sq.sqrt() * y[5] * self.pin_radius;
                g[GUARD_CONTACT] = rho_sq - self.clearance * self.clearance;
                g[GUARD_UPPER] = if mode == Mode::SlipPlus { rho_v_t } else { -rho_v_t };
            }
            Mode::Relaxing => {
                let pose = self.pose(y);
                g[GUARD_CONTACT] = -self.normal.force(pose.delta, pose.delta_dot);
                g[GUARD_UPPER] = pose.delta;
            }
            Mode::SlipPlus | Mode::SlipMinus | Mode::Stick => {
                let pose = self.pose(y);
                g[GUARD_CONTACT] = if self.normal.adhesion {
                    pose.delta
                } else {
                    self.normal.force(pose.delta, pose.delta_dot)
                };
                match mode.sigma() {
                    Some(sigma) => g[GUARD_UPPER] = self.v_t(&pose, y) * sigma,
                    None => {
                        let forces = self.forces(mode, y, &pose);
                        g[GUARD_UPPER] = forces.normal * self.mu - forces.tangential;
                        g[GUARD_LOWER] = forces.normal * self.mu + forces.tangential;
                    }
                }
            }
        }
        g
    }

    /// `π/2 − θ` [rad] where the block ends at 90°.
    #[inline(always)]
    pub(super) fn below_90<S: Real>(&self, y: &State<S>) -> S {
        if self.stop_at_90 { -(y[2] - FRAC_PI_2) } else { S::cst(1.0) }
    }

    /// Bounds of the guards' rounding errors.
    pub(super) fn guard_bounds_of(&self, mode: Mode, y: &State<f64>) -> [f64; 4] {
        let eps = 4.0 * f64::EPSILON;
        let delta = delta_bound(self.clearance);
        // Above zero at rest too: a bound of zero would have an event sought to the last bit.
        let least = self.rounding_floor();
        let speed = (y[3].abs() + y[4].abs() + y[5].abs() * self.pin_radius).max(least.speed);
        let area = 2.0 * self.clearance * delta;
        let mut bounds = [ANGLE_BOUND, area, delta, delta];
        if mode.is_contact() || mode == Mode::Relaxing {
            let pose = self.pose(y);
            let force = self.normal.slope(pose.delta) * delta
                + eps
                    * (self.normal.force(pose.delta, 0.0).abs() + self.normal.damping * speed)
                        .max(least.force);
            if mode == Mode::Relaxing || !self.normal.adhesion {
                bounds[GUARD_CONTACT] = force;
            } else if mode == Mode::Stick {
                bounds[GUARD_CONTACT] = delta;
            }
            if mode.sigma().is_some() {
                let arm = if self.normal.adhesion { pose.rho } else { 1.0 };
                bounds[GUARD_UPPER] = arm * eps * speed;
            } else if mode == Mode::Stick {
                let drive = self.torque.abs() / self.pin_radius;
                let load = self.normal.force(pose.delta, pose.delta_dot).abs() + drive;
                let friction = force * (1.0 + self.mu) + 4.0 * eps * load;
                bounds[GUARD_UPPER] = friction;
                bounds[GUARD_LOWER] = friction;
            }
        }
        bounds
    }

    /// What follows when a guard of `mode` falls at `y`.
    pub(super) fn after<S: Real>(&self, mode: Mode, guard: usize, y: &mut State<S>) -> Next<Mode> {
        if guard == GUARD_90 {
            return Next::Stop;
        }
        Next::Mode(match (mode, guard) {
            (Mode::Pinned, _) => Mode::Pinned,
            (Mode::Apart | Mode::Relaxing, GUARD_CONTACT) => self.entered(y),
            (Mode::Apart | Mode::Relaxing, _) => Mode::Apart,
            (_, GUARD_CONTACT) => self.left(y),
            (Mode::SlipPlus | Mode::SlipMinus, _) => self.reversed(mode, y),
            // F_T = −σ μ F_N at its upper bound is slip−, at its lower one slip+.
            (Mode::Stick, upper_or_lower) => {
                self.project_v_t(y);
                if upper_or_lower == GUARD_UPPER { Mode::SlipMinus } else { Mode::SlipPlus }
            }
        })
    }

    /// The mode in which contact begins at `y`: the sign of v_T; where that is zero, the sign of
    /// the frictionless v̇_T.
    pub(super) fn entered<S: Real>(&self, y: &State<S>) -> Mode {
        let pose = self.pose(y);
        let v_t = self.v_t(&pose, y).value();
        if v_t != 0.0 {
            return Mode::slip(v_t);
        }
        self.slip_without_friction(y, &pose)
    }

    /// The mode that a contact falls back to when its guard is violated at `y`.
    fn left<S: Real>(&self, y: &State<S>) -> Mode {
        if self.normal.adhesion || self.pose(y).delta.value() <= 0.0 {
            Mode::Apart
        } else {
            Mode::Relaxing
        }
    }

    /// What follows when v_T reaches zero at `y` while slipping in `mode`.
    ///
    /// With v̇⁺ and v̇⁻ the accelerations under slip+ and slip−: stick where `v̇⁺ ≤ 0 ≤ v̇⁻`, both
    /// leading back to zero; else on to the other sign. A. F. Filippov, *Differential Equations
    /// with Discontinuous Righthand Sides* (1988), §4.
    fn reversed<S: Real>(&self, mode: Mode, y: &mut State<S>) -> Mode {
        let pose = self.pose(y);
        let plus = self.v_t_dot_in(Mode::SlipPlus, y, &pose);
        let minus = self.v_t_dot_in(Mode::SlipMinus, y, &pose);
        if plus <= 0.0 && 0.0 <= minus {
            self.project_v_t(y);
            Mode::Stick
        } else if mode == Mode::SlipPlus {
            Mode::SlipMinus
        } else {
            Mode::SlipPlus
        }
    }
}

/// Rounding error of `π/2 − θ` near 90° [rad].
pub(super) const ANGLE_BOUND: f64 = 4.0 * f64::EPSILON * FRAC_PI_2;

/// Rounding error of `ρ − c` for ρ near c [m].
pub(super) fn delta_bound(clearance: f64) -> f64 {
    4.0 * f64::EPSILON * clearance
}
