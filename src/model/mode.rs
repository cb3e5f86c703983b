//! Free, slip+, slip−, stick: the discrete states of a joint.

use std::fmt;

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
        if v_t < 0.0 {
            Self::SlipMinus
        } else {
            Self::SlipPlus
        }
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
