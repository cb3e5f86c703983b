//! Radau IIA methods: fully implicit, with stages computed by Newton's iteration.

mod convergence;
mod full;
mod newton;
mod step;

pub use newton::RadauMethod;
pub use step::RadauStep;

use crate::order_conditions::{residuals, trees};

/// A collocation method of three stages whose last node is the end of the step, and whose `A⁻¹` has one real
/// eigenvalue and a complex pair.
///
/// ```text
/// z_i = h Σ_j a_ij f(t + c_j h, y + z_j),   y₁ = y + z₃
/// A⁻¹ T = T Λ,   Λ = [γ 0 0; 0 α −β; 0 β α],   z = T w
/// ```
///
/// Simplified Newton iteration for `w` then solves two linear systems per iteration, one real and one complex, with
/// the Jacobian `J` at the start of the step. The index 2,3 denotes the complex number that the second and third
/// component make together:
///
/// ```text
/// (γ I − hJ) Δw₁ = h (T⁻¹ f)₁ − γ w₁
/// ((α + iβ) I − hJ) Δw₂,₃ = h (T⁻¹ f)₂,₃ − (α + iβ) w₂,₃
/// ```
///
/// Simplified iteration diverges where the direction of a stiff force turns within a step. Let a force of angular
/// frequency ω hold the motion near a curve, whose normal turns by θ over the step. With the normal of the start, an
/// error ε along the tangent becomes an error θε along the normal, and this one becomes (ωh)² θ · θε along the tangent.
/// So the iteration needs θωh < 1, and its steps fall as the fourth root of the stiffness, though the accuracy allows
/// longer ones. Where that is so, full Newton iteration solves the step, with the Jacobian `J_i` of each stage, anew in
/// each iteration:
///
/// ```text
/// Σ_j (A⁻¹)_ij Δz_j − hJ_i Δz_i = h f_i − Σ_j (A⁻¹)_ij z_j
/// ```
///
/// C. Lubich, "Integration of stiff mechanical systems by Runge–Kutta methods", Z. angew. Math. Phys. 44, 1022–1053
/// (1993), treats such systems. He shows that the methods keep their accuracy, however stiff the force.
///
/// The error estimate is the defect of the collocation polynomial's slope at the start, where the polynomial need not
/// satisfy the equation, filtered by `(γ I − hJ)⁻¹`. It falls as h⁴, because `u` is cubic. The dense output is
/// corrected by the same filtered defect. The filter keeps that correction as small as the error, however stiff the
/// system is:
///
/// ```text
/// u(θ) cubic through y, y + z₁, y + z₂, y₁ at θ = 0, c₁, c₂, 1
/// error = (γ I − hJ)⁻¹ (h ẏ − u′(0))
/// y(t + θh) = u(θ) + γ error ψ(θ),   ψ′(θ) = (1 − θ/c₁)(1 − θ/c₂)(1 − θ),   ψ(0) = ψ(1) = 0
/// ```
///
/// E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer (1996), IV.8, and their code
/// RADAU5. The dense output is derived here.
#[derive(Debug)]
pub struct Radau {
    /// Order of the propagated solution.
    pub order: usize,
    /// Order of the embedded solution.
    pub embedded_order: usize,
    /// Order of the dense output, whose local error falls with one power more.
    pub dense_order: usize,
    /// Order of the stages, whose local errors fall with one power more.
    pub stage_order: usize,
    /// Nodes.
    pub c: [f64; 3],
    /// Rows of the matrix `A`; the last row contains the weights.
    pub a: [[f64; 3]; 3],
    /// Real eigenvalue γ of `A⁻¹`.
    pub real: f64,
    /// Real and imaginary part of its complex eigenvalue α + iβ.
    pub complex: [f64; 2],
    /// Rows of T.
    pub t: [[f64; 3]; 3],
    /// Rows of T⁻¹.
    pub t_inverse: [[f64; 3]; 3],
    /// The root of ψ(θ) = θ (1 − θ)² (1 − θ/root) beyond 0 and 1.
    pub bubble_root: f64,
}

