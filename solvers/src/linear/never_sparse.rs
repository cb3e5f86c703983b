//! What stands for sparse matrices in a build without the feature `sparse`: types without values.

use std::convert::Infallible;
use std::marker::PhantomData;

use super::Entries;

/// Any scalar.
pub(crate) trait Factorised {}

impl<T> Factorised for T {}

/// Never.
pub(crate) fn may_be_sparse(_n: usize) -> bool {
    false
}

pub(crate) struct SparseMatrix(Infallible);

impl SparseMatrix {
    pub(super) fn for_many(_n: usize) -> Option<Self> {
        None
    }

    pub(super) fn set(&mut self, _all: &impl Entries) -> bool {
        match self.0 {}
    }

    pub(super) fn non_finite_row(&self) -> Option<usize> {
        match self.0 {}
    }

    pub(super) fn add_product(&self, _x: &[f64], _y: &mut [f64]) {
        match self.0 {}
    }
}

pub(crate) struct SparseLu<T>(Infallible, PhantomData<T>);

impl<T> SparseLu<T> {
    pub(super) fn for_many(_n: usize) -> Option<Self> {
        None
    }

    pub(super) fn factorise(&mut self, _matrix: &SparseMatrix, _shift: T, _h: f64) {
        match self.0 {}
    }

    pub(super) fn solve(&mut self, _b: &mut [T]) {
        match self.0 {}
    }
}
