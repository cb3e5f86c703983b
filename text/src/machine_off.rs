//! What stands for machine code in a build without it.

use crate::tape::{Inputs, Tape};

/// No machine code.
#[derive(Debug, Default)]
pub(crate) struct Machine {}

impl Machine {
    /// Runs nothing.
    #[inline(always)]
    pub(crate) fn run(
        &self,
        _tape: &Tape,
        _inputs: &Inputs<'_, f64>,
        _first: &mut [f64],
        _second: Option<&mut [f64]>,
    ) -> bool {
        false
    }
}
