//! The stage loop of Radau IIA methods: fully implicit, their stages found by Newton's iteration.

use nalgebra::Complex;

use crate::control::Control;
use crate::linear::{Jacobian, Shifted};
use crate::one_step::OneStep;
use crate::order_conditions::{residuals, trees};
use crate::stats::Stats;
use crate::step::Step;
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;

/// Iterations before a step under a tolerance is given up. RADAU5.
const ITERATIONS: usize = 7;
/// Iterations before one that goes on to rounding is.
const ITERATIONS_TO_ROUNDING: usize = 50;
/// Corrections that grow by this factor do not come to rest any more.
const GROWTH: f64 = 1e3;
/// Largest part of the tolerance that an iteration may leave. RADAU5.
const REST: f64 = 0.03;
/// A correction by this part of a state is noise once corrections no longer shrink.
const NOISE: f64 = 1e-8;
/// States smaller than this part of the largest one are iterated as if they had that size.
const SMALLEST: f64 = 1e-6;

/// A collocation method of three stages, the last one at the end of the step, whose `A⁻¹` has one real
/// eigenvalue and a pair of complex ones.
///
/// ```text
/// z_i = h Σ_j a_ij f(t + c_j h, y + z_j),   y₁ = y + z₃
/// A⁻¹ T = T Λ,   Λ = [γ 0 0; 0 α −β; 0 β α],   z = T w
/// ```
///
/// Simplified Newton for `w` then has two linear systems an iteration, one real and one complex,
/// with the Jacobian `J` at the start of the step; `f` and `w` with the index 2,3 stand for the complex
/// number of the two:
///
/// ```text
/// (γ I − hJ) Δw₁ = h (T⁻¹ f)₁ − γ w₁
/// ((α + iβ) I − hJ) Δw₂,₃ = h (T⁻¹ f)₂,₃ − (α + iβ) w₂,₃
/// ```
///
/// The error estimate is the filtered defect of the collocation polynomial's slope at the start, where
/// it need not fit; it falls as h⁴, `u` being cubic. The same defect bends the dense output where it is
/// seen; behind the filter it stays as small as the error however stiff the system is:
///
/// ```text
/// u(θ) cubic through y, y + z₁, y + z₂, y₁ at θ = 0, c₁, c₂, 1
/// error = (γ I − hJ)⁻¹ (h ẏ − u′(0))
/// y(t + θh) = u(θ) + γ error ψ(θ),   ψ′(θ) = (1 − θ/c₁)(1 − θ/c₂)(1 − θ),   ψ(0) = ψ(1) = 0
/// ```
///
/// E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer (1996), IV.8,
/// and their code RADAU5; the dense output derived here.
#[derive(Debug)]
pub struct Radau {
    /// Order of the propagated solution.
    pub order: usize,
    /// Order of the embedded solution.
    pub embedded_order: usize,
    /// Order of the dense output: its local error falls with one power more.
    pub dense_order: usize,
    /// Order of the stages: their local errors fall with one power more.
    pub stage_order: usize,
    /// Nodes.
    pub c: [f64; 3],
    /// Rows of the matrix; the last one has the weights.
    pub a: [[f64; 3]; 3],
    /// Real eigenvalue γ of `A⁻¹`.
    pub real: f64,
    /// Real and imaginary part of its complex eigenvalue α + iβ.
    pub complex: [f64; 2],
    /// Rows of T.
    pub t: [[f64; 3]; 3],
    /// Rows of T⁻¹.
    pub t_inverse: [[f64; 3]; 3],
    /// ψ(θ) = θ (1 − θ)² (1 − θ/root).
    pub bubble_root: f64,
}

impl Radau {
    /// Residuals of all that the coefficients promise: the row sums `Σ_j a_ij = c_i` and the other
    /// conditions of the stages' order, `Σ_j a_ij c_jᵏ⁻¹ = c_iᵏ/k`; the [order
    /// conditions](crate::order_conditions) of the last row, of the embedded solution and of the dense
    /// output at θ = 1/3; `A T Λ = T` and `T⁻¹ T = I`.
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

        // With the slope at the start as a stage before the others.
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

    /// Weights of the `z_i` in `u(θ) − y`.
    fn stage_weights(&self, theta: f64) -> [f64; 3] {
        std::array::from_fn(|i| {
            let mut z = [[0.0]; 3];
            z[i] = [1.0];
            let [e, d] = self.bend(z.each_ref().map(|z| z[0]));
            theta * (z[2][0] - (1.0 - theta) * (e + theta * d))
        })
    }

