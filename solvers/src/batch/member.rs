//! One run of a batch: what is its own between two steps.

use super::parameters::ByParameters;
use super::runner::Runner;
use super::steps::Steps;
use super::{End, Entry};
use crate::control::Verdict;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::lanes::Simd;
use crate::one_step::{OneStep, PhaseState};
use crate::phase::PhaseEnd;
use crate::record::Needs;
use crate::step::Step;
use crate::system::{Alike, Vector};
use crate::work::Stats;

/// A run in a phase whose mode has parameters.
pub(super) struct Member<'r, 'a, P: Alike, M> {
    pub(super) index: usize,
    own: Runner<'r, 'a, P, M>,
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
    /// Not in this batch.
    Ends(End),
}

impl<'r, 'a, P: Alike, M: OneStep<P>> Member<'r, 'a, P, M> {
    /// Begins a run towards `t_end` by `method`, up to its first phase whose mode has parameters. Returns how the run
    /// ended where it has none.
    pub(super) fn begin(entry: Entry<'r, 'a, P>, method: M, t_end: f64) -> Result<Self, End> {
        let index = entry.index;
        let mut own = Runner::new(entry, method);
        let (phase, parameters) = own.enter_lane(None, t_end)?;
        Ok(Self {
            index,
            own,
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
        steps.judgement_mut().tolerate(lane, self.own.solver.controller.control());
        steps.load(lane, &self.own.solver.method, self.own.solver.watch.touches.limits());
    }

    /// Takes over the start in its `lane` where that is [newer](Self::is_stale) than its own.
    pub(super) fn refresh<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        if std::mem::take(&mut self.is_stale) {
            let Runner { run, solver, .. } = &mut self.own;
            let (point, method) = (&mut run.point, &mut solver.method);
            steps.unload_start(lane, point.t, method);
            point.y.clone_from(method.step().y0());
        }
    }

    /// Chooses the end of its next step.
    #[inline(always)]
    pub(super) fn aim<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        let Runner { run, solver, .. } = &mut self.own;
        let Integration { problem, point, stats, .. } = &mut **run;
        let phase = &mut self.phase;
        solver.choose_step_by(problem, point, phase, stats, |method, _, stats| {
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
        } else if steps.serves(&self.own.solver.method) {
            self.judge(lane, steps)
        } else {
            self.refresh(lane, steps);
            steps.unload_within(lane, &mut self.own.solver.method);
            self.attempt()
        };
        match judged {
            Ok(None) if self.own.run.point.t != self.phase.t_end => {
                if self.stays_in_lane {
                    Fate::Stays
                } else {
                    Fate::Moves
                }
            }
            Ok(end) => self.pass(end.unwrap_or(PhaseEnd::EndOfTime)),
            Err(error) => Fate::Ends(Some(Err(error))),
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
        let Runner { run, solver, .. } = &mut self.own;
        let (is_proposed, error_sq) = (solver.is_proposed, judgement.error_sq.lane(lane));
        let verdict = solver.controller.verdict(is_proposed, self.h, |_| error_sq);
        let is_verified = !S::TESTS_ENDS || solver.watch.is_verified_for(self.h);
        let is_plain = judgement.is_plain & (1 << lane) != 0 && is_verified;
        let is_clear = || judgement.is_clear & (1 << lane) != 0 && is_verified;
        run.stats.work.n_rhs += S::N_RHS;
        if let Verdict::Accept(next) = verdict
            && (is_plain || is_clear() && self.tell_touches(lane, steps))
        {
            let Runner { run, solver, .. } = &mut self.own;
            run.stats.work.n_rhs += S::n_rhs_of_end(&solver.method);
            self.phase.h = solver.next_size(next);
            self.stays_in_lane = true;
            return Ok(self.accept(lane, steps));
        }
        self.unload(lane, steps);
        let Self { own, phase, h, .. } = self;
        let Runner { run, solver, .. } = own;
        steps.unload_within(lane, &mut solver.method);
        let (step, mode) = (solver.method.step(), run.point.mode.clone());
        solver.watch.start_at(run.problem, mode, step.t0(), step.y0(), step.slope0());
        own.solve(|solver, context| solver.apply_verdict(context, phase, *h, verdict))
    }

    /// Tells of the touches on the step in its `lane`; false where the step is to be unloaded for that.
    #[cold]
    #[inline(never)]
    fn tell_touches<V: Simd, S: Steps<P, V, Method = M>>(
        &mut self,
        lane: usize,
        steps: &S,
    ) -> bool {
        let Self { own: Runner { run, record, solver, .. }, t1, h, .. } = self;
        steps.note_turns(lane, (run.point.t, *h), &mut solver.watch);
        solver.watch.touches.tell_known(*t1, *h, &mut |graze| {
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
        let needs = self.own.needs(self.t1);
        if needs == Needs::Nothing {
            let Runner { run, record, solver, .. } = &mut self.own;
            let Integration { point, stats, .. } = &mut **run;
            solver.arrive(self.t1, &mut point.t, &mut self.phase, stats);
            self.is_stale = true;
            let go_on = record.passed(self.t1, stats);
            return go_on.is_break().then_some(PhaseEnd::Interrupted { landed_on: None });
        }
        self.unload(lane, steps);
        let Self { own, phase, .. } = self;
        if needs == Needs::DenseOutput {
            let method = &mut own.solver.method;
            steps.unload_dense(lane, method);
            method.densify(own.run.problem, own.run.point.mode.clone(), &mut Stats::default());
        }
        own.solve(|solver, context| solver.accept(context, phase, None, needs))
    }

    /// Takes over both ends of the step in its `lane`.
    #[inline(always)]
    fn unload<V: Simd, S: Steps<P, V, Method = M>>(&mut self, lane: usize, steps: &S) {
        self.refresh(lane, steps);
        steps.unload_end(lane, self.t1, self.h, &mut self.own.solver.method);
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
        let Runner { run, solver, .. } = &self.own;
        let (problem, mode) = (run.problem, &run.point.mode);
        let (t, step) = (self.t1, solver.method.step());
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
        let Self { own, phase, t1, h, .. } = self;
        let Runner { run, solver, .. } = &mut *own;
        let mode = run.point.mode.clone();
        solver.method.attempt(run.problem, mode, *t1, *h, &mut run.stats);
        own.solve(|solver, context| solver.judge(context, phase, *h))
    }

    /// Passes from a phase that ended, or from its turn, to the next one in its lane.
    fn pass(&mut self, end: PhaseEnd) -> Fate {
        let ended = self.own.pass(end).map_err(|error| Some(Err(error)));
        match ended.and_then(|ended| self.own.enter_lane(ended, self.phase.t_end)) {
            Ok((phase, parameters)) => {
                (self.phase, self.parameters, self.is_checked) = (phase, parameters, false);
                Fate::Moves
            }
            Err(end) => Fate::Ends(end),
        }
    }

    /// Goes on alone to the end of the run.
    pub(super) fn finish(self) -> Result<Outcome, Error> {
        self.own.finish(self.phase)
    }
}
