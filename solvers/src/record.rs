//! Recorders, which see the steps and events of an integration.

use std::ops::ControlFlow;

use crate::error::Error;
use crate::point::Point;
use crate::step::Step;
use crate::system::{Next, System};
use crate::work::Stats;

/// An accepted step, as a recorder sees it.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use deltazero_solvers::problems::{HertzBall, StopMode};
/// use deltazero_solvers::{Accepted, Control, Integration, Method, Record, Tolerance};
///
/// /// How long a ball touches its wall.
/// struct Touching(f64);
///
/// impl Record<HertzBall> for Touching {
///     fn step(&mut self, accepted: &Accepted<'_, HertzBall>) -> ControlFlow<()> {
///         if accepted.mode == StopMode::Contact {
///             self.0 += accepted.step.t1() - accepted.step.t0();
///         }
///         ControlFlow::Continue(())
///     }
/// }
///
/// let ball = HertzBall { mass: 1.0, stiffness: 1e4, exponent: 1.5, start: [-0.1, 1.0] };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&ball, control)?;
/// let mut touching = Touching(0.0);
/// Integration::new(&ball, 0.0, ball.start).run(1.0, &mut *solver, &mut touching)?;
/// assert!((touching.0 - ball.contact_time()).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Accepted<'a, P: System> {
    /// The mode it was taken in.
    pub mode: P::Mode,
    /// Both ends of the step, and its dense output where it was [needed](Record::needs).
    pub step: &'a dyn Step<P::State<f64>>,
    /// The guard that the step landed on, if any.
    pub landed_on: Option<usize>,
    /// The size that the step control proposed whatever the longest step: a series for this step, before any rejection,
    /// another method for the next one; `None` for methods of `diffsol` and in extended precision.
    pub(crate) proposed: Option<f64>,
    /// The work done so far.
    pub stats: &'a Stats,
}

/// A located event, after its transition.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Control, Event, Integration, Method, Needs, Record, Tolerance};
///
/// /// The energy that a ball loses at its bounces [J/kg].
/// struct Lost(f64);
///
/// impl Record<BouncingBall> for Lost {
///     fn event(&mut self, event: &Event<'_, BouncingBall>) -> ControlFlow<()> {
///         let [before, after] = [event.y_before[1], event.y[1]];
///         self.0 += 0.5 * (before * before - after * after);
///         ControlFlow::Continue(())
///     }
///     fn needs(&self, _t0: f64, _t1: f64) -> Needs {
///         Needs::Nothing
///     }
/// }
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&ball, control)?;
/// let mut lost = Lost(0.0);
/// Integration::new(&ball, 0.0, ball.start()).run(1.0, &mut *solver, &mut lost)?;
/// // Two bounces by then: m g h (1 − e⁴).
/// assert!((lost.0 - 9.8 * (1.0 - 1.0 / 16.0)).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Event<'a, P: System> {
    /// Time.
    pub t: f64,
    /// The violated guard, numbered in the mode before.
    pub guard: usize,
    /// The mode before.
    pub before: P::Mode,
    /// What followed.
    pub after: Next<P::Mode>,
    /// The state before the transition.
    pub y_before: &'a P::State<f64>,
    /// The state after the transition.
    pub y: &'a P::State<f64>,
}

/// A guard that comes within the error of the method of its surface: whether there is an event there is not known, and
/// either may be right.
///
/// ```
/// use deltazero_solvers::{Next, Real, Run, System};
///
/// /// `ẋ = 1`, and a guard that touches zero at x = 0.6.
/// struct Touch;
///
/// impl System for Touch {
///     type Mode = ();
///     type State<S: Real> = [S; 1];
///     type Guards<S: Real> = [S; 1];
///     fn initial_mode(&self, _t: f64, _: &[f64; 1]) {}
///     fn rhs<S: Real>(&self, (): (), _t: S, _: &[S; 1], dydt: &mut [S; 1]) {
///         *dydt = [S::cst(1.0)];
///     }
///     fn guards<S: Real>(&self, (): (), _t: S, &[x]: &[S; 1], g: &mut [S; 1]) {
///         *g = [(x - 0.6) * (x - 0.6)];
///     }
///     fn transition<S: Real>(&self, (): (), _: usize, _t: S, _: &mut [S; 1]) -> Next<()> {
///         Next::Stop
///     }
/// }
///
/// let run = Run::of(&Touch, [0.0]).method("dop853").tolerance(1e-6, 1e-6).to(1.0)?;
/// let [touch] = &run.trajectory.grazings[..] else { panic!("it touches once") };
/// assert!((touch.t - 0.6).abs() < 1e-6 && !touch.is_event);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Grazing<M> {
    /// Time at which the guard is least, or of the event.
    pub t: f64,
    /// The mode before.
    pub mode: M,
    /// The guard, numbered in that mode.
    pub guard: usize,
    /// How far it falls below zero, or would if nothing switched, in its unit. Below zero where it stays above its
    /// surface; and where a method of diffsol returns to it after an arc lower than the error of a step: minus the height
    /// of the arc.
    pub depth: f64,
    /// What the error of the method may change it by, in the same unit.
    pub error: f64,
    /// Whether the run has an event there.
    pub is_event: bool,
}

