//! The mechanisms: the paper's deployable struts with clearance in two root joints, and a slider-crank.
//!
//! The two joints of the struts share no term. Each is a [`Block`] of its own: pin displacement (X, Y) in the
//! bush, strut angle θ, and their rates, a hybrid system with the modes of [`Mode`].
//!
//! Several bays are a [`Chain`], in which joint 1 of each bay is one system with all others; joint 2 is at
//! the root alone and keeps the inertia of one bay: struts 3, 5 and 6 of later bays are not added to it. A
//! joint whose friction has a state of its own is a chain of one bay.
//!
//! The [slider-crank](slider_crank) is one joint, the same, with another [`Body`] on it.

pub mod block;
pub mod chain;
pub mod contact;
pub mod elastic;
pub mod energy;
mod friction;
pub mod inertia;
mod jacobian;
mod jointed;
pub mod laws;
pub mod mode;
mod plain_slip;
pub mod reading;
pub mod restitution;
mod scale;
pub mod slider_crank;
pub mod sliding;

pub use block::{Block, Body, State};
pub use chain::Chain;
pub use jointed::Jointed;
pub use mode::Mode;
pub use reading::Reading;
pub use slider_crank::SliderCrank;

use contact::NormalLaw;
use deltazero_study::{Problem as _, Subject};
use elastic::Elastic;
use inertia::BlockInertia;
use sliding::Shape;

use crate::config::{Config, MechanismName};

/// A mechanism: its independent parts.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// The parts in the order of the joints: joint 1 (AB) and joint 2 (AF) of the struts, or the one joint of
    /// a slider-crank.
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

impl Part {
    /// A joint of it with what hangs on it, alone.
    pub fn block(&self) -> &Block {
        match self {
            Self::Block(block) => block,
            Self::Chain(chain) => chain.block(),
        }
    }

    /// Number of its joints.
    pub fn n_joints(&self) -> usize {
        match self {
            Self::Block(block) => block.n_sites(),
            Self::Chain(chain) => chain.n_sites(),
        }
    }
}

impl Mechanism {
    /// What a study integrates of it.
    pub fn subject(&self) -> Subject {
        let part = |part: &Part| match part {
            Part::Block(block) => deltazero_study::Part::new(block.clone()),
            Part::Chain(chain) => deltazero_study::Part::new(chain.clone()),
        };
        Subject { parts: self.parts.iter().map(part).collect() }
    }

    /// The mechanism of a configuration.
    pub fn new(config: &Config) -> Self {
        let part = |(block, bays): (Block, usize)| match block.sliding.bristles() {
            None if bays == 1 => Part::Block(block),
            _ => Part::Chain(Chain::of(block, bays)),
        };
        let parts = match config.mechanism {
            MechanismName::Strut => {
                let bays = [config.bays as usize, 1];
                Self::struts(config).into_iter().zip(bays).map(part).collect()
            }
            MechanismName::SliderCrank => vec![part((Self::slider_crank(config), 1))],
        };
        Self { parts }
    }

    /// The joint of each part with what hangs on it, alone.
    pub fn blocks(&self) -> Vec<&Block> {
        self.parts.iter().map(Part::block).collect()
    }

    /// Every joint: its bay, from 1, and the joint with what hangs on it, alone.
    pub fn joints(&self) -> Vec<(usize, &Block)> {
        let joints = |part| (1..=Part::n_joints(part)).map(|bay| (bay, Part::block(part)));
        self.parts.iter().flat_map(joints).collect()
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
    let normal = NormalLaw::new(&own.contact, &own.joint);
    let sliding = Shape::new(&own.friction);
    let reading = Reading::of(config.reading, joint - 1);
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
        strut_length,
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
