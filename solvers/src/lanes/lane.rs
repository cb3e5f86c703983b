//! One run among several: what is its own between two attempts.

use super::attempt::{Aim, Attempt};
use super::scalar::Simd;
use crate::control::Verdict;
use crate::erk::ExplicitRk;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::{OneStep, OneStepSolver, PhaseContext, PhaseState};
use crate::phase::PhaseEnd;
use crate::record::{Needs, Record};
use crate::stats::Stats;
use crate::step::Step;
use crate::system::{Alike, System};

/// A run with its method and recorder, and the step that it is to attempt.
pub(super) struct Lane<'r, 'a, P: System, R, M> {
    pub(super) index: usize,
    pub(super) run: &'r mut Integration<'a, P>,
    pub(super) record: &'r mut R,
    pub(super) solver: OneStepSolver<P, M>,
    pub(super) course: PhaseState,
    pub(super) t1: f64,
    pub(super) h: f64,
    /// Whether its state and the step of its method are older than its time: the present ones are in the vectors alone.
    pub(super) is_stale: bool,
}

/// A run by an explicit tableau method of `S` stages.
pub(super) type TableauLane<'r, 'a, P, R, const S: usize> =
    Lane<'r, 'a, P, R, ExplicitRk<<P as System>::State<f64>, S>>;

/// How a run goes on after an attempt.
pub(super) enum Fate {
    /// With another attempt in its mode.
    Attempts,
    /// With another phase, in this mode or another.
    Begins,
    /// Not at all.
    Ends(Result<Outcome, Error>),
}

impl<'r, 'a, P: System, R: Record<P>, M: OneStep<P>> Lane<'r, 'a, P, R, M> {
    /// Begins `run` towards `t_end`, or tells how it ended.
    pub(super) fn begin(
        (index, run, record): (usize, &'r mut Integration<'a, P>, &'r mut R),
        mut solver: OneStepSolver<P, M>,
        t_end: f64,
    ) -> Result<Self, Result<Outcome, Error>> {
        if let Some(outcome) = run.begin(t_end, record).map_err(Err)? {
            return Err(Ok(outcome));
        }
        match enter(run, &mut solver, t_end).map_err(Err)? {
            Some((course, t1, h)) => {
                Ok(Self { index, run, record, solver, course, t1, h, is_stale: false })
            }
            None => Err(Ok(Outcome::Finished)),
        }
    }

    /// What tells its system in its mode from others of a kind, if that is numbers alone.
    pub(super) fn numbers(&self) -> Option<P::Numbers<f64>>
    where
        P: Alike,
    {
        self.run.problem.numbers(&self.run.point.mode)
    }

    pub(super) fn mode(&self) -> &P::Mode {
        &self.run.point.mode
    }

    /// What its recorder needs of the step that it attempts.
    #[inline(always)]
    pub(super) fn needs(&self) -> Needs {
        self.record.needs(self.run.point.t, self.t1)
    }

    /// Takes the step that it attempts, a plain one that nobody needs, without its end; one of size `next` is to
    /// follow.
    #[inline(always)]
    pub(super) fn step_unseen(&mut self, next: f64) {
        let Integration { point, stats, .. } = &mut *self.run;
        self.course.h = next;
        self.solver.arrive(self.t1, &mut point.t, &mut self.course, stats);
        self.is_stale = true;
    }

    /// Goes on from how an attempt ended the phase, if it did.
    #[inline]
    pub(super) fn go_on(&mut self, judged: Result<Option<PhaseEnd>, Error>) -> Fate {
        let fate = judged.and_then(|end| match end {
            Some(end) => self.pass(end),
            None => {
                let Integration { problem, point, stats, .. } = &mut *self.run;
                self.solver.choose_step(problem, point, &mut self.course, stats);
                match self.course.next(point)? {
                    Some((t1, h)) => {
                        (self.t1, self.h) = (t1, h);
                        Ok(Fate::Attempts)
                    }
                    None => self.pass(PhaseEnd::EndOfTime),
                }
            }
        });
        fate.unwrap_or_else(|error| Fate::Ends(Err(error)))
    }

    /// Goes on alone to the end of its phase; of a method that proposes sizes from the start of that.
    pub(super) fn go_alone(&mut self) -> Fate {
        watch_from_start(self.run, &mut self.solver);
        let mut judged = match self.course.due {
            Some(_) => Ok(None),
            None => self.attempt(),
        };
        loop {
            let fate = self.go_on(judged);
            if !matches!(fate, Fate::Attempts) {
                return fate;
            }
            judged = self.attempt();
        }
    }

    /// Attempts its step alone; how the phase ended, if it did.
    pub(super) fn attempt(&mut self) -> Result<Option<PhaseEnd>, Error> {
        let Self { run, record, solver, course, t1, h, .. } = self;
        let (problem, mode) = (run.problem, run.point.mode.clone());
        solver.method.attempt(problem, mode, *t1, *h, &mut run.stats);
        solver.judge(&mut scene(run, *record), course, *h)
    }

    /// Passes from a phase that ended to the next.
    fn pass(&mut self, end: PhaseEnd) -> Result<Fate, Error> {
        if let Some(outcome) = self.run.pass(end, self.record)? {
            return Ok(Fate::Ends(Ok(outcome)));
        }
        let Some(phase) = enter(self.run, &mut self.solver, self.course.t_end)? else {
            return Ok(Fate::Ends(Ok(Outcome::Finished)));
        };
        (self.course, self.t1, self.h) = phase;
        Ok(Fate::Begins)
    }
}

impl<P: System, R: Record<P>, const S: usize> TableauLane<'_, '_, P, R, S> {
    pub(super) fn aim(&self) -> Aim<'_, P::State<f64>, S> {
        Aim { t1: self.t1, h: self.h, from: &self.solver.method.step }
    }

