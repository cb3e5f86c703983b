//! A run joint by joint, of whatever parts it is made.

use deltazero_solvers::{Grid, Next, Sample, Switch, Trajectory};
use deltazero_study::trace::OwnTrajectory;

use super::BlockTrajectory;
use crate::model::{Jointed, Mode};

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