/// What a recorder needs of a step.
///
/// ```
/// use deltazero_solvers::Needs;
///
/// /// What a step from 1 to 2 is needed for to sample it at `t`.
/// fn to_sample(t: f64) -> Needs {
///     Needs::to_sample(t, 1.0, 2.0)
/// }
/// assert_eq!([1.5, 2.0, 2.5].map(to_sample), [Needs::DenseOutput, Needs::Ends, Needs::Nothing]);
/// assert!(Needs::Nothing < Needs::Ends && Needs::Ends < Needs::DenseOutput);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Needs {
    /// Nothing: the step need not be shown. If it is shown nevertheless, its dense output may be invalid.
    Nothing,
    /// Both ends with the slopes there. The dense output between them may be invalid, because its extra stages are
    /// not evaluated.
    Ends,
    /// The dense output too.
    DenseOutput,
}

impl Needs {
    /// What is needed of the step from `t0` to `t1` to sample it at `t`, a time not before the step. A step whose times are one
    /// is needed at that time alone.
    pub fn to_sample(t: f64, t0: f64, t1: f64) -> Self {
        let beyond = if t1 > t0 { t - t1 } else { t1 - t };
        if beyond == 0.0 {
            Self::Ends
        } else if beyond > 0.0 || t1 == t0 {
            Self::Nothing
        } else {
            Self::DenseOutput
        }
    }
}

/// Number of rejected attempts between two calls of [`Record::rejected`].
pub const REJECTIONS_A_LOOK: u64 = 64;

/// Sees, in order, every accepted step that it [needs](Record::needs) and every event, each once; is [told](Record::passed)
/// of every accepted step that it does not see; and is called now and then while attempts are
/// [rejected](Record::rejected). [`ControlFlow::Break`] ends the run as [`Interrupted`](crate::Outcome::Interrupted); after a
/// step that landed on an event, that event is shown first.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use std::ops::ControlFlow;
///
/// use deltazero_solvers::{
///     Accepted, Control, Integration, Method, Needs, Record, System, Tolerance,
/// };
///
/// /// The longest step.
/// struct Longest(f64);
///
/// impl<P: System> Record<P> for Longest {
///     fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
///         self.0 = self.0.max(accepted.step.t1() - accepted.step.t0());
///         ControlFlow::Continue(())
///     }
///     fn needs(&self, _t0: f64, _t1: f64) -> Needs {
///         Needs::Ends
///     }
/// }
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let method = Method::named("rk45").ok_or("no such method")?;
/// let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6; 2] });
/// let mut solver = method.solver(&ball, control)?;
/// let mut longest = Longest(0.0);
/// Integration::new(&ball, 0.0, ball.start()).run(1.0, &mut *solver, &mut longest)?;
/// assert!(longest.0 > 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Record<P: System> {
    /// A run from `start` towards `t_end` begins.
    ///
    /// # Errors
    /// The recorder's own, where it cannot record this run.
    fn begin(&mut self, _start: &Point<P>, _t_end: f64) -> Result<(), Error> {
        Ok(())
    }

    /// A step was accepted. A recorder of events alone leaves this out, and [needs](Self::needs) nothing.
    fn step(&mut self, _accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// An event was located and its transition made. Events at the same time are shown in the order in which they
    /// happened.
    fn event(&mut self, _event: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// A guard [grazes](crate::Grazing) in the accepted step that follows.
    fn grazing(&mut self, _grazing: &Grazing<P::Mode>) {}

    /// A step to `t` was accepted that is not shown, because [nothing](Needs::Nothing) was needed of it; the work done
    /// so far.
    fn passed(&mut self, _t: f64, _stats: &Stats) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Another [`REJECTIONS_A_LOOK`] attempts were rejected. This call accepts no step.
    ///
    /// A recorder that ends a run by a limit of work or time, or on a signal from outside, should check its limit
    /// here too: many attempts may be rejected for each accepted step, possibly without end. The methods of diffsol
    /// do not make this call, because each of their steps rejects a bounded number of attempts.
    fn rejected(&mut self, _stats: &Stats) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// What the recorder needs of a step from `t0` to `t1`; a step costs less where less is needed. A recorder that only
    /// counts steps or limits their work needs nothing, because [`passed`](Self::passed) tells it of each step.
    ///
    /// Called before the step is shown, possibly more than once, and also for steps that are then not accepted.
    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::DenseOutput
    }
}

