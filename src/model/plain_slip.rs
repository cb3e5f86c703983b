//! Slip of struts under the plain law: what most of a run is, and joints differ in by numbers alone.

use std::f64::consts::FRAC_PI_2;

use deltazero_solvers::real::Over;

use super::block::{Block, State};
use super::contact::PinPose;
use super::inertia::BlockInertia;
use super::mode::{GUARD_CONTACT, GUARD_END, GUARD_UPPER, Mode, products};

/// A slip of struts under `F_N = K δ + D δ̇` with Coulomb's friction, all of it at the pin but for a torque of
/// friction. `C` are the constants of one joint, or of several at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainSlip<C = f64> {
    inertia: BlockInertia<C>,
    /// `c` [m], and its square.
    clearance: [C; 2],
    /// `K` [N/m].
    stiffness: C,
    /// `D` [N s/m].
    damping: C,
    /// `σ μ r` [m], σ the sign of v_T.
    friction_arm: C,
    /// `M` [N m].
    torque: C,
    /// `r` [m].
    pin_radius: C,
    /// `σ`.
    sigma: C,
    /// `(1, 0)` where the block ends at θ = 90°, else `(0, 1)`: the factor of that guard and what is added to it.
    ends: [C; 2],
}

impl PlainSlip {
    /// How many numbers it is.
    pub(super) const N: usize = 18;

    /// The slip `mode` of `block`.
    #[inline(always)]
    pub(super) fn new(block: &Block, inertia: &BlockInertia, stiffness: f64, mode: Mode) -> Self {
        let sigma = if matches!(mode, Mode::SlipPlus(_)) { 1.0 } else { -1.0 };
        let ends = f64::from(u8::from(block.stop_at_90));
        Self {
            inertia: *inertia,
            clearance: [block.clearance, block.clearance * block.clearance],
            stiffness,
            damping: block.normal.damping,
            friction_arm: sigma * block.mu * block.pin_radius,
            torque: block.torque,
            pin_radius: block.pin_radius,
            sigma,
            ends: [ends, 1.0 - ends],
        }
    }

    /// Its numbers, in the order of its fields.
    pub(super) fn numbers(&self) -> [f64; Self::N] {
        let BlockInertia { m_x, m_y, per_mass: [per_x, per_y], p, q, j_0, j_c } = self.inertia;
        let ([c, c_sq], [ends, goes_on]) = (self.clearance, self.ends);
        let Self { stiffness, damping, friction_arm, torque, pin_radius, sigma, .. } = *self;
        [
            m_x,
            m_y,
            per_x,
            per_y,
            p,
            q,
            j_0,
            j_c,
            c,
            c_sq,
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            ends,
            goes_on,
        ]
    }
}

impl<C: Copy> PlainSlip<C> {
    /// Of its [numbers](PlainSlip::numbers).
    #[inline(always)]
    pub(super) fn of(numbers: &[C; PlainSlip::N]) -> Self {
        let [
            m_x,
            m_y,
            per_x,
            per_y,
            p,
            q,
            j_0,
            j_c,
            c,
            c_sq,
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            ends,
            goes_on,
        ] = *numbers;
        Self {
            inertia: BlockInertia { m_x, m_y, per_mass: [per_x, per_y], p, q, j_0, j_c },
            clearance: [c, c_sq],
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            ends: [ends, goes_on],
        }
    }

    /// (Ẍ, Ÿ, θ̈): those of the general law without its terms of zero, and without a branch among its operations,
    /// past which series are slower.
    #[inline(always)]
    pub(super) fn accelerations<S: Over<C>>(&self, y: &State<S>) -> [S; 3] {
        let pose = PinPose::new([y[0], y[1]], [y[3], y[4]], self.clearance[0]);
        let arrow = self.inertia.at(y[2]);
        let pull = -(pose.delta * self.stiffness + pose.delta_dot * self.damping);
        let torque = pull * self.friction_arm + self.torque;
        let loads = [pose.n[0] * pull, pose.n[1] * pull, torque];
        self.inertia.accelerations(&arrow, y[5] * y[5], loads)
    }

    /// The guards: `π/2 − θ`, `(ρ + c) δ` and `σ ρ v_T`.
    #[inline(always)]
    pub(super) fn guards<S: Over<C>>(&self, y: &State<S>) -> [S; 4] {
        let mut g = [S::cst(1.0); 4];
        let [rho_sq, rho_v_t] = products(y, self.pin_radius);
        g[GUARD_END] = -(y[2] - FRAC_PI_2) * self.ends[0] + self.ends[1];
        g[GUARD_CONTACT] = rho_sq - self.clearance[1];
        g[GUARD_UPPER] = rho_v_t * self.sigma;
        g
    }
}
