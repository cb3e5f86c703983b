//! A sparse matrix whose pattern grows as entries appear, and its factorisation by `faer`.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::mat::MatMut;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, Par};

use super::{Entries, Scalar};

/// Number of states from which on a sparse factorisation is tried.
const MANY: usize = 32;

/// Whether a matrix of `n` rows may be sparse.
pub(crate) fn may_be_sparse(n: usize) -> bool {
    n >= MANY
}

/// Largest fraction of nonzero entries of a matrix that is held sparse.
const DENSITY: f64 = 0.25;

/// A scalar that can be factorised.
pub(crate) trait Factorised: faer::traits::ComplexField {}

impl<T: faer::traits::ComplexField> Factorised for T {}

/// Index of the entry in row `i` of column `j`, if the pattern has it.
pub(crate) fn position(
    pattern: SymbolicSparseColMatRef<'_, usize>,
    i: usize,
    j: usize,
) -> Option<usize> {
    let column = pattern.col_range(j);
    let found = pattern.row_idx()[column.clone()].binary_search(&i);
    found.ok().map(|k| column.start + k)
}

/// A matrix with the pattern of all entries that have appeared so far.
pub(crate) struct SparseMatrix {
    pattern: SymbolicSparseColMat<usize>,
    entries: Vec<f64>,
}

impl SparseMatrix {
    /// A matrix without entries, where there are many states.
    pub(super) fn for_many(n: usize) -> Option<Self> {
        let pattern = || SymbolicSparseColMat::new_checked(n, n, vec![0; n + 1], None, Vec::new());
        may_be_sparse(n).then(|| Self { pattern: pattern(), entries: Vec::new() })
    }

    /// The row of an entry that is not finite, if there is one.
    pub(super) fn non_finite_row(&self) -> Option<usize> {
        let entry = self.entries.iter().position(|entry| !entry.is_finite())?;
        self.pattern.row_idx().get(entry).copied()
    }

    pub(super) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (j, x) in x.iter().enumerate() {
            let column = self.pattern.col_range(j);
            let rows = &self.pattern.row_idx()[column.clone()];
            for (i, entry) in rows.iter().zip(&self.entries[column]) {
                y[*i] += entry * x;
            }
        }
    }

    /// Sets all entries. Returns false where there are too many to be held sparse.
    pub(super) fn set(&mut self, all: &impl Entries) -> bool {
        self.entries.fill(0.0);
        // The pattern contains the diagonal once it contains any entry.
        let mut is_complete = !self.entries.is_empty();
        all.for_each(|i, j, entry| match position(self.pattern.as_ref(), i, j) {
            Some(k) => self.entries[k] = entry,
            None => is_complete = false,
        });
        if is_complete {
            return true;
        }
        let mut new = Vec::new();
        all.for_each(|i, j, _| new.push((i, j)));
        self.widen(all.n(), &new) && self.set(all)
    }

    /// Adds these entries `(i, j)`, and the diagonal, to the pattern of `n` rows. Returns false where they are too many.
    fn widen(&mut self, n: usize, new: &[(usize, usize)]) -> bool {
        let mut rows: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
        for (j, rows) in rows.iter_mut().enumerate() {
            rows.extend(&self.pattern.row_idx()[self.pattern.col_range(j)]);
        }
        new.iter().for_each(|&(i, j)| rows[j].push(i));
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
        self.entries = vec![0.0; all.len()];
        self.pattern = SymbolicSparseColMat::new_checked(n, n, starts, None, all);
        true
    }
}

/// A sparse factorisation. Each pattern is analysed once; the values are factorised in the same memory.
pub(crate) struct SparseLu<T> {
    shifted: Vec<T>,
    symbolic: Option<SymbolicLu<usize>>,
    numeric: NumericLu<usize, T>,
    is_singular: bool,
    memory: MemBuffer,
}

impl<T: Scalar> SparseLu<T> {
    /// Workspace where there are many states.
    pub(super) fn for_many(n: usize) -> Option<Self> {
        may_be_sparse(n).then(Self::new)
    }

    pub(crate) fn new() -> Self {
        Self {
            shifted: Vec::new(),
            symbolic: None,
            numeric: NumericLu::new(),
            is_singular: true,
            memory: MemBuffer::new(StackReq::EMPTY),
        }
    }

    /// Computes the symbolic factorisation of a pattern.
    fn analyse(&mut self, pattern: SymbolicSparseColMatRef<'_, usize>) {
        self.numeric = NumericLu::new();
        self.symbolic = factorize_symbolic_lu(pattern, LuSymbolicParams::default()).ok();
        if let Some(symbolic) = &self.symbolic {
            self.memory = MemBuffer::new(
                symbolic
                    .factorize_numeric_lu_scratch::<T>(Par::Seq, Default::default())
                    .or(symbolic.solve_in_place_scratch::<T>(1, Par::Seq)),
            );
        }
    }

    pub(super) fn factorise(&mut self, matrix: &SparseMatrix, shift: T, h: f64) {
        // A pattern never loses entries, so a pattern with the same number of entries is the one analysed last.
        if self.shifted.len() != matrix.entries.len() {
            self.shifted = vec![T::real(0.0); matrix.entries.len()];
            self.symbolic = None;
        }
        for (shifted, entry) in self.shifted.iter_mut().zip(&matrix.entries) {
            *shifted = T::real(-h * entry);
        }
        for i in 0..matrix.pattern.ncols() {
            if let Some(k) = position(matrix.pattern.as_ref(), i, i) {
                self.shifted[k] += shift;
            }
        }
        let shifted = std::mem::take(&mut self.shifted);
        self.factorise_matrix(SparseColMatRef::new(matrix.pattern.as_ref(), shifted.as_slice()));
        self.shifted = shifted;
    }

    /// Factorises `matrix`, whose pattern must be that of the last factorised one.
    pub(crate) fn factorise_matrix(&mut self, matrix: SparseColMatRef<'_, usize, T>) {
        if self.symbolic.is_none() {
            self.analyse(matrix.symbolic());
        }
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

    pub(crate) fn solve(&mut self, b: &mut [T]) {
        let Some(symbolic) = self.symbolic.as_ref().filter(|_| !self.is_singular) else {
            b.fill(T::real(f64::NAN));
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
