//! One run of a batch: what is its own between two steps.

use super::Entry;
use super::parameters::ByParameters;
use super::steps::Steps;
use crate::control::Verdict;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::lanes::Simd;
use crate::one_step::{OneStep, OneStepSolver, PhaseContext, PhaseState};
use crate::phase::PhaseEnd;
use crate::record::{Needs, Record};
use crate::stats::Stats;
use crate::step::Step;
use crate::system::{Alike, Vector};

/// A run with its recorder, in a phase whose mode has parameters.
pub(super) struct Member<'r, 'a, P: Alike, M> {
    pub(super) index: usize,
    run: &'r mut Integration<'a, P>,
    record: &'r mut dyn Record<P>,
    solver: OneStepSolver<P, M>,
    phase: PhaseState,
    parameters: P::Parameters<f64>,
    /// End and size of the step that it is to take.
    pub(super) t1: f64,
    pub(super) h: f64,
    /// Why it cannot take a step.
    failed: Option<Error>,
    /// Whether its state and the step of its method are older than its time; the present ones are in its lane.
    is_stale: bool,
    /// Whether its next step starts at the end of the last one in its lane.
    stays_in_lane: bool,
    /// Whether the parameters of this phase are known to describe its mode.
    is_checked: bool,
}

/// How a run goes on after a step.
pub(super) enum Fate {
    /// With the next step in its lane.
    Stays,
    /// With a step from another start or by other parameters, to be [loaded](Member::load).
    Moves,
    /// Not at all.
    Ends(Result<Outcome, Error>),
}

impl<'r, 'a, P: Alike, M: OneStep<P>> Member<'r, 'a, P, M> {
    /// Begins a run towards `t_end` by `method`, up to its first phase whose mode has parameters. Returns how the run
    /// ended where it has none.
    pub(super) fn begin(
        entry: Entry<'r, 'a, P>,
        method: M,
        t_end: f64,
    ) -> Result<Self, Result<Outcome, Error>> {
        let Entry { index, run, control, record } = entry;
        let mut solver = OneStepSolver::new(run.problem, method, control.clone());
        let ended = run.begin(t_end, record).map_err(Err)?;
        let (phase, parameters) = enter(run, record, &mut solver, (ended, t_end))?;
        Ok(Self {
            index,
            run,
            record,
            solver,
            phase,
            parameters,
            t1: 0.0,
            h: 0.0,
            failed: None,
            is_stale: false,
            stays_in_lane: false,
            is_checked: false,
        })
    }

    pub(super) fn parameters(&self) -> &P::Parameters<f64> {
        &self.parameters
    }

    /// Writes its parameters, its tolerance and the start of its next step to `lane`.
    pub(super) fn load<V: Simd, S: Steps<P, V, Method = M>>(
        &self,
        lane: usize,
        field: &mut ByParameters<P, V>,
        steps: &mut S,
    ) {
        field.set(lane, &self.parameters);
        steps.judgement_mut().tolerate(lane, self.solver.controller.control());
        steps.load(lane, &self.solver.method, self.solver.watch.lows());
    }

