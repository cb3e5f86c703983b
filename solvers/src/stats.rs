//! Counts of work, and what of it goes where.

use std::ops::{Add, AddAssign, ControlFlow, Sub};

use crate::record::{Accepted, Event, Needs, Record};
use crate::system::System;

/// Evaluations and linear algebra, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Evaluations of the right-hand side; none for Jacobians, samples or audits.
    pub n_rhs: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
}

/// What an integration cost, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// All work, that of rejected and retaken steps included.
    pub work: Work,
    /// What of it began phases: slopes at their starts and the choice of a first step.
    pub restart: Work,
    /// What of it located events: retaken steps, and stages of dense output for it.
    pub location: Work,
    /// Accepted steps; one that lands on an event counts once.
    pub n_accepted: u64,
    /// Those of them that [`auto`](crate::auto) took with its implicit half; none of another method.
    pub n_implicit: u64,
    /// Steps refused by their error estimate or by a failed Newton iteration.
    pub n_rejected: u64,
    /// Steps retaken from the same start to land on an event.
    pub n_retaken: u64,
    /// Transitions.
    pub n_events: u64,
}

impl Stats {
    /// The work of the steps alone, without restarts and location.
    pub fn stepping(&self) -> Work {
        self.work - self.restart - self.location
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.n_rhs += other.n_rhs;
        self.n_jac += other.n_jac;
        self.n_factorisations += other.n_factorisations;
        self.n_lin_solves += other.n_lin_solves;
    }
}

impl Add for Work {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sub for Work {
    type Output = Self;

    /// # Panics
    /// Where `other` is not a part of it.
    fn sub(self, other: Self) -> Self {
        Self {
            n_rhs: self.n_rhs - other.n_rhs,
            n_jac: self.n_jac - other.n_jac,
            n_factorisations: self.n_factorisations - other.n_factorisations,
            n_lin_solves: self.n_lin_solves - other.n_lin_solves,
        }
    }
}

impl AddAssign for Stats {
    fn add_assign(&mut self, other: Self) {
        self.work += other.work;
        self.restart += other.restart;
        self.location += other.location;
        self.n_accepted += other.n_accepted;
        self.n_implicit += other.n_implicit;
        self.n_rejected += other.n_rejected;
        self.n_retaken += other.n_retaken;
        self.n_events += other.n_events;
    }
}

impl Sub for Stats {
    type Output = Self;

    /// # Panics
    /// Where `other` is not a part of it.
    fn sub(self, other: Self) -> Self {
        Self {
            work: self.work - other.work,
            restart: self.restart - other.restart,
            location: self.location - other.location,
            n_accepted: self.n_accepted - other.n_accepted,
            n_implicit: self.n_implicit - other.n_implicit,
            n_rejected: self.n_rejected - other.n_rejected,
            n_retaken: self.n_retaken - other.n_retaken,
            n_events: self.n_events - other.n_events,
        }
    }
}

/// A recorder that splits the work of an integration by kinds of modes: flight, contact, stick.
///
/// Work is booked with accepted steps: that of a step that failed is in no kind. Counts that fall are
/// those of another integration, and counted from zero.
#[derive(Clone, Debug)]
pub struct WorkByKind<K, F> {
    kind: F,
    seen: Stats,
    /// Each kind met, in that order, with the work done in its modes: an event belongs to the mode
    /// that it ends.
    pub kinds: Vec<(K, Stats)>,
}

impl<K: PartialEq, F> WorkByKind<K, F> {
    /// Nothing seen yet; `kind` tells the kind of a mode.
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
        // Events are counted where they are seen.
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