    /// Weights of the slopes at the start and at the stages in the unfiltered defect over h.
    fn defect_weights(&self) -> [f64; 4] {
        let mut weights = [1.0, 0.0, 0.0, 0.0];
        for j in 0..3 {
            let z = std::array::from_fn(|i| self.a[i][j]);
            let [e, _] = self.bend(z);
            weights[j + 1] = e - z[2];
        }
        weights
    }

    /// `e` and `d` of the cubic through the stages: `u(θ) = y + θ (z₃ − (1 − θ)(e + d θ))`.
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
fn transformed(matrix: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}

/// How an iteration ended.
enum Iteration {
    Converged,
    Diverged,
    /// The slope of this state at a stage is not finite.
    NotFinite(usize),
}

/// A Radau method at work on one system.
pub struct RadauMethod<Y> {
    tableau: &'static Radau,
    /// What the error estimate is weighed by; none with a fixed step.
    tolerance: Option<Tolerance>,
    /// What an iteration may leave, in parts of that.
    rest: f64,
    jacobian: Jacobian,
    real: Shifted<f64>,
    complex: Shifted<Complex<f64>>,
    /// Whether the Jacobian is that of the present start.
    is_linearised: bool,
    /// Whether a step from the present start was completed: what follows are steps retaken.
    is_completed: bool,
    has_converged: bool,
    /// Increments to begin an iteration with, `g₁ x + g₂ x² + g₃ x³` at the time `t0 + x h_guess`.
    guess: [Y; 3],
    /// None at the start of a phase.
    h_guess: Option<f64>,
    /// What a correction leaves, in parts of it, as the last iteration found it.
    left: f64,
    z: [Y; 3],
    w: [Y; 3],
    k: [Y; 3],
    y_stage: Y,
    delta: Y,
    delta_pair: Vec<Complex<f64>>,
    /// What corrections are weighed by.
    scale: Y,
    step: RadauStep<Y>,
}

/// A step of a Radau method.
#[derive(Debug)]
pub struct RadauStep<Y> {
    t0: f64,
    t1: f64,
    h: f64,
    y0: Y,
    y1: Y,
    slope0: Y,
    slope1: Y,
    error: Y,
    /// `e` and `d` of the cubic.
    bend: [Y; 2],
    tableau: &'static Radau,
}

impl<Y: Vector<f64>> RadauMethod<Y> {
    /// The method of `tableau` for systems of `n` states, its steps chosen by `control`.
    ///
    /// The estimate falls as h⁴, the local error of the solution as h⁶: the estimate is held to
    /// `rtol^(2/3)/10` and `atol` in the same ratio, so that errors follow `rtol` as those of other
    /// methods do. RADAU5.
    pub fn new(tableau: &'static Radau, n: usize, control: &Control) -> Self {
        let zero = || Y::from_fn(n, |_| 0.0);
        let three = || std::array::from_fn(|_| zero());
        let tolerance = match control {
            Control::Fixed(_) => None,
            Control::Adaptive(Tolerance { rtol, atol }) => {
                let held = 0.1 * libm::pow(*rtol, 2.0 / 3.0);
                let atol = atol.iter().map(|atol| atol * (held / rtol)).collect();
                Some(Tolerance { rtol: held, atol })
            }
        };
        let rest = tolerance.as_ref().map_or(0.0, |tolerance| {
            (10.0 * f64::EPSILON / tolerance.rtol).max(tolerance.rtol.sqrt().min(REST))
        });
        let step = RadauStep {
            t0: 0.0,
            t1: 0.0,
            h: 0.0,
            y0: zero(),
            y1: zero(),
            slope0: zero(),
            slope1: zero(),
            error: zero(),
            bend: [zero(), zero()],
            tableau,
        };
        Self {
            tableau,
            tolerance,
            rest,
            jacobian: Jacobian::new(n),
            real: Shifted::new(n),
            complex: Shifted::new(n),
            is_linearised: false,
            is_completed: false,
            has_converged: true,
            guess: three(),
            h_guess: None,
            left: 1.0,
            z: three(),
            w: three(),
            k: three(),
            y_stage: zero(),
            delta: zero(),
            delta_pair: vec![Complex::new(0.0, 0.0); n],
            scale: zero(),
            step,
        }
    }

    /// Entries `i` of three vectors.
    #[inline]
    fn at(vectors: &[Y; 3], i: usize) -> [f64; 3] {
        vectors.each_ref().map(|v| v.as_ref()[i])
    }

    #[inline]
    fn set(vectors: &mut [Y; 3], i: usize, values: [f64; 3]) {
        for (vector, value) in vectors.iter_mut().zip(values) {
            vector.as_mut()[i] = value;
        }
    }

