//! A run of a chain: all its bays together, events located.

use std::time::{Duration, Instant};

use deltazero_solvers::{
    Control, Error, Integration, Method, Next, Outcome, Record, Stats, Switch, Tolerance,
    Trajectory,
};

use super::{Accuracy, ModeChange};
use crate::model::chain::{Chain, Modes};

/// What became of a chain.
#[derive(Clone, Debug)]
pub struct ChainRun {
    /// How it ended.
    pub outcome: Result<Outcome, Error>,
    /// Time of the last accepted step [s].
    pub t: f64,
    /// State there.
    pub y: Vec<f64>,
    /// Modes there.
    pub modes: Modes,
    /// Work; an evaluation of the right-hand side is one of all bays.
    pub stats: Stats,
    /// Time that the integration took.
    pub wall: Duration,
}

impl ChainRun {
    /// The bay, from 1, that an error is about, where it is about one.
    pub fn failed_bay(&self) -> Option<usize> {
        match self.outcome.as_ref().err()? {
            Error::NonFinite { component, .. } => Some(Chain::bay_of_state(*component) + 1),
            Error::NonFiniteGuard { guard, .. } | Error::Chatter { guard, .. } => {
                Some(Chain::bay_of(*guard) + 1)
            }
            _ => None,
        }
    }
}

/// Samples and events of a chain.
pub type ChainTrajectory = Trajectory<Vec<f64>, Modes>;

/// Integrates `chain` from `y0` at t = 0 to `t_end`, shown to `record`.
///
/// There is no blind run of a chain: it would be a second copy of every method, for a baseline that one
/// bay has shown.
pub fn integrate_chain(
    chain: &Chain,
    method: &Method,
    accuracy: Accuracy,
    y0: Vec<f64>,
    t_end: f64,
    record: &mut dyn Record<Chain>,
) -> ChainRun {
    let start = Instant::now();
    let control = match accuracy {
        Accuracy::Step(step) => Control::Fixed(step),
        Accuracy::Rtol(rtol, atol) => {
            let atol = match atol {
                None => chain.scale().iter().map(|scale| rtol * scale).collect(),
                Some(atol) => atol.each().repeat(chain.bays),
            };
            Control::Adaptive(Tolerance { rtol, atol })
        }
    };
    let mut run = Integration::new(chain, 0.0, y0);
    let outcome = chain.bay.check().and_then(|()| method.solver(chain, control));
    let outcome = outcome.and_then(|mut solver| run.run(t_end, &mut *solver, record));
    let (point, stats) = (run.point, run.stats);
    let (t, y, modes) = (point.t, point.y, point.mode);
    let outcome = (0..chain.bays).fold(outcome, |outcome, k| {
        chain.bay.judged(outcome, t, modes[k], &Chain::state_of(&y, k))
    });
    ChainRun { outcome, t, y, modes, stats, wall: start.elapsed() }
}

/// Contacts of all bays that began at the floor of the impact speed or below it.
pub(super) fn chain_contacts_at_floor(chain: &Chain, trajectory: &ChainTrajectory) -> usize {
    let is_at_floor = |switch: &&Switch<Modes>| match &switch.after {
        Next::Mode(after) => {
            let k = Chain::bay_of(switch.guard);
            chain.bay.begins_at_floor(switch.before[k], after[k])
        }
        Next::Stop => false,
    };
    trajectory.events.iter().filter(is_at_floor).count()
}

/// The mode changes of each bay among the events of a chain.
pub fn chain_mode_changes(chain: &Chain, trajectory: &ChainTrajectory) -> Vec<Vec<ModeChange>> {
    let mut changes = vec![Vec::new(); chain.bays];
    for switch in &trajectory.events {
        let Next::Mode(after) = &switch.after else { continue };
        let k = Chain::bay_of(switch.guard);
        let (before, after) = (switch.before[k].code(), after[k].code());
        if before != after {
            changes[k].push(ModeChange { t: switch.t, before, after });
        }
    }
    changes
}
