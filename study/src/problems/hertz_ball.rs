//! [`HertzBall`] as a study knows it.

use deltazero_solvers::Real;
use deltazero_solvers::problems::{HertzBall, StopMode};

use super::role_of;
use crate::problem::{Energy, Power, Problem, Quantity, Role, Touch};

impl Problem for HertzBall {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        let (depth, speed) = (self.greatest_penetration(), self.start[1].abs());
        vec![Quantity::new("delta", "m", depth), Quantity::new("delta_dot", "m/s", speed)]
    }

    fn role(&self, mode: &StopMode, _site: usize) -> Role {
        role_of(mode)
    }

    fn touch<S: Real>(
        &self,
        mode: &StopMode,
        _t: S,
        &[depth, rate]: &[S; 2],
        _site: usize,
    ) -> Option<Touch<S>> {
        let force = match mode {
            StopMode::Free => S::cst(0.0),
            StopMode::Contact => self.force(depth),
        };
        Some(Touch { depth, rate, force })
    }

    /// Of a dented wall `K δⁿ⁺¹/(n + 1)`.
    fn energies(&self, mode: &StopMode, _t: f64, &[delta, rate]: &[f64; 2]) -> Option<Energy> {
        let elastic = match mode {
            StopMode::Free => 0.0,
            StopMode::Contact => self.force(delta) * delta / (self.exponent + 1.0),
        };
        Some(Energy { kinetic: 0.5 * self.mass * rate * rate, elastic })
    }

    fn powers(&self, _mode: &StopMode, _t: f64, _y: &[f64; 2]) -> Option<Power> {
        Some(Power::default())
    }
}
