//! The linear systems of full Newton iteration for few states: without the states whose rates are other states.

use super::super::{Radau, transformed};
use crate::linear::DenseLu;
use crate::system::System;

/// A number for each stage.
type OfStages = [f64; 3];

/// As [`FullMatrix`](super::FullMatrix), dense. In mechanics half of the equations are `ẏ_p = y_q`, a position and its
/// speed. A state whose rate is a multiple of another one is eliminated by
///
/// ```text
/// A⁻¹ x_p − h c x_q = b_p   ⇒   x_p = A (b_p + h c x_q)
/// ```
///
/// so that a factorisation takes an eighth of the operations (Hairer and Wanner, IV.8, have this for simplified
/// iteration).
pub(in crate::radau) struct FewStates {
    a: [OfStages; 3],
    a_inverse: [OfStages; 3],
    h: f64,
    /// The Jacobian at each stage, by columns.
    jacobians: [Vec<f64>; 3],
    rates: Vec<Rate>,
    /// The states that are solved for, and those that are eliminated.
    kept: Vec<usize>,
    gone: Vec<Gone>,
    lu: DenseLu<f64>,
    matrix: Vec<f64>,
    b: Vec<f64>,
    /// The right-hand side of each state, then its solution.
    x: Vec<OfStages>,
}

/// A state that is eliminated: its rate is `by` times the state `of`.
#[derive(Clone, Copy)]
struct Gone {
    p: usize,
    of: usize,
    by: f64,
}

/// What the rate of a state depends on in any stage.
#[derive(Clone, Copy, PartialEq)]
enum Rate {
    Constant,
    /// A multiple of one other state.
    Multiple {
        of: usize,
        by: f64,
    },
    Other,
}

impl Rate {
    /// Adds the entry `by` of the state `of`.
    fn add(&mut self, of: usize, by: f64) {
        let entry = Self::Multiple { of, by };
        if *self == Self::Constant {
            *self = entry;
        } else if *self != entry {
            *self = Self::Other;
        }
    }
}

impl FewStates {
    /// Workspace for `n` states.
    pub(super) fn new(tableau: &Radau, n: usize) -> Self {
        Self {
            a: tableau.a,
            a_inverse: tableau.a_inverse(),
            h: 0.0,
            jacobians: [(); 3].map(|()| vec![0.0; n * n]),
            rates: vec![Rate::Constant; n],
            kept: Vec::with_capacity(n),
            gone: Vec::with_capacity(n),
            lu: DenseLu::new(3 * n),
            matrix: Vec::with_capacity(9 * n * n),
            b: Vec::with_capacity(3 * n),
            x: vec![[0.0; 3]; n],
        }
    }

    pub(super) fn factorise<P: System>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: OfStages,
        y: &[P::State<f64>; 3],
        h: f64,
    ) {
        let n = self.x.len();
        self.h = h;
        self.rates.fill(Rate::Constant);
        for ((jacobian, t), y) in self.jacobians.iter_mut().zip(t).zip(y) {
            jacobian.fill(0.0);
            problem.jacobian(mode.clone(), t, y, |p, q, value| {
                jacobian[q * n + p] = value;
                if value != 0.0 {
                    self.rates[p].add(q, value);
                }
            });
        }
        self.factorise_kept();
    }

    /// Factorises the matrix of the states that are kept.
    fn factorise_kept(&mut self) {
        self.choose();
        self.assemble();
        self.lu.factorise(&self.matrix, 0.0, -1.0);
    }

    /// Chooses which states are eliminated; what one of them is expressed by is kept.
    fn choose(&mut self) {
        let Self { rates, kept, gone, jacobians, .. } = self;
        let n = rates.len();
        kept.clear();
        gone.clear();
        for p in 0..n {
            match rates[p] {
                Rate::Multiple { of, by }
                    if (of > p || kept.contains(&of))
                        && jacobians.iter().all(|jacobian| jacobian[of * n + p] == by) =>
                {
                    gone.push(Gone { p, of, by });
                    if of > p {
                        rates[of] = Rate::Other;
                    }
                }
                _ => kept.push(p),
            }
        }
        let n_rows = 3 * kept.len();
        self.lu.resize(n_rows);
        self.matrix.resize(n_rows * n_rows, 0.0);
        self.b.resize(n_rows, 0.0);
    }

    /// Writes the matrix of the states that are kept: stage i of the one at place p is number 3p + i.
    fn assemble(&mut self) {
        let (n, n_kept, h) = (self.x.len(), self.kept.len(), self.h);
        self.matrix.fill(0.0);
        for (place, q) in self.kept.iter().enumerate() {
            for j in 0..3 {
                let column = &mut self.matrix[(3 * place + j) * 3 * n_kept..][..3 * n_kept];
                for (i, row) in self.a_inverse.iter().enumerate() {
                    column[3 * place + i] = row[j];
                }
                for (at, p) in self.kept.iter().enumerate() {
                    column[3 * at + j] -= h * self.jacobians[j][q * n + p];
                }
                for gone in self.gone.iter().filter(|gone| gone.of == *q) {
                    for i in 0..3 {
                        let factor = h * h * gone.by * self.a[i][j];
                        let entries = &self.jacobians[i][gone.p * n..][..n];
                        for (at, p) in self.kept.iter().enumerate() {
                            column[3 * at + i] -= factor * entries[*p];
                        }
                    }
                }
            }
        }
    }

    /// Number of states that are solved for.
    #[cfg(test)]
    pub(super) fn n_kept(&self) -> usize {
        self.kept.len()
    }

    pub(super) fn set(&mut self, p: usize, stages: OfStages) {
        self.x[p] = stages;
    }

    pub(super) fn solve(&mut self) {
        let (n, h) = (self.x.len(), self.h);
        for Gone { p, .. } in &self.gone {
            self.x[*p] = transformed(&self.a, self.x[*p]);
        }
        for (b, p) in self.b.chunks_exact_mut(3).zip(&self.kept) {
            for (i, b) in b.iter_mut().enumerate() {
                let known = |gone: &Gone| self.jacobians[i][gone.p * n + p] * self.x[gone.p][i];
                *b = self.x[*p][i] + h * self.gone.iter().map(known).sum::<f64>();
            }
        }
        self.lu.solve(&mut self.b);
        for (b, p) in self.b.chunks_exact(3).zip(&self.kept) {
            self.x[*p].copy_from_slice(b);
        }
        for Gone { p, of, by } in &self.gone {
            let own = transformed(&self.a, self.x[*of].map(|x| h * by * x));
            for (x, own) in self.x[*p].iter_mut().zip(own) {
                *x += own;
            }
        }
    }

    pub(super) fn at(&self, p: usize) -> OfStages {
        self.x[p]
    }
}
