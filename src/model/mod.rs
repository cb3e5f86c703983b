//! The mechanisms: the paper's deployable struts with clearance in two root joints, and a slider-crank.
//!
//! The two joints of the struts share no term. Each is a [`Block`] of its own: pin displacement (X, Y) in the
//! bush, strut angle θ, and their rates, a hybrid system with the modes of [`Mode`].
//!
//! Several bays are a [`Chain`], in which joint 1 of each bay is one system with all others; joint 2 is at
//! the root alone and keeps the inertia of one bay: struts 3, 5 and 6 of later bays are not added to it.
//!
//! The [slider-crank](slider_crank) is one block: its joint is the same, another [`Body`] hangs on it.

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
pub mod slider_crank;
pub mod sliding;

pub use block::{Block, Body, State};
pub use chain::Chain;
pub use mode::Mode;
pub use reading::Reading;
pub use slider_crank::SliderCrank;

use crate::config::{Config, MechanismName};
use contact::NormalLaw;
use inertia::BlockInertia;
use sliding::Shape;

/// A mechanism: its independent blocks.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// The blocks in the order of the joints: joint 1 (AB) and joint 2 (AF) of the struts, or the one of a
    /// slider-crank.
    pub blocks: Vec<Block>,
}

impl Mechanism {
    /// The mechanism of a configuration.
    pub fn new(config: &Config) -> Self {
        let blocks = match config.mechanism {
            MechanismName::Strut => Self::struts(config).into(),
            MechanismName::SliderCrank => vec![Self::slider_crank(config)],
        };
        Self { blocks }
    }

    /// The two blocks of the struts.
    pub fn struts(config: &Config) -> [Block; 2] {
        let (strut, drive) = (&config.strut, &config.drive);
        let block = |joint, inertia, torque| Block {
            torque,
            stop_at_90: config.run.stop_at_90,
            ..block(config, joint, Body::Struts(inertia), strut.length)
        };
        [
            block(1, BlockInertia::joint_1(strut), drive.m1),
            block(2, BlockInertia::joint_2(strut), drive.m4),
        ]
    }

    fn slider_crank(config: &Config) -> Block {
        let own = &config.slider_crank;
        let body = SliderCrank {
            crank: own.crank_length,
            rod: own.rod_length,
            rod_mass: own.rod_mass,
            rod_inertia: own.rod_inertia,
            slider_mass: own.slider_mass,
            speed: own.crank_speed,
            start: own.start_angle,
        };
        block(config, 1, Body::SliderCrank(body), own.rod_length)
    }
}

/// A joint of `config` with a body on it, without a drive torque or an end.
fn block(config: &Config, joint: usize, body: Body, strut_length: f64) -> Block {
    let own = &config.joints[joint - 1];
    Block {
        joint,
        body,
        strut_length,
        torque: 0.0,
        clearance: own.joint.clearance,
        pin_radius: own.joint.pin_radius,
        normal: NormalLaw::new(&own.contact, &own.joint),
        mu: own.friction.coefficient,
        sliding: Shape::new(&own.friction),
        reading: Reading::of(config.reading, joint - 1),
        stop_at_90: false,
    }
}
