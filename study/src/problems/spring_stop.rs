//! [`SpringStop`] as a study knows it.

use deltazero_solvers::Real;
use deltazero_solvers::problems::{SpringStop, StopMode};

use super::{on_a_spring, position_and_velocity, role_of};
use crate::problem::{Energy, Power, Problem, Quantity, Role, Touch};

impl Problem for SpringStop {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        // Without a gap, or where the stop is not reached, that of the swing on the spring alone.
        let (omega, [x, v]) = ((self.stiffness / self.mass).sqrt(), self.start);
        let swing = libm::hypot(x, v / omega);
        let above_zero = |size: f64, other: f64| if size > 0.0 { size } else { other };
        position_and_velocity(
            above_zero(self.gap, swing),
            above_zero(self.surface_speed(), omega * swing),
        )
    }

    fn role(&self, mode: &StopMode, _site: usize) -> Role {
        role_of(mode)
    }

    fn touch<S: Real>(
        &self,
        mode: &StopMode,
        _t: S,
        &[x, v]: &[S; 2],
        _site: usize,
    ) -> Option<Touch<S>> {
        let depth = x - self.gap;
        let force = match mode {
            StopMode::Free => S::cst(0.0),
            StopMode::Contact => depth * self.stop_stiffness,
        };
        Some(Touch { depth, rate: v, force })
    }

    fn energies(&self, mode: &StopMode, _t: f64, y: &[f64; 2]) -> Option<Energy> {
        let depth = y[0] - self.gap;
        let elastic = match mode {
            StopMode::Free => 0.0,
            StopMode::Contact => self.stop_stiffness * depth * depth,
        };
        Some(Energy { elastic: 0.5 * elastic, ..on_a_spring(self.mass, self.stiffness, *y) })
    }

    fn powers(&self, _mode: &StopMode, _t: f64, _y: &[f64; 2]) -> Option<Power> {
        Some(Power::default())
    }
}
