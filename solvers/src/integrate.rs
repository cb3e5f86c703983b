//! The driver: phase after phase, a transition between each.

use std::collections::VecDeque;

use crate::error::{Error, Outcome};
use crate::event::GuardWatch;
use crate::phase::{PhaseEnd, PhaseSolver, Point, check_finite};
use crate::record::{Event, Record};
use crate::stats::Stats;
use crate::system::{Next, System};

/// Transitions at one instant beyond which two modes are held to chatter, or twice as many as there are
/// guards.
const CHATTER: usize = 16;
/// That many events in a row …
const STORM: usize = 100;
/// … within this fraction of the time since the integration's start are held to accumulate, …
const STORM_SPAN: f64 = 1e-9;
/// … or within this fraction of the span of the run: also at its start.
const STORM_OF_RUN: f64 = 1e-12;

/// An integration of one system: where it stands and what it has cost.
///
/// After an error both stay valid up to the last accepted step.
pub struct Integration<'a, P: System> {
    problem: &'a P,
    /// Time, state and mode.
    pub point: Point<P>,
    /// Work so far.
    pub stats: Stats,
    watch: GuardWatch<P>,
    last_events: VecDeque<f64>,
    t_start: f64,
    t_end: f64,
}

impl<'a, P: System> Integration<'a, P> {
    /// An integration that starts at `(t, y)` in the mode that the system gives it.
    pub fn new(problem: &'a P, t: f64, y: P::State<f64>) -> Self {
        let mode = problem.initial_mode(t, &y);
        Self {
            problem,
            point: Point { t, y, mode },
            stats: Stats::default(),
            watch: GuardWatch::new(problem),
            last_events: VecDeque::with_capacity(STORM),
            t_start: t,
            t_end: t,
        }
    }

    /// Integrates to `t_end` (before the present time: backward) with `solver`, and shows every
    /// accepted step and every event to `record`.
    ///
    /// # Errors
    /// [`Error::BadArgument`] for a `t_end` that is not finite, [`Error::NonFinite`] for such a
    /// start, [`Error::Chatter`] for transitions without rest at one instant, [`Error::EventStorm`]
    /// for events that accumulate to no [limit](System::accumulation), and any error of a step.
    pub fn run(
        &mut self,
        t_end: f64,
        solver: &mut dyn PhaseSolver<P>,
        record: &mut dyn Record<P>,
    ) -> Result<Outcome, Error> {
        if !t_end.is_finite() {
            let allowed = "the end of a run must be finite";
            return Err(Error::BadArgument { name: "t_end", value: t_end, allowed });
        }
        check_finite(&self.point, &self.point.y)?;
        self.t_end = t_end;
        let mut guard = self.violated()?;
        loop {
            if let Some(guard) = guard
                && let Some(outcome) = self.switch(guard, record)?
            {
                return Ok(outcome);
            }
            let point = &mut self.point;
            match solver.solve_phase(self.problem, point, t_end, &mut self.stats, record)? {
                PhaseEnd::EndOfTime => return Ok(Outcome::Finished),
                PhaseEnd::Interrupted => return Ok(Outcome::Interrupted),
                PhaseEnd::Guard(violated) => guard = Some(violated),
            }
        }
    }

    fn violated(&mut self) -> Result<Option<usize>, Error> {
        let Point { t, y, mode } = &self.point;
        self.watch.violated(self.problem, *mode, *t, y)
    }

    /// Makes the transition of `guard`, and those of all guards that are then violated at the
    /// same instant, one after the other.
    fn switch(
        &mut self,
        mut guard: usize,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        let mut last = (self.point.mode, guard);
        let most = CHATTER.max(2 * self.problem.n_guards());
        for _ in 0..most {
            last = (self.point.mode, guard);
            let Point { t, y, mode } = &mut self.point;
            let after = self.problem.transition(*mode, guard, *t, y);
            let mut outcome = self.enter(guard, after, record)?;
            if outcome.is_none()
                && let Some(span) = self.storm()
            {
                let Point { t, y, mode } = &mut self.point;
                let Some(limit) = self.problem.accumulation(*mode, guard, *t, y) else {
                    let mode = format!("{mode:?}");
                    return Err(Error::EventStorm { t: *t, n: STORM, span, mode });
                };
                outcome = self.enter(guard, Next::Mode(limit), record)?;
            }
            if outcome.is_some() {
                return Ok(outcome);
            }
            match self.violated()? {
                None => return Ok(None),
                Some(next) => guard = next,
            }
        }
        let (mode, guard) = last;
        Err(Error::Chatter { t: self.point.t, n: most, mode: format!("{mode:?}"), guard })
    }

    /// Enters what follows an event of `guard`, the state being put on it already; an outcome where
    /// the run ends here.
    fn enter(
        &mut self,
        guard: usize,
        after: Next<P::Mode>,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        let Point { t, y, mode } = &mut self.point;
        let before = *mode;
        if let Next::Mode(next) = after {
            *mode = next;
        }
        self.stats.n_events += 1;
        let go_on = record.event(&Event { t: *t, guard, before, after, y });
        check_finite(&self.point, &self.point.y)?;
        Ok(match after {
            Next::Stop => Some(Outcome::Stopped),
            Next::Mode(_) if go_on.is_break() => Some(Outcome::Interrupted),
            Next::Mode(_) => None,
        })
    }

    /// Takes note of an event; the time over which the last ones accumulated, if they did.
    fn storm(&mut self) -> Option<f64> {
        let t = self.point.t;
        self.last_events.push_back(t);
        if self.last_events.len() < STORM {
            return None;
        }
        let span = self.last_events.pop_front().map_or(f64::INFINITY, |first| (t - first).abs());
        let so_far = STORM_SPAN * (t - self.t_start).abs();
        let of_run = STORM_OF_RUN * (self.t_end - self.t_start).abs();
        if span > so_far.max(of_run) {
            return None;
        }
        self.last_events.clear();
        Some(span)
    }
}
