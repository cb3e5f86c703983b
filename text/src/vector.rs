//! Vectors of states and guards.

use std::fmt::Debug;

use deltazero_solvers::{Real, Vector};

/// The types of vectors of a model.
///
/// A model can always be run with states on the heap, [`Any`]. Where the program that uses it is compiled for its number of
/// states, [`Few`], explicit methods and Taylor series take half as long or less, because a short array stays in registers.
pub trait Family: Clone + Copy + Debug + Default + Send + Sync + 'static {
    /// The states, of numbers `S`.
    type State<S: Real>: Vector<S>;
}

/// States on the heap, any number of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Any;

impl Family for Any {
    type State<S: Real> = Vec<S>;
}

/// `N` states in an array.
#[derive(Clone, Copy, Debug, Default)]
pub struct Few<const N: usize>;

impl<const N: usize> Family for Few<N> {
    type State<S: Real> = [S; N];
}

/// Numbers that are zero at first, up to `N` of them without memory of their own.
pub(crate) struct Buffer<S, const N: usize> {
    few: [S; N],
    many: Vec<S>,
    n: usize,
}

impl<S: Real, const N: usize> Buffer<S, N> {
    #[inline]
    pub(crate) fn new(n: usize) -> Self {
        let zero = S::cst(0.0);
        let many = if n > N { vec![zero; n] } else { Vec::new() };
        Self { few: [zero; N], many, n }
    }

    #[inline]
    pub(crate) fn numbers(&mut self) -> &mut [S] {
        if self.n > N { &mut self.many } else { &mut self.few[..self.n] }
    }
}