impl Radau {
    /// Residuals of all conditions that the coefficients must meet: the row sums `Σ_j a_ij = c_i` and the other
    /// conditions of the stage order, `Σ_j a_ij c_jᵏ⁻¹ = c_iᵏ/k`; the [order conditions](crate::order_conditions) of
    /// the last row, of the embedded solution and of the dense output at θ = 1/3; `A T Λ = T` and `T⁻¹ T = I`.
    pub fn residuals(&self) -> Vec<f64> {
        let mut all = Vec::new();
        for k in 1..=self.stage_order as i32 {
            for (row, c) in self.a.iter().zip(self.c) {
                let sum: f64 = row.iter().zip(self.c).map(|(a, c)| a * c.powi(k - 1)).sum();
                all.push(sum - c.powi(k) / f64::from(k));
            }
        }

        let rows = self.a.each_ref().map(|row| &row[..]);
        all.extend(residuals(&self.a[2], &trees(&rows, &rows, self.order)));

        // The slope at the start is added as a stage before the others.
        let start = |row: &[f64; 3]| [0.0, row[0], row[1], row[2]];
        let (zero, [a, b, c]) = ([0.0; 4], self.a.each_ref().map(start));
        let rows = [&zero[..], &a[..], &b[..], &c[..]];
        let defect = self.defect_weights();
        let embedded: [f64; 4] = std::array::from_fn(|i| c[i] + defect[i] / self.real);
        all.extend(residuals(&embedded, &trees(&rows, &rows, self.embedded_order)));

        let theta: f64 = 1.0 / 3.0;
        let bubble = theta * (1.0 - theta).powi(2) * (1.0 - theta / self.bubble_root);
        let stages = self.stage_weights(theta);
        let dense: [f64; 4] = std::array::from_fn(|i| {
            let cubic: f64 = [a, b, c].iter().zip(stages).map(|(row, w)| row[i] * w).sum();
            cubic + bubble * defect[i]
        });
        for tree in trees(&rows, &rows, self.dense_order) {
            let order = tree.order as i32;
            all.push(
                residuals(&dense, std::slice::from_ref(&tree))[0]
                    + (1.0 - theta.powi(order)) / tree.density,
            );
        }

        let [alpha, beta] = self.complex;
        let lambda = [[self.real, 0.0, 0.0], [0.0, alpha, -beta], [0.0, beta, alpha]];
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (left, right) = (product(&product(&self.a, &self.t), &lambda), self.t);
        let (one, unit) = (product(&self.t_inverse, &self.t), identity);
        for (left, right) in [(left, right), (one, unit)] {
            let entries = left.as_flattened().iter().zip(right.as_flattened());
            all.extend(entries.map(|(left, right)| left - right));
        }
        all
    }

    /// Rows of `A⁻¹`, which is `T Λ T⁻¹`.
    fn a_inverse(&self) -> [[f64; 3]; 3] {
        let [alpha, beta] = self.complex;
        let lambda = [[self.real, 0.0, 0.0], [0.0, alpha, -beta], [0.0, beta, alpha]];
        product(&product(&self.t, &lambda), &self.t_inverse)
    }

    /// Weights of the `z_i` in `u(θ) − y`.
    fn stage_weights(&self, theta: f64) -> [f64; 3] {
        std::array::from_fn(|i| {
            let mut z = [[0.0]; 3];
            z[i] = [1.0];
            let [e, d] = self.bend(z.each_ref().map(|z| z[0]));
            theta * (z[2][0] - (1.0 - theta) * (e + theta * d))
        })
    }

    /// Weights of the slopes at the start and at the stages in the unfiltered defect, divided by h.
    fn defect_weights(&self) -> [f64; 4] {
        let mut weights = [1.0, 0.0, 0.0, 0.0];
        for j in 0..3 {
            let z = std::array::from_fn(|i| self.a[i][j]);
            let [e, _] = self.bend(z);
            weights[j + 1] = e - z[2];
        }
        weights
    }

    /// The coefficients `e` and `d` of the cubic through the stages: `u(θ) = y + θ (z₃ − (1 − θ)(e + d θ))`.
    fn bend(&self, z: [f64; 3]) -> [f64; 2] {
        let [c1, c2, _] = self.c;
        let second = |z: f64, c: f64, z3: f64| (z3 - z / c) / (1.0 - c);
        let (one, two) = (second(z[0], c1, z[2]), second(z[1], c2, z[2]));
        let d = (one - two) / (c1 - c2);
        [two - c2 * d, d]
    }
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| transformed(&[0, 1, 2].map(|j| b.map(|row| row[j])), row))
}

/// `M x`.
#[inline(always)]
fn transformed(matrix: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}
