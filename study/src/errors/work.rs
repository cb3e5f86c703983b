//! Where the work of a run went: flight, contact, stick, restarts, location of events.

use deltazero_solvers::{Stats, Work};
use serde::{Deserialize, Serialize};

/// Evaluations and linear algebra, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Evaluations of the right-hand side of a part.
    pub n_rhs: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
}

impl From<Work> for Counts {
    fn from(work: Work) -> Self {
        let Work { n_rhs, n_jac, n_factorisations, n_lin_solves, .. } = work;
        Self { n_rhs, n_jac, n_factorisations, n_lin_solves }
    }
}

/// The steps of one phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhaseWork {
    /// Work of the steps, without restarts and location.
    #[serde(flatten)]
    pub counts: Counts,
    /// Accepted steps.
    pub n_accepted: u64,
    /// Rejected steps.
    pub n_rejected: u64,
    /// Events that ended it.
    pub n_events: u64,
}

/// What landing on events took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LocationWork {
    /// Work.
    #[serde(flatten)]
    pub counts: Counts,
    /// Steps retaken.
    pub n_retaken: u64,
}

/// The work of stepping in each phase that a run met, and that of all restarts and of all locations:
/// together all of it, but for a step that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorkByPhase {
    /// Held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pinned: Option<PhaseWork>,
    /// Free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flight: Option<PhaseWork>,
    /// Slipping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<PhaseWork>,
    /// Sticking.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stick: Option<PhaseWork>,
    /// Slopes at the starts of phases, and the choice of a first step.
    pub restart: Counts,
    /// Landing on events.
    pub location: LocationWork,
}

impl WorkByPhase {
    /// The work of phases by the names of [`Role::phase`](crate::problem::Role::phase), as
    /// [`WorkByKind`](deltazero_solvers::WorkByKind) has it for each problem.
    pub fn new(kinds: &[(&'static str, Stats)]) -> Self {
        let mut all = Stats::default();
        kinds.iter().for_each(|(_, stats)| all += *stats);
        let of = |phase: &str| {
            let mut own = Stats::default();
            kinds.iter().filter(|(of, _)| *of == phase).for_each(|(_, stats)| own += *stats);
            let Stats { n_accepted, n_rejected, n_events, .. } = own;
            let counts = Counts::from(own.stepping());
            (own != Stats::default()).then_some(PhaseWork {
                counts,
                n_accepted,
                n_rejected,
                n_events,
            })
        };
        Self {
            pinned: of("pinned"),
            flight: of("flight"),
            contact: of("contact"),
            stick: of("stick"),
            restart: all.restart.into(),
            location: LocationWork { counts: all.location.into(), n_retaken: all.n_retaken },
        }
    }

    /// Whether the problem tells which of its modes are contact, or hold it.
    pub fn tells_of_contact(&self) -> bool {
        self.pinned.is_some() || self.contact.is_some() || self.stick.is_some()
    }

    /// Right-hand sides for each transition that are there only because of it: restarts and location.
    pub fn n_rhs_per_event(&self) -> Option<f64> {
        let phases = [self.pinned, self.flight, self.contact, self.stick];
        let n_events: u64 = phases.iter().flatten().map(|phase| phase.n_events).sum();
        let n_rhs = self.restart.n_rhs + self.location.counts.n_rhs;
        (n_events > 0).then(|| n_rhs as f64 / n_events as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_told_by_phase_and_what_events_took_by_event() {
        let stats = |n_rhs: u64, n_events: u64| Stats {
            work: Work { n_rhs, n_jac: 7, ..Work::default() },
            restart: Work { n_rhs: n_rhs / 10, ..Work::default() },
            location: Work { n_rhs: n_rhs / 5, n_jac: 2, ..Work::default() },
            n_accepted: n_rhs / 4,
            n_retaken: n_events + 1,
            n_events,
            ..Stats::default()
        };
        // Two parts that fly, one that touches.
        let all = [("flight", stats(100, 2)), ("flight", stats(200, 3)), ("contact", stats(50, 1))];
        let work = WorkByPhase::new(&all);
        let flight = work.flight.unwrap();
        assert_eq!((flight.counts.n_rhs, flight.counts.n_jac), (300 - 30 - 60, 2 * (7 - 2)));
        assert_eq!((flight.n_accepted, flight.n_events), (75, 5));
        assert_eq!(work.contact.unwrap().counts.n_rhs, 50 - 5 - 10);
        assert_eq!((work.stick, work.pinned), (None, None));
        assert_eq!((work.restart.n_rhs, work.location.counts.n_rhs), (35, 70));
        assert_eq!((work.location.counts.n_jac, work.location.n_retaken), (6, 9));
        assert!(work.tells_of_contact());
        assert_eq!(work.n_rhs_per_event(), Some((35.0 + 70.0) / 6.0));

        let quiet = WorkByPhase::new(&[("flight", stats(100, 0))]);
        assert!(!quiet.tells_of_contact());
        assert_eq!(quiet.n_rhs_per_event(), None);
    }
}
