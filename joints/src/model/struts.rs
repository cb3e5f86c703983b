//! The joints of the paper's struts.

use super::inertia::BlockInertia;
use super::{Block, Body, Chain, block};
use crate::keys::Shared;

/// Joint 1 in each of the bays of a configuration, as one system.
pub fn chain_of(shared: &Shared) -> Chain {
    let [bay, _] = struts(shared);
    Chain::of(bay, shared.bays as usize)
}

/// The two joints of one bay.
pub fn struts(shared: &Shared) -> [Block; 2] {
    let (strut, drive) = (&shared.strut, &shared.drive);
    let of = |joint, inertia, torque| {
        let body = Body::Struts(inertia);
        let mut own = block(shared, joint, body, (strut.length, shared.reading));
        (own.torque, own.stop_at_90) = (torque, shared.run.stop_at_90);
        own
    };
    [of(1, BlockInertia::joint_1(strut), drive.m1), of(2, BlockInertia::joint_2(strut), drive.m4)]
}