    /// Takes over the start in its `lane` where that is [newer](Self::is_stale) than its own.
    pub(super) fn refresh<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        if std::mem::take(&mut self.is_stale) {
            let (point, method) = (&mut self.run.point, &mut self.solver.method);
            steps.unload_start(lane, point.t, method);
            point.y.clone_from(method.step().y0());
        }
    }

    /// Chooses the end of its next step.
    #[inline(always)]
    pub(super) fn aim<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        let Integration { problem, point, stats, .. } = &mut *self.run;
        let phase = &mut self.phase;
        self.solver.choose_step_by(problem, point, phase, stats, |method, _, stats| {
            stats.work.add_series();
            steps.propose(lane, method)
        });
        match phase.next(point) {
            Ok(Some((t1, h))) => (self.t1, self.h) = (t1, h),
            // Members are never at the end of time.
            Ok(None) => {}
            Err(error) => self.failed = Some(error),
        }
    }

    /// Goes on from the step in its `lane`, or from one taken alone where that does not [serve](Steps::serves).
    #[inline]
    pub(super) fn settle<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> Fate {
        self.stays_in_lane = false;
        let judged = if let Some(error) = self.failed.take() {
            self.refresh(lane, steps);
            Err(error)
        } else if steps.serves(&self.solver.method) {
            self.judge(lane, steps)
        } else {
            self.refresh(lane, steps);
            steps.unload_within(lane, &mut self.solver.method);
            self.attempt()
        };
        match judged {
            Ok(None) if self.run.point.t != self.phase.t_end => {
                if self.stays_in_lane {
                    Fate::Stays
                } else {
                    Fate::Moves
                }
            }
            Ok(end) => self.pass(end.unwrap_or(PhaseEnd::EndOfTime)),
            Err(error) => Fate::Ends(Err(error)),
        }
    }

    /// Judges the step in its `lane`, and returns how the phase ended, if it did.
    #[inline(always)]
    fn judge<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> Result<Option<PhaseEnd>, Error> {
        if !self.is_checked {
            self.check(lane, steps)?;
        }
        let judgement = steps.judgement();
        let (is_proposed, error_sq) = (self.solver.is_proposed, judgement.error_sq.lane(lane));
        let verdict = self.solver.controller.verdict(is_proposed, self.h, |_| error_sq);
        let knows = !S::TESTS_ENDS || self.solver.watch.knows(self.h);
        let is_plain = judgement.is_plain & (1 << lane) != 0 && knows;
        let is_clear = || judgement.is_clear & (1 << lane) != 0 && knows;
        self.run.stats.work.n_rhs += S::N_RHS;
        if let Verdict::Accept(next) = verdict
            && (is_plain || is_clear() && self.tell_touches(lane, steps))
        {
            self.run.stats.work.n_rhs += S::n_rhs_of_end(&self.solver.method);
            self.phase.h = next;
            self.stays_in_lane = true;
            return Ok(self.accept(lane, steps));
        }
        self.unload(lane, steps);
        steps.unload_within(lane, &mut self.solver.method);
        let (step, mode) = (self.solver.method.step(), self.run.point.mode.clone());
        let (problem, watch) = (self.run.problem, &mut self.solver.watch);
        watch.start_at(problem, mode, step.t0(), step.y0(), step.slope0());
        let (phase, h) = (&mut self.phase, self.h);
        let context = &mut context(self.run, self.record);
        self.solver.apply_verdict(context, phase, h, verdict)
    }

    /// Tells of the touches on the step in its `lane`; false where the step is to be unloaded for that.
    #[cold]
    #[inline(never)]
    fn tell_touches<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> bool {
        let Self { run, record, solver, t1, h, .. } = self;
        steps.note_turns(lane, (run.point.t, *h), &mut solver.watch);
        solver.watch.tell_known(*t1, *h, &mut |graze| {
            run.stats.n_grazing += 1;
            record.grazing(&graze.in_mode(run.point.mode.clone()));
        })
    }

    /// Accepts the step in its `lane`, which crosses no guard. It is unloaded only where the recorder needs it.
    #[inline(always)]
    fn accept<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> Option<PhaseEnd> {
        let needs = self.record.needs(self.run.point.t, self.t1);
        if needs == Needs::Nothing {
            let Integration { point, stats, .. } = &mut *self.run;
            self.solver.arrive(self.t1, &mut point.t, &mut self.phase, stats);
            self.is_stale = true;
            let go_on = self.record.passed(self.t1, stats);
            return go_on.is_break().then_some(PhaseEnd::Interrupted);
        }
        self.unload(lane, steps);
        if needs == Needs::DenseOutput {
            let (problem, mode) = (self.run.problem, self.run.point.mode.clone());
            steps.unload_dense(lane, &mut self.solver.method);
            self.solver.method.densify(problem, mode, &mut Stats::default());
        }
        let context = &mut context(self.run, self.record);
        self.solver.accept(context, &mut self.phase, None, needs)
    }

    /// Takes over both ends of the step in its `lane`.
    #[inline(always)]
    fn unload<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        self.refresh(lane, steps);
        steps.unload_end(lane, self.t1, self.h, &mut self.solver.method);
    }

    /// Compares slope and guards at the end of the step in its `lane` with those of the system in its mode.
    #[cold]
    #[inline(never)]
    fn check<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> Result<(), Error> {
        self.is_checked = true;
        self.unload(lane, steps);
        let (problem, mode) = (self.run.problem, &self.run.point.mode);
        let (t, step) = (self.t1, self.solver.method.step());
        let mut slope = step.y1().clone();
        problem.rhs(mode.clone(), t, step.y1(), &mut slope);
        let mut guards = P::Guards::<f64>::from_fn(problem.n_guards(), |_| 0.0);
        problem.guards(mode.clone(), t, step.y1(), &mut guards);
        let compare = |function, component, found: f64, expected: f64| {
            if found == expected || found.is_nan() && expected.is_nan() {
                return Ok(());
            }
            let mode = format!("{mode:?}");
            Err(Error::UnlikeParameters { t, mode, function, component, found, expected })
        };
        for (i, expected) in slope.as_ref().iter().enumerate() {
            compare("rhs_of", i, step.slope1().as_ref()[i], *expected)?;
        }
        for (i, expected) in guards.as_ref().iter().enumerate() {
            compare("guards_of", i, steps.guard_at_end(i).lane(lane), *expected)?;
        }
        Ok(())
    }

    /// Takes its step alone, and returns how the phase ended, if it did.
    fn attempt(&mut self) -> Result<Option<PhaseEnd>, Error> {
        let Self { run, record, solver, phase, t1, h, .. } = self;
        let (problem, mode) = (run.problem, run.point.mode.clone());
        solver.method.attempt(problem, mode, *t1, *h, &mut run.stats);
        solver.judge(&mut context(run, *record), phase, *h)
    }

    /// Passes from a phase that ended to the next one whose mode has parameters.
    fn pass(&mut self, end: PhaseEnd) -> Fate {
        let Self { run, record, solver, phase, .. } = self;
        let entered = match run.pass(end, *record) {
            Ok(ended) => enter(run, *record, solver, (ended, phase.t_end)),
            Err(error) => Err(Err(error)),
        };
        match entered {
            Ok((phase, parameters)) => {
                (self.phase, self.parameters, self.is_checked) = (phase, parameters, false);
                Fate::Moves
            }
            Err(end) => Fate::Ends(end),
        }
    }

    /// Goes on alone to the end of the run.
    pub(super) fn finish(self) -> Result<Outcome, Error> {
        let Self { run, record, mut solver, mut phase, .. } = self;
        let (step, mode) = (solver.method.step(), run.point.mode.clone());
        solver.watch.start_at(run.problem, mode, step.t0(), step.y0(), step.slope0());
        let end = solver.finish(&mut context(run, record), &mut phase)?;
        let ended = run.pass(end, record)?;
        run.go_on(ended, phase.t_end, &mut solver, record)
    }
}

