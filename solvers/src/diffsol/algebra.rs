//! The vectors and matrices that `diffsol` computes with: dense for few states, sparse for many.

use diffsol::{DefaultDenseMatrix, FaerSparseMat, FaerVec, NalgebraMat, NalgebraVec};
use diffsol_la::{
    Context, FaerContext, LinearSolver, Matrix, MatrixSparsity, NalgebraContext, Vector,
    VectorCommon as _,
};

use super::lu::{DenseSolver, SparseSolver};
use crate::linear::position;

/// A kind of linear algebra.
pub(crate) trait Algebra: Sized + 'static {
    type C: Context + Default;
    type V: Vector<T = f64, C = Self::C> + DefaultDenseMatrix<T = f64, C = Self::C>;
    type M: Matrix<T = f64, V = Self::V, C = Self::C>;
    type Solver: LinearSolver<Self::M>;

    /// The components of a vector.
    fn components(x: &Self::V) -> &[f64];

    /// The components of a vector, mutable.
    fn components_mut(x: &mut Self::V) -> &mut [f64];

    /// A sparsity pattern of `n` states with these entries; `None` for a dense matrix.
    fn pattern(
        n: usize,
        entries: impl FnOnce() -> Vec<(usize, usize)>,
    ) -> Option<<Self::M as Matrix>::Sparsity>;

    /// Makes all entries zero.
    fn clear(matrix: &mut Self::M);

    /// Writes the entry in row `i` of column `j`, and returns whether the matrix has a place for it.
    fn set(matrix: &mut Self::M, i: usize, j: usize, entry: f64) -> bool;
}

/// Dense linear algebra by `nalgebra`.
pub(crate) struct Dense;

impl Algebra for Dense {
    type C = NalgebraContext;
    type V = NalgebraVec<f64>;
    type M = NalgebraMat<f64>;
    type Solver = DenseSolver;

    #[inline]
    fn components(x: &Self::V) -> &[f64] {
        x.inner().as_slice()
    }

    #[inline]
    fn components_mut(x: &mut Self::V) -> &mut [f64] {
        x.inner_mut().as_mut_slice()
    }

    fn pattern(
        _n: usize,
        _entries: impl FnOnce() -> Vec<(usize, usize)>,
    ) -> Option<<Self::M as Matrix>::Sparsity> {
        None
    }

    fn clear(matrix: &mut Self::M) {
        matrix.inner_mut().fill(0.0);
    }

    #[inline]
    fn set(matrix: &mut Self::M, i: usize, j: usize, entry: f64) -> bool {
        matrix.inner_mut()[(i, j)] = entry;
        true
    }
}

/// Sparse linear algebra by `faer`.
pub(crate) struct Sparse;

impl Algebra for Sparse {
    type C = FaerContext;
    type V = FaerVec<f64>;
    type M = FaerSparseMat<f64>;
    type Solver = SparseSolver;

    fn components(x: &Self::V) -> &[f64] {
        x.inner().col_as_slice(0)
    }

    fn components_mut(x: &mut Self::V) -> &mut [f64] {
        x.inner_mut().col_as_slice_mut(0)
    }

    fn pattern(
        n: usize,
        entries: impl FnOnce() -> Vec<(usize, usize)>,
    ) -> Option<<Self::M as Matrix>::Sparsity> {
        MatrixSparsity::<Self::M>::try_from_indices(n, n, entries()).ok()
    }

    fn clear(matrix: &mut Self::M) {
        matrix.inner_mut()[0].val_mut().fill(0.0);
    }

    fn set(matrix: &mut Self::M, i: usize, j: usize, entry: f64) -> bool {
        let matrix = &mut matrix.inner_mut()[0];
        let place = position(matrix.symbolic(), i, j);
        if let Some(k) = place {
            matrix.val_mut()[k] = entry;
        }
        place.is_some()
    }
}
