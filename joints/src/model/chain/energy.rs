//! Energies and powers of one state of a chain.

use deltazero_study::problem::{Energy, Power};

use super::{Chain, Modes};

impl Chain {
    /// Energies of `y` in `modes`, summed over the bays: kinetic of absolute velocities, elastic of the
    /// contacts.
    pub fn energy(&self, modes: &Modes, y: &[f64]) -> Energy {
        let mut sum = Energy::default();
        let mut bush = [0.0; 2];
        for k in 0..self.bays {
            let mut y = self.state_of(y, k);
            y[3] += bush[0];
            y[4] += bush[1];
            let energy = self.bay.energy(modes[k], &y);
            sum.kinetic += energy.kinetic;
            sum.elastic += energy.elastic;
            bush = [y[3] + self.reach() * libm::cos(y[2]) * y[5], y[4]];
        }
        sum
    }

    /// Powers at `y` in `modes`, summed over the bays.
    pub fn power(&self, modes: &Modes, y: &[f64]) -> Power {
        let mut sum = Power::default();
        self.along(modes, y, 0..self.bays, |k, motion| {
            let power = self.bay.power_under(modes[k], &motion.y, motion.contact);
            sum.drive += power.drive;
            sum.damping += power.damping;
            sum.friction += power.friction;
        });
        sum
    }
}
