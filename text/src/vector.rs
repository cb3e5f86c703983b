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
