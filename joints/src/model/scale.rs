//! Natural scales of a block's states, from which absolute tolerances follow.

use std::f64::consts::TAU;

use deltazero_study::Problem as _;
use deltazero_study::errors::{ErrorScale, Largest};

use super::block::Block;
use super::body::Body;
use super::linkage::Linkage as _;
use super::state::State;

impl Block {
    /// The scale of each state [m, m, rad, m/s, m/s, rad/s].
    ///
    /// Displacements go with the clearance c (0.1 mm where there is none), their rates with the
    /// speed `√(2 a c)` that the drive's acceleration `a = M p̄/I` gives the pin across it. The
    /// angle and its rate are those displacements and rates over a strut length. A linkage has `a = r ω²`,
    /// a length of its own, and where that is less than c a lower bound of the penetration, `c F/F(c)`, F = Σm a: beside
    /// such loads an error of δ that is small against c is a large one in force and energy.
    pub fn scale(&self) -> State<f64> {
        let c = if self.clearance > 0.0 { self.clearance } else { 1e-4 };
        let (pull, d) = match &self.body {
            Body::Struts(inertia) => {
                (self.torque.abs().max(1e-3) * inertia.p / inertia.about_pin(0.0, 1.0), c)
            }
            Body::Linkage(linkage) => {
                // A pin that is held penetrates nothing, and its law may have no force at that depth.
                let is_held = self.clearance == 0.0;
                let part = linkage.force_scale() / self.normal.elastic.force(c);
                (linkage.acceleration_scale(), if is_held { c } else { c * part.min(1.0) })
            }
        };
        let v = (2.0 * pull * d).sqrt();
        let l = self.strut_length;
        [d, d, d / l, v, v, v / l]
    }

    /// The scales of its errors, where θ reaches `theta` [rad].
    pub fn error_scale(&self, theta: f64) -> ErrorScale {
        let largest = Largest::known([("θ".to_owned(), theta)]);
        ErrorScale::new(&self.groups(), self.unit_of_time(), &largest)
    }

    /// In what its time is counted [s]: a second, or the turn of a crank.
    pub(super) fn body_time(&self) -> f64 {
        match &self.body {
            Body::Struts(_) => 1.0,
            Body::Linkage(linkage) => TAU / linkage.speed(),
        }
    }

    /// Speed and force that are nothing beside those of the motion: a millionth of their scales.
    pub(super) fn rounding_floor(&self) -> RoundingFloor {
        let force = match &self.body {
            Body::Struts(_) => self.torque.abs().max(1e-3) / self.strut_length,
            Body::Linkage(linkage) => linkage.force_scale(),
        };
        RoundingFloor { speed: 1e-6 * self.scale()[3], force: 1e-6 * force }
    }

    /// What the drive alone may ask of a pin that sticks [N].
    pub(super) fn drive_force(&self) -> f64 {
        match &self.body {
            Body::Struts(_) => self.torque.abs() / self.pin_radius,
            Body::Linkage(linkage) => linkage.force_scale(),
        }
    }
}

/// See [`Block::rounding_floor`].
pub(super) struct RoundingFloor {
    /// [m/s].
    pub(super) speed: f64,
    /// [N].
    pub(super) force: f64,
}
