//! The event-blind baseline: the mode is read off the state at every stage.

use std::ops::ControlFlow;

use crate::record::{Accepted, Event, Record};
use crate::system::{ModeOfState, Next, System};

/// A system without guards whose right-hand side looks up its mode in the state, as a model
/// written with `if` statements does.
///
/// A step whose stages straddle a surface has order one or two, whatever the method; this is what
/// [located](crate::integrate) runs are compared with.
#[derive(Clone, Copy, Debug)]
pub struct Blind<'a, P>(pub &'a P);

impl<P: ModeOfState> System for Blind<'_, P> {
    type Mode = ();
    type State<S: crate::Real> = P::State<S>;
    type Guards<S: crate::Real> = [S; 0];

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn n_guards(&self) -> usize {
        0
    }

    fn initial_mode(&self, _t: f64, _y: &Self::State<f64>) {}

    fn rhs<S: crate::Real>(&self, (): (), t: S, y: &Self::State<S>, dydt: &mut Self::State<S>) {
        self.0.rhs(self.0.mode_of_state(t, y), t, y, dydt);
    }

    fn guards<S: crate::Real>(&self, (): (), _t: S, _y: &Self::State<S>, _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &Self::State<f64>, _bounds: &mut [f64; 0]) {}

    fn transition<S: crate::Real>(
        &self,
        (): (),
        _guard: usize,
        _t: S,
        _y: &mut Self::State<S>,
    ) -> Next<()> {
        Next::Mode(())
    }

    fn jacobian(&self, (): (), t: f64, y: &Self::State<f64>, entry: impl FnMut(usize, usize, f64)) {
        self.0.jacobian(self.0.mode_of_state(t, y), t, y, entry);
    }
}

/// Shows a blind run to a recorder of the underlying system: each step in the mode that its start
/// has, and an event at the end of each step after which the mode differs.
pub struct Unblind<'a, P: System, R> {
    problem: &'a P,
    mode: P::Mode,
    record: R,
}

impl<'a, P: ModeOfState, R: Record<P>> Unblind<'a, P, R> {
    /// A run of `Blind(problem)` from `(t, y)`, shown to `record`.
    pub fn new(problem: &'a P, t: f64, y: &P::State<f64>, record: R) -> Self {
        Self { problem, mode: problem.mode_of_state(t, y), record }
    }
}

impl<'a, P: ModeOfState, R: Record<P>> Record<Blind<'a, P>> for Unblind<'a, P, R> {
    fn step(&mut self, accepted: &Accepted<'_, Blind<'a, P>>) -> ControlFlow<()> {
        let (step, before) = (accepted.step, self.mode);
        let seen = Accepted { mode: before, step, landed_on: None, stats: accepted.stats };
        let go_on = self.record.step(&seen);
        let after = self.problem.mode_of_state(step.t1(), step.y1());
        if after == before || go_on.is_break() {
            return go_on;
        }
        self.mode = after;
        let (t, y) = (step.t1(), step.y1());
        self.record.event(&Event { t, guard: 0, before, after: Next::Mode(after), y })
    }

    fn event(&mut self, _: &Event<'_, Blind<'a, P>>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
