//! A run joint by joint, of whatever parts it is made.

use deltazero_solvers::{Grid, Next, Sample, Switch, Trajectory};
use deltazero_study::problem::changes;
use deltazero_study::run::ModeChange;
use deltazero_study::trace::OwnTrajectory;

use super::BlockTrajectory;
use crate::model::block::ContactForces;
use crate::model::{Block, Jointed, Mode, State};

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

/// The events of each joint of `part`.
pub fn switches<P: Jointed>(part: &P, events: &[Switch<P::Mode>]) -> Vec<Vec<Switch<Mode>>> {
    let n_guards = part.n_guards() / part.n_sites();
    let mut all = vec![Vec::new(); part.n_sites()];
    for event in events {
        let k = part.site_of_guard(&event.before, event.guard);
        let after = match &event.after {
            Next::Mode(mode) => Next::Mode(P::joint_mode(mode, k)),
            Next::Stop => Next::Stop,
        };
        let (guard, before) = (event.guard % n_guards, P::joint_mode(&event.before, k));
        all[k].push(Switch { t: event.t, guard, before, after });
    }
    all
}

/// The samples and events of each joint of `part`.
pub fn trajectories<P: Jointed>(part: &P, run: &OwnTrajectory<P>) -> Vec<BlockTrajectory> {
    let mut all = vec![Trajectory::on(Grid::Steps); part.n_sites()];
    for (own, events) in all.iter_mut().zip(switches(part, &run.events)) {
        own.events = events;
    }
    for sample in &run.samples {
        for (k, own) in all.iter_mut().enumerate() {
            let (mode, y) =
                (P::joint_mode(&sample.mode, k), part.joint_state(sample.y.as_ref(), k));
            own.samples.push(Sample { t: sample.t, mode, y });
        }
    }
    all
}

/// The history of the first `most` joints of `part`, from the root.
pub fn histories<'a, P: Jointed>(
    part: &'a P,
    run: &OwnTrajectory<P>,
    most: usize,
) -> Vec<JointHistory<'a>> {
    let block = part.block();
    let joint = |(k, changes): (usize, Vec<ModeChange>)| JointHistory {
        bay: k + 1,
        block,
        samples: Vec::with_capacity(run.samples.len()),
        changes,
    };
    let changes = changes(part, &run.events).into_iter().take(most);
    let mut all: Vec<_> = changes.enumerate().map(joint).collect();
    for sample in &run.samples {
        let forces = part.joint_forces(&sample.mode, &sample.y);
        for (k, (joint, forces)) in all.iter_mut().zip(forces).enumerate() {
            let (t, mode) = (sample.t, P::joint_mode(&sample.mode, k));
            let y = block.in_paper_order(&part.joint_state(sample.y.as_ref(), k));
            joint.samples.push(JointSample { t, mode, y, forces });
        }
    }
    all
}