    fn n(&self) -> usize {
        self.delta_pair.len()
    }

    /// Begins an iteration at the guess, or at zero increments where there is none.
    fn begin(&mut self) {
        let Some(h_guess) = self.h_guess else {
            self.z.iter_mut().chain(&mut self.w).for_each(|all| all.as_mut().fill(0.0));
            return;
        };
        let x = self.tableau.c.map(|c| c * self.step.h / h_guess);
        for i in 0..self.n() {
            let [g1, g2, g3] = Self::at(&self.guess, i);
            let z = x.map(|x| x * (g1 + x * (g2 + x * g3)));
            Self::set(&mut self.z, i, z);
            Self::set(&mut self.w, i, transformed(&self.tableau.t_inverse, z));
        }
    }

    /// Solves the equations of the stages: under a tolerance to a part of it, otherwise, and for
    /// steps retaken, to rounding, so that their ends are a function of `h` alone.
    ///
    /// Corrections that shrink by the rate θ leave θ/(1 − θ) of the last one. The first correction is
    /// judged by what the iteration before left, under a tolerance alone. RADAU5.
    fn iterate<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) -> Iteration {
        let tolerance = self.tolerance.as_ref().filter(|_| !self.is_completed);
        let is_to_rounding = tolerance.is_none();
        let (most, rest, noise) = match tolerance {
            Some(tolerance) => {
                let y0 = self.step.y0.as_ref().iter().zip(&tolerance.atol);
                for (scale, (y0, atol)) in self.scale.as_mut().iter_mut().zip(y0) {
                    *scale = atol + tolerance.rtol * y0.abs();
                }
                (ITERATIONS, self.rest, 1e-3 * self.rest)
            }
            None => (ITERATIONS_TO_ROUNDING, f64::EPSILON, NOISE),
        };
        self.begin();
        self.left = if is_to_rounding {
            f64::INFINITY
        } else {
            libm::pow(self.left.max(f64::EPSILON), 0.8)
        };
        let (mut first, mut last, mut last_rate) = (f64::NAN, f64::NAN, f64::NAN);
        for n in 1..=most {
            if let Some(component) = self.evaluate_stages(problem, mode, stats) {
                return Iteration::NotFinite(component);
            }
            self.correct(stats);
            if n == 1 && is_to_rounding {
                self.weigh_by_size();
            }
            let size = self.correction();
            if size == 0.0 {
                return Iteration::Converged;
            }
            if n == 1 {
                first = size;
            }
            if n > 1 {
                let ratio = size / last;
                let rate = if n == 2 { ratio } else { (ratio * last_rate).sqrt() };
                last_rate = ratio;
                if rate < 0.99 {
                    self.left = rate / (1.0 - rate);
                    // Given up at once where the iterations left will not do.
                    let to_come = most.saturating_sub(n + 1) as f64;
                    let in_the_end = self.left * size * libm::pow(rate, to_come);
                    if in_the_end > rest && !is_to_rounding {
                        return Iteration::Diverged;
                    }
                } else if size <= noise {
                    // Rounding: it gets no better.
                    return Iteration::Converged;
                } else if !is_to_rounding {
                    return Iteration::Diverged;
                }
            }
            if !size.is_finite() || size > GROWTH * first {
                return Iteration::Diverged;
            }
            if self.left * size <= rest {
                return Iteration::Converged;
            }
            last = size;
        }
        Iteration::Diverged
    }

