//! The naive right-hand side: the mode is read off the state at every call, as a model written
//! with `if` does.

use deltazero::model::{Block, State};
use deltazero_solvers::{ModeOfState, System};

/// `ẏ = f(y)` of one joint.
#[inline]
pub(crate) fn rhs(block: &Block, y: &State<f64>, dydt: &mut State<f64>) {
    block.rhs(block.mode_of_state(0.0, y), 0.0, y, dydt);
}

/// Calls `entry(i, j, ∂f_i/∂y_j)` for all entries of its Jacobian.
pub(crate) fn jacobian(block: &Block, y: &State<f64>, entry: impl FnMut(usize, usize, f64)) {
    block.jacobian(block.mode_of_state(0.0, y), 0.0, y, entry);
}

/// The state in a slice; not a number where it has no six entries.
#[inline]
pub(crate) fn state(y: &[f64]) -> State<f64> {
    y.try_into().unwrap_or([f64::NAN; 6])
}
