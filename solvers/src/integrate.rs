//! The driver: it runs one phase after the other, with transitions between them.

use std::borrow::Cow;
use std::collections::VecDeque;

use crate::error::{Error, Outcome};
use crate::event_location::GuardWatch;
use crate::phase::{PhaseEnd, PhaseSolver, check_finite};
use crate::point::Point;
use crate::real::Real;
use crate::record::{Event, Record};
use crate::system::{Next, System, Vector};
use crate::work::Stats;

/// Largest number of transitions at one instant, unless twice the number of guards is larger. Beyond it the run ends
/// in [`Error::Chatter`].
const CHATTER: usize = 16;
/// What to change where one guard stays violated after its own transition, where transitions within one mode violate
/// each other's guards, and where modes hand over to each other.
const UNPROJECTED: &str = "it stays violated after its own transition; put the state on the surface there, or, in Rust, state a larger rounding bound";
const UNDONE: &str = "transitions within this mode violate each other's guards; let one transition settle them together, or, in Rust, state larger rounding bounds";
const HANDED_OVER: &str =
    "two modes hand over to each other; give the model the sliding or sticking mode between them";
/// Events are held to accumulate where this many in a row, or twice as many as there are guards, …
const STORM: usize = 100;
/// … lie within this fraction of the time since the integration's start, …
const STORM_SPAN: f64 = 1e-9;
/// … or within this fraction of the span of the run, which also applies right after its start.
const STORM_OF_RUN: f64 = 1e-12;

/// An integration of one system: its present point and the work done so far.
///
/// After an error both are valid, and are those of the last accepted step. It may be gone on with, by the same or by another
/// method. Where a recorder interrupted it at a step that landed on an event, it goes on after the transition. The options of a
/// single run are simpler said to [`Run`](crate::Run).
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Control, Integration, Method, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut run = Integration::new(&ball, 0.0, ball.start());
/// for (name, t_end) in [("dop853", 0.8), ("taylor", 1.3)] {
///     let method = Method::named(name).ok_or("no such method")?;
///     let mut solver = method.solver(&ball, control.clone())?;
///     run.run(t_end, &mut *solver, &mut ())?;
/// }
/// assert!((run.point.y[0] - ball.state(1.3)[0]).abs() < 1e-8);
/// assert_eq!(run.stats.n_events, 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Integration<'a, P: System> {
    pub(crate) problem: &'a P,
    /// Time, state and mode.
    pub point: Point<P>,
    /// Work so far.
    pub stats: Stats,
    transitions: Transitions<P>,
}

impl<'a, P: System> Integration<'a, P> {
    /// An integration that starts at `(t, y)` in the mode that the system gives it.
    pub fn new(problem: &'a P, t: f64, y: P::State<f64>) -> Self {
        let mode = problem.initial_mode(t, &of_its_length(problem, &y));
        Self::at(problem, Point { t, y, mode })
    }

    /// An integration that starts at `point`, in the mode of that point.
    pub fn at(problem: &'a P, point: Point<P>) -> Self {
        let transitions = Transitions::new(problem, point.t);
        Self { problem, point, stats: Stats::default(), transitions }
    }

    /// Integrates to `t_end` with `solver`, backward where `t_end` is before the present time, and shows `record` the
    /// accepted steps that it needs and every event.
    ///
    /// # Errors
    /// [`Error::BadArgument`] for a start or an end that is no finite time, and for a start with more or fewer states than the
    /// system [has](System::dim), or with none, [`Error::NonFinite`] for a start that is not finite,
    /// [`Error::Chatter`] for transitions at one instant that do not end, [`Error::EventStorm`] for events that
    /// accumulate to no [limit](System::accumulation), [`Error::BadGuardBound`] for a rounding bound that is not above
    /// zero, any error of the recorder's [beginning](Record::begin), and any error of a step.
    pub fn run(
        &mut self,
        t_end: f64,
        solver: &mut dyn PhaseSolver<P>,
        record: &mut dyn Record<P>,
    ) -> Result<Outcome, Error> {
        let ended = self.begin(t_end, record)?;
        self.go_on(ended, t_end, solver, record)
    }

    /// Integrates from phase to phase to `t_end`, unless the run has `ended`.
    pub(crate) fn go_on(
        &mut self,
        mut ended: Option<Outcome>,
        t_end: f64,
        solver: &mut dyn PhaseSolver<P>,
        record: &mut dyn Record<P>,
    ) -> Result<Outcome, Error> {
        loop {
            if let Some(outcome) = ended {
                return Ok(outcome);
            }
            let point = &mut self.point;
            let end = solver.solve_phase(self.problem, point, t_end, &mut self.stats, record)?;
            ended = self.pass(end, record)?;
        }
    }

