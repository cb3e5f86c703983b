//! One run of a batch, and how it goes on outside of its lane.

use std::ops::ControlFlow;

use super::{End, Entry};
use crate::auto::{AutoSolver, Turn, Turns};
use crate::control::Control;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::{OneStep, OneStepSolver, PhaseContext, PhaseState};
use crate::phase::PhaseEnd;
use crate::record::{Needs, Record};
use crate::step::Step;
use crate::system::Alike;

/// A run with its recorder, and with the solvers that integrate it where its lane does not.
pub(super) struct Runner<'r, 'a, P: Alike, M> {
    pub(super) run: &'r mut Integration<'a, P>,
    pub(super) record: &'r mut dyn Record<P>,
    control: &'r Control,
    pub(super) solver: OneStepSolver<P, M>,
    /// The implicit method that takes turns with the solver, if one does.
    turns: Option<Turns<'a, P>>,
    /// The turn that follows an explicit one that ended within a phase.
    next: Option<Turn>,
}

/// A phase whose mode has parameters, and these.
type InLane<P> = (PhaseState, <P as Alike>::Parameters<f64>);

impl<'r, 'a, P: Alike, M: OneStep<P>> Runner<'r, 'a, P, M> {
    /// A run by `method`.
    pub(super) fn new(entry: Entry<'r, 'a, P>, method: M) -> Self {
        let Entry { run, control, record, in_turns, .. } = entry;
        let solver = OneStepSolver::new(run.problem, method, control.clone());
        let turns = in_turns.zip(control.tolerance()).map(|(explicit, tolerance)| {
            Turns::new(run.problem, tolerance, f64::INFINITY, explicit)
        });
        Self { run, record, control, solver, turns, next: None }
    }

    /// Unless the run has `ended`, integrates it to the first explicit turn in a mode with parameters. Returns how the
    /// run ended where none comes, and none where it is to go on by another method.
    pub(super) fn enter_lane(
        &mut self,
        mut ended: Option<Outcome>,
        t_end: f64,
    ) -> Result<InLane<P>, End> {
        let failed = |error| Some(Err(error));
        loop {
            if let Some(outcome) = ended {
                return Err(Some(Ok(outcome)));
            }
            if self.run.point.t == t_end {
                return Err(Some(Ok(Outcome::Finished)));
            }
            if self.is_outgrown() {
                return Err(None);
            }
            if let ControlFlow::Break(end) = self.until_explicit(t_end).map_err(failed)? {
                ended = self.run.pass(end, self.record).map_err(failed)?;
                continue;
            }
            if self.run.point.t == t_end {
                continue;
            }
            let Integration { problem, point, stats, .. } = &mut *self.run;
            let mut phase = self.solver.begin(problem, point, t_end, stats).map_err(failed)?;
            if let Some(parameters) = problem.parameters(&point.mode) {
                return Ok((phase, parameters));
            }
            let end = self.solve(|solver, context| solver.finish(context, &mut phase));
            ended = self.pass(end.map_err(failed)?).map_err(failed)?;
        }
    }

    /// Whether a phase begins for which the method is to be chosen anew.
    fn is_outgrown(&mut self) -> bool {
        let Self { run: Integration { problem, point, .. }, turns, next, .. } = self;
        let turns = turns.as_mut().filter(|_| next.is_none());
        turns.is_some_and(|turns| turns.explicit_is_outgrown_at(problem, point))
    }

    /// Integrates through the implicit turns that come first.
    fn until_explicit(&mut self, t_end: f64) -> Result<ControlFlow<PhaseEnd>, Error> {
        let Self { run, record, solver, turns, next, .. } = self;
        let Some(turns) = turns else { return Ok(ControlFlow::Continue(())) };
        let turn =
            next.take().unwrap_or_else(|| turns.begin(run.problem, &run.point, &mut run.stats));
        turns.until_explicit(turn, solver, &mut context(run, *record), t_end)
    }

    /// Passes from a phase that ended, or from an explicit turn within it, to what follows. Returns the outcome where
    /// the run ends instead.
    pub(super) fn pass(&mut self, end: PhaseEnd) -> Result<Option<Outcome>, Error> {
        if self.next.is_some() { Ok(None) } else { self.run.pass(end, self.record) }
    }

    /// What is needed of a step to `t1` that is to be accepted.
    #[inline(always)]
    pub(super) fn needs(&self, t1: f64) -> Needs {
        let needs = self.record.needs(self.run.point.t, t1);
        if self.turns.is_some() { needs.max(Needs::Ends) } else { needs }
    }

    /// Goes on by `f`, which the solver is given to; the recorder and the rule of turns see what is accepted.
    #[inline(always)]
    pub(super) fn solve<T>(
        &mut self,
        f: impl FnOnce(&mut OneStepSolver<P, M>, &mut PhaseContext<'_, P>) -> T,
    ) -> T {
        let Self { run, record, solver, turns, next, .. } = self;
        let Integration { problem, point, stats, .. } = &mut **run;
        let mut leg = None;
        let record: &mut dyn Record<P> = match turns {
            Some(turns) => leg.insert(turns.explicit_leg(problem, *record, stats)),
            None => *record,
        };
        let result = f(solver, &mut PhaseContext { problem, point, stats, record });
        if let Some(leg) = leg {
            *next = leg.over(stats);
        }
        result
    }

    /// Goes on from the middle of a phase to the end of the run.
    pub(super) fn finish(mut self, mut phase: PhaseState) -> Result<Outcome, Error> {
        let (run, OneStepSolver { method, watch, .. }) = (&mut *self.run, &mut self.solver);
        let step = method.step();
        watch.start_at(run.problem, run.point.mode.clone(), step.t0(), step.y0(), step.slope0());
        let end = self.solve(|solver, context| solver.finish(context, &mut phase))?;
        let Self { run, record, control, mut solver, turns, next } = self;
        let Some((mut turns, tolerance)) = turns.zip(control.tolerance()) else {
            let ended = run.pass(end, record)?;
            return run.go_on(ended, phase.t_end, &mut solver, record);
        };
        let end = match next {
            Some(turn) => {
                let mut both = turns.with(&mut solver);
                both.go_on(turn, &mut context(run, record), phase.t_end)?
            }
            None => end,
        };
        let ended = run.pass(end, record)?;
        let mut auto = AutoSolver::of(tolerance.clone(), Box::new(solver), turns);
        run.go_on(ended, phase.t_end, &mut auto, record)
    }
}

/// What the solver of a run changes.
fn context<'c, P: Alike>(
    run: &'c mut Integration<'_, P>,
    record: &'c mut dyn Record<P>,
) -> PhaseContext<'c, P> {
    PhaseContext { problem: run.problem, point: &mut run.point, stats: &mut run.stats, record }
}
