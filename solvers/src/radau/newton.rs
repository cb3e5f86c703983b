//! The stages of a Radau step, computed by Newton iteration.

mod attempt;
mod guess;

use num_complex::Complex;

use super::convergence::{Convergence, Iteration};
use super::full::FullMatrix;
use super::{Radau, RadauStep, transformed};
use crate::control::Control;
use crate::linear::{Jacobian, Shifted};
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;
use guess::StartingGuess;

/// Largest error that the iteration may leave, κ, as a fraction of the tolerance of the estimate. RADAU5.
const NEWTON_TOLERANCE_MAX: f64 = 0.03;
/// A correction up to this many times the estimated rounding is taken for rounding once the iteration does not converge.
const ROUNDINGS: f64 = 30.0;
/// States smaller than this fraction of the largest one are iterated as if they had that size.
const SMALLEST: f64 = 1e-6;

/// Full Newton iteration pays for steps this many times longer than those that simplified iteration can solve. An
/// attempt by it takes about four times as long (5.6 µs and 1.4 µs on contacts of six states of 1e12 and 1e7 N/m), and
/// simplified iteration, which must stay below the size that it cannot solve, gets on by two thirds of that size per
/// attempt.
const PAYING: f64 = 3.0;
/// Number of steps by full Newton iteration before simplified iteration is tried again. A vain try costs two or three
/// of its iterations.
const FULL_STEPS: usize = 16;
/// Number of corrections by full iteration that may grow. Where a stiff force holds the motion near a curve, a
/// correction along the tangent leaves the curve by its square, and the force of that distance spoils the next one.
const PATIENCE: usize = 3;

/// A Radau method applied to one system.
pub struct RadauMethod<Y> {
    tableau: &'static Radau,
    /// The tolerance for the error estimate; `None` with a fixed step.
    estimate_tolerance: Option<Tolerance>,
    /// The tolerance of the run; `None` with a fixed step.
    run_tolerance: Option<Tolerance>,
    /// Error that an iteration may leave, as a fraction of the tolerance of the estimate: κ of Hairer & Wanner, FNEWT of RADAU5,
    /// `max(10 ε/rtol, min(0.03, √rtol))` with the rtol of the estimate.
    newton_tolerance: f64,
    jacobian: Jacobian,
    real: Shifted<f64>,
    complex: Shifted<Complex<f64>>,
    full: FullMatrix,
    /// Number of steps still to be taken by full Newton iteration.
    n_full: usize,
    /// Least step size at which simplified iteration diverged, since it last converged at a larger one.
    least_diverged: f64,
    /// Square of the norm of the error of the step before.
    error_before_sq: f64,
    /// Whether the Jacobian is evaluated at the present start.
    is_linearised: bool,
    /// Whether a step from the present start was completed. Further attempts are then retaken steps.
    is_completed: bool,
    has_converged: bool,
    guess: StartingGuess<Y>,
    /// Whether phases begin on the slow solution, where the slope at the start is a good guess.
    starts_on_slow_solution: bool,
    /// `η = θ/(1 − θ)` of the last iteration, whose corrections shrank by the factor θ: the error after a correction is η times
    /// the correction. Hairer & Wanner, IV.8.
    eta: f64,
    z: [Y; 3],
    w: [Y; 3],
    k: [Y; 3],
    y_stages: [Y; 3],
    /// Slope at the start, or near it, that the error estimate is made of.
    slope: Y,
    delta: Y,
    delta_pair: Vec<Complex<f64>>,
    /// Scale of each state by which corrections are divided.
    scale: Y,
    step: RadauStep<Y>,
}

