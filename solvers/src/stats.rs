//! Counts of work.

/// What an integration cost, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Evaluations of the right-hand side, rejected and retaken steps included; none for
    /// Jacobians, samples or audits.
    pub n_rhs: u64,
    /// Accepted steps; one that lands on an event counts once.
    pub n_accepted: u64,
    /// Steps refused by their error estimate or by a failed Newton iteration.
    pub n_rejected: u64,
    /// Steps retaken from the same start to land on an event.
    pub n_retaken: u64,
    /// Transitions.
    pub n_events: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
}

impl std::ops::AddAssign for Stats {
    fn add_assign(&mut self, other: Self) {
        self.n_rhs += other.n_rhs;
        self.n_accepted += other.n_accepted;
        self.n_rejected += other.n_rejected;
        self.n_retaken += other.n_retaken;
        self.n_events += other.n_events;
        self.n_jac += other.n_jac;
        self.n_factorisations += other.n_factorisations;
        self.n_lin_solves += other.n_lin_solves;
    }
}