    /// Takes over the start of the attempt in this lane, where it is [stale](Lane::is_stale).
    pub(super) fn refresh<V: Simd>(&mut self, attempt: &Attempt<P, V, S>, lane: usize) {
        if std::mem::take(&mut self.is_stale) {
            let point = &mut self.run.point;
            self.solver.method.take_start(point.t, (&attempt.method, lane));
            point.y.clone_from(self.solver.method.step.y0());
        }
    }

    /// Takes over the end of the attempt in this lane: some time before it [settles](Self::settle), which else waits
    /// for what was stored piece by piece.
    #[inline(always)]
    pub(super) fn receive<V: Simd>(&mut self, attempt: &Attempt<P, V, S>, lane: usize) {
        self.refresh(attempt, lane);
        self.solver.method.take_end((self.t1, self.h), (&attempt.method, lane));
    }

    /// The same where its recorder needs the step; whether it does.
    #[inline(always)]
    pub(super) fn receive_needed<V: Simd>(
        &mut self,
        attempt: &Attempt<P, V, S>,
        lane: usize,
    ) -> bool {
        let is_needed = self.needs() != Needs::Nothing;
        if is_needed {
            self.receive(attempt, lane);
        }
        is_needed
    }

    /// Goes on by what the attempt came to in this lane; [stale](Lane::is_stale) after a plain step that it has not
    /// [received](Self::receive).
    #[inline]
    pub(super) fn settle<V: Simd>(
        &mut self,
        (attempt, lane): (&Attempt<P, V, S>, usize),
        is_received: bool,
    ) -> Fate {
        self.run.stats.work.n_rhs += ExplicitRk::<P::State<f64>, S>::N_RHS;
        let verdict = attempt.verdict(lane, self.h, &mut self.solver.controller);
        let judged = match verdict {
            Verdict::Accept(next) if attempt.is_plain(lane) => {
                self.run.stats.work.n_rhs += self.solver.method.n_rhs_of_end();
                if is_received {
                    Ok(self.show((attempt, lane), next))
                } else {
                    self.step_unseen(next);
                    Ok(None)
                }
            }
            _ => {
                if !is_received {
                    self.receive(attempt, lane);
                }
                self.judge((attempt, lane), verdict)
            }
        };
        self.go_on(judged)
    }

    /// Takes the attempt, a plain one, for a step, after which one of size `next` is to follow; how the phase ended,
    /// if it did.
    fn show<V: Simd>(
        &mut self,
        (attempt, lane): (&Attempt<P, V, S>, usize),
        next: f64,
    ) -> Option<PhaseEnd> {
        let needs = self.needs();
        let Self { run, record, solver, course, .. } = self;
        if needs == Needs::DenseOutput {
            solver.method.take_stages((&attempt.method, lane));
            let mode = run.point.mode.clone();
            solver.method.densify(run.problem, mode, &mut Stats::default());
        }
        course.h = next;
        solver.accept(&mut scene(run, *record), course, None, needs)
    }

    /// How the phase ended, if it did, by the attempt as it would be judged alone.
    fn judge<V: Simd>(
        &mut self,
        (attempt, lane): (&Attempt<P, V, S>, usize),
        verdict: Verdict,
    ) -> Result<Option<PhaseEnd>, Error> {
        let Self { run, record, solver, course, h, .. } = self;
        solver.method.take_stages((&attempt.method, lane));
        watch_from_start(run, solver);
        solver.apply_verdict(&mut scene(run, *record), course, *h, verdict)
    }
}

/// Has the guards watched from the start of the present step on.
fn watch_from_start<P: System, M: OneStep<P>>(
    run: &Integration<'_, P>,
    solver: &mut OneStepSolver<P, M>,
) {
    let (step, mode) = (solver.method.step(), run.point.mode.clone());
    solver.watch.start_at(run.problem, mode, step.t0(), step.y0(), step.slope0());
}

/// Begins a phase: its course, and end and size of its first step unless it is still due; none at the end of time.
fn enter<P: System, M: OneStep<P>>(
    run: &mut Integration<'_, P>,
    solver: &mut OneStepSolver<P, M>,
    t_end: f64,
) -> Result<Option<(PhaseState, f64, f64)>, Error> {
    if run.point.t == t_end {
        return Ok(None);
    }
    let mut course = solver.begin(run.problem, &run.point, t_end, &mut run.stats)?;
    if M::PROPOSES {
        return Ok(Some((course, run.point.t, 0.0)));
    }
    solver.choose_step(run.problem, &run.point, &mut course, &mut run.stats);
    Ok(course.next(&run.point)?.map(|(t1, h)| (course, t1, h)))
}

pub(super) fn scene<'s, P: System>(
    run: &'s mut Integration<'_, P>,
    record: &'s mut dyn Record<P>,
) -> PhaseContext<'s, P> {
    PhaseContext { problem: run.problem, point: &mut run.point, stats: &mut run.stats, record }
}
