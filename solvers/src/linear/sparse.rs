//! A sparse factorisation, by `faer`.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::mat::MatMut;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Par};

use crate::system::System;

/// Part of the entries that a matrix held sparse has at most.
const DENSITY: f64 = 0.25;

/// A sparse factorisation: the pattern analysed once, the values factorised in the same memory.
pub(crate) struct Sparse {
    pattern: SymbolicSparseColMat<usize>,
    jacobian: Vec<f64>,
    shifted: Vec<f64>,
    symbolic: Option<SymbolicLu<usize>>,
    numeric: NumericLu<usize, f64>,
    is_singular: bool,
    memory: MemBuffer,
}

impl Sparse {
    pub(super) fn new(n: usize) -> Self {
        Self {
            pattern: SymbolicSparseColMat::new_checked(n, n, vec![0; n + 1], None, Vec::new()),
            jacobian: Vec::new(),
            shifted: Vec::new(),
            symbolic: None,
            numeric: NumericLu::new(),
            is_singular: false,
            memory: MemBuffer::new(StackReq::EMPTY),
        }
    }

    /// Index of the entry in row `i` of column `j`, if the pattern has it.
    fn position(pattern: &SymbolicSparseColMat<usize>, i: usize, j: usize) -> Option<usize> {
        let column = pattern.col_range(j);
        let found = pattern.row_idx()[column.clone()].binary_search(&i);
        found.ok().map(|k| column.start + k)
    }

    pub(super) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (j, x) in x.iter().enumerate() {
            let column = self.pattern.col_range(j);
            let rows = &self.pattern.row_idx()[column.clone()];
            for (i, entry) in rows.iter().zip(&self.jacobian[column]) {
                y[*i] += entry * x;
            }
        }
    }

    /// Evaluates the Jacobian; false where it has too many entries to be held sparse.
    pub(super) fn evaluate<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> bool {
        self.jacobian.fill(0.0);
        let mut is_complete = true;
        problem.jacobian(mode, t, y, |i, j, entry| match Self::position(&self.pattern, i, j) {
            Some(k) => self.jacobian[k] = entry,
            None => is_complete = false,
        });
        is_complete || (self.widen(problem, mode, t, y) && self.evaluate(problem, mode, t, y))
    }

    /// Adds the entries of this Jacobian, and the diagonal, to the pattern; false where there are too
    /// many.
    fn widen<P: System>(&mut self, problem: &P, mode: P::Mode, t: f64, y: &P::State<f64>) -> bool {
        let n = problem.dim();
        let mut rows: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
        for (j, rows) in rows.iter_mut().enumerate() {
            rows.extend(&self.pattern.row_idx()[self.pattern.col_range(j)]);
        }
        problem.jacobian(mode, t, y, |i, j, _| rows[j].push(i));
        let mut starts = vec![0];
        let mut all = Vec::new();
        for mut rows in rows {
            rows.sort_unstable();
            rows.dedup();
            all.extend(rows);
            starts.push(all.len());
        }
        if all.len() as f64 > DENSITY * (n * n) as f64 {
            return false;
        }
        self.jacobian = vec![0.0; all.len()];
        self.shifted = self.jacobian.clone();
        self.pattern = SymbolicSparseColMat::new_checked(n, n, starts, None, all);
        self.symbolic =
            factorize_symbolic_lu(self.pattern.as_ref(), LuSymbolicParams::default()).ok();
        let Some(symbolic) = &self.symbolic else {
            return false;
        };
        self.numeric = NumericLu::new();
        self.memory = MemBuffer::new(
            symbolic
                .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
                .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)),
        );
        true
    }

    pub(super) fn factorise(&mut self, shift: f64, h: f64) {
        for (shifted, entry) in self.shifted.iter_mut().zip(&self.jacobian) {
            *shifted = -h * entry;
        }
        for i in 0..self.pattern.ncols() {
            if let Some(k) = Self::position(&self.pattern, i, i) {
                self.shifted[k] += shift;
            }
        }
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), self.shifted.as_slice());
        let stack = MemStack::new(&mut self.memory);
        self.is_singular = match &self.symbolic {
            Some(symbolic) => symbolic
                .factorize_numeric_lu(
                    &mut self.numeric,
                    matrix,
                    Par::Seq,
                    stack,
                    Default::default(),
                )
                .is_err(),
            None => true,
        };
    }

    pub(super) fn solve(&mut self, b: &mut [f64]) {
        let Some(symbolic) = self.symbolic.as_ref().filter(|_| !self.is_singular) else {
            b.fill(f64::NAN);
            return;
        };
        let n = b.len();
        let b = MatMut::from_column_major_slice_mut(b, n, 1);
        let stack = MemStack::new(&mut self.memory);
        LuRef::new_unchecked(symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            stack,
        );
    }
}
