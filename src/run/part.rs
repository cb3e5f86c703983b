//! The parts of a mechanism that are integrated each by itself, with their trajectories.

use super::chain::chain_contacts_at_floor;
use super::{
    BlockTrajectory, ChainTrajectory, ModeChange, chain_mode_changes, contacts_at_floor,
    mode_changes,
};
use crate::model::block::ContactForces;
use crate::model::{Block, Chain, Mode, State};

/// A block, or a chain, with its samples and events.
#[derive(Clone, Debug)]
pub enum Part<'a> {
    /// A joint with its struts.
    Block(&'a Block, BlockTrajectory),
    /// Joint 1 of several bays.
    Chain(&'a Chain, ChainTrajectory),
}

/// A sample of one joint.
#[derive(Clone, Copy, Debug)]
pub struct JointSample {
    /// Time [s].
    pub t: f64,
    /// Mode.
    pub mode: Mode,
    /// State, in the paper's order.
    pub y: State<f64>,
    /// Forces of its contact.
    pub forces: ContactForces<f64>,
}

/// The history of one joint.
#[derive(Clone, Debug)]
pub struct JointHistory<'a> {
    /// The bay, from 1 at the root.
    pub bay: usize,
    /// The joint with its struts.
    pub block: &'a Block,
    /// Its samples.
    pub samples: Vec<JointSample>,
    /// Its mode changes.
    pub changes: Vec<ModeChange>,
}

impl Part<'_> {
    /// Contacts that began at the floor of the impact speed or below it.
    pub fn n_at_floor(&self) -> usize {
        match self {
            Self::Block(block, trajectory) => contacts_at_floor(block, trajectory),
            Self::Chain(chain, trajectory) => chain_contacts_at_floor(chain, trajectory),
        }
    }

    /// The history of each joint, from the root.
    pub fn joints(&self) -> Vec<JointHistory<'_>> {
        match self {
            Self::Block(block, trajectory) => {
                let sample = |sample: &deltazero_solvers::Sample<State<f64>, Mode>| {
                    let (t, mode, y) = (sample.t, sample.mode, sample.y);
                    let forces = block.forces(mode, &y, &block.pose(&y));
                    JointSample { t, mode, y: block.in_paper_order(&y), forces }
                };
                let samples = trajectory.samples.iter().map(sample).collect();
                vec![JointHistory { bay: 1, block, samples, changes: mode_changes(trajectory) }]
            }
            Self::Chain(chain, trajectory) => {
                let changes = chain_mode_changes(chain, trajectory);
                let new = |(k, changes)| JointHistory {
                    bay: k + 1,
                    block: &chain.bay,
                    samples: Vec::with_capacity(trajectory.samples.len()),
                    changes,
                };
                let mut joints: Vec<_> = changes.into_iter().enumerate().map(new).collect();
                for sample in &trajectory.samples {
                    let forces = chain.forces(&sample.mode, &sample.y);
                    for (k, (joint, forces)) in joints.iter_mut().zip(forces).enumerate() {
                        let (mode, y) = (sample.mode[k], Chain::state_of(&sample.y, k));
                        joint.samples.push(JointSample { t: sample.t, mode, y, forces });
                    }
                }
                joints
            }
        }
    }
}