    /// Begins a run to `t_end` with the transitions of guards that are violated at its start. Returns the outcome
    /// where one of them ends the run.
    pub(crate) fn begin(
        &mut self,
        t_end: f64,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        check_length(self.problem, &self.point.y)?;
        check_span(self.point.t, t_end)?;
        record.begin(&self.point, t_end)?;
        match self.transitions.begin(self.problem, &self.point, t_end)? {
            Some(guard) => self.pass(PhaseEnd::Guard(guard), record),
            None => Ok(None),
        }
    }

    /// Passes from a phase that ended to the next one, through the transitions between them. Returns the outcome
    /// where the run ends instead.
    pub(crate) fn pass(
        &mut self,
        end: PhaseEnd,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        match end {
            PhaseEnd::EndOfTime => Ok(Some(Outcome::Finished)),
            PhaseEnd::Interrupted { landed_on: None } => Ok(Some(Outcome::Interrupted)),
            // The run goes on after the event, so that its guard is not violated there.
            PhaseEnd::Interrupted { landed_on: Some(guard) } => {
                Ok(self.switch(guard, record)?.or(Some(Outcome::Interrupted)))
            }
            PhaseEnd::Guard(guard) => self.switch(guard, record),
        }
    }

    /// Makes the transitions at the present point, where `guard` fell.
    fn switch(
        &mut self,
        guard: usize,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        let Point { t, y, mode } = &mut self.point;
        let at = Instant { t: *t, y, mode };
        self.transitions.switch(self.problem, at, guard, &mut self.stats, record)
    }
}

/// A start as `problem` may be asked for its mode: one with more or fewer states than it has, which is an error of the first
/// run, is cut or filled up with zeros.
pub(crate) fn of_its_length<'y, P: System>(
    problem: &P,
    y: &'y P::State<f64>,
) -> Cow<'y, P::State<f64>> {
    let is_of_type = <P::State<f64> as Vector<f64>>::LENGTH > 0;
    if is_of_type || check_length(problem, y).is_ok() {
        return Cow::Borrowed(y);
    }
    let each = |i: usize| y.as_ref().get(i).copied().unwrap_or(0.0);
    Cow::Owned(Vector::from_fn(problem.dim(), each))
}

/// Whether a start has as many states as `problem` has, and that has any.
pub(crate) fn check_length<P: System>(problem: &P, y: &P::State<f64>) -> Result<(), Error> {
    let n = y.as_ref().len();
    let allowed = if n != problem.dim() {
        "a start has as many states as the system says that it has"
    } else if n == 0 {
        "a system has one state at least, if only one that rests"
    } else {
        return Ok(());
    };
    Err(Error::BadArgument { name: "number of states", value: n as f64, allowed })
}

/// Time, state and mode of a run between two phases, in plain or extended precision.
pub(crate) struct Instant<'a, P: System, B: Real> {
    pub(crate) t: B,
    pub(crate) y: &'a mut P::State<B>,
    pub(crate) mode: &'a mut P::Mode,
}

impl<P: System, B: Real> Instant<'_, P, B> {
    fn point(&self) -> Point<P> {
        Point { t: self.t.value(), y: rounded::<P, B>(self.y), mode: self.mode.clone() }
    }
}

/// The nearest `f64` of a state.
pub(crate) fn rounded<P: System, B: Real>(y: &P::State<B>) -> P::State<f64> {
    let y = y.as_ref();
    Vector::from_fn(y.len(), |i| y[i].value())
}

/// Whether a run can begin at `t` and end at `t_end`.
pub(crate) fn check_span(t: f64, t_end: f64) -> Result<(), Error> {
    let allowed = "start and end of a run must be finite";
    let bad = [("t", t), ("t_end", t_end)].into_iter().find(|(_, value)| !value.is_finite());
    bad.map_or(Ok(()), |(name, value)| Err(Error::BadArgument { name, value, allowed }))
}

/// Makes the transitions between phases, until no guard is violated.
pub(crate) struct Transitions<P: System> {
    watch: GuardWatch<P>,
    /// Times of the last events, at most one fewer than are held to accumulate.
    last_events: VecDeque<f64>,
    n_storm: usize,
    t_start: f64,
    t_end: f64,
}

impl<P: System> Transitions<P> {
    /// The transitions of an integration that starts at `t`.
    pub(crate) fn new(problem: &P, t: f64) -> Self {
        let n_storm = STORM.max(2 * problem.n_guards());
        let last_events = VecDeque::with_capacity(n_storm);
        Self { watch: GuardWatch::new(problem), last_events, n_storm, t_start: t, t_end: t }
    }

    /// Begins a run from `point` to `t_end`, and returns the first guard that is violated at `point`.
    pub(crate) fn begin(
        &mut self,
        problem: &P,
        point: &Point<P>,
        t_end: f64,
    ) -> Result<Option<usize>, Error> {
        check_finite(point, &point.y)?;
        self.t_end = t_end;
        self.violated(problem, point)
    }

