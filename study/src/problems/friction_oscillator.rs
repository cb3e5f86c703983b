//! [`FrictionOscillator`] as a study knows it.

use deltazero_solvers::problems::{FrictionMode, FrictionOscillator};

use super::{on_a_spring, position_and_velocity};
use crate::problem::{Energy, Power, Problem, Quantity, Role};

/// What presses the mass on its surface is not told, only the friction.
impl Problem for FrictionOscillator {
    fn start(&self) -> [f64; 2] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        let length = self.release.abs().max(self.friction / self.stiffness);
        position_and_velocity(length, self.omega() * length)
    }

    fn role(&self, mode: &FrictionMode, _site: usize) -> Role {
        if *mode == FrictionMode::Stick { Role::Stick } else { Role::Contact }
    }

    fn code(&self, mode: &FrictionMode, site: usize) -> i8 {
        if *mode == FrictionMode::SlipMinus { -1 } else { self.role(mode, site).code() }
    }

    fn tells_forces(&self) -> bool {
        false
    }

    fn energies(&self, _mode: &FrictionMode, _t: f64, y: &[f64; 2]) -> Option<Energy> {
        Some(on_a_spring(self.mass, self.stiffness, *y))
    }

    fn powers(&self, _mode: &FrictionMode, _t: f64, &[_, v]: &[f64; 2]) -> Option<Power> {
        Some(Power { friction: self.friction * v.abs(), ..Power::default() })
    }
}
