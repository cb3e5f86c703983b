use deltazero_solvers::Real;
use deltazero_solvers::problems::{SpringStop, StopMode};

use super::position_and_velocity;
use crate::problem::{Problem, Quantity, Role, Touch};

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
        match mode {
            StopMode::Free => Role::Free,
            StopMode::Contact => Role::Contact,
        }
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
}
