//! The energy balance of a run: a recorder that integrates powers over each step, and what it tells of the run.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Next, Record};

pub use crate::balance::Balance;

use crate::points::{Points, mode_inside};
use crate::problem::{Energy, Power, Problem};
use crate::quadrature::{GAUSS, Nodes};
use crate::self_check::SelfCheck;
use crate::setting::Events;

/// Integrates the powers of one problem along its run: Gauss quadrature on the dense output of every step. Of a problem
/// without energies there is no balance.
pub struct EnergyBalance<'a, P: Problem> {
    problem: &'a P,
    events: Events,
    is_given: bool,
    start: f64,
    work: f64,
    dissipated: f64,
    /// Kinetic energy now, before an event.
    kinetic: f64,
    /// What the balance says against the run.
    pub check: SelfCheck,
    /// The points of the step that was added last.
    pub(crate) points: Points<P>,
}

impl<'a, P: Problem> EnergyBalance<'a, P> {
    /// The balance of a run of `problem` from `y0` that treats events in this way.
    pub fn new(problem: &'a P, events: Events, y0: &P::State<f64>) -> Self {
        Self::with(&GAUSS, problem, events, y0)
    }

    /// As [`new`](Self::new), the powers integrated by the quadrature of `nodes`.
    pub(crate) fn with(nodes: Nodes, problem: &'a P, events: Events, y0: &P::State<f64>) -> Self {
        let energy = problem.energies(&problem.initial_mode(0.0, y0), 0.0, y0);
        let (is_given, Energy { kinetic, elastic }) =
            (energy.is_some(), energy.unwrap_or_default());
        let start = kinetic + elastic;
        let check = SelfCheck::of(problem.laws(), start);
        let points = Points::of(nodes);
        Self {
            problem,
            events,
            is_given,
            start,
            work: 0.0,
            dissipated: 0.0,
            kinetic,
            check,
            points,
        }
    }

    /// The balance at the end of the run, at `(t, y)` in `mode`; none where no energies are given.
    pub fn at(&self, mode: &P::Mode, t: f64, y: &P::State<f64>) -> Option<Balance> {
        let Energy { kinetic, elastic } = self.problem.energies(mode, t, y)?;
        let Self { work, dissipated, .. } = *self;
        let residual = work + self.start - kinetic - elastic - dissipated;
        Some(Balance { work, kinetic, elastic, dissipated, residual })
    }

    /// Whether the problem tells of energies.
    pub(crate) fn is_given(&self) -> bool {
        self.is_given
    }
}

impl<P: Problem> Record<P> for EnergyBalance<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let mode = mode_inside(self.problem, self.events, &accepted.mode, step.t1(), step.y1());
        if self.is_given {
            let drive_work = self.problem.drive_work(step.y0(), step.y1());
            self.work += drive_work.unwrap_or(0.0);
            self.points.look(self.problem, self.events, accepted);
            for node in self.points.nodes() {
                let power = self.problem.powers(&node.mode, node.t, &node.y);
                let power: Power = power.unwrap_or_default();
                self.dissipated += node.weight * power.dissipated();
                self.check
                    .note_dissipation(node.weight * power.damping, node.weight * power.friction);
                if drive_work.is_none() {
                    self.work += node.weight * power.drive;
                }
            }
            if let Some(balance) = self.at(&mode, step.t1(), step.y1()) {
                self.kinetic = balance.kinetic;
                self.check.note_balance(step.t1(), &balance);
            }
        }
        for site in 0..self.problem.n_sites() {
            if self.problem.role(&mode, site).is_contact()
                && let Some(touch) = self.problem.touch(&mode, step.t1(), step.y1(), site)
            {
                self.check.note_penetration(step.t1(), touch.depth);
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        // What ends a run may take energy, too.
        let after = if let Next::Mode(after) = &event.after { after } else { &event.before };
        let energy = |mode, y| self.problem.energies(mode, event.t, y);
        let sides = energy(&event.before, event.y_before).zip(energy(after, event.y));
        if let Some((dented, energy)) = sides {
            // A contact that ends or begins at δ = 0 holds no energy there; a blind run sees it later.
            if self.problem.takes_energy(&event.before, after) {
                let impact = self.kinetic - energy.kinetic;
                self.dissipated += impact + (dented.elastic - energy.elastic);
            }
            self.kinetic = energy.kinetic;
        }
        ControlFlow::Continue(())
    }
}
