//! The linear systems of the methods of `diffsol`, solved by the factorisations of this crate.

use std::cell::RefCell;

use diffsol_la::error::{LaError, LinearSolverError};
use diffsol_la::{LinearOp, LinearSolver, Matrix as _, MatrixCommon as _};

use super::algebra::{Algebra, Dense, Sparse};
use crate::linear::{DenseLu, SparseLu};

type Matrix<A> = <A as Algebra>::M;
type Vector<A> = <A as Algebra>::V;
type Context<A> = <A as Algebra>::C;

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
pub(crate) struct DenseSolver(Option<(Matrix<Dense>, DenseLu<f64>)>);

impl LinearSolver<Matrix<Dense>> for DenseSolver {
    fn set_sparsity<
        C: LinearOp<T = f64, V = Vector<Dense>, M = Matrix<Dense>, C = Context<Dense>>,
    >(
        &mut self,
        op: &C,
    ) {
        let (n, context) = (op.nrows(), *op.context());
        self.0 = Some((C::M::new_from_sparsity(n, n, op.sparsity(), context), DenseLu::new(n)));
    }

    fn set_linearisation<
        C: LinearOp<T = f64, V = Vector<Dense>, M = Matrix<Dense>, C = Context<Dense>>,
    >(
        &mut self,
        op: &C,
    ) {
        if let Some((matrix, lu)) = &mut self.0 {
            op.matrix_inplace(matrix);
            lu.factorise(matrix.inner().as_slice(), 0.0, -1.0);
        }
    }

    fn solve_in_place(&self, b: &mut Vector<Dense>) -> Result<(), LaError> {
        let Some((_, lu)) = &self.0 else {
            return Err(LinearSolverError::LuNotInitialized.into());
        };
        let b = Dense::components_mut(b);
        lu.solve(b);
        solved(b)
    }

    /// Transposed systems occur only in adjoint solutions, which are not supported.
    fn solve_transpose_in_place(&self, _b: &mut Vector<Dense>) -> Result<(), LaError> {
        Err(LinearSolverError::LuNotInitialized.into())
    }
}

/// A sparse iteration matrix and its factors; `None` before its pattern is known.
#[derive(Default)]
pub(crate) struct SparseSolver(Option<(Matrix<Sparse>, RefCell<SparseLu<f64>>)>);

impl LinearSolver<Matrix<Sparse>> for SparseSolver {
    fn set_sparsity<
        C: LinearOp<T = f64, V = Vector<Sparse>, M = Matrix<Sparse>, C = Context<Sparse>>,
    >(
        &mut self,
        op: &C,
    ) {
        let (n, context) = (op.nrows(), *op.context());
        let matrix = C::M::new_from_sparsity(n, n, op.sparsity(), context);
        self.0 = Some((matrix, RefCell::new(SparseLu::new())));
    }

    fn set_linearisation<
        C: LinearOp<T = f64, V = Vector<Sparse>, M = Matrix<Sparse>, C = Context<Sparse>>,
    >(
        &mut self,
        op: &C,
    ) {
        if let Some((matrix, lu)) = &mut self.0 {
            op.matrix_inplace(matrix);
            lu.get_mut().factorise_matrix(matrix.inner()[0].as_ref());
        }
    }

    fn solve_in_place(&self, b: &mut Vector<Sparse>) -> Result<(), LaError> {
        let Some((_, lu)) = &self.0 else {
            return Err(LinearSolverError::LuNotInitialized.into());
        };
        let b = Sparse::components_mut(b);
        lu.borrow_mut().solve(b);
        solved(b)
    }

    /// Not supported, as for [`DenseSolver`].
    fn solve_transpose_in_place(&self, _b: &mut Vector<Sparse>) -> Result<(), LaError> {
        Err(LinearSolverError::LuNotInitialized.into())
    }
}
