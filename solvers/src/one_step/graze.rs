//! Grazing guards of accepted steps.

use super::{OneStep, OneStepSolver, PhaseContext};
use crate::control::Control;
use crate::dense::hermite;
use crate::event_location::{ERROR_GROWTH, FullStep, Graze};
use crate::step::Step;
use crate::system::{System, Vector};

impl<P: System, M: OneStep<P>> OneStepSolver<P, M> {
    /// Counts the guards that graze in the last attempt, an accepted step, and tells the recorder of them. The step landed
    /// on the given guard or on none, and a full step has the size `h`.
    #[inline(always)]
    pub(super) fn tell_grazing(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        landed_on: Option<usize>,
        h: f64,
    ) {
        if landed_on.is_some() || self.watch.touches.are_noted() {
            self.graze(context, landed_on, h);
        }
    }

    #[cold]
    #[inline(never)]
    fn graze(&mut self, context: &mut PhaseContext<'_, P>, landed_on: Option<usize>, h: f64) {
        let PhaseContext { problem, point, stats, record } = context;
        let mode = || point.mode.clone();
        if landed_on.is_none() {
            self.note_error(problem, mode());
        }
        let y = self.method.step().y1().as_ref();
        let of_step = |i: usize| match self.controller.control() {
            Control::Adaptive(tolerance) => tolerance.allowed(i, y),
            Control::Fixed(_) => self.error_of_full.as_ref()[i].abs(),
        };
        let mut told = |graze: Graze| {
            stats.n_grazing += 1;
            record.grazing(&graze.in_mode(point.mode.clone()));
        };
        let error = |i: usize| ERROR_GROWTH * of_step(i);
        let full = FullStep { h, landed_on };
        self.watch.graze(*problem, mode(), self.method.step(), full, &error, &mut told);
    }

    /// Notes an estimate of the error of a fixed step before it is cut at an event: that of the method, or, where it has
    /// none, the [defect] of a cubic. It falls as h⁴, and errors of the classical method do along a run. The work is not
    /// counted.
    pub(super) fn note_error(&mut self, problem: &P, mode: P::Mode) {
        if matches!(self.controller.control(), Control::Adaptive(_)) {
            return;
        }
        if self.method.embedded_order().is_some() {
            self.error_of_full.clone_from(self.method.error());
            return;
        }
        self.error_of_full = defect(problem, mode, self.method.step());
    }
}

/// The defect `h (p′ − f(p))` of the cubic `p` through both ends of a step, at a quarter of it.
fn defect<P: System>(problem: &P, mode: P::Mode, step: &dyn Step<P::State<f64>>) -> P::State<f64> {
    let (t0, h) = (step.t0(), step.t1() - step.t0());
    let mut y = step.y1().clone();
    let ends = ((step.y0(), step.slope0()), (step.y1(), step.slope1()));
    hermite(0.25, h, ends.0, ends.1, &mut y);
    let mut slope = y.clone();
    problem.rhs(mode, t0 + 0.25 * h, &y, &mut slope);
    Vector::from_fn(y.as_ref().len(), |i| {
        let rise = step.y1().as_ref()[i] - step.y0().as_ref()[i];
        let [from, to] = [step.slope0(), step.slope1()].map(|slope| slope.as_ref()[i]);
        // p′(¼) = (18 (y₁ − y₀)/h + 3 ẏ₀ − 5 ẏ₁)/16
        (18.0 * rise + h * (3.0 * from - 5.0 * to)) / 16.0 - h * slope.as_ref()[i]
    })
}
