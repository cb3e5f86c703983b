//! The linear systems of full Newton iteration: all stages at once, each with the Jacobian at its own state.

use super::Radau;
use crate::linear::{Entries, Jacobian, Shifted};
use crate::system::System;

/// The matrix `A⁻¹ ⊗ I − h diag(J₁, J₂, J₃)`, where `J_i` is the Jacobian at stage i. Its rows are divided by the
/// diagonal of `A⁻¹`, so that it is the identity minus a matrix. Stage i of state p is number 3p + i.
pub(super) struct FullMatrix {
    /// Rows of `A⁻¹`.
    a_inverse: [[f64; 3]; 3],
    matrix: Jacobian,
    lu: Shifted<f64>,
    b: Vec<f64>,
}

/// What [`FullMatrix`] subtracts from the identity.
struct Stages<'a, P: System> {
    problem: &'a P,
    mode: P::Mode,
    a_inverse: [[f64; 3]; 3],
    t: [f64; 3],
    y: &'a [P::State<f64>; 3],
    h: f64,
}

impl<P: System> Entries for Stages<'_, P> {
    fn n(&self) -> usize {
        3 * self.problem.dim()
    }

    fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        for (i, row) in self.a_inverse.iter().enumerate() {
            let scale = self.h / row[i];
            self.problem.jacobian(self.mode.clone(), self.t[i], &self.y[i], |p, q, value| {
                entry(3 * p + i, 3 * q + i, scale * value);
            });
            for j in (0..3).filter(|j| *j != i) {
                (0..self.problem.dim()).for_each(|p| entry(3 * p + i, 3 * p + j, -row[j] / row[i]));
            }
        }
    }
}

impl FullMatrix {
    /// Workspace for `n` states.
    pub(super) fn new(tableau: &Radau, n: usize) -> Self {
        Self {
            a_inverse: tableau.a_inverse(),
            matrix: Jacobian::new(3 * n),
            lu: Shifted::new(3 * n),
            b: vec![0.0; 3 * n],
        }
    }

    /// Factorises the matrix of a step of size `h` whose stages have the states `y` at the times `t`. Where a Jacobian
    /// is not finite or the matrix is singular, solutions are not finite.
    pub(super) fn factorise<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: [f64; 3],
        y: &[P::State<f64>; 3],
        h: f64,
    ) {
        self.matrix.set(&Stages { problem, mode, a_inverse: self.a_inverse, t, y, h });
        self.lu.factorise(&self.matrix, 1.0, 1.0);
    }

    /// Sets the right-hand side of state `p`.
    pub(super) fn set(&mut self, p: usize, stages: [f64; 3]) {
        for (i, value) in stages.into_iter().enumerate() {
            self.b[3 * p + i] = value / self.a_inverse[i][i];
        }
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&mut self) {
        self.lu.solve(&mut self.b);
    }

    /// The solution of state `p`.
    pub(super) fn at(&self, p: usize) -> [f64; 3] {
        std::array::from_fn(|i| self.b[3 * p + i])
    }
}