/// Records nothing.
impl<P: System> Record<P> for () {
    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

/// A recorder that keeps nothing. It calls a function with the time and the work so far at each accepted step, and
/// after every [`REJECTIONS_A_LOOK`] rejected attempts: to show progress, or to end a run by a limit of work or time.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use std::ops::ControlFlow;
///
/// use deltazero_solvers::{Control, Integration, Method, Outcome, Tolerance, Watch};
///
/// # let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let method = Method::named("rk45").ok_or("no such method")?;
/// let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6; 2] });
/// let mut solver = method.solver(&ball, control)?;
/// let mut limit = Watch::new(|_t, stats| {
///     if stats.n_accepted < 10 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
/// });
/// let mut run = Integration::new(&ball, 0.0, ball.start());
/// assert_eq!(run.run(2.0, &mut *solver, &mut limit)?, Outcome::Interrupted);
/// assert_eq!(run.stats.n_accepted, 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Watch<F> {
    look: F,
    t: f64,
}

impl<F: FnMut(f64, &Stats) -> ControlFlow<()>> Watch<F> {
    /// A recorder that calls `look`, which may end the run.
    pub fn new(look: F) -> Self {
        Self { look, t: f64::NAN }
    }
}

impl<P: System, F: FnMut(f64, &Stats) -> ControlFlow<()>> Record<P> for Watch<F> {
    fn begin(&mut self, start: &Point<P>, _t_end: f64) -> Result<(), Error> {
        self.t = start.t;
        Ok(())
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        Record::<P>::passed(self, accepted.step.t1(), accepted.stats)
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.t = t;
        (self.look)(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        (self.look)(self.t, stats)
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

/// Two recorders of the same run; either may end it.
impl<P: System, A: Record<P>, B: Record<P>> Record<P> for (A, B) {
    fn begin(&mut self, start: &Point<P>, t_end: f64) -> Result<(), Error> {
        self.0.begin(start, t_end)?;
        self.1.begin(start, t_end)
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let first = self.0.step(accepted);
        let second = self.1.step(accepted);
        if first.is_break() { first } else { second }
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let first = self.0.event(event);
        let second = self.1.event(event);
        if first.is_break() { first } else { second }
    }

    fn grazing(&mut self, grazing: &Grazing<P::Mode>) {
        self.0.grazing(grazing);
        self.1.grazing(grazing);
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        let first = self.0.passed(t, stats);
        let second = self.1.passed(t, stats);
        if first.is_break() { first } else { second }
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        let first = self.0.rejected(stats);
        let second = self.1.rejected(stats);
        if first.is_break() { first } else { second }
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.0.needs(t0, t1).max(self.1.needs(t0, t1))
    }
}

/// A recorder, or none.
impl<P: System, R: Record<P>> Record<P> for Option<R> {
    fn begin(&mut self, start: &Point<P>, t_end: f64) -> Result<(), Error> {
        self.as_mut().map_or(Ok(()), |record| record.begin(start, t_end))
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |record| record.step(accepted))
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |record| record.event(event))
    }

    fn grazing(&mut self, grazing: &Grazing<P::Mode>) {
        if let Some(record) = self {
            record.grazing(grazing);
        }
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |record| record.passed(t, stats))
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |record| record.rejected(stats))
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.as_ref().map_or(Needs::Nothing, |record| record.needs(t0, t1))
    }
}

impl<P: System, R: Record<P> + ?Sized> Record<P> for &mut R {
    fn begin(&mut self, start: &Point<P>, t_end: f64) -> Result<(), Error> {
        (**self).begin(start, t_end)
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        (**self).step(accepted)
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        (**self).event(event)
    }

    fn grazing(&mut self, grazing: &Grazing<P::Mode>) {
        (**self).grazing(grazing);
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        (**self).passed(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        (**self).rejected(stats)
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        (**self).needs(t0, t1)
    }
}

/// Counts a rejected attempt, and calls `record` after every [`REJECTIONS_A_LOOK`] of them.
pub(crate) fn reject<P: System>(stats: &mut Stats, record: &mut dyn Record<P>) -> ControlFlow<()> {
    stats.n_rejected += 1;
    if stats.n_rejected.is_multiple_of(REJECTIONS_A_LOOK) {
        return record.rejected(stats);
    }
    ControlFlow::Continue(())
}
