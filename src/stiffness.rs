//! Whether the steps of a run are bound by stability: a recorder that looks at the fastest decay now and then.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Needs, Record};

use crate::model::Jointed;
use crate::warning::{Code, Warning};

/// Accepted steps from one look to the next.
const STEPS_A_LOOK: u64 = 256;
/// A step longer than this many times of decay resolves none of them: what bounds it is stability. Steps of an
/// explicit method reach 3 (rk45) to 5 (vern98, high series) there, and less than one where accuracy bounds them.
const UNRESOLVED: f64 = 2.0;
/// Iterations for the fastest decay; a rough value is enough.
const ITERATIONS: usize = 20;

/// Looks at the steps of a run of `part` by an explicit method.
#[derive(Clone, Debug)]
pub struct Stiffness<'a, P> {
    part: &'a P,
    n_steps: u64,
    n_looks: u64,
    /// Looks at steps bound by stability.
    n_bound: u64,
    /// Largest rate of decay seen \[1/s\], and the step there [s].
    fastest: (f64, f64),
    /// Mode there.
    mode: String,
}

impl<'a, P: Jointed> Stiffness<'a, P> {
    /// No step yet.
    pub fn new(part: &'a P) -> Self {
        let (n_steps, n_looks, n_bound) = (0, 0, 0);
        Self { part, n_steps, n_looks, n_bound, fastest: (0.0, 0.0), mode: String::new() }
    }

    /// The warning that most of the steps were bound by stability, if they were.
    pub fn warning(&self) -> Option<Warning> {
        let (rate, h) = self.fastest;
        let message = format!(
            "{:.0} % of the steps are bound by stability, not by the tolerance: the contact decays at {rate:.1e} 1/s \
             in mode {}, and an explicit step there is at most some {h:.1e} s long; take an implicit method \
             (radau5), or, of a law with hysteresis whose contact begins slowly, a larger \
             contact.impact_speed_floor",
            100.0 * self.n_bound as f64 / self.n_looks.max(1) as f64,
            self.mode
        );
        (2 * self.n_bound > self.n_looks).then_some(Warning { code: Code::Stiff, message })
    }

    /// The fastest decay at `(t, y)` in `mode` \[1/s\], by the power method on the Jacobian, states measured by their
    /// scales; zero or less where what is fastest does not decay.
    fn decay(&self, mode: &P::Mode, t: f64, y: &P::State<f64>) -> f64 {
        let scales = self.part.scales();
        let scales = scales.as_ref();
        let mut entries = Vec::new();
        self.part.jacobian(mode.clone(), t, y, |i, j, entry| {
            // Bristles have no scale of their own where there are none.
            if scales[i] > 0.0 {
                entries.push((i, j, entry * scales[j] / scales[i]));
            }
        });
        let mut v = vec![1.0; scales.len()];
        let mut decay = 0.0;
        for _ in 0..ITERATIONS {
            let mut next = vec![0.0; v.len()];
            for (i, j, entry) in &entries {
                next[*i] += entry * v[*j];
            }
            let along: f64 = v.iter().zip(&next).map(|(v, next)| v * next).sum();
            decay = -along / v.iter().map(|v| v * v).sum::<f64>();
            let length = next.iter().map(|next| next * next).sum::<f64>().sqrt();
            if length == 0.0 || !length.is_finite() {
                return 0.0;
            }
            v = next.iter().map(|next| next / length).collect();
        }
        decay
    }
}

impl<P: Jointed> Record<P> for Stiffness<'_, P> {
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
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}
