//! The linear systems of implicit methods, `(s I − h J) x = b` with a real or complex shift `s`: dense for few
//! states, sparse for many where the feature `sparse` is on.

mod dense;
#[cfg(feature = "sparse")]
mod sparse;
#[cfg(not(feature = "sparse"))]
#[path = "never_sparse.rs"]
mod sparse;

use std::ops::{AddAssign, Div, Mul, MulAssign, SubAssign};

use num_complex::Complex;

use crate::system::System;
pub(crate) use dense::DenseLu;
use dense::SquareMatrix;
use sparse::SparseMatrix;
#[cfg(feature = "diffsol")]
pub(crate) use sparse::position;
pub(crate) use sparse::{Factorised, SparseLu, may_be_sparse};

/// A scalar of linear systems: real or complex.
pub(crate) trait Scalar:
    Copy + Factorised + AddAssign + SubAssign + MulAssign + Mul<Output = Self> + Div<Output = Self>
{
    /// The real number `x`.
    fn real(x: f64) -> Self;

    /// `|Re| + |Im|`.
    fn size(self) -> f64;

    /// Calls `factorise_any`. It is not generic, so that it is compiled in this crate alone; so with the next.
    fn factorise(shifted: &mut Shifted<Self>, jacobian: &Jacobian, shift: Self, h: f64);

    /// Calls `solve_any`.
    fn solve(shifted: &mut Shifted<Self>, b: &mut [Self]);
}

impl Scalar for f64 {
    #[inline(always)]
    fn real(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn size(self) -> f64 {
        self.abs()
    }

    fn factorise(shifted: &mut Shifted<Self>, jacobian: &Jacobian, shift: Self, h: f64) {
        shifted.factorise_any(jacobian, shift, h);
    }

    fn solve(shifted: &mut Shifted<Self>, b: &mut [Self]) {
        shifted.solve_any(b);
    }
}

impl Scalar for Complex<f64> {
    #[inline(always)]
    fn real(x: f64) -> Self {
        Self::new(x, 0.0)
    }

    #[inline(always)]
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }

    fn factorise(shifted: &mut Shifted<Self>, jacobian: &Jacobian, shift: Self, h: f64) {
        shifted.factorise_any(jacobian, shift, h);
    }

    fn solve(shifted: &mut Shifted<Self>, b: &mut [Self]) {
        shifted.solve_any(b);
    }
}

/// The entries of a square matrix.
pub(crate) trait Entries {
    /// Number of rows.
    fn n(&self) -> usize;

    /// Calls `entry(i, j, value)` for every entry that can be nonzero, as [`System::jacobian`] does.
    fn for_each(&self, entry: impl FnMut(usize, usize, f64));
}

/// The Jacobian of a system in a mode at `(t, y)`.
pub(crate) struct JacobianAt<'a, P: System> {
    pub(crate) problem: &'a P,
    pub(crate) mode: P::Mode,
    pub(crate) t: f64,
    pub(crate) y: &'a P::State<f64>,
}

impl<P: System> Entries for JacobianAt<'_, P> {
    fn n(&self) -> usize {
        self.problem.dim()
    }

    fn for_each(&self, entry: impl FnMut(usize, usize, f64)) {
        self.problem.jacobian(self.mode.clone(), self.t, self.y, entry);
    }
}

/// A matrix `J` of [`Entries`], such as the Jacobian of a system in one mode at one state.
pub(crate) enum Jacobian {
    Dense(SquareMatrix),
    Sparse(SparseMatrix),
}

impl Jacobian {
    /// Workspace for `n` states.
    pub(crate) fn new(n: usize) -> Self {
        SparseMatrix::for_many(n).map_or_else(|| Self::Dense(SquareMatrix::zeros(n)), Self::Sparse)
    }

    /// Evaluates the Jacobian of `mode` at `(t, y)`. Returns the row of an entry that is not finite, if there is one.
    pub(crate) fn evaluate<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> Option<usize> {
        self.set(&JacobianAt { problem, mode, t, y })
    }

    /// Sets all entries. Returns the row of an entry that is not finite, if there is one.
    pub(crate) fn set(&mut self, all: &impl Entries) -> Option<usize> {
        let n = all.n();
        if let Self::Sparse(sparse) = self {
            if sparse.set(all) {
                return sparse.non_finite_row();
            }
            *self = Self::Dense(SquareMatrix::zeros(n));
        }
        if let Self::Dense(SquareMatrix { columns: entries, .. }) = self {
            entries.fill(0.0);
            all.for_each(|i, j, entry| entries[j * n + i] = entry);
            return entries.iter().position(|entry| !entry.is_finite()).map(|entry| entry % n);
        }
        None
    }

    /// `y ← y + J x`.
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Dense(jacobian) => dense::add_product(jacobian, x, y),
            Self::Sparse(sparse) => sparse.add_product(x, y),
        }
    }
}

/// `s I − h J`, factorised anew for each `h`.
pub(crate) enum Shifted<T> {
    Dense(DenseLu<T>),
    Sparse(Box<SparseLu<T>>),
}

