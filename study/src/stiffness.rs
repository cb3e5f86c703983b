//! Whether the steps of a run are bound by stability: a recorder that looks at the fastest decay now and then.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Needs, Record};

use crate::problem::{Problem, scales};
use crate::warning::{Code, Warning};

/// Accepted steps from one look to the next.
const STEPS_A_LOOK: u64 = 256;
/// A step longer than this many times of decay resolves none of them: what bounds it is stability. Steps of an
/// explicit method reach 3 (rk45) to 5 (vern98, high series) there, and less than one where accuracy bounds them.
const UNRESOLVED: f64 = 2.0;
/// Iterations for the fastest decay; a rough value is enough.
const ITERATIONS: usize = 40;

/// Looks at a run after which a warning is told at once.
const PATIENCE: u64 = 100;

/// Looks at the steps of a run of `problem` by an explicit method.
pub struct Stiffness<'a, P> {
    problem: &'a P,
    /// Told the warning once, as soon as it holds of a run that is long.
    tell: &'a dyn Fn(&Warning),
    is_told: bool,
    n_steps: u64,
    n_looks: u64,
    /// Looks at steps bound by stability.
    n_bound: u64,
    /// Largest rate of decay seen \[1/s\], and the step there [s].
    fastest: (f64, f64),
    /// Mode there.
    mode: String,
}

impl<'a, P: Problem> Stiffness<'a, P> {
    /// No step yet.
    pub fn new(problem: &'a P, tell: &'a dyn Fn(&Warning)) -> Self {
        let (n_steps, n_looks, n_bound) = (0, 0, 0);
        let (fastest, mode) = ((0.0, 0.0), String::new());
        Self { problem, tell, is_told: false, n_steps, n_looks, n_bound, fastest, mode }
    }

    /// The warning that most of the steps were bound by stability, if they were.
    pub fn warning(&self) -> Option<Warning> {
        let (rate, h) = self.fastest;
        let message = format!(
            "{:.0} % of the steps are bound by stability, not by the tolerance: the motion decays at {rate:.1e} 1/s \
             in mode {}, and an explicit step there is at most some {h:.1e} s long; take an implicit method \
             (radau5)",
            100.0 * self.n_bound as f64 / self.n_looks.max(1) as f64,
            self.mode
        );
        (2 * self.n_bound > self.n_looks).then_some(Warning { code: Code::Stiff, message })
    }

    /// The fastest decay at `(t, y)` in `mode` \[1/s\], states measured by their scales.
    fn decay(&self, mode: &P::Mode, t: f64, y: &P::State<f64>) -> f64 {
        let scales = scales(self.problem);
        let mut entries = Vec::new();
        self.problem.jacobian(mode.clone(), t, y, |i, j, entry| {
            // Bristles that never bend have no scale.
            if scales[i] > 0.0 {
                entries.push((i, j, entry * scales[j] / scales[i]));
            }
        });
        fastest_decay(&entries, scales.len())
    }
}

/// `−Re λ` of the eigenvalue largest in size of the `n × n` matrix with these entries, and of a real pair the
/// larger one; zero where the matrix is nilpotent or not finite.
///
/// By the power method. A pair has no limit there, but spans it: with `w = A v` and `A w = s w − p v`, by least
/// squares, its eigenvalues are the roots of `λ² − s λ + p`.
fn fastest_decay(entries: &[(usize, usize, f64)], n: usize) -> f64 {
    let times = |v: &[f64]| {
        let mut product = vec![0.0; n];
        for (i, j, entry) in entries {
            product[*i] += entry * v[*j];
        }
        product
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut v = vec![1.0; n];
    for _ in 0..ITERATIONS {
        let w = times(&v);
        let length = dot(&w, &w).sqrt();
        if length == 0.0 || !length.is_finite() {
            return 0.0;
        }
        v = w.iter().map(|w| w / length).collect();
    }
    let w = times(&v);
    let w2 = times(&w);
    let (ww, wv, vv) = (dot(&w, &w), dot(&w, &v), dot(&v, &v));
    let determinant = ww * vv - wv * wv;
    if determinant <= 1e-10 * ww * vv {
        return -wv / vv;
    }
    let s = (dot(&w2, &w) * vv - dot(&w2, &v) * wv) / determinant;
    let p = (dot(&w2, &w) * wv - dot(&w2, &v) * ww) / determinant;
    -0.5 * s + (0.25 * s * s - p).max(0.0).sqrt()
}

impl<P: Problem> Record<P> for Stiffness<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.n_steps += 1;
        if self.n_steps.is_multiple_of(STEPS_A_LOOK) {
            let (step, mode) = (accepted.step, &accepted.mode);
            let h = step.t1() - step.t0();
            let rate = self.decay(mode, step.t1(), step.y1());
            self.n_looks += 1;
            if h * rate > UNRESOLVED {
                self.n_bound += 1;
                if rate > self.fastest.0 {
                    self.fastest = (rate, h);
                    self.mode = format!("{mode:?}");
                }
            }
            if !self.is_told
                && self.n_looks >= PATIENCE
                && let Some(warning) = self.warning()
            {
                (self.tell)(&warning);
                self.is_told = true;
            }
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decay_of_an_oscillation_is_that_of_its_amplitude() {
        // ÿ + 2 ζ ω ẏ + ω² y = 0, states measured by 1 and ω₀.
        let zetas = [0.0, 0.02, 0.1, 0.5, 0.9, 2.0, 50.0];
        let of = |at: (f64, f64)| zetas.map(|zeta| (at, zeta));
        for ((omega, scale), zeta) in [(1e4, 1e3), (1e-6, 1e-7)].into_iter().flat_map(of) {
            let entries =
                [(0, 1, scale), (1, 0, -omega * omega / scale), (1, 1, -2.0 * zeta * omega)];
            let expected = omega * (zeta + (zeta * zeta - 1.0_f64).max(0.0).sqrt());
            let decay = fastest_decay(&entries, 2);
            // Measured: 2e-12.
            assert!((decay - expected).abs() < 2e-11 * omega, "{zeta}: {decay:e}, {expected:e}");
        }
        // A triangle has its diagonal as eigenvalues.
        let triangle = [(0, 0, -3.0), (0, 1, 7.0), (1, 1, -100.0), (1, 2, -50.0), (2, 2, -20.0)];
        let decay = fastest_decay(&triangle, 3);
        assert!((decay - 100.0).abs() < 1e-9, "{decay:e}");
        assert_eq!(fastest_decay(&[(0, 1, 1.0)], 2), 0.0);
        assert!(fastest_decay(&[(0, 0, 3.0)], 1) < 0.0);
    }
}
