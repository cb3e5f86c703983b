//! Counts of work, in total and by purpose.

use std::ops::{Add, AddAssign, Sub};

/// Counts of evaluations and of linear algebra.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Run, Work};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let run = Run::of(&ball, ball.start()).method("rk4").step(0.01).to(0.1)?;
/// // Ten steps of four evaluations, after the slope at the start.
/// assert_eq!(run.stats.work, Work { n_rhs: 41, ..Work::default() });
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Work {
    /// Evaluations of the right-hand side, except those for Jacobians, samples and audits.
    pub n_rhs: u64,
    /// Those of them that were Taylor series of the right-hand side and the guards.
    pub n_series: u64,
    /// Evaluations of the Jacobian.
    pub n_jac: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Solutions of linear systems.
    pub n_lin_solves: u64,
}

/// Counts of all work of an integration.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::Run;
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let stats = Run::of(&ball, ball.start()).method("rk45").tolerance(1e-6, 1e-6).to(1.0)?.stats;
/// assert_eq!(stats.n_events, 2);
/// let rest = stats.restart.n_rhs + stats.location.n_rhs;
/// assert_eq!(stats.stepping().n_rhs, stats.work.n_rhs - rest);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stats {
    /// All work, including that of rejected and retaken steps.
    pub work: Work,
    /// The part that began phases: slopes at their starts and the choice of a first step.
    pub restart: Work,
    /// The part that located events: retaken steps, and stages of dense output for the search.
    pub location: Work,
    /// Accepted steps. A step that lands on an event counts once, however often it was retaken.
    pub n_accepted: u64,
    /// Accepted steps that [`auto`](crate::auto) took with its implicit method; zero for other methods.
    pub n_implicit: u64,
    /// Steps rejected because of their error estimate, a failed Newton iteration, or an end that was not finite.
    pub n_rejected: u64,
    /// Steps retaken from the same start to land on an event, or shortened to where the guards have series.
    pub n_retaken: u64,
    /// Transitions.
    pub n_events: u64,
    /// Guards that came within the error of the method of their surface: each is a [`Grazing`](crate::Grazing).
    pub n_grazing: u64,
}

impl Stats {
    /// The work of the steps alone, without restarts and the location of events.
    pub fn stepping(&self) -> Work {
        self.work - self.restart - self.location
    }
}

impl Work {
    /// Counts a Taylor series, which is an evaluation too.
    pub(crate) fn add_series(&mut self) {
        self.n_rhs += 1;
        self.n_series += 1;
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.n_rhs += other.n_rhs;
        self.n_series += other.n_series;
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
    /// Where a count of `other` is larger, in a build with overflow checks.
    fn sub(self, other: Self) -> Self {
        Self {
            n_rhs: self.n_rhs - other.n_rhs,
            n_series: self.n_series - other.n_series,
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
        self.n_grazing += other.n_grazing;
    }
}

impl Sub for Stats {
    type Output = Self;

    /// # Panics
    /// Where a count of `other` is larger, in a build with overflow checks.
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
            n_grazing: self.n_grazing - other.n_grazing,
        }
    }
}
