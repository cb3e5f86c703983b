//! Vectors of states and guards: few numbers in place, many on the heap.

use std::fmt;

use deltazero_solvers::Vector;

/// Numbers that are held in place, at most.
const FEW: usize = 8;

/// The states, or the guards, of a model from a file.
#[derive(Clone)]
pub enum Numbers<S> {
    /// The first so many of these.
    Few(usize, [S; FEW]),
    /// More than that, or none.
    Many(Vec<S>),
}

impl<S> AsRef<[S]> for Numbers<S> {
    #[inline(always)]
    fn as_ref(&self) -> &[S] {
        match self {
            Self::Few(n, numbers) => &numbers[..*n],
            Self::Many(numbers) => numbers,
        }
    }
}

impl<S> AsMut<[S]> for Numbers<S> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [S] {
        match self {
            Self::Few(n, numbers) => &mut numbers[..*n],
            Self::Many(numbers) => numbers,
        }
    }
}

impl<S: fmt::Debug> fmt::Debug for Numbers<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_ref().fmt(f)
    }
}

impl<S: PartialEq> PartialEq for Numbers<S> {
    fn eq(&self, other: &Self) -> bool {
        self.as_ref() == other.as_ref()
    }
}

impl<S: Copy + fmt::Debug> Vector<S> for Numbers<S> {
    #[inline(always)]
    fn from_fn(n: usize, mut entry: impl FnMut(usize) -> S) -> Self {
        if n == 0 || n > FEW {
            return Self::Many((0..n).map(entry).collect());
        }
        let mut numbers = [entry(0); FEW];
        for (i, number) in numbers.iter_mut().enumerate().take(n).skip(1) {
            *number = entry(i);
        }
        Self::Few(n, numbers)
    }

    #[inline(always)]
    fn take(&mut self) -> Self {
        std::mem::replace(self, Self::Many(Vec::new()))
    }
}
