//! Energies and powers of one state of a block.

use deltazero_study::problem::{Energy, Power};

use super::block::{Block, ContactForces};
use super::body::Body;
use super::contact::{Onset, PinPose};
use super::linkage::Linkage as _;
use super::mode::Mode;
use super::state::State;

impl Block {
    /// Energies of `y` in `mode`; that of a linkage is its own, of struts
    ///
    /// ```text
    /// T = ½ M_x (Ẋ + p̄ cos θ θ̇)² + ½ M_y (Ẏ − q̄ sin θ θ̇)² + ½ (j_0 + j_c cos²θ) θ̇²
    /// ```
    pub fn energy(&self, mode: Mode, y: &State<f64>) -> Energy {
        let [_, _, theta, v_x, v_y, omega] = *y;
        let kinetic = match &self.body {
            Body::Struts(inertia) => {
                let (sin, cos) = libm::sincos(theta);
                let u_x = v_x + inertia.p * cos * omega;
                let u_y = v_y - inertia.q * sin * omega;
                0.5 * (inertia.m_x * u_x * u_x
                    + inertia.m_y * u_y * u_y
                    + inertia.schur(cos) * omega * omega)
            }
            Body::Linkage(linkage) => linkage.kinetic(y),
        };
        let elastic =
            if mode.is_contact() { self.normal.elastic.energy(self.pose(y).delta) } else { 0.0 };
        Energy { kinetic, elastic }
    }

    /// Powers at `y` in `mode`: that of the normal law's losses, and by friction `−F_T v_T` where it acts as a
    /// force and a torque, `−F_T r θ̇` where as a torque alone.
    pub fn power(&self, mode: Mode, y: &State<f64>) -> Power {
        let onset = mode.onset().filter(|_| mode.is_contact());
        let contact = onset.map(|onset| {
            let pose = self.pose(y);
            (pose, self.forces(mode, y, &pose), onset)
        });
        self.power_under(mode, y, contact)
    }

    /// The load on the pin of a linkage at `y` in `mode` under the forces of its contact.
    pub fn load_on_linkage(
        &self,
        mode: Mode,
        y: &State<f64>,
        forces: ContactForces<f64>,
    ) -> [f64; 3] {
        match (&self.body, mode) {
            (Body::Linkage(linkage), Mode::Pinned) => linkage.ideal_load(y),
            (_, Mode::Pinned | Mode::Apart | Mode::Relaxing(_)) => [0.0; 3],
            _ => self.pin_load(&self.pose(y), forces),
        }
    }

    /// [`power`](Self::power) where this is the contact of the joint, with its forces and how it began; none where `mode` is none.
    pub(super) fn power_under(
        &self,
        mode: Mode,
        y: &State<f64>,
        contact: Option<(PinPose<f64>, ContactForces<f64>, Onset)>,
    ) -> Power {
        let forces = contact.map_or(ContactForces::frictionless(0.0), |(_, forces, _)| forces);
        let torque = match &self.body {
            Body::Struts(_) => self.torque,
            Body::Linkage(linkage) => linkage.torque(y, self.load_on_linkage(mode, y, forces)),
        };
        let drive = torque * y[5];
        let Some((pose, forces, onset)) = contact else {
            return Power { drive, damping: 0.0, friction: 0.0 };
        };
        let damping = self.normal.loss(pose.delta, pose.delta_dot, onset);
        let turning = self.pin_radius * self.body.held().spin(y);
        let speed = turning + self.reading.tangential_force * pose.w([y[3], y[4]]);
        Power { drive, damping, friction: -(forces.tangential * speed) }
    }
}