/// Unless the run has `ended`, integrates it alone to the first phase whose mode has parameters. Returns that phase,
/// or how the run ended.
fn enter<P: Alike, M: OneStep<P>>(
    run: &mut Integration<'_, P>,
    record: &mut dyn Record<P>,
    solver: &mut OneStepSolver<P, M>,
    (mut ended, t_end): (Option<Outcome>, f64),
) -> Result<(PhaseState, P::Parameters<f64>), Result<Outcome, Error>> {
    loop {
        if let Some(outcome) = ended {
            return Err(Ok(outcome));
        }
        if run.point.t == t_end {
            return Err(Ok(Outcome::Finished));
        }
        let mut phase =
            solver.begin(run.problem, &run.point, t_end, &mut run.stats).map_err(Err)?;
        if let Some(parameters) = run.problem.parameters(&run.point.mode) {
            return Ok((phase, parameters));
        }
        let end = solver.finish(&mut context(run, record), &mut phase).map_err(Err)?;
        ended = run.pass(end, record).map_err(Err)?;
    }
}

/// What the solver of a run changes.
fn context<'c, P: Alike>(
    run: &'c mut Integration<'_, P>,
    record: &'c mut dyn Record<P>,
) -> PhaseContext<'c, P> {
    PhaseContext { problem: run.problem, point: &mut run.point, stats: &mut run.stats, record }
}
