//! [`Thermostat`] as a study knows it.

use deltazero_solvers::problems::{Heater, Thermostat};

use crate::problem::{Problem, Quantity};

impl Problem for Thermostat {
    fn start(&self) -> [f64; 1] {
        [self.start]
    }

    /// The size of the temperature is the width of its band.
    fn states(&self) -> Vec<Quantity> {
        vec![Quantity::new("T", "K", self.high - self.low)]
    }

    fn mode_number(&self, mode: &Heater) -> u16 {
        u16::from(*mode == Heater::On)
    }

    fn unit_of_time(&self) -> f64 {
        self.time_constant()
    }
}
