//! The linear systems of full Newton iteration for many states, where they may be sparse.

use super::super::Radau;
use crate::linear::{Entries, Jacobian, Shifted};
use crate::system::System;

/// As [`FullMatrix`](super::FullMatrix), its rows divided by the diagonal of `A⁻¹`, so that it is the identity minus a
/// matrix. Stage i of state p is number 3p + i.
pub(in crate::radau) struct ManyStates {
    /// Rows of `A⁻¹`.
    a_inverse: [[f64; 3]; 3],
    matrix: Jacobian,
    lu: Shifted<f64>,
    b: Vec<f64>,
}

/// What [`ManyStates`] subtracts from the identity.
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

impl ManyStates {
    /// Workspace for `n` states.
    pub(super) fn new(tableau: &Radau, n: usize) -> Self {
        Self {
            a_inverse: tableau.a_inverse(),
            matrix: Jacobian::new(3 * n),
            lu: Shifted::new(3 * n),
            b: vec![0.0; 3 * n],
        }
    }

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

    pub(super) fn set(&mut self, p: usize, stages: [f64; 3]) {
        for (i, value) in stages.into_iter().enumerate() {
            self.b[3 * p + i] = value / self.a_inverse[i][i];
        }
    }

    pub(super) fn solve(&mut self) {
        self.lu.solve(&mut self.b);
    }

    pub(super) fn at(&self, p: usize) -> [f64; 3] {
        std::array::from_fn(|i| self.b[3 * p + i])
    }
}