impl<T: Scalar> Shifted<T> {
    /// Workspace for `n` states.
    pub(crate) fn new(n: usize) -> Self {
        SparseLu::for_many(n)
            .map_or_else(|| Self::Dense(DenseLu::new(n)), |lu| Self::Sparse(Box::new(lu)))
    }

    /// Factorises `shift I − h J`. Where that matrix is singular, solutions are not finite.
    pub(crate) fn factorise(&mut self, jacobian: &Jacobian, shift: T, h: f64) {
        T::factorise(self, jacobian, shift, h);
    }

    /// Replaces `b` by the solution `x` of `(shift I − h J) x = b`.
    pub(crate) fn solve(&mut self, b: &mut [T]) {
        T::solve(self, b);
    }

    #[inline(always)]
    fn factorise_any(&mut self, jacobian: &Jacobian, shift: T, h: f64) {
        if let (Self::Sparse(_), Jacobian::Dense(jacobian)) = (&*self, jacobian) {
            *self = Self::Dense(DenseLu::new(jacobian.n));
        }
        match (self, jacobian) {
            (Self::Dense(lu), Jacobian::Dense(jacobian)) => {
                lu.factorise(&jacobian.columns, shift, h);
            }
            (Self::Sparse(lu), Jacobian::Sparse(jacobian)) => lu.factorise(jacobian, shift, h),
            // A dense Jacobian never becomes sparse again.
            _ => {}
        }
    }

