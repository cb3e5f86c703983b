//! Square matrices by columns, and a dense LU factorisation in place.

use super::Scalar;

/// A square matrix, with its columns one after the other.
pub(crate) struct SquareMatrix {
    pub(super) n: usize,
    pub(super) columns: Vec<f64>,
}

impl SquareMatrix {
    /// The matrix of zeros with `n` rows.
    pub(super) fn zeros(n: usize) -> Self {
        Self { n, columns: vec![0.0; n * n] }
    }
}

/// Gaussian elimination with partial pivoting, in place.
pub(crate) struct DenseLu<T> {
    /// The upper triangle with inverted diagonal, and below it the multipliers.
    lu: Vec<T>,
    /// The row swapped up in each step of the elimination.
    pivots: Vec<usize>,
}

/// Calls the function with the number of states as a constant where it is one of the usual numbers. Loops of known
/// length are unrolled, and a solution then takes half the time or less (`benches/README.md`).
macro_rules! unrolled {
    ($work:ident($($argument:expr),*; $n:expr)) => {
        match $n {
            2 => $work($($argument),*, 2),
            4 => $work($($argument),*, 4),
            6 => $work($($argument),*, 6),
            9 => $work($($argument),*, 9),
            n => $work($($argument),*, n),
        }
    };
}

/// `y ← y + J x`.
pub(super) fn add_product(jacobian: &SquareMatrix, x: &[f64], y: &mut [f64]) {
    unrolled!(multiply(&jacobian.columns, x, y; x.len()));
}

/// Adds the product of the `n` columns and `x` to `y`.
#[inline(always)]
fn multiply(columns: &[f64], x: &[f64], y: &mut [f64], n: usize) {
    let (columns, x, y) = (&columns[..n * n], &x[..n], &mut y[..n]);
    for (j, x) in x.iter().enumerate() {
        for i in 0..n {
            y[i] += columns[j * n + i] * x;
        }
    }
}

impl<T: Scalar> DenseLu<T> {
    pub(crate) fn new(n: usize) -> Self {
        Self { lu: vec![T::real(0.0); n * n], pivots: vec![0; n] }
    }

    /// Makes it one of matrices with `n` rows.
    pub(crate) fn resize(&mut self, n: usize) {
        self.lu.resize(n * n, T::real(0.0));
        self.pivots.resize(n, 0);
    }

    /// Factorises `shift I − h J`, where `jacobian` are the columns of J.
    pub(crate) fn factorise(&mut self, jacobian: &[f64], shift: T, h: f64) {
        let n = self.pivots.len();
        for (lu, entry) in self.lu.iter_mut().zip(jacobian) {
            *lu = T::real(-h * entry);
        }
        for diagonal in self.lu.iter_mut().step_by(n + 1) {
            *diagonal += shift;
        }
        unrolled!(eliminate(&mut self.lu, &mut self.pivots; n));
    }

    /// Replaces `b` by the solution, which is not finite where the matrix is singular.
    pub(crate) fn solve(&self, b: &mut [T]) {
        unrolled!(substitute(&self.lu, &self.pivots, b; b.len()));
    }
}

/// Eliminates in the `n` columns of `lu`, with swaps of whole rows.
#[inline(always)]
fn eliminate<T: Scalar>(lu: &mut [T], pivots: &mut [usize], n: usize) {
    for k in 0..n {
        let column = &lu[k * n..][..n];
        let larger = |p: usize, i: usize| if column[i].size() > column[p].size() { i } else { p };
        let pivot = (k + 1..n).fold(k, larger);
        pivots[k] = pivot;
        if pivot != k {
            lu.chunks_exact_mut(n).for_each(|column| column.swap(k, pivot));
        }
        let (done, rest) = lu.split_at_mut((k + 1) * n);
        let column = &mut done[k * n..];
        let inverse = T::real(1.0) / column[k];
        column[k] = inverse;
        for entry in &mut column[k + 1..] {
            *entry *= inverse;
        }
        for other in rest.chunks_exact_mut(n) {
            let above = other[k];
            for (other, multiplier) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                *other -= above * *multiplier;
            }
        }
    }
}

/// Solves the system factorised in the `n` columns of `lu`: forward, then backward substitution.
#[inline(always)]
fn substitute<T: Scalar>(lu: &[T], pivots: &[usize], b: &mut [T], n: usize) {
    let (lu, b) = (&lu[..n * n], &mut b[..n]);
    // All swaps come first, so that the loops after them can keep `b` in registers.
    for (k, &pivot) in pivots[..n].iter().enumerate() {
        b.swap(k, pivot);
    }
    for k in 0..n {
        for i in k + 1..n {
            b[i] -= b[k] * lu[k * n + i];
        }
    }
    for k in (0..n).rev() {
        b[k] *= lu[k * n + k];
        for i in 0..k {
            b[i] -= b[k] * lu[k * n + i];
        }
    }
}
