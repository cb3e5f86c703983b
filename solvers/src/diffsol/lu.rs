//! The linear systems of the methods of `diffsol`, by the elimination of our own.

use diffsol_la::error::{LaError, LinearSolverError};
use diffsol_la::{
    LinearOp, LinearSolver, Matrix as _, MatrixCommon as _, NalgebraContext, Vector as _,
};

use super::equations::{M, V};
use crate::linear::DenseLu;

/// An iteration matrix and its factors; none before its size is known.
#[derive(Default)]
pub(crate) struct Lu(Option<(M, DenseLu<f64>)>);

impl LinearSolver<M> for Lu {
    fn set_sparsity<C: LinearOp<T = f64, V = V, M = M, C = NalgebraContext>>(&mut self, op: &C) {
        let (n, context) = (op.nrows(), *op.context());
        self.0 = Some((M::new_from_sparsity(n, n, op.sparsity(), context), DenseLu::new(n)));
    }

    fn set_linearisation<C: LinearOp<T = f64, V = V, M = M, C = NalgebraContext>>(
        &mut self,
        op: &C,
    ) {
        if let Some((matrix, lu)) = &mut self.0 {
            op.matrix_inplace(matrix);
            lu.factorise(matrix.inner(), 0.0, -1.0);
        }
    }

    fn solve_in_place(&self, b: &mut V) -> Result<(), LaError> {
        let Some((_, lu)) = &self.0 else {
            return Err(LinearSolverError::LuNotInitialized.into());
        };
        let b = b.inner_mut().as_mut_slice();
        lu.solve(b);
        if b.iter().all(|b| b.is_finite()) {
            Ok(())
        } else {
            Err(LinearSolverError::LuSolveFailed.into())
        }
    }

    /// Systems of the transposed matrix are those of adjoint solutions, which are not offered here.
    fn solve_transpose_in_place(&self, _b: &mut V) -> Result<(), LaError> {
        Err(LinearSolverError::LuNotInitialized.into())
    }
}
