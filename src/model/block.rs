//! One joint with the struts that hang on it: a hybrid system of six states.

use std::f64::consts::FRAC_PI_2;

use deltazero_solvers::{ModeOfState, Next, Real, System};

use super::contact::{NormalLaw, PinPose};
use super::inertia::BlockInertia;
use super::mode::Mode;
use super::reading::Reading;

/// State of a block: X, Y [m], θ [rad] and their rates. X is the pin displacement whose arm goes
/// with sin θ (x01, z02), Y the one with cos θ (y01, y02).
pub type State<S> = [S; 6];

/// Guard: θ below 90°, where the struts line up.
pub const GUARD_90: usize = 0;
/// Guard: on this side of the contact surface.
pub const GUARD_CONTACT: usize = 1;
/// Guard: slipping, v_T keeps its sign; sticking, F_T < μ F_N; relaxing, δ > 0.
pub const GUARD_UPPER: usize = 2;
/// Guard: sticking, F_T > −μ F_N.
pub const GUARD_LOWER: usize = 3;

/// A joint and its struts.
///
/// Joint 1 and joint 2 differ in constants alone: with X = z02, Y = y02 the equations of joint 2
/// are those of joint 1.
#[derive(Clone, Debug)]
pub struct Block {
    /// Number of the joint, 1 or 2.
    pub joint: usize,
    /// Mass matrix.
    pub inertia: BlockInertia,
    /// Strut length `l` [m].
    pub strut_length: f64,
    /// Drive torque `M` on θ [N m].
    pub torque: f64,
    /// Clearance `c` [m]; zero holds the pin.
    pub clearance: f64,
    /// Radius `r` of the pin, the arm of friction [m].
    pub pin_radius: f64,
    /// Normal force law.
    pub normal: NormalLaw,
    /// Coulomb's coefficient `μ`.
    pub mu: f64,
    /// Where the contact forces enter.
    pub reading: Reading,
    /// Whether the block ends at θ = 90°.
    pub stop_at_90: bool,
}

/// Forces of one contact.
#[derive(Clone, Copy, Debug)]
pub struct ContactForces<S> {
    /// Normal force `F_N` [N].
    pub normal: S,
    /// Friction `F_T` [N], along `t = (n_Y, −n_X)` on the pin.
    pub tangential: S,
}

impl Block {
    /// Pin displacement, velocity and their polar form.
    #[inline(always)]
    pub fn pose<S: Real>(&self, y: &State<S>) -> PinPose<S> {
        PinPose::new([y[0], y[1]], [y[3], y[4]], self.clearance)
    }

    /// `v_T = t·v + θ̇ r` [m/s]: tangential velocity of the pin's surface at the contact point.
    #[inline(always)]
    pub fn v_t<S: Real>(&self, pose: &PinPose<S>, y: &State<S>) -> S {
        pose.w + y[5] * self.pin_radius
    }

    /// Accelerations (Ẍ, Ÿ, θ̈) under a normal force and friction in the direction of `pose`.
    #[inline(always)]
    pub(super) fn accelerations<S: Real>(
        &self,
        y: &State<S>,
        pose: &PinPose<S>,
        forces: ContactForces<S>,
    ) -> [S; 3] {
        let sin_cos = y[2].sin_cos();
        self.inertia
            .accelerations(sin_cos, y[5] * y[5], self.loads(y, sin_cos, pose, forces))
    }

    /// Generalised forces (Q_X, Q_Y, Q_θ); see [`Reading`].
    #[inline(always)]
    pub(super) fn loads<S: Real>(
        &self,
        y: &State<S>,
        (sin, cos): (S, S),
        pose: &PinPose<S>,
        forces: ContactForces<S>,
    ) -> [S; 3] {
        let ContactForces { normal, tangential } = forces;
        let [n_x, n_y] = pose.n;
        let on_pin = tangential * self.reading.tangential_force;
        let [along_cos, along_sin] = self.reading.normal_moment;
        let mut q = [
            n_y * on_pin - n_x * normal,
            -(n_y * normal) - n_x * on_pin,
            tangential * self.pin_radius + self.torque,
        ];
        if self.reading.normal_moment != [0.0, 0.0] {
            let arm = cos * n_x * along_cos + sin * n_y * along_sin;
            q[2] = q[2] + arm * normal * (0.5 * self.strut_length);
        }
        if self.reading.centrifugal != 1.0 {
            let s_x = self.inertia.m_x * self.inertia.p;
            q[0] = q[0] + sin * y[5] * y[5] * (s_x * (self.reading.centrifugal - 1.0));
        }
        q
    }