    fn violated(&mut self, problem: &P, point: &Point<P>) -> Result<Option<usize>, Error> {
        self.watch.violated_on_entry(problem, point.mode.clone(), point.t, &point.y)
    }

    /// Makes the transition of `guard`, and then of every guard that is violated afterwards at the same instant, one
    /// after the other. Returns the outcome where the run ends here.
    pub(crate) fn switch<B: Real>(
        &mut self,
        problem: &P,
        mut at: Instant<'_, P, B>,
        mut guard: usize,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<Option<Outcome>, Error> {
        // Modes and guards of the last three transitions, the last one first.
        let mut last = std::array::from_fn(|_| (at.mode.clone(), guard));
        let most = CHATTER.max(2 * problem.n_guards());
        for _ in 0..most {
            last.rotate_right(1);
            last[0] = (at.mode.clone(), guard);
            let before = at.point();
            let after = problem.transition(at.mode.clone(), guard, at.t, at.y);
            let mut outcome = enter(&mut at, (guard, before), after, stats, record)?;
            if outcome != Some(Outcome::Stopped)
                && let Some(span) = self.storm(at.t.value())
            {
                let before = at.point();
                let (t, mut y, mode) = (before.t, before.y.clone(), before.mode.clone());
                let Some(limit) = problem.accumulation(mode.clone(), guard, t, &mut y) else {
                    let mode = format!("{mode:?}");
                    return Err(Error::EventStorm { t, n: self.n_storm, span, mode });
                };
                *at.y = Vector::from_fn(y.as_ref().len(), |i| B::cst(y.as_ref()[i]));
                let limit = enter(&mut at, (guard, before), Next::Mode(limit), stats, record)?;
                outcome = outcome.or(limit);
            }
            if outcome.is_some() {
                return Ok(outcome);
            }
            match self.violated(problem, &at.point())? {
                None => return Ok(None),
                Some(next) => guard = next,
            }
        }
        let last = last.map(|(mode, guard)| (format!("{mode:?}"), guard));
        let cure = cure(&last);
        let [(mode, guard), ..] = last;
        Err(Error::Chatter { t: at.t.value(), n: most, mode, guard, cure })
    }

    /// Notes an event at `t`. Where the last events accumulate, returns the time between the first and the last of
    /// them.
    fn storm(&mut self, t: f64) -> Option<f64> {
        self.last_events.push_back(t);
        if self.last_events.len() < self.n_storm {
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

/// What to change, by the modes, as texts, and the guards of the last three transitions, the last one first.
///
/// What a mode carries may differ from one transition to the next, as an impact speed that is stored anew. So a mode whose
/// [variant] stays is held to stay, unless it comes back after one transition: then two values of what it carries, as two
/// corners, are two modes that hand over to each other.
fn cure([last, before, third]: &[(String, usize); 3]) -> &'static str {
    let alternates = third.0 == last.0 && before.0 != last.0;
    let stays = variant(&before.0) == variant(&last.0) && !alternates;
    match (stays, before.1 == last.1) {
        (true, true) => UNPROJECTED,
        (true, false) => UNDONE,
        (false, _) => HANDED_OVER,
    }
}

/// The variant in the text that a derived `Debug` makes of a mode: `Flight` of `Flight { speed: 2.0 }` and of `Flight(2.0)`.
/// Another text is returned whole.
fn variant(mode: &str) -> &str {
    let end = mode.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(mode.len());
    let (name, rest) = mode.split_at(end);
    let is_derived = !name.is_empty() && (rest.starts_with('(') || rest.starts_with(" {"));
    if is_derived { name } else { mode }
}

/// Enters the mode after an event of a guard at the point before, and shows the event to the recorder; the state is
/// already the one after the transition. Returns the outcome where the run ends here.
fn enter<P: System, B: Real>(
    at: &mut Instant<'_, P, B>,
    (guard, Point { y: y_before, mode: before, .. }): (usize, Point<P>),
    after: Next<P::Mode>,
    stats: &mut Stats,
    record: &mut dyn Record<P>,
) -> Result<Option<Outcome>, Error> {
    if let Next::Mode(next) = &after {
        at.mode.clone_from(next);
    }
    stats.n_events += 1;
    let point = at.point();
    let (t, y_before, y) = (point.t, &y_before, &point.y);
    let go_on = record.event(&Event { t, guard, before, after: after.clone(), y_before, y });
    check_finite(&point, &point.y)?;
    Ok(match after {
        Next::Stop => Some(Outcome::Stopped),
        Next::Mode(_) if go_on.is_break() => Some(Outcome::Interrupted),
        Next::Mode(_) => None,
    })
}