    /// The slopes at the stages; the first state whose slope is not finite.
    fn evaluate_stages<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) -> Option<usize> {
        for ((c, z), k) in self.tableau.c.iter().zip(&self.z).zip(&mut self.k) {
            let states = self.step.y0.as_ref().iter().zip(z.as_ref());
            for (y, (y0, z)) in self.y_stage.as_mut().iter_mut().zip(states) {
                *y = y0 + z;
            }
            problem.rhs(mode, self.step.t0 + c * self.step.h, &self.y_stage, k);
            stats.work.n_rhs += 1;
            if let Some(component) = k.as_ref().iter().position(|slope| !slope.is_finite()) {
                return Some(component);
            }
        }
        None
    }

    /// One correction of `w`, and with it of `z`.
    fn correct(&mut self, stats: &mut Stats) {
        let tableau = self.tableau;
        let shift = Complex::new(tableau.complex[0], tableau.complex[1]);
        let h = self.step.h;
        for i in 0..self.n() {
            let f = transformed(&tableau.t_inverse, Self::at(&self.k, i));
            let w = Self::at(&self.w, i);
            self.delta.as_mut()[i] = h * f[0] - tableau.real * w[0];
            self.delta_pair[i] =
                Complex::new(h * f[1], h * f[2]) - shift * Complex::new(w[1], w[2]);
        }
        self.real.solve(self.delta.as_mut());
        self.complex.solve(&mut self.delta_pair);
        stats.work.n_lin_solves += 2;
        for i in 0..self.n() {
            let [w1, w2, w3] = Self::at(&self.w, i);
            let (delta, pair) = (self.delta.as_ref()[i], self.delta_pair[i]);
            let w = [w1 + delta, w2 + pair.re, w3 + pair.im];
            Self::set(&mut self.w, i, w);
            Self::set(&mut self.z, i, transformed(&tableau.t, w));
        }
    }

    /// Weighs corrections by what the states are and become over the step.
    fn weigh_by_size(&mut self) {
        let mut largest = 0.0_f64;
        for i in 0..self.n() {
            let [a, b, c] = Self::at(&self.z, i).map(f64::abs);
            let size = self.step.y0.as_ref()[i].abs() + a.max(b).max(c);
            self.scale.as_mut()[i] = size;
            largest = largest.max(size);
        }
        for scale in self.scale.as_mut() {
            *scale += SMALLEST * largest;
        }
    }

    /// Root mean square of the last correction, weighed.
    fn correction(&self) -> f64 {
        let mut sum = 0.0;
        let deltas = self.delta.as_ref().iter().zip(&self.delta_pair);
        for ((real, pair), scale) in deltas.zip(self.scale.as_ref()) {
            // The scale is zero where nothing moves.
            for delta in [*real, pair.re, pair.im].into_iter().filter(|delta| *delta != 0.0) {
                sum += (delta / scale) * (delta / scale);
            }
        }
        (sum / (3 * self.n()) as f64).sqrt()
    }

    /// The end of the step and its polynomial, from the stages.
    fn finish(&mut self) {
        for i in 0..self.n() {
            let z = Self::at(&self.z, i);
            let step = &mut self.step;
            step.y1.as_mut()[i] = step.y0.as_ref()[i] + z[2];
            let [e, d] = self.tableau.bend(z);
            step.bend[0].as_mut()[i] = e;
            step.bend[1].as_mut()[i] = d;
        }
    }

    /// The error from the slope at the start, which is in `y_stage`.
    fn estimate(&mut self, stats: &mut Stats) {
        let step = &mut self.step;
        let z3 = self.z[2].as_ref();
        let bend = step.bend[0].as_ref();
        for (i, error) in step.error.as_mut().iter_mut().enumerate() {
            *error = step.h * self.y_stage.as_ref()[i] - (z3[i] - bend[i]);
        }
        self.real.solve(step.error.as_mut());
        stats.work.n_lin_solves += 1;
    }

    /// The same once more where the error is not tolerated, with the slope at `y₀ + error` in place of
    /// that at the start: a stiff state off its slow solution has a first estimate far too large.
    fn estimate_again<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) {
        let step = &mut self.step;
        for (error, y0) in step.error.as_mut().iter_mut().zip(step.y0.as_ref()) {
            *error += y0;
        }
        problem.rhs(mode, step.t0, &step.error, &mut self.y_stage);
        stats.work.n_rhs += 1;
        if self.y_stage.as_ref().iter().all(|slope| slope.is_finite()) {
            self.estimate(stats);
        } else {
            for (error, y0) in step.error.as_mut().iter_mut().zip(step.y0.as_ref()) {
                *error -= y0;
            }
        }
    }

    /// Makes the cubic of the last attempt the guess for others from the same start.
    fn keep_polynomial(&mut self) {
        for i in 0..self.n() {
            let z3 = self.z[2].as_ref()[i];
            let [e, d] = self.step.bend.each_ref().map(|bend| bend.as_ref()[i]);
            Self::set(&mut self.guess, i, [z3 - e, e - d, d]);
        }
        self.h_guess = Some(self.step.h);
    }

    /// Continues the guess beyond its end.
    fn shift_guess(&mut self) {
        for i in 0..self.n() {
            let [g1, g2, g3] = Self::at(&self.guess, i);
            Self::set(&mut self.guess, i, [g1 + 2.0 * g2 + 3.0 * g3, g2 + 3.0 * g3, g3]);
        }
    }
}

impl<P: System> OneStep<P> for RadauMethod<P::State<f64>> {
    type Step = RadauStep<P::State<f64>>;

    fn embedded_order(&self) -> Option<usize> {
        Some(self.tableau.embedded_order)
    }

