use deltazero_solvers::problems::FrictionOscillator;

use super::position_and_velocity;
use crate::problem::{Problem, Quantity};

impl Problem for FrictionOscillator {
    fn start(&self) -> [f64; 2] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.release.abs(), self.omega() * self.release.abs())
    }
}
