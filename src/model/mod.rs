//! The deployable strut mechanism with clearance in its two root joints: the paper's equations.
//!
//! The two joints share no term. Each is a [`Block`] of its own: pin displacement (X, Y) in the
//! bush, strut angle θ, and their rates, a hybrid system with the modes of [`Mode`].
//!
//! Several bays are a [`Chain`], in which joint 1 of each bay is one system with all others; joint 2 is at
//! the root alone and keeps the inertia of one bay: struts 3, 5 and 6 of later bays are not added to it.

pub mod block;
pub mod chain;
pub mod contact;
pub mod elastic;
pub mod energy;
mod friction;
pub mod inertia;
mod jacobian;
pub mod laws;
pub mod mode;
pub mod reading;
pub mod restitution;
mod scale;
pub mod sliding;

pub use block::{Block, State};
pub use chain::Chain;
pub use mode::Mode;
pub use reading::Reading;

use crate::config::Config;
use contact::NormalLaw;
use inertia::BlockInertia;
use sliding::Shape;

/// The mechanism: its independent blocks, joint 1 (AB) and joint 2 (AF).
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// The blocks in the order of the joints.
    pub blocks: [Block; 2],
}

impl Mechanism {
    /// The mechanism of a configuration.
    pub fn new(config: &Config) -> Self {
        let strut = &config.strut;
        let block = |joint: usize, inertia: BlockInertia, torque: f64| {
            let own = &config.joints[joint - 1];
            Block {
                joint,
                inertia,
                strut_length: strut.length,
                torque,
                clearance: own.joint.clearance,
                pin_radius: own.joint.pin_radius,
                normal: NormalLaw::new(&own.contact, &own.joint),
                mu: own.friction.coefficient,
                sliding: Shape::new(&own.friction),
                reading: Reading::of(config.reading, joint - 1),
                stop_at_90: config.run.stop_at_90,
            }
        };
        Self {
            blocks: [
                block(1, BlockInertia::joint_1(strut), config.drive.m1),
                block(2, BlockInertia::joint_2(strut), config.drive.m4),
            ],
        }
    }
}
