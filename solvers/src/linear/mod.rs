//! The linear systems of implicit methods, `(s I − h J) x = b`: dense for few states, sparse for many.

mod dense;
mod sparse;

use crate::system::System;
use dense::Dense;
use sparse::Sparse;

/// Number of states from which a sparse factorisation is tried.
const MANY: usize = 32;

/// `s I − h J` with the Jacobian `J` of a system, factorised for one `h` after the other.
pub(crate) enum ShiftedJacobian {
    Dense(Dense),
    Sparse(Box<Sparse>),
}

impl ShiftedJacobian {
    /// Memory for `n` states.
    pub(crate) fn new(n: usize) -> Self {
        if n < MANY { Self::Dense(Dense::new(n)) } else { Self::Sparse(Box::new(Sparse::new(n))) }
    }

    /// Evaluates the Jacobian of `mode` at `(t, y)`.
    pub(crate) fn evaluate<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) {
        if let Self::Sparse(sparse) = self {
            if sparse.evaluate(problem, mode, t, y) {
                return;
            }
            *self = Self::Dense(Dense::new(problem.dim()));
        }
        if let Self::Dense(dense) = self {
            dense.evaluate(problem, mode, t, y);
        }
    }

    /// `y ← y + J x`.
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Dense(dense) => dense.add_product(x, y),
            Self::Sparse(sparse) => sparse.add_product(x, y),
        }
    }

    /// Factorises `shift I − h J`. Where that is singular, solutions are not numbers.
    pub(crate) fn factorise(&mut self, shift: f64, h: f64) {
        match self {
            Self::Dense(dense) => dense.factorise(shift, h),
            Self::Sparse(sparse) => sparse.factorise(shift, h),
        }
    }

    /// Replaces `b` by the solution `x` of `(shift I − h J) x = b`.
    pub(crate) fn solve(&mut self, b: &mut [f64]) {
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

    /// `ẏ_i = y_(i−1) − 3 y_i² + y_(i+1)`; with `true` for a mode the last state pulls on the first.
    struct Chain {
        n: usize,
        /// Whether its Jacobian is given with all its zeros.
        is_full: bool,
    }

    impl System for Chain {
        type Mode = bool;
        type State<S: Real> = Vec<S>;
        type Guards<S: Real> = [S; 0];

        fn dim(&self) -> usize {
            self.n
        }

        fn n_guards(&self) -> usize {
            0
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

    /// `shift x − h J x − b` of the solution, by differences of the right-hand side.
    fn residual(chain: &Chain, is_ring: bool, matrix: &mut ShiftedJacobian) -> f64 {
        let (shift, h) = (0.5, -0.3);
        let y: Vec<f64> = (0..chain.n).map(|i| 1.0 + 0.01 * i as f64).collect();
        let b: Vec<f64> = (0..chain.n).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        matrix.evaluate(chain, is_ring, 0.0, &y);
        matrix.factorise(shift, h);
        matrix.solve(&mut x);
        let mut product = vec![0.0; chain.n];
        matrix.add_product(&x, &mut product);
        // The right-hand side is quadratic: this difference is J x.
        let ahead = |sign: f64| {
            let moved = y.iter().zip(&x).map(|(y, x)| y + 0.5 * sign * x).collect();
            let mut dydt = y.clone();
            chain.rhs(is_ring, 0.0, &moved, &mut dydt);
            dydt
        };
        let differences = ahead(1.0).into_iter().zip(ahead(-1.0)).map(|(a, b)| a - b);
        let mut worst = 0.0_f64;
        for (i, difference) in differences.enumerate() {
            worst = worst.max((product[i] - difference).abs());
            worst = worst.max((shift * x[i] - h * product[i] - b[i]).abs());
        }
        worst
    }

    #[test]
    fn solutions_solve_their_system_dense_and_sparse() {
        for n in [1, 2, 6, MANY - 1, MANY, 200] {
            let chain = Chain { n, is_full: false };
            let mut matrix = ShiftedJacobian::new(n);
            for is_ring in [false, n > 2, false] {
                // Measured: 2.1e-14, the sparse one with its pattern widened once.
                let found = residual(&chain, is_ring, &mut matrix);
                assert!(found < 2e-13, "{n}: {found:e}");
            }
            assert_eq!(matches!(matrix, ShiftedJacobian::Sparse(_)), n >= MANY);
        }
    }

    #[test]
    fn a_full_jacobian_is_held_dense_however_large() {
        let full = Chain { n: MANY, is_full: true };
        let mut matrix = ShiftedJacobian::new(MANY);
        matrix.evaluate(&full, false, 0.0, &vec![1.0; MANY]);
        assert!(matches!(matrix, ShiftedJacobian::Dense(_)));
    }

    #[test]
    fn a_singular_matrix_gives_no_numbers() {
        for n in [2, 100] {
            let mut matrix = ShiftedJacobian::new(n);
            matrix.evaluate(&Chain { n, is_full: false }, false, 0.0, &vec![0.0; n]);
            matrix.factorise(0.0, 0.0);
            let mut x = vec![1.0; n];
            matrix.solve(&mut x);
            assert!(x.iter().any(|x| !x.is_finite()));
        }
    }

    #[test]
    fn factorising_again_allocates_nothing() {
        for n in [6, 200] {
            let chain = Chain { n, is_full: false };
            let y = vec![1.0; n];
            let mut x = vec![1.0; n];
            let mut matrix = ShiftedJacobian::new(n);
            let mut solve = |h| {
                matrix.evaluate(&chain, false, 0.0, &y);
                matrix.factorise(1.0, h);
                matrix.solve(&mut x);
            };
            solve(0.1);
            let counted = allocation_counter::measure(|| solve(0.2));
            assert_eq!(counted.count_total, 0, "{n} states");
        }
    }
}
