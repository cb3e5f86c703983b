//! The linear systems of the methods of `diffsol`, solved by the factorisations of this crate.

use std::cell::RefCell;

use diffsol::{FaerSparseMat, FaerVec, NalgebraMat, NalgebraVec};
use diffsol_la::error::{LaError, LinearSolverError};
use diffsol_la::{
    FaerContext, LinearOp, LinearSolver, Matrix as _, MatrixCommon as _, NalgebraContext,
    Vector as _,
};

use crate::linear::{DenseLu, SparseLu};

/// An error unless the solution in `b` is finite; that of a singular matrix is not.
fn solved(b: &[f64]) -> Result<(), LaError> {
    if b.iter().all(|b| b.is_finite()) {
        Ok(())
    } else {
        Err(LinearSolverError::LuSolveFailed.into())
    }
}

/// An iteration matrix and its factors; `None` before its size is known.
#[derive(Default)]
pub(crate) struct DenseSolver(Option<(NalgebraMat<f64>, DenseLu<f64>)>);

impl LinearSolver<NalgebraMat<f64>> for DenseSolver {
    fn set_sparsity<
        C: LinearOp<T = f64, V = NalgebraVec<f64>, M = NalgebraMat<f64>, C = NalgebraContext>,
    >(
        &mut self,
        op: &C,
    ) {
        let (n, context) = (op.nrows(), *op.context());
        self.0 = Some((C::M::new_from_sparsity(n, n, op.sparsity(), context), DenseLu::new(n)));
    }

    fn set_linearisation<
        C: LinearOp<T = f64, V = NalgebraVec<f64>, M = NalgebraMat<f64>, C = NalgebraContext>,
    >(
        &mut self,
        op: &C,
    ) {
        if let Some((matrix, lu)) = &mut self.0 {
            op.matrix_inplace(matrix);
            lu.factorise(matrix.inner().as_slice(), 0.0, -1.0);
        }
    }

    fn solve_in_place(&self, b: &mut NalgebraVec<f64>) -> Result<(), LaError> {
        let Some((_, lu)) = &self.0 else {
            return Err(LinearSolverError::LuNotInitialized.into());
        };
        let b = b.inner_mut().as_mut_slice();
        lu.solve(b);
        solved(b)
    }

    /// Transposed systems occur only in adjoint solutions, which are not supported.
    fn solve_transpose_in_place(&self, _b: &mut NalgebraVec<f64>) -> Result<(), LaError> {
        Err(LinearSolverError::LuNotInitialized.into())
    }
}

/// A sparse iteration matrix and its factors; `None` before its pattern is known.
#[derive(Default)]
pub(crate) struct SparseSolver(Option<(FaerSparseMat<f64>, RefCell<SparseLu<f64>>)>);

impl LinearSolver<FaerSparseMat<f64>> for SparseSolver {
    fn set_sparsity<
        C: LinearOp<T = f64, V = FaerVec<f64>, M = FaerSparseMat<f64>, C = FaerContext>,
    >(
        &mut self,
        op: &C,
    ) {
        let (n, context) = (op.nrows(), *op.context());
        let matrix = C::M::new_from_sparsity(n, n, op.sparsity(), context);
        self.0 = Some((matrix, RefCell::new(SparseLu::new())));
    }

    fn set_linearisation<
        C: LinearOp<T = f64, V = FaerVec<f64>, M = FaerSparseMat<f64>, C = FaerContext>,
    >(
        &mut self,
        op: &C,
    ) {
        if let Some((matrix, lu)) = &mut self.0 {
            op.matrix_inplace(matrix);
            lu.get_mut().factorise_matrix(matrix.inner()[0].as_ref());
        }
    }

    fn solve_in_place(&self, b: &mut FaerVec<f64>) -> Result<(), LaError> {
        let Some((_, lu)) = &self.0 else {
            return Err(LinearSolverError::LuNotInitialized.into());
        };
        let b = b.inner_mut().col_as_slice_mut(0);
        lu.borrow_mut().solve(b);
        solved(b)
    }

    /// Not supported, as for [`DenseSolver`].
    fn solve_transpose_in_place(&self, _b: &mut FaerVec<f64>) -> Result<(), LaError> {
        Err(LinearSolverError::LuNotInitialized.into())
    }
}
