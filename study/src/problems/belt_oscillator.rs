//! [`BeltOscillator`] as a study knows it.

use deltazero_solvers::problems::{BeltMode, BeltOscillator};

use super::{on_a_spring, position_and_velocity};
use crate::problem::{Energy, Power, Problem, Quantity, Role};

/// The belt drives the mass by friction; what presses it on the belt is not told.
impl Problem for BeltOscillator {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        let length = self.static_friction / self.stiffness;
        position_and_velocity(length, self.belt_speed.max(self.omega() * length))
    }

    fn role(&self, mode: &BeltMode, _site: usize) -> Role {
        if *mode == BeltMode::Stick { Role::Stick } else { Role::Contact }
    }

    fn code(&self, mode: &BeltMode, site: usize) -> i8 {
        if *mode == BeltMode::SlipMinus { -1 } else { self.role(mode, site).code() }
    }

    fn tells_forces(&self) -> bool {
        false
    }

    fn energies(&self, _mode: &BeltMode, _t: f64, y: &[f64; 2]) -> Option<Energy> {
        Some(on_a_spring(self.mass, self.stiffness, *y))
    }

    fn powers(&self, mode: &BeltMode, _t: f64, &[x, v]: &[f64; 2]) -> Option<Power> {
        let pull = match mode {
            BeltMode::Stick => self.stiffness * x,
            BeltMode::SlipPlus => -self.kinetic_friction,
            BeltMode::SlipMinus => self.kinetic_friction,
        };
        let friction = pull * (self.belt_speed - v);
        Some(Power { drive: pull * self.belt_speed, damping: 0.0, friction })
    }
}
