//! Natural scales of a block's states, from which absolute tolerances follow.

use super::block::{Block, State};

impl Block {
    /// The scale of each state [m, m, rad, m/s, m/s, rad/s].
    ///
    /// Displacements go with the clearance c (0.1 mm where there is none), their rates with the
    /// speed `√(2 a c)` that the drive's acceleration `a = M p̄/I` gives the pin across it. The
    /// angle and its rate are those displacements and rates over a strut length.
    pub fn scale(&self) -> State<f64> {
        let c = if self.clearance > 0.0 { self.clearance } else { 1e-4 };
        let pull = self.torque.abs().max(1e-3) * self.inertia.p / self.inertia.about_pin(0.0, 1.0);
        let v = (2.0 * pull * c).sqrt();
        let l = self.strut_length;
        [c, c, c / l, v, v, v / l]
    }

    /// Speed and force that are nothing beside those of the motion: a millionth of their scales.
    pub(super) fn rounding_floor(&self) -> RoundingFloor {
        let force = self.torque.abs().max(1e-3) / self.strut_length;
        RoundingFloor { speed: 1e-6 * self.scale()[3], force: 1e-6 * force }
    }
}

/// See [`Block::rounding_floor`].
pub(super) struct RoundingFloor {
    /// [m/s].
    pub(super) speed: f64,
    /// [N].
    pub(super) force: f64,
}
