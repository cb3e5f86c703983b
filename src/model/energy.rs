//! Energies and powers of one state of a block.

use super::block::{Block, ContactForces, State};
use super::contact::{PinPose, Touch};
use super::mode::Mode;

/// Energies of a state [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic energy of the contact; none where the mode is no contact.
    pub elastic: f64,
}

/// Powers at a state [W].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Of the drive torque, `M θ̇`.
    pub drive: f64,
    /// Taken by damping and friction; friction as a torque alone may give as well.
    pub dissipated: f64,
}

impl Block {
    /// Energies of `y` in `mode`.
    ///
    /// ```text
    /// T = ½ M_x (Ẋ + p̄ cos θ θ̇)² + ½ M_y (Ẏ − q̄ sin θ θ̇)² + ½ (j_0 + j_c cos²θ) θ̇²
    /// ```
    pub fn energy(&self, mode: Mode, y: &State<f64>) -> Energy {
        let [_, _, theta, v_x, v_y, omega] = *y;
        let (sin, cos) = libm::sincos(theta);
        let inertia = &self.inertia;
        let u_x = v_x + inertia.p * cos * omega;
        let u_y = v_y - inertia.q * sin * omega;
        let kinetic = 0.5
            * (inertia.m_x * u_x * u_x
                + inertia.m_y * u_y * u_y
                + inertia.schur(cos) * omega * omega);
        let elastic =
            if mode.is_contact() { self.normal.elastic.energy(self.pose(y).delta) } else { 0.0 };
        Energy { kinetic, elastic }
    }

    /// Powers at `y` in `mode`: that of the normal law's losses, and by friction `−F_T v_T` where it acts as a
    /// force and a torque, `−F_T r θ̇` where as a torque alone.
    pub fn power(&self, mode: Mode, y: &State<f64>) -> Power {
        let (Some(touch), true) = (mode.touch(), mode.is_contact()) else {
            return self.power_of(y, None);
        };
        let pose = self.pose(y);
        self.power_of(y, Some((&pose, self.forces(mode, y, &pose), touch)))
    }

    /// The same with the forces of the contact given, and how it began.
    pub(super) fn power_of(
        &self,
        y: &State<f64>,
        contact: Option<(&PinPose<f64>, ContactForces<f64>, Touch)>,
    ) -> Power {
        let drive = self.torque * y[5];
        let Some((pose, forces, touch)) = contact else {
            return Power { drive, dissipated: 0.0 };
        };
        let damping = self.normal.loss(pose.delta, pose.delta_dot, touch);
        let turning = self.pin_radius * y[5];
        let speed = turning + self.reading.tangential_force * pose.w([y[3], y[4]]);
        let friction = forces.tangential * speed;
        Power { drive, dissipated: damping - friction }
    }
}