    fn restart(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        stats: &mut Stats,
    ) {
        let step = &mut self.step;
        (step.t0, step.t1, step.h) = (t, t, 0.0);
        step.y0.clone_from(y);
        step.y1.clone_from(y);
        problem.rhs(mode, t, y, &mut step.slope0);
        stats.work.n_rhs += 1;
        (self.is_linearised, self.is_completed) = (false, false);
        (self.h_guess, self.left) = (None, 1.0);
    }

    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        let tableau = self.tableau;
        (self.step.t1, self.step.h) = (t1, h);
        if !std::mem::replace(&mut self.is_linearised, true) {
            let non_finite = self.jacobian.evaluate(problem, mode, self.step.t0, &self.step.y0);
            stats.work.n_jac += 1;
            if let Some(component) = non_finite {
                (self.is_linearised, self.has_converged) = (false, true);
                return self.step.spoil(component);
            }
        }
        self.real.factorise(&self.jacobian, tableau.real, h);
        let shift = Complex::new(tableau.complex[0], tableau.complex[1]);
        self.complex.factorise(&self.jacobian, shift, h);
        stats.work.n_factorisations += 2;
        let end = self.iterate(problem, mode, stats);
        self.has_converged = !matches!(end, Iteration::Diverged);
        match end {
            Iteration::Diverged => return,
            Iteration::NotFinite(component) => return self.step.spoil(component),
            Iteration::Converged => self.finish(),
        }
        self.y_stage.clone_from(&self.step.slope0);
        self.estimate(stats);
        if self.tolerance.as_ref().is_some_and(|tolerance| self.step.norm_sq(tolerance) > 1.0) {
            self.estimate_again(problem, mode, stats);
        }
    }

    fn has_converged(&self) -> bool {
        self.has_converged
    }

    fn repeats(&self) -> bool {
        self.tolerance.is_none()
    }

    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        let step = &mut self.step;
        problem.rhs(mode, step.t1, &step.y1, &mut step.slope1);
        stats.work.n_rhs += 1;
        if !std::mem::replace(&mut self.is_completed, true) {
            self.keep_polynomial();
        }
    }

    fn advance(&mut self) {
        self.keep_polynomial();
        self.shift_guess();
        let step = &mut self.step;
        step.t0 = step.t1;
        std::mem::swap(&mut step.y0, &mut step.y1);
        std::mem::swap(&mut step.slope0, &mut step.slope1);
        (self.is_linearised, self.is_completed) = (false, false);
    }

    fn step(&self) -> &Self::Step {
        &self.step
    }

    fn error(&self) -> &P::State<f64> {
        &self.step.error
    }

    fn error_norm_sq(&self, tolerance: &Tolerance) -> f64 {
        self.step.norm_sq(self.tolerance.as_ref().unwrap_or(tolerance))
    }
}

impl<Y: Vector<f64>> RadauStep<Y> {
    fn norm_sq(&self, tolerance: &Tolerance) -> f64 {
        tolerance.norm_sq(self.error.as_ref(), self.y0.as_ref(), self.y1.as_ref())
    }

    /// Makes `component` of the end no number: a linear solve would spread it to all.
    fn spoil(&mut self, component: usize) {
        self.y1.clone_from(&self.y0);
        self.y1.as_mut()[component] = f64::NAN;
        self.error.as_mut().fill(0.0);
        self.error.as_mut()[component] = f64::NAN;
    }
}

impl<Y: Vector<f64>> Step<Y> for RadauStep<Y> {
    fn t0(&self) -> f64 {
        self.t0
    }

    fn t1(&self) -> f64 {
        self.t1
    }

    fn y0(&self) -> &Y {
        &self.y0
    }

    fn y1(&self) -> &Y {
        &self.y1
    }

    fn slope0(&self) -> &Y {
        &self.slope0
    }

    fn slope1(&self) -> &Y {
        &self.slope1
    }

    fn interpolate(&self, t: f64, y: &mut Y) {
        if t == self.t1 {
            y.clone_from(&self.y1);
            return;
        }
        let theta = (t - self.t0) / self.h;
        let rest = 1.0 - theta;
        let bubble = self.tableau.real * rest * (1.0 - theta / self.tableau.bubble_root);
        let ends = self.y0.as_ref().iter().zip(self.y1.as_ref());
        let [e, d] = self.bend.each_ref().map(|bend| bend.as_ref());
        let bends = self.error.as_ref().iter().zip(e.iter().zip(d));
        for ((y, (y0, y1)), (error, (e, d))) in y.as_mut().iter_mut().zip(ends).zip(bends) {
            *y = rest * y0 + theta * y1 + theta * rest * (bubble * error - e - theta * d);
        }
    }
}
