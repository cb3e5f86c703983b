//! [`BouncingBall`] as a study knows it.

use deltazero_solvers::Record;
use deltazero_solvers::problems::{BouncingBall, BouncingMode};

use super::position_and_velocity;
use crate::problem::{Problem, Quantity, Role};
use crate::run::{Begun, OwnRun, Setting, at_once};

impl Problem for BouncingBall {
    fn start(&self) -> [f64; 2] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.height, (2.0 * self.gravity * self.height).sqrt())
    }

    fn role(&self, mode: &BouncingMode, _site: usize) -> Role {
        match mode {
            BouncingMode::Flight => Role::Free,
            BouncingMode::Rest => Role::Contact,
        }
    }

    fn tells_forces(&self) -> bool {
        false
    }

    fn runs_at_once(&self) -> bool {
        true
    }

    #[inline]
    fn integrate_at_once(
        runs: &[Begun<'_, Self>],
        setting: &Setting,
        t_end: f64,
        records: &mut [&mut dyn Record<Self>],
    ) -> Vec<OwnRun<Self>> {
        at_once(runs, setting, t_end, records)
    }
}
