//! The energy balance of a run: a recorder that integrates powers over each step.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Next, Record};
use serde::Serialize;

use crate::model::{Block, Mode, State};

/// Nodes and weights of Gauss–Legendre quadrature on [0, 1], exact to degree five.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Where the energy went, all in J, summed over blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
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

/// Integrates the powers of one block along its run: three-point Gauss quadrature on the dense
/// output of every step.
#[derive(Clone, Debug)]
pub struct EnergyBalance<'a> {
    block: &'a Block,
    start: f64,
    work: f64,
    dissipated: f64,
}

impl<'a> EnergyBalance<'a> {
    /// The balance of a run of `block` from `y0` in `mode`.
    pub fn new(block: &'a Block, mode: Mode, y0: &State<f64>) -> Self {
        let energy = block.energy(mode, y0);
        let start = energy.kinetic + energy.elastic;
        Self { block, start, work: 0.0, dissipated: 0.0 }
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
            step.interpolate(step.t0() + node * h, &mut y);
            self.dissipated += weight * h * self.block.power(accepted.mode, &y).dissipated;
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, Block>) -> ControlFlow<()> {
        if let Next::Mode(after) = event.after {
            let elastic = |mode| self.block.energy(mode, event.y).elastic;
            self.dissipated += elastic(event.before) - elastic(after);
        }
        ControlFlow::Continue(())
    }
}