    /// `v̇_T` under the accelerations `a` [m/s²].
    ///
    /// ```text
    /// v̇_T = t·(Ẍ, Ÿ) − (t·v) δ̇/ρ + θ̈ r
    /// ```
    #[inline(always)]
    fn v_t_dot<S: Real>(&self, pose: &PinPose<S>, a: [S; 3]) -> S {
        pose.n[1] * a[0] - pose.n[0] * a[1] - pose.w * pose.delta_dot / pose.rho
            + a[2] * self.pin_radius
    }

    /// `∂v̇_T/∂F_T` [1/kg], and the accelerations that a unit of `F_T` adds.
    #[inline(always)]
    pub(super) fn friction_response<S: Real>(
        &self,
        y: &State<S>,
        pose: &PinPose<S>,
    ) -> (S, [S; 3]) {
        let on_pin = self.reading.tangential_force;
        let load = [
            pose.n[1] * on_pin,
            -(pose.n[0] * on_pin),
            S::cst(self.pin_radius),
        ];
        let a = self
            .inertia
            .accelerations(y[2].sin_cos(), S::cst(0.0), load);
        let along = pose.n[1] * a[0] - pose.n[0] * a[1] + a[2] * self.pin_radius;
        (along, a)
    }

    /// The forces of a contact in `mode`: `F_N` of the normal law, and `F_T = −σ μ F_N` slipping,
    /// `F_T` of `v̇_T = 0` sticking; none where the mode is no contact.
    #[inline(always)]
    pub fn forces<S: Real>(&self, mode: Mode, y: &State<S>, pose: &PinPose<S>) -> ContactForces<S> {
        if !mode.is_contact() {
            return ContactForces {
                normal: S::cst(0.0),
                tangential: S::cst(0.0),
            };
        }
        let normal = self.normal.force(pose.delta, pose.delta_dot);
        let tangential = match mode.sigma() {
            Some(sigma) => normal * (-sigma * self.mu),
            None => {
                let frictionless = ContactForces {
                    normal,
                    tangential: S::cst(0.0),
                };
                let v_t_dot = self.v_t_dot(pose, self.accelerations(y, pose, frictionless));
                -(v_t_dot / self.friction_response(y, pose).0)
            }
        };
        ContactForces { normal, tangential }
    }

    /// `v̇_T` in `mode`.
    fn v_t_dot_in<S: Real>(&self, mode: Mode, y: &State<S>, pose: &PinPose<S>) -> f64 {
        let forces = self.forces(mode, y, pose);
        self.v_t_dot(pose, self.accelerations(y, pose, forces))
            .value()
    }

    /// The mode in which contact begins at `y`: the sign of v_T; where that is zero, the sign of
    /// the frictionless v̇_T.
    fn entered<S: Real>(&self, y: &State<S>) -> Mode {
        let pose = self.pose(y);
        let v_t = self.v_t(&pose, y).value();
        if v_t != 0.0 {
            return Mode::slip(v_t);
        }
        let normal = self.normal.force(pose.delta, pose.delta_dot);
        let forces = ContactForces {
            normal,
            tangential: S::cst(0.0),
        };
        Mode::slip(
            self.v_t_dot(&pose, self.accelerations(y, &pose, forces))
                .value(),
        )
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

    /// Makes v_T exactly zero by moving the pin's centre along t.
    fn project_v_t<S: Real>(&self, y: &mut State<S>) {
        let pose = self.pose(y);
        let v_t = self.v_t(&pose, y);
        y[3] = y[3] - pose.n[1] * v_t;
        y[4] = y[4] + pose.n[0] * v_t;
    }

    /// In the order of the paper's coordinates: joint 1 (x01, y01, θ1, …), joint 2 (y02, z02, θ2, …).
    pub fn in_paper_order(&self, y: &State<f64>) -> State<f64> {
        let [x, y_, theta, v_x, v_y, omega] = *y;
        if self.joint == 1 {
            *y
        } else {
            [y_, x, theta, v_y, v_x, omega]
        }
    }

    /// The start of the paper: X = 0, Y = −c, θ = 0, at rest.
    pub fn initial_state(&self) -> State<f64> {
        [0.0, -self.clearance, 0.0, 0.0, 0.0, 0.0]
    }
}

impl ModeOfState for Block {
    fn mode_of_state<S: Real>(&self, _t: S, y: &State<S>) -> Mode {
        if self.clearance == 0.0 {
            return Mode::Pinned;
        }
        let pose = self.pose(y);
        // A pin at the very centre has no direction, and is apart.
        if pose.delta.value() > 0.0 {
            if self.normal.adhesion || self.normal.force(pose.delta, pose.delta_dot).value() > 0.0 {
                self.entered(y)
            } else {
                Mode::Relaxing
            }
        } else {
            Mode::Apart
        }
    }
}

impl System for Block {
    type Mode = Mode;
    type State<S: Real> = State<S>;
    type Guards<S: Real> = [S; 4];

