//! The compiled model as a [`Problem`].

use deltazero_solvers::{Record, Vector};
use deltazero_study::problem::{Problem, Quantity, Role};
use deltazero_study::run::{OwnRun, extended};

use crate::compile::role;
use crate::mode::Mode;
use crate::system::TextModel;
use crate::vector::Numbers;

impl Problem for TextModel {
    fn start(&self) -> Numbers<f64> {
        Numbers::from_fn(self.0.starts.len(), |i| self.0.starts[i])
    }

    fn states(&self) -> Vec<Quantity> {
        self.0.states.clone()
    }

    fn name(&self) -> String {
        self.0.part.clone()
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        role(self.0.modes[usize::from(mode.number)].role)
    }

    fn mode_name(&self, mode: &Mode, _site: usize) -> String {
        self.name_of(*mode).to_owned()
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: Numbers<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}
