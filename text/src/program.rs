//! Formulas ready to be run: by machine code with `f64` where there is such, else by their tape.

use deltazero_solvers::Real;

use crate::graph::{Graph, Id};
use crate::machine::Machine;
use crate::tape::{Inputs, Tape};

/// A tape, with its machine code once it has run often.
#[derive(Debug)]
pub(crate) struct Program {
    pub(crate) tape: Tape,
    pub(crate) machine: Machine,
}

impl Program {
    /// The program of one group of formulas.
    pub(crate) fn of(graph: &Graph, outputs: &[Id]) -> Self {
        Self::of_two(graph, outputs, &[])
    }

    /// The program of two groups, of which the first can be run alone.
    pub(crate) fn of_two(graph: &Graph, first: &[Id], second: &[Id]) -> Self {
        Self { tape: Tape::of(graph, first, second), machine: Machine::default() }
    }

    /// How many results the first group has.
    pub(crate) fn n_first(&self) -> usize {
        self.tape.first_outputs.len()
    }

    /// How many results the second group has.
    pub(crate) fn n_second(&self) -> usize {
        self.tape.second_outputs.len()
    }

    /// Writes the results of the first group.
    #[inline]
    pub(crate) fn run<S: Real>(&self, inputs: &Inputs<'_, S>, outputs: &mut [S]) {
        self.run_in(inputs, outputs, None);
    }

    /// Writes the results of both groups.
    #[inline]
    pub(crate) fn run_both<S: Real>(
        &self,
        inputs: &Inputs<'_, S>,
        first: &mut [S],
        second: &mut [S],
    ) {
        self.run_in(inputs, first, Some(second));
    }

    #[inline(always)]
    fn run_in<S: Real>(
        &self,
        inputs: &Inputs<'_, S>,
        first: &mut [S],
        mut second: Option<&mut [S]>,
    ) {
        if let (Some(y), Some(first)) = (S::as_f64s(inputs.y), S::as_f64s_mut(first)) {
            let inputs = Inputs { t: inputs.t.value(), y, held: inputs.held };
            let second = second.as_deref_mut().and_then(S::as_f64s_mut);
            if self.machine.run(&self.tape, &inputs, first, second) {
                return;
            }
        }
        self.tape.interpret(inputs, first, second);
    }
}