    fn dim(&self) -> usize {
        6
    }

    fn n_guards(&self) -> usize {
        4
    }

    /// As [`mode_of_state`](ModeOfState::mode_of_state); a start on the surface, to rounding, is free.
    fn initial_mode(&self, t: f64, y: &State<f64>) -> Mode {
        let on_surface = self.pose(y).delta.abs() <= delta_bound(self.clearance);
        if on_surface && self.clearance > 0.0 {
            Mode::Apart
        } else {
            self.mode_of_state(t, y)
        }
    }

    #[inline(always)]
    fn rhs<S: Real>(&self, mode: Mode, _t: S, y: &State<S>, dydt: &mut State<S>) {
        let zero = S::cst(0.0);
        *dydt = match mode {
            Mode::Pinned => {
                let (sin, cos) = y[2].sin_cos();
                let i_c = self.inertia.about_pin(0.0, 1.0) - self.inertia.about_pin(1.0, 0.0);
                let moment = sin * cos * y[5] * y[5] * i_c + self.torque;
                let about_pin = self.inertia.about_pin(sin, cos);
                [zero, zero, y[5], zero, zero, moment / about_pin]
            }
            Mode::Apart | Mode::Relaxing => {
                let sin_cos = y[2].sin_cos();
                let (mut q, omega_sq) = ([zero, zero, S::cst(self.torque)], y[5] * y[5]);
                if self.reading.centrifugal != 1.0 {
                    let s_x = self.inertia.m_x * self.inertia.p;
                    q[0] = sin_cos.0 * omega_sq * (s_x * (self.reading.centrifugal - 1.0));
                }
                let a = self.inertia.accelerations(sin_cos, omega_sq, q);
                [y[3], y[4], y[5], a[0], a[1], a[2]]
            }
            Mode::SlipPlus | Mode::SlipMinus | Mode::Stick => {
                let pose = self.pose(y);
                let a = self.accelerations(y, &pose, self.forces(mode, y, &pose));
                [y[3], y[4], y[5], a[0], a[1], a[2]]
            }
        };
    }

    #[inline(always)]
    fn guards<S: Real>(&self, mode: Mode, _t: S, y: &State<S>, g: &mut [S; 4]) {
        let inside = S::cst(1.0);
        *g = [inside; 4];
        if self.stop_at_90 {
            g[GUARD_90] = -(y[2] - FRAC_PI_2);
        }
        match mode {
            Mode::Pinned => {}
            // (c² − ρ²)/2c is −δ at the surface, and smooth at the bush's centre too.
            Mode::Apart => {
                let c = self.clearance;
                g[GUARD_CONTACT] = -(y[0] * y[0] + y[1] * y[1] - c * c) / (2.0 * c);
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
    }

    fn guard_bounds(&self, mode: Mode, _t: f64, y: &State<f64>, bounds: &mut [f64; 4]) {
        let eps = 4.0 * f64::EPSILON;
        let delta = delta_bound(self.clearance);
        let speed = y[3].abs() + y[4].abs() + y[5].abs() * self.pin_radius;
        *bounds = [eps * FRAC_PI_2, delta, delta, delta];
        if mode.is_contact() || mode == Mode::Relaxing {
            let pose = self.pose(y);
            let force = self.normal.slope(pose.delta) * delta
                + eps * (self.normal.force(pose.delta, 0.0).abs() + self.normal.damping * speed);
            if mode == Mode::Relaxing || !self.normal.adhesion {
                bounds[GUARD_CONTACT] = force;
            }
            if mode.sigma().is_some() {
                bounds[GUARD_UPPER] = eps * speed;
            } else if mode == Mode::Stick {
                let drive = self.torque.abs() / self.pin_radius;
                let load = self.normal.force(pose.delta, pose.delta_dot).abs() + drive;
                let friction = force * (1.0 + self.mu) + 4.0 * eps * load;
                bounds[GUARD_UPPER] = friction;
                bounds[GUARD_LOWER] = friction;
            }
        }
    }

    fn transition<S: Real>(&self, mode: Mode, guard: usize, _t: S, y: &mut State<S>) -> Next<Mode> {
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
                if upper_or_lower == GUARD_UPPER {
                    Mode::SlipMinus
                } else {
                    Mode::SlipPlus
                }
            }
        })
    }

    fn jacobian(
        &self,
        mode: Mode,
        _t: f64,
        y: &State<f64>,
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        for (i, row) in self.jacobian_rows(mode, y).iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                entry(i, j, *value);
            }
        }
    }
}

/// Rounding error of `ρ − c` for ρ near c [m].
fn delta_bound(clearance: f64) -> f64 {
    4.0 * f64::EPSILON * clearance
}
