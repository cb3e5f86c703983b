//! Energy balance and contacts of a run together, on the same points of its steps.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Needs, Record};

use crate::energy_balance::EnergyBalance;
use crate::errors::contacts::Contacts;
use crate::problem::Problem;
use crate::quadrature::nodes_of_order;
use crate::setting::Events;

/// A recorder of energy balance and contacts. Most of what it costs is the dense output, which is looked at once.
pub(crate) struct Account<'a, P: Problem> {
    pub(crate) balance: EnergyBalance<'a, P>,
    pub(crate) contacts: Contacts<'a, P>,
}

impl<'a, P: Problem> Account<'a, P> {
    /// A recorder for a run of `problem` from `y0`. `order` is the order of the method: it selects the quadrature.
    pub(crate) fn new(problem: &'a P, order: usize, events: Events, y0: &P::State<f64>) -> Self {
        let nodes = nodes_of_order(order);
        let balance = EnergyBalance::with(nodes, problem, events, y0);
        Self { balance, contacts: Contacts::with(nodes, problem, events) }
    }
}

impl<P: Problem> Record<P> for Account<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.balance.step(accepted)?;
        if !self.balance.is_given() {
            return self.contacts.step(accepted);
        }
        if self.contacts.feels(&accepted.mode) {
            self.contacts.add(accepted, self.balance.points.all());
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.balance.event(event)?;
        self.contacts.event(event)
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.balance.needs(t0, t1).max(self.contacts.needs(t0, t1))
    }
}
