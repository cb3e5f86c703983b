//! A dense factorisation in place.

use nalgebra::{ComplexField, DMatrix};

/// `y ← y + J x`.
pub(super) fn add_product(jacobian: &DMatrix<f64>, x: &[f64], y: &mut [f64]) {
    for (column, x) in jacobian.as_slice().chunks_exact(x.len()).zip(x) {
        for (y, entry) in y.iter_mut().zip(column) {
            *y += entry * x;
        }
    }
}

/// Gaussian elimination with partial pivoting, in place.
pub(crate) struct DenseLu<T> {
    /// Upper triangle with inverted diagonal, and the multipliers below it.
    lu: DMatrix<T>,
    /// The row that each step of the elimination swapped up.
    pivots: Vec<usize>,
}

impl<T: ComplexField<RealField = f64> + Copy> DenseLu<T> {
    pub(super) fn new(n: usize) -> Self {
        Self { lu: DMatrix::zeros(n, n), pivots: vec![0; n] }
    }

    pub(super) fn factorise(&mut self, jacobian: &DMatrix<f64>, shift: T, h: f64) {
        let n = self.pivots.len();
        self.lu.zip_apply(jacobian, |lu, entry| *lu = T::from_real(-h * entry));
        for i in 0..n {
            self.lu[(i, i)] += shift;
        }
        let columns = self.lu.as_mut_slice();
        for k in 0..n {
            let (done, rest) = columns.split_at_mut((k + 1) * n);
            let column = &mut done[k * n..];
            let larger =
                |p: usize, i: usize| if column[i].norm1() > column[p].norm1() { i } else { p };
            let pivot = (k + 1..n).fold(k, larger);
            self.pivots[k] = pivot;
            column.swap(k, pivot);
            let inverse = T::one() / column[k];
            column[k] = inverse;
            for entry in &mut column[k + 1..] {
                *entry *= inverse;
            }
            for other in rest.chunks_exact_mut(n) {
                other.swap(k, pivot);
                let above = other[k];
                for (other, multiplier) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *other -= above * *multiplier;
                }
            }
        }
    }

    pub(super) fn solve(&self, b: &mut [T]) {
        let n = b.len();
        let columns = self.lu.as_slice().chunks_exact(n).enumerate();
        for ((k, column), &pivot) in columns.clone().zip(&self.pivots) {
            b.swap(k, pivot);
            let (above, below) = b.split_at_mut(k + 1);
            for (b, multiplier) in below.iter_mut().zip(&column[k + 1..]) {
                *b -= above[k] * *multiplier;
            }
        }
        for (k, column) in columns.rev() {
            let (above, below) = b.split_at_mut(k);
            below[0] *= column[k];
            for (b, entry) in above.iter_mut().zip(column) {
                *b -= below[0] * *entry;
            }
        }
    }
}
