//! [`SlidingStops`] as a study knows it.

use deltazero_solvers::problems::{Block, SlidingStops, StopsMode, Wall};

use super::position_and_velocity;
use crate::problem::{Energy, Power, Problem, Quantity, Role};

/// It slides on the ground, and sticks there or at a stop; neither tells what it presses with.
impl Problem for SlidingStops {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.gap, (2.0 * self.drive * self.gap / self.mass).sqrt())
    }

    fn role(&self, mode: &StopsMode, _site: usize) -> Role {
        match mode.block {
            Block::Slides(_) => Role::Contact,
            Block::At(_) | Block::Rests => Role::Stick,
        }
    }

    fn code(&self, mode: &StopsMode, site: usize) -> i8 {
        match mode.block {
            Block::Slides(Wall::Left) => -1,
            _ => self.role(mode, site).code(),
        }
    }

    /// Where it sticks.
    fn mode_number(&self, mode: &StopsMode) -> u16 {
        match mode.block {
            Block::Slides(_) | Block::Rests => 0,
            Block::At(Wall::Left) => 1,
            Block::At(Wall::Right) => 2,
        }
    }

    fn tells_forces(&self) -> bool {
        false
    }

    fn unit_of_time(&self) -> f64 {
        self.half_period
    }

    fn energies(&self, _mode: &StopsMode, _t: f64, &[_, v]: &[f64; 2]) -> Option<Energy> {
        Some(Energy { kinetic: 0.5 * self.mass * v * v, elastic: 0.0 })
    }

    fn powers(&self, mode: &StopsMode, _t: f64, &[_, v]: &[f64; 2]) -> Option<Power> {
        let (drive, friction) = (self.force(*mode) * v, self.friction * v.abs());
        Some(Power { drive, damping: 0.0, friction })
    }

    /// Every impact.
    fn takes_energy(&self, before: &StopsMode, after: &StopsMode) -> bool {
        matches!((before.block, after.block), (Block::Slides(_), Block::At(_)))
    }
}
