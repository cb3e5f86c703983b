//! The size of the next attempt: after an accepted step, after one that was rejected or failed, and at the start of a phase.

use super::{Due, OneStep, OneStepSolver, PhaseContext, PhaseState, underflow};
use crate::control::Control;
use crate::error::Error;
use crate::phase::{PhaseEnd, check_finite};
use crate::point::Point;
use crate::record::reject;
use crate::step::Step;
use crate::system::System;
use crate::tolerance::Tolerance;
use crate::work::Stats;

impl<P: System, M: OneStep<P>> OneStepSolver<P, M> {
    /// Counts a step of size `h` whose equations were not solved, and makes the next attempt a smaller one. It is an
    /// error where the size is fixed or time does not resolve the smaller size. Returns [`PhaseEnd::Interrupted`]
    /// where the recorder ends the run.
    pub(super) fn unconverged(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        h: f64,
    ) -> Result<Option<PhaseEnd>, Error> {
        let (t, mode) = (context.point.t, context.point.mode.clone());
        let error = || Error::NoConvergence { t, h, mode: format!("{mode:?}") };
        self.shortened(context, phase, h, error)
    }

    /// Counts a step of size `h` that failed, and makes the next attempt half as long. It is the given `error` where
    /// the size is fixed or time does not resolve the smaller size. Returns [`PhaseEnd::Interrupted`] where the
    /// recorder ends the run.
    pub(super) fn shortened(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        h: f64,
        error: impl FnOnce() -> Error,
    ) -> Result<Option<PhaseEnd>, Error> {
        let PhaseContext { point, stats, record, .. } = context;
        let go_on = reject(stats, *record);
        let smaller = self.controller.halved(h);
        let resolved = smaller.filter(|smaller| point.t + 0.1 * smaller != point.t);
        phase.h = resolved.ok_or_else(error)?;
        Ok(go_on.is_break().then_some(PhaseEnd::Interrupted { landed_on: None }))
    }

    /// Counts a rejected step, and makes the next attempt one of size `smaller`; it is an error where time does not
    /// resolve that size. Returns [`PhaseEnd::Interrupted`] where the recorder ends the run.
    pub(super) fn rejected(
        &self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        smaller: f64,
    ) -> Result<Option<PhaseEnd>, Error> {
        let PhaseContext { point, stats, record, .. } = context;
        let go_on = reject(stats, *record);
        if point.t + 0.1 * smaller == point.t {
            check_finite(point, self.method.step().y1())?;
            check_finite(point, self.method.error())?;
            return Err(underflow(point.t, &point.mode, smaller));
        }
        phase.h = smaller;
        Ok(go_on.is_break().then_some(PhaseEnd::Interrupted { landed_on: None }))
    }

    /// Chooses the size of the next step if that is still [due](PhaseState::due). Under adaptive control this is the
    /// size that the method proposes; else the size that the controller made of the last step, after an event no longer than that
    /// step was before it was cut, or a first step size.
    #[inline(always)]
    pub(crate) fn choose_step(
        &mut self,
        problem: &P,
        point: &Point<P>,
        phase: &mut PhaseState,
        stats: &mut Stats,
    ) {
        self.choose_step_by(problem, point, phase, stats, |method, tolerance, stats| {
            method.propose(problem, point.mode.clone(), tolerance, stats)
        });
    }

    /// The same, with `propose` in place of the method's own proposal.
    #[inline(always)]
    pub(crate) fn choose_step_by(
        &mut self,
        problem: &P,
        point: &Point<P>,
        phase: &mut PhaseState,
        stats: &mut Stats,
        propose: impl FnOnce(&mut M, &Tolerance, &mut Stats) -> Option<f64>,
    ) {
        let Some(due) = phase.due.take() else { return };
        let (span, before) = (phase.t_end - point.t, stats.work);
        if span == 0.0 {
            return;
        }
        let proposed = match self.controller.control() {
            Control::Adaptive(tolerance) if M::PROPOSES => {
                propose(&mut self.method, tolerance, stats)
            }
            _ => None,
        };
        self.is_proposed = proposed.is_some();
        // An infinite proposal stands for the whole span.
        let proposed = proposed.map(|h| h.min(span.abs()));
        match due {
            Due::Next => {
                self.last_proposed = proposed.unwrap_or(phase.h).abs();
                phase.h = self.last_proposed.min(self.longest_now).copysign(span);
            }
            Due::First { least } => {
                let h = match (proposed.or(self.next_h), self.controller.control()) {
                    (Some(h), _) | (None, &Control::Fixed(h)) => h,
                    (None, Control::Adaptive(tolerance)) => {
                        self.first_step(tolerance, problem, point, phase.t_end, stats)
                    }
                };
                let first = std::mem::replace(&mut self.first_limit, f64::INFINITY);
                self.last_proposed = h.abs().min(first);
                phase.h = self.last_proposed.min(self.longest_now).max(least).copysign(span);
                stats.restart += stats.work - before;
            }
        }
    }

    /// The size of the next step, of which `h` is proposed after an accepted one.
    #[inline(always)]
    pub(crate) fn next_size(&mut self, h: f64) -> f64 {
        if !(M::PROPOSES && self.is_proposed) {
            self.last_proposed = h.abs();
        }
        h.abs().min(self.longest_now).copysign(h)
    }
}
