//! The energy balance of a run: a recorder that integrates powers over each step.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Next, Record, System as _};
use serde::{Deserialize, Serialize};

use crate::config::Events;
use crate::model::{Block, Mode, State};
use crate::quadrature::GAUSS;
use crate::run::mode_within;

/// Where the energy went, all in J, summed over blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Work of the drive torques.
    pub work: f64,
    /// Kinetic energy at the end.
    pub kinetic: f64,
    /// Elastic energy of the contacts at the end.
    pub elastic: f64,
    /// Taken by damping, by friction, and left in the bush where contact ends without adhesion.
    pub dissipated: f64,
    /// `work + energy at the start − kinetic − elastic − dissipated`: zero for an exact run of a
    /// consistent reading (`pin`, `full`).
    pub residual: f64,
}

impl std::ops::AddAssign for Balance {
    fn add_assign(&mut self, other: Self) {
        self.work += other.work;
        self.kinetic += other.kinetic;
        self.elastic += other.elastic;
        self.dissipated += other.dissipated;
        self.residual += other.residual;
    }
}

/// Integrates the powers of one block along its run: five-point Gauss quadrature on the dense
/// output of every step.
#[derive(Clone, Debug)]
pub struct EnergyBalance<'a> {
    block: &'a Block,
    events: Events,
    start: f64,
    work: f64,
    dissipated: f64,
}

impl<'a> EnergyBalance<'a> {
    /// The balance of a run of `block` from `y0` that treats events in this way.
    pub fn new(block: &'a Block, events: Events, y0: &State<f64>) -> Self {
        let energy = block.energy(block.initial_mode(0.0, y0), y0);
        let start = energy.kinetic + energy.elastic;
        Self { block, events, start, work: 0.0, dissipated: 0.0 }
    }

    /// The balance at the end of the run, at `y` in `mode`.
    pub fn at(&self, mode: Mode, y: &State<f64>) -> Balance {
        let energy = self.block.energy(mode, y);
        let Self { work, dissipated, .. } = *self;
        let residual = work + self.start - energy.kinetic - energy.elastic - dissipated;
        Balance { work, kinetic: energy.kinetic, elastic: energy.elastic, dissipated, residual }
    }
}

impl Record<Block> for EnergyBalance<'_> {
    fn step(&mut self, accepted: &Accepted<'_, Block>) -> ControlFlow<()> {
        let step = accepted.step;
        let h = step.t1() - step.t0();
        self.work += self.block.torque * (step.y1()[2] - step.y0()[2]);
        let mut y = *step.y0();
        for (node, weight) in GAUSS {
            let t = step.t0() + node * h;
            step.interpolate(t, &mut y);
            let mode = mode_within(self.block, self.events, accepted.mode, t, &y);
            self.dissipated += weight * h * self.block.power(mode, &y).dissipated;
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, Block>) -> ControlFlow<()> {
        // A contact that ends or begins at δ = 0 holds no energy there; a blind run sees it later.
        if let Next::Mode(after) = event.after
            && [event.before, after].iter().any(|mode| matches!(mode, Mode::Relaxing(_)))
        {
            let elastic = |mode| self.block.energy(mode, event.y).elastic;
            self.dissipated += elastic(event.before) - elastic(after);
        }
        ControlFlow::Continue(())
    }
}
