//! Counts of work by kinds of modes.

use std::ops::ControlFlow;

pub use crate::work::{Stats, Work};

use crate::record::{Accepted, Event, Needs, Record};
use crate::system::System;

/// A recorder that splits the work of an integration by kinds of modes, such as flight, contact and stick.
///
/// Work is assigned when a step is accepted, to the kind of its mode; the work after the last accepted step of a run
/// that fails is assigned to no kind. Counts that fall are taken as the start of another integration and counted from
/// zero.
///
/// ```
/// use deltazero_solvers::problems::{HertzBall, StopMode};
/// use deltazero_solvers::{Control, Integration, Method, Tolerance, WorkByKind};
///
/// let ball = HertzBall { mass: 1.0, stiffness: 1e4, exponent: 1.5, start: [-0.1, 1.0] };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("rk45").ok_or("no such method")?.solver(&ball, control)?;
/// let mut by_kind = WorkByKind::new(|mode: StopMode| mode);
/// let mut run = Integration::new(&ball, 0.0, ball.start);
/// run.run(1.0, &mut *solver, &mut by_kind)?;
/// let [(StopMode::Free, flight), (StopMode::Contact, contact)] = by_kind.kinds[..] else {
///     panic!("it flies, and touches")
/// };
/// assert!(contact.n_accepted > flight.n_accepted);
/// assert_eq!(contact.work.n_rhs + flight.work.n_rhs, run.stats.work.n_rhs);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct WorkByKind<K, F> {
    kind: F,
    seen: Stats,
    /// Each kind met, in the order of first meeting, with the work done in its modes. An event is counted for the
    /// mode that it ends.
    pub kinds: Vec<(K, Stats)>,
}

impl<K: PartialEq, F> WorkByKind<K, F> {
    /// An empty recorder; `kind` gives the kind of a mode.
    pub fn new(kind: F) -> Self {
        Self { kind, seen: Stats::default(), kinds: Vec::new() }
    }

    fn add(&mut self, kind: K, work: Stats) {
        match self.kinds.iter_mut().find(|known| known.0 == kind) {
            Some(known) => known.1 += work,
            None => self.kinds.push((kind, work)),
        }
    }
}

impl<P: System, K: PartialEq, F: Fn(P::Mode) -> K> Record<P> for WorkByKind<K, F> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        // Events are counted in `event`.
        let now = Stats { n_events: 0, ..*accepted.stats };
        if now.work.n_rhs < self.seen.work.n_rhs || now.n_accepted < self.seen.n_accepted {
            self.seen = Stats::default();
        }
        self.add((self.kind)(accepted.mode.clone()), now - self.seen);
        self.seen = now;
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.add((self.kind)(event.before.clone()), Stats { n_events: 1, ..Stats::default() });
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}