impl<Y: Vector<f64>> RadauMethod<Y> {
    /// The method of `tableau` for systems of `n` states, with steps chosen by `control`.
    ///
    /// The error estimate falls as h⁴, but the local error of the solution as h⁶. So the estimate is compared with
    /// `rtol^(2/3)/10`, and with `atol` in the same ratio; errors then follow `rtol` as those of other methods do.
    /// RADAU5.
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
        let newton_tolerance = tolerance.as_ref().map_or(0.0, |tolerance| {
            (10.0 * f64::EPSILON / tolerance.rtol)
                .max(tolerance.rtol.sqrt().min(NEWTON_TOLERANCE_MAX))
        });
        Self {
            tableau,
            estimate_tolerance: tolerance,
            run_tolerance: control.tolerance().cloned(),
            newton_tolerance,
            jacobian: Jacobian::new(n),
            real: Shifted::new(n),
            complex: Shifted::new(n),
            full: FullMatrix::new(tableau, n),
            n_full: 0,
            least_diverged: f64::INFINITY,
            error_before_sq: f64::NAN,
            is_linearised: false,
            is_completed: false,
            has_converged: true,
            guess: StartingGuess::new(n),
            starts_on_slow_solution: false,
            eta: 1.0,
            z: three(),
            w: three(),
            k: three(),
            y_stages: three(),
            slope: zero(),
            delta: zero(),
            delta_pair: vec![Complex::new(0.0, 0.0); n],
            scale: zero(),
            step: RadauStep::new(tableau, n),
        }
    }

    /// The method for phases that begin on the slow solution, as after steps of another method: the first iteration
    /// of a phase begins along the slope and not at zero increments.
    pub(crate) fn on_slow_solutions(self) -> Self {
        Self { starts_on_slow_solution: true, ..self }
    }

    /// Entry `i` of each of three vectors.
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

    /// Starts an iteration at the guess, or at zero increments where there is no guess.
    fn begin(&mut self) {
        let Some(h_guess) = self.guess.h else {
            self.z.iter_mut().chain(&mut self.w).for_each(|all| all.as_mut().fill(0.0));
            return;
        };
        let x = self.tableau.c.map(|c| c * self.step.h / h_guess);
        for i in 0..self.n() {
            let [g1, g2, g3] = Self::at(&self.guess.polynomial, i);
            let z = x.map(|x| x * (g1 + x * (g2 + x * g3)));
            self.guess.end.as_mut()[i] = z[2];
            Self::set(&mut self.z, i, z);
            Self::set(&mut self.w, i, transformed(&self.tableau.t_inverse, z));
        }
    }

    /// Solves the equations of the stages, by full Newton iteration while steps are to be taken by it. Under a
    /// tolerance the error is reduced to a fraction of it. With fixed steps, and for retaken steps, the iteration
    /// continues to rounding, so that the end of the step is a function of `h` alone.
    fn iterate<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) -> Iteration {
        let is_full = self.n_full > 0;
        let mut convergence = self.convergence(is_full);
        self.begin();
        let mut end = Iteration::Diverged;
        for n in 1..=convergence.most {
            if let Some(component) = self.evaluate_stages(problem, mode.clone(), stats) {
                end = Iteration::NotFinite(component);
                break;
            }
            self.evaluate_residual();
            if is_full {
                self.solve_fully(problem, mode.clone(), stats);
            } else {
                self.real.solve(self.delta.as_mut());
                self.complex.solve(&mut self.delta_pair);
                stats.work.n_lin_solves += 2;
            }
            self.correct();
            if n == 1 && convergence.is_to_rounding {
                self.weigh_by_size();
            }
            let size = self.correction();
            if let Some(ended) = convergence.judge(n, size) {
                let is_done = matches!(ended, Iteration::Diverged)
                    && !convergence.is_to_rounding
                    && self.is_of_rounding(size, stats);
                end = if is_done { Iteration::Converged } else { ended };
                break;
            }
        }
        // The corrections of full iteration shrink ever faster, so their rate says nothing of the next iteration.
        self.eta = if is_full { 1.0 } else { convergence.eta };
        end
    }

    /// Whether full iteration pays after simplified iteration diverged: this step, or the step that the error of the
    /// one before allows, is [so many times](PAYING) longer than one that simplified iteration can solve.
    /// A retaken step begins no full iteration.
    fn full_pays(&mut self) -> bool {
        let (Some(h_before), false) = (self.guess.h, self.is_completed) else { return false };
        let h = self.step.h.abs();
        self.least_diverged = self.least_diverged.min(h);
        let exponent = 0.5 / (self.tableau.embedded_order + 1) as f64;
        let allowed = h_before.abs() / libm::pow(self.error_before_sq, exponent);
        h.max(allowed) >= PAYING * self.least_diverged
    }

    /// The test of convergence of an iteration that is to begin. Under a tolerance it also sets the scales of the
    /// corrections.
    fn convergence(&mut self, is_full: bool) -> Convergence {
        let Some(tolerance) = self.estimate_tolerance.as_ref().filter(|_| !self.is_completed)
        else {
            return Convergence::to_rounding();
        };
        let y0 = self.step.y0.as_ref().iter().zip(&tolerance.atol);
        for (scale, (y0, atol)) in self.scale.as_mut().iter_mut().zip(y0) {
            *scale = atol + tolerance.rtol * y0.abs();
        }
        let patience = if is_full { PATIENCE } else { 0 };
        Convergence::to_tolerance(self.newton_tolerance, self.eta, patience)
    }

    /// Evaluates the slopes at the stages. Returns the first state whose slope is not finite, if there is one.
    fn evaluate_stages<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) -> Option<usize> {
        self.set_stages();
        let times = self.stage_times();
        for ((t, k), y) in times.iter().zip(&mut self.k).zip(&self.y_stages) {
            problem.rhs(mode.clone(), *t, y, k);
            stats.work.n_rhs += 1;
            if let Some(component) = k.as_ref().iter().position(|slope| !slope.is_finite()) {
                return Some(component);
            }
        }
        None
    }

    /// Sets the states of the stages.
    fn set_stages(&mut self) {
        for (y, z) in self.y_stages.iter_mut().zip(&self.z) {
            let states = self.step.y0.as_ref().iter().zip(z.as_ref());
            for (y, (y0, z)) in y.as_mut().iter_mut().zip(states) {
                *y = y0 + z;
            }
        }
    }

    fn stage_times(&self) -> [f64; 3] {
        self.tableau.c.map(|c| self.step.t0 + c * self.step.h)
    }

    /// Computes the right-hand side of the equation of a correction of `w`.
    fn evaluate_residual(&mut self) {
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
    }

    /// Replaces the residual by the correction of full Newton iteration.
    fn solve_fully<P: System<State<f64> = Y>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        stats: &mut Stats,
    ) {
        self.full.factorise(problem, mode, self.stage_times(), &self.y_stages, self.step.h);
        for i in 0..self.n() {
            let (real, pair) = (self.delta.as_ref()[i], self.delta_pair[i]);
            self.full.set(i, transformed(&self.tableau.t, [real, pair.re, pair.im]));
        }
        self.full.solve();
        for i in 0..self.n() {
            let [real, re, im] = transformed(&self.tableau.t_inverse, self.full.at(i));
            self.delta.as_mut()[i] = real;
            self.delta_pair[i] = Complex::new(re, im);
        }
        stats.work.n_jac += 3;
        stats.work.n_factorisations += 1;
        stats.work.n_lin_solves += 1;
    }

    /// Corrects `w` and updates `z`.
    fn correct(&mut self) {
        for i in 0..self.n() {
            let [w1, w2, w3] = Self::at(&self.w, i);
            let (delta, pair) = (self.delta.as_ref()[i], self.delta_pair[i]);
            let w = [w1 + delta, w2 + pair.re, w3 + pair.im];
            Self::set(&mut self.w, i, w);
            Self::set(&mut self.z, i, transformed(&self.tableau.t, w));
        }
    }

    /// Sets the scale of each state to its size at the start plus its largest change over the step.
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

    /// Root mean square of the last correction, divided by the scales.
    fn correction(&self) -> f64 {
        let mut sum = 0.0;
        let deltas = self.delta.as_ref().iter().zip(&self.delta_pair);
        for ((real, pair), scale) in deltas.zip(self.scale.as_ref()) {
            // A correction of zero is left out, because the scale is zero where all states are zero.
            for delta in [*real, pair.re, pair.im].into_iter().filter(|delta| *delta != 0.0) {
                sum += (delta / scale) * (delta / scale);
            }
        }
        (sum / (3 * self.n()) as f64).sqrt()
    }

    /// Whether a correction of this size is one of rounding, within the tolerance. States of the stages are rounded by
    /// e = ε |y|, their slopes then differ by J e, and the solution by about
    ///
    /// ```text
    /// (γ I − hJ)⁻¹ hJ e = γ (γ I − hJ)⁻¹ e − e
    /// ```
    ///
    /// Of a position x that a stiff force holds, this is γ ε x/h in its velocity: more, the shorter the step is.
    fn is_of_rounding(&mut self, size: f64, stats: &mut Stats) -> bool {
        let y0 = self.step.y0.as_ref();
        for (noise, y0) in self.delta.as_mut().iter_mut().zip(y0) {
            *noise = self.tableau.real * f64::EPSILON * y0.abs();
        }
        self.real.solve(self.delta.as_mut());
        stats.work.n_lin_solves += 1;
        let of_states = self.delta.as_ref().iter().zip(y0).zip(self.scale.as_ref());
        let squares = of_states.map(|((noise, y0), scale)| {
            let part = (noise - f64::EPSILON * y0.abs()) / scale;
            part * part
        });
        let noise = (squares.sum::<f64>() / self.n() as f64).sqrt();
        size <= 1.0 && size <= ROUNDINGS * noise
    }

    /// Computes the end of the step and its polynomial from the stages.
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

    /// Computes the error estimate from `slope`.
    fn estimate(&mut self, stats: &mut Stats) {
        let step = &mut self.step;
        let z3 = self.z[2].as_ref();
        let bend = step.bend[0].as_ref();
        for (i, error) in step.error.as_mut().iter_mut().enumerate() {
            *error = step.h * self.slope.as_ref()[i] - (z3[i] - bend[i]);
        }
        self.real.solve(step.error.as_mut());
        stats.work.n_lin_solves += 1;
    }

    /// Repeats the estimate with the slope at `y₀ + error` in place of that at the start, for a step whose first
    /// estimate exceeds the tolerance. The first estimate of a stiff state that is not on its slow solution is far
    /// too large.
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
        problem.rhs(mode, step.t0, &step.error, &mut self.slope);
        stats.work.n_rhs += 1;
        if self.slope.as_ref().iter().all(|slope| slope.is_finite()) {
            self.estimate(stats);
        } else {
            for (error, y0) in step.error.as_mut().iter_mut().zip(step.y0.as_ref()) {
                *error -= y0;
            }
        }
    }

    /// Estimates the error from the difference of the end and the guess, for a step by full Newton iteration. The
    /// estimate by the defect says nothing of states that are stiff at the start and not at the end, and simplified
    /// iteration, which diverges there, does not come to it. On smooth solutions the estimates are equal:
    ///
    /// ```text
    /// error = −c₁c₂/(6γ) h⁴y⁗,   y₁ − guess = (1/4 + (2 − c₁ − c₂)/(3r) + (1 − c₁)(1 − c₂)/(2r²)) h⁴y⁗/6
    /// ```
    ///
    /// with r the size of the step divided by that of the step before.
    fn estimate_from_guess(&mut self) {
        let (Some(tolerance), Some(h_guess)) = (&self.estimate_tolerance, self.guess.h) else {
            return;
        };
        let ends = self.z[2].as_ref().iter().zip(self.guess.end.as_mut());
        ends.for_each(|(z, guess)| *guess = z - *guess);
        let ([c1, c2, _], r) = (self.tableau.c, self.step.h / h_guess);
        let apart = 0.25 + ((2.0 - c1 - c2) / 3.0 + 0.5 * (1.0 - c1) * (1.0 - c2) / r) / r;
        let ratio = apart * self.tableau.real / (c1 * c2);
        let (y0, y1) = (self.step.y0.as_ref(), self.step.y1.as_ref());
        self.guess.error_sq = tolerance.norm_sq(self.guess.end.as_ref(), y0, y1) / (ratio * ratio);
    }

    /// Square of the norm of the larger error estimate; not a number where that by the defect is none.
    fn error_sq(&self, tolerance: &Tolerance) -> f64 {
        let of_defect = self.step.norm_sq(tolerance);
        if of_defect < self.guess.error_sq { self.guess.error_sq } else { of_defect }
    }

    /// Makes the cubic of the last attempt the guess for further attempts from the same start.
    fn keep_polynomial(&mut self) {
        for i in 0..self.n() {
            let z3 = self.z[2].as_ref()[i];
            let [e, d] = self.step.bend.each_ref().map(|bend| bend.as_ref()[i]);
            Self::set(&mut self.guess.polynomial, i, [z3 - e, e - d, d]);
        }
        self.guess.h = Some(self.step.h);
    }

    /// Moves the origin of the guess to the end of the step, so that it extrapolates over the next step.
    fn shift_guess(&mut self) {
        for i in 0..self.n() {
            let [g1, g2, g3] = Self::at(&self.guess.polynomial, i);
            Self::set(&mut self.guess.polynomial, i, [g1 + 2.0 * g2 + 3.0 * g3, g2 + 3.0 * g3, g3]);
        }
    }
}
