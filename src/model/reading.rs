//! The readings of the paper: constants of one struct.

use crate::config::ReadingName;

/// Where contact and friction forces enter the equations of motion of a block.
///
/// ```text
/// Q_X = −F_N n_X + φ F_T t_X + (κ − 1) S_x sin θ θ̇²,   Q_Y = −F_N n_Y + φ F_T t_Y,
/// Q_θ = (l/2) F_N (α_c cos θ n_X + α_s sin θ n_Y) + F_T r
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// `α_c`, `α_s`: the moment of the normal force about the pin, in half struts.
    pub normal_moment: [f64; 2],
    /// `φ`: 1 where friction also acts as a force on the pin, 0 where as a torque only.
    pub tangential_force: f64,
    /// `κ`: sign of the centrifugal term in the equation of X; −1 as printed in Eq. (17).
    pub centrifugal: f64,
}

impl Reading {
    /// The contact force acts at the pin, friction is a torque only, signs are as derived.
    pub const AT_PIN: Self =
        Self { normal_moment: [0.0, 0.0], tangential_force: 0.0, centrifugal: 1.0 };

    /// The reading called `name` of joint 1 (`joint = 0`) or 2 (`joint = 1`).
    ///
    /// - `pin`: the contact force acts at the pin, whose partial velocity has no part in θ;
    ///   friction is a torque only, as Eq. (9) has it.
    /// - `full`: the same with the friction force on the pin: Newton's third law complete.
    /// - `centroid`: Eq. (9) literally, the contact force at the strut's centroid, signs as derived.
    /// - `printed`: Eqs. (12), (14) and (17) verbatim. Against the derivation the sign of the
    ///   sin θ term is wrong in (12), that of the cos θ term in (14), and the centrifugal term
    ///   in (17).
    /// - `cosine`: as `centroid` without its sin θ terms, friction as torque and force: it
    ///   reproduces the paper's 9 s for strut AF.
    pub fn of(name: ReadingName, joint: usize) -> Self {
        let at_pin = Self::AT_PIN;
        match (name, joint) {
            (ReadingName::Pin, _) => at_pin,
            (ReadingName::Full, _) => Self { tangential_force: 1.0, ..at_pin },
            (ReadingName::Centroid, _) => Self { normal_moment: [-1.0, 1.0], ..at_pin },
            (ReadingName::Printed, 0) => Self { normal_moment: [-1.0, -1.0], ..at_pin },
            (ReadingName::Printed, _) => {
                Self { normal_moment: [1.0, 1.0], centrifugal: -1.0, ..at_pin }
            }
            (ReadingName::Cosine, _) => {
                Self { normal_moment: [-1.0, 0.0], tangential_force: 1.0, ..at_pin }
            }
        }
    }
}
