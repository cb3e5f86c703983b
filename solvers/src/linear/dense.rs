//! A dense factorisation in place.

use nalgebra::DMatrix;

use crate::system::System;

/// Gaussian elimination with partial pivoting, in place.
pub(crate) struct Dense {
    jacobian: DMatrix<f64>,
    /// Upper triangle with inverted diagonal, and the multipliers below it.
    lu: DMatrix<f64>,
    /// The row that each step of the elimination swapped up.
    pivots: Vec<usize>,
}

impl Dense {
    pub(super) fn new(n: usize) -> Self {
        let zero = DMatrix::zeros(n, n);
        Self { jacobian: zero.clone(), lu: zero, pivots: vec![0; n] }
    }

    pub(super) fn evaluate<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) {
        self.jacobian.fill(0.0);
        problem.jacobian(mode, t, y, |i, j, entry| self.jacobian[(i, j)] = entry);
    }

    pub(super) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (column, x) in self.jacobian.as_slice().chunks_exact(x.len()).zip(x) {
            for (y, entry) in y.iter_mut().zip(column) {
                *y += entry * x;
            }
        }
    }

    pub(super) fn factorise(&mut self, shift: f64, h: f64) {
        let n = self.pivots.len();
        self.lu.zip_apply(&self.jacobian, |lu, entry| *lu = -h * entry);
        for i in 0..n {
            self.lu[(i, i)] += shift;
        }
        let columns = self.lu.as_mut_slice();
        for k in 0..n {
            let (done, rest) = columns.split_at_mut((k + 1) * n);
            let column = &mut done[k * n..];
            let larger = |p: usize, i: usize| if column[i].abs() > column[p].abs() { i } else { p };
            let pivot = (k + 1..n).fold(k, larger);
            self.pivots[k] = pivot;
            column.swap(k, pivot);
            column[k] = 1.0 / column[k];
            for i in k + 1..n {
                column[i] *= column[k];
            }
            for other in rest.chunks_exact_mut(n) {
                other.swap(k, pivot);
                let above = other[k];
                for (other, multiplier) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *other -= above * multiplier;
                }
            }
        }
    }

    pub(super) fn solve(&self, b: &mut [f64]) {
        let n = b.len();
        let columns = self.lu.as_slice().chunks_exact(n).enumerate();
        for ((k, column), &pivot) in columns.clone().zip(&self.pivots) {
            b.swap(k, pivot);
            let (above, below) = b.split_at_mut(k + 1);
            for (b, multiplier) in below.iter_mut().zip(&column[k + 1..]) {
                *b -= above[k] * multiplier;
            }
        }
        for (k, column) in columns.rev() {
            let (above, below) = b.split_at_mut(k);
            below[0] *= column[k];
            for (b, entry) in above.iter_mut().zip(column) {
                *b -= below[0] * entry;
            }
        }
    }
}