    #[inline(always)]
    fn solve_any(&mut self, b: &mut [T]) {
        match self {
            Self::Dense(dense) => dense.solve(b),
            Self::Sparse(sparse) => sparse.solve(b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;
    use crate::system::Next;

    /// Number of states from which on a matrix may be sparse.
    const MANY: usize = 32;

    /// Real and imaginary part.
    trait Parts {
        fn parts(self) -> [f64; 2];
    }

    impl Parts for f64 {
        fn parts(self) -> [f64; 2] {
            [self, 0.0]
        }
    }

    impl Parts for Complex<f64> {
        fn parts(self) -> [f64; 2] {
            [self.re, self.im]
        }
    }

    /// `ẏ_i = y_(i−1) − 3 y_i² + y_(i+1)`; in the mode `true` the last state also acts on the first.
    struct Chain {
        n: usize,
        /// Whether the Jacobian is given with all zero entries.
        is_full: bool,
    }

    impl System for Chain {
        type Mode = bool;
        type State<S: Real> = Vec<S>;
        type Guards<S: Real> = [S; 0];

        fn dim(&self) -> usize {
            self.n
        }

        fn initial_mode(&self, _t: f64, _y: &Vec<f64>) -> bool {
            false
        }

        fn rhs<S: Real>(&self, is_ring: bool, _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
            let last = self.n - 1;
            for i in 0..=last {
                let left = if i > 0 { y[i - 1] } else { S::cst(0.0) };
                let right = if i < last { y[i + 1] } else { S::cst(0.0) };
                dydt[i] = left - y[i] * y[i] * 3.0 + right;
            }
            if is_ring {
                dydt[0] = dydt[0] + y[last];
            }
        }

        fn guards<S: Real>(&self, _: bool, _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}

        fn guard_bounds(&self, _: bool, _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, _: bool, _: usize, _t: S, _y: &mut Vec<S>) -> Next<bool> {
            Next::Stop
        }

        fn jacobian(
            &self,
            is_ring: bool,
            _t: f64,
            y: &Vec<f64>,
            mut entry: impl FnMut(usize, usize, f64),
        ) {
            let last = self.n - 1;
            if self.is_full {
                (0..self.n * self.n).for_each(|k| entry(k / self.n, k % self.n, 0.0));
            }
            for (i, y) in y.iter().enumerate() {
                entry(i, i, -6.0 * y);
                if i > 0 {
                    entry(i, i - 1, 1.0);
                    entry(i - 1, i, 1.0);
                }
            }
            if is_ring {
                entry(0, last, 1.0);
            }
        }
    }

    /// Largest entry of `shift x − h J x − b` at the solution, where `J x` is checked against differences of the
    /// right-hand side.
    fn residual<T: Scalar + Parts>(
        chain: &Chain,
        is_ring: bool,
        shift: T,
        jacobian: &mut Jacobian,
        shifted: &mut Shifted<T>,
    ) -> f64 {
        let h = -0.3;
        let y: Vec<f64> = (0..chain.n).map(|i| 1.0 + 0.01 * i as f64).collect();
        let b: Vec<T> = (0..chain.n).map(|i| shift * T::real((i as f64).sin())).collect();
        let mut x = b.clone();
        jacobian.evaluate(chain, is_ring, 0.0, &y);
        shifted.factorise(jacobian, shift, h);
        shifted.solve(&mut x);
        let mut worst = 0.0_f64;
        let mut check = |x: &[f64], rest: &[f64]| {
            let mut product = vec![0.0; chain.n];
            jacobian.add_product(x, &mut product);
            // The right-hand side is quadratic, so this difference is exactly J x.
            let ahead = |sign: f64| {
                let moved = y.iter().zip(x).map(|(y, x)| y + 0.5 * sign * x).collect();
                let mut dydt = y.clone();
                chain.rhs(is_ring, 0.0, &moved, &mut dydt);
                dydt
            };
            let differences = ahead(1.0).into_iter().zip(ahead(-1.0)).map(|(a, b)| a - b);
            for (i, difference) in differences.enumerate() {
                worst = worst.max((product[i] - difference).abs());
                worst = worst.max((rest[i] - h * product[i]).abs());
            }
        };
        for part in 0..2 {
            let rest = |(x, b): (&T, &T)| {
                let mut rest = shift * *x;
                rest -= *b;
                rest.parts()[part]
            };
            let rest: Vec<f64> = x.iter().zip(&b).map(rest).collect();
            check(&x.iter().map(|x| x.parts()[part]).collect::<Vec<_>>(), &rest);
        }
        worst
    }

    fn expect_solutions<T: Scalar + Parts>(shift: T) {
        for n in [1, 2, 4, 6, MANY - 1, MANY, 200] {
            let chain = Chain { n, is_full: false };
            let (mut jacobian, mut shifted) = (Jacobian::new(n), Shifted::new(n));
            for is_ring in [false, n > 2, false] {
                // Measured: 2.1e-14, with the sparse pattern widened once.
                let found = residual(&chain, is_ring, shift, &mut jacobian, &mut shifted);
                assert!(found < 2e-13, "{n}: {found:e}");
            }
            let is_sparse = n >= MANY && cfg!(feature = "sparse");
            assert_eq!(matches!(jacobian, Jacobian::Sparse(_)), is_sparse);
        }
    }

    #[test]
    fn solutions_solve_their_system_dense_and_sparse() {
        expect_solutions(0.5);
        expect_solutions(Complex::new(0.5, -0.7));
    }

    #[test]
    fn a_full_jacobian_is_held_dense_however_large() {
        let full = Chain { n: MANY, is_full: true };
        let mut jacobian = Jacobian::new(MANY);
        jacobian.evaluate(&full, false, 0.0, &vec![1.0; MANY]);
        assert!(matches!(jacobian, Jacobian::Dense(_)));
        let mut shifted = Shifted::new(MANY);
        shifted.factorise(&jacobian, 2.0, 0.0);
        let mut x = vec![1.0; MANY];
        shifted.solve(&mut x);
        assert_eq!(x, vec![0.5; MANY]);
    }

    #[test]
    fn a_jacobian_without_entries_is_zero_however_many_states_there_are() {
        struct Still;
        impl System for Still {
            type Mode = ();
            type State<S: Real> = Vec<S>;
            type Guards<S: Real> = [S; 0];
            fn dim(&self) -> usize {
                MANY
            }
            fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}
            fn rhs<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, dydt: &mut Vec<S>) {
                dydt.fill(S::cst(1.0));
            }
            fn guards<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}
            fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}
            fn transition<S: Real>(&self, (): (), _: usize, _: S, _: &mut Vec<S>) -> Next<()> {
                Next::Stop
            }
            fn jacobian(&self, (): (), _: f64, _: &Vec<f64>, _: impl FnMut(usize, usize, f64)) {}
        }
        let (mut jacobian, mut matrix) = (Jacobian::new(MANY), Shifted::new(MANY));
        jacobian.evaluate(&Still, (), 0.0, &vec![0.0; MANY]);
        matrix.factorise(&jacobian, 2.0, 0.1);
        let mut x = vec![1.0; MANY];
        matrix.solve(&mut x);
        assert_eq!(x, vec![0.5; MANY]);
    }

    #[test]
    fn a_singular_matrix_gives_no_numbers() {
        for n in [2, 100] {
            let (mut jacobian, mut shifted) = (Jacobian::new(n), Shifted::new(n));
            jacobian.evaluate(&Chain { n, is_full: false }, false, 0.0, &vec![0.0; n]);
            shifted.factorise(&jacobian, 0.0, 0.0);
            let mut x = vec![1.0; n];
            shifted.solve(&mut x);
            assert!(x.iter().any(|x| !x.is_finite()));
        }
    }

    #[test]
    fn factorising_again_allocates_nothing() {
        for n in [6, 200] {
            let chain = Chain { n, is_full: false };
            let y = vec![1.0; n];
            let mut x = vec![Complex::new(1.0, 1.0); n];
            let (mut jacobian, mut shifted) = (Jacobian::new(n), Shifted::new(n));
            let mut solve = |h| {
                jacobian.evaluate(&chain, false, 0.0, &y);
                shifted.factorise(&jacobian, Complex::new(1.0, 2.0), h);
                shifted.solve(&mut x);
            };
            solve(0.1);
            let counted = allocation_counter::measure(|| solve(0.2));
            assert_eq!(counted.count_total, 0, "{n} states");
        }
    }
}
