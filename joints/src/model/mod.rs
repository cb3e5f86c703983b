//! Pins in bushes with clearance: a joint with what hangs on it, and the laws of its contact.
//!
//! A joint is a [`Block`]: pin displacement (X, Y) in the bush, an angle θ, and their rates, a hybrid system with the
//! modes of [`Mode`]. The two joints of the paper's struts share no term, so each is a block of its own.
//!
//! Several bays are a [`Chain`], in which joint 1 of each bay is one system with all others; joint 2 is at
//! the root alone and keeps the inertia of one bay: struts 3, 5 and 6 of later bays are not added to it. A
//! joint whose friction has a state of its own is a chain of one bay.
//!
//! A [linkage] is one joint, the same, with another [`Body`] on it.

pub mod block;
mod body;
pub mod chain;
pub mod contact;
pub mod energy;
pub mod four_bar;
mod friction;
mod generalised_forces;
pub mod inertia;
mod jacobian;
mod jointed;
pub mod linkage;
pub mod linkages;
pub mod mode;
mod plain_slip;
pub mod reading;
mod scale;
pub mod slider_crank;
pub mod sliding;
mod state;
pub mod struts;

pub use block::Block;
pub use body::Body;
pub use chain::Chain;
pub use four_bar::FourBar;
pub use jointed::Jointed;
pub use linkages::AnyLinkage;
pub use mode::Mode;
pub use reading::Reading;
pub use slider_crank::SliderCrank;
pub use state::State;

use contact::NormalLaw;
use sliding::Shape;

use crate::keys::{ReadingName, Shared};
use crate::laws::elastic::Elastic;

/// The joints of a mechanism; none of one that is not made of joints.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    /// The parts in the order of the joints: joint 1 (AB) and joint 2 (AF) of the struts, or the one joint of
    /// another mechanism.
    pub parts: Vec<Part>,
}

/// What shares no term with the rest of its mechanism.
#[derive(Clone, Debug)]
pub enum Part {
    /// A joint with what hangs on it.
    Block(Block),
    /// Joint 1 of several bays, or a joint whose friction has bristles.
    Chain(Chain),
}

impl From<Part> for deltazero_study::Part {
    fn from(part: Part) -> Self {
        match part {
            Part::Block(block) => Self::new(block),
            Part::Chain(chain) => Self::new(chain),
        }
    }
}

impl Part {
    /// `bays` joints like `block` in a row.
    pub fn of(block: Block, bays: usize) -> Self {
        match block.sliding.bristles() {
            None if bays == 1 => Self::Block(block),
            _ => Self::Chain(Chain::of(block, bays)),
        }
    }

    /// A joint of it with what hangs on it, alone.
    pub fn block(&self) -> &Block {
        match self {
            Self::Block(block) => block,
            Self::Chain(chain) => chain.block(),
        }
    }
}

impl Joints {
    /// The joint of each part with what hangs on it, alone.
    pub fn blocks(&self) -> Vec<&Block> {
        self.parts.iter().map(Part::block).collect()
    }
}

/// A joint of `shared` with a body on it, without a drive torque or an end; `length` is that of the part that turns.
///
/// # Panics
/// Where `joint` is neither 1 nor 2.
pub fn block(
    shared: &Shared,
    joint: usize,
    body: Body,
    (length, reading): (f64, ReadingName),
) -> Block {
    let own = &shared.joints[joint - 1];
    let normal = NormalLaw::new(&own.contact, &own.joint);
    let sliding = Shape::new(&own.friction);
    let reading = Reading::of(reading, joint - 1);
    let is_plain = matches!(sliding, Shape::Constant)
        && normal.hysteresis == 0.0
        && reading == Reading::AT_PIN;
    let plain_stiffness = match normal.elastic {
        Elastic::Linear { stiffness } if is_plain => Some(stiffness),
        _ => None,
    };
    Block {
        joint,
        body,
        strut_length: length,
        torque: 0.0,
        clearance: own.joint.clearance,
        pin_radius: own.joint.pin_radius,
        normal,
        mu: own.friction.coefficient,
        sliding,
        reading,
        stop_at_90: false,
        plain_stiffness,
    }
}
