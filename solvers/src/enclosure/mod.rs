//! Intervals that are proven to contain the exact solution of a hybrid system, and the times of its events.
//!
//! Every integrator of this crate estimates its error. An [`Enclosure`] bounds it: it computes with [`Interval`]s that
//! are rounded outward, and adds a bound of the remainder to every Taylor polynomial. What is enclosed is the model's
//! own code, with the numbers of its parameters as `f64`, computed without rounding from there.
//!
//! ```text
//! y(t + h) ∈ Σ_(k≤N) y_k hᵏ + y_(N+1)(B) h^(N+1),    y(t + s) ∈ B for 0 ≤ s ≤ h,    N = 15
//! ```
//!
//! - A box `B` that the solution stays in is found by Picard's iteration.
//! - The set of states that are possible is a parallelepiped. The derivative of the polynomial carries it (mean value
//!   form); its axes are made orthogonal where they come too near to each other (Lohner's method).
//! - Over a step each guard is a polynomial with a bounded remainder. Either it is shown to be above zero, or it is
//!   shown to fall through zero once; no other guard falls before.
//! - The time of an event is bounded by Newton's method on intervals. The set passes it by the saltation matrix, with
//!   entries in intervals.
//!
//! What cannot be shown ends in [`Error::NotProven`], with a [`Doubt`]. Simple crossings of one guard at a time can be
//! shown; touches, sets of states that meet events in several orders, and accumulations cannot.
//!
//! A ball is dropped from 1 m on a floor that returns half its speed:
//!
//! ```
//! use deltazero_solvers::enclosure::Enclosure;
//! use deltazero_solvers::problems::BouncingBall;
//! use deltazero_solvers::{Error, System, Tolerance};
//!
//! let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
//! let mode = ball.initial_mode(0.0, &ball.start());
//! let tolerance = Tolerance { rtol: 1e-16, atol: vec![1e-16; 2] };
//! let mut enclosure = Enclosure::new(&ball, mode, 0.0, &ball.start(), tolerance)?;
//! let mut n = 0;
//! while let Some(bounce) = enclosure.advance(1.2)? {
//!     assert!(bounce.t.distance(ball.bounce_time(n)) < 1e-15 && bounce.t.width() < 1e-13);
//!     n += 1;
//! }
//! assert_eq!(n, 3);
//! # Ok::<(), Error>(())
//! ```
//!
//! # What the proof rests on
//!
//! - Arithmetic of `f64` by IEEE 754, rounded to nearest: sums, products, quotients and roots. So it is on all targets
//!   of Rust with SSE2 or NEON, not on 32-bit x86 without SSE2. No compiler flag may change it.
//! - The code here, and the compiler. No function of `libm` enters a bound; sine and cosine are by series of their own,
//!   and models that use `exp`, `ln`, `powf`, hyperbolic functions or arcs are refused.
//! - A right-hand side and guards that use no other scalar than the one given, and no hidden state. Where one branches on
//!   the [value](crate::Real::value) of a number that is not the same for all states that are possible, the model is
//!   refused. A number made of constants alone is not watched: its sign is known, unless rounding hides it.
//! - Transitions that decide by the *signs* of values, or by which of some ranges one value is in, and otherwise only
//!   store values in the mode. A sign that is not the same for all states that are possible is refused, and so is a mode
//!   or a state that is not the same by the lower bounds of the values and by the upper ones. A range between two others
//!   from which the same follows is not watched, nor is a comparison of two values with each other, but
//!   [`min`](crate::Real::min) and [`max`](crate::Real::max) are, which compare by a sign.
//! - The promise of [`System::transition`] that every guard of the new mode is at or above
//!   zero: a guard that is about zero where a mode begins is taken not to be below it, and is then shown to rise.
//!   Whether a model keeps that promise in exact arithmetic is for its author to say.
//!
//! R. E. Moore, *Interval Analysis* (1966). R. J. Lohner, thesis, Karlsruhe (1988). N. S. Nedialkov, K. R. Jackson, G.
//! F. Corliss, Appl. Math. Comput. 105(1), 21–68 (1999). W. Tucker, *Validated Numerics*, Princeton University Press
//! (2011).

mod event;
mod expand;
mod interval;
mod polynomial;
mod set;
mod step;
mod tube;
mod watched;

pub use crate::doubt::Doubt;
pub use interval::Interval;

use event::Fall;
use expand::Field;
use set::Set;
use step::{ORDER, Step, Tried};

use crate::error::Error;
use crate::integrate::check_length;
use crate::phase::check_finite;
use crate::point::Point;
use crate::system::{Next, System};
use crate::tolerance::Tolerance;

/// The largest and the smallest factor from one step size to the next.
const GROWTH: f64 = 2.0;
const SHRINK: f64 = 0.1;
/// Halvings of a step after which it is given up.
const SHORTEST: usize = 40;
/// The largest factor from a step that is too long to the next attempt.
const SAFETY: f64 = 0.9;

/// An event that is proven to be the next one.
///
/// ```
/// use deltazero_solvers::enclosure::Enclosure;
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Error, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-16, atol: vec![1e-16; 2] };
/// let mode = BouncingMode::Flight;
/// let mut enclosure = Enclosure::new(&ball, mode, 0.0, &ball.start(), tolerance)?;
/// let Some(bounce) = enclosure.advance(0.6)? else { panic!("it bounces by then") };
/// assert_eq!((bounce.guard, bounce.after), (0, Some(mode)));
/// assert!(bounce.y_before[0].contains(0.0) && bounce.y_after[0].is_point());
/// let speed = bounce.y_after[1];
/// assert!(speed.distance(ball.bounce_speed(0)) < 1e-15 && speed.width() < 1e-14);
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ProvenEvent<M> {
    /// Bounds of its time.
    pub t: Interval,
    /// The guard that falls.
    pub guard: usize,
    /// The mode before it.
    pub before: M,
    /// The mode after it; none where it is terminal.
    pub after: Option<M>,
    /// Bounds of the states before it.
    pub y_before: Vec<Interval>,
    /// Bounds of the states after it.
    pub y_after: Vec<Interval>,
}

/// The enclosure of one solution of a system, as far as it is computed.
///
/// See the [module](self) for the method, an example, and what the proof rests on.
///
/// ```
/// use deltazero_solvers::enclosure::Enclosure;
/// use deltazero_solvers::problems::{FrictionMode, FrictionOscillator};
/// use deltazero_solvers::{Error, Tolerance};
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-16, atol: vec![1e-16; 2] };
/// let (mode, start) = (FrictionMode::SlipMinus, slider.start());
/// let mut enclosure = Enclosure::new(&slider, mode, 0.0, &start, tolerance)?;
/// while enclosure.advance(10.0)?.is_some() {}
/// assert_eq!((enclosure.t(), enclosure.mode()), (10.0, &FrictionMode::Stick));
/// let x = enclosure.state()[0];
/// assert!(x.distance(slider.state(10.0)[0]) < 1e-15 && x.width() < 1e-13);
/// # Ok::<(), Error>(())
/// ```
pub struct Enclosure<'p, P: System> {
    field: Field<'p, P>,
    t: f64,
    set: Set,
    tolerance: Tolerance,
    /// The step size to try next.
    h: f64,
    /// The mode began in a step not taken yet, at most this long ago.
    begun: Option<f64>,
    is_over: bool,
    n_steps: usize,
}

impl<'p, P: System> Enclosure<'p, P> {
    /// The solution that is in the state `y` and in `mode` at `t`.
    ///
    /// The remainder of each step is held below `tolerance`; its `atol` are also the sizes by which states of several
    /// units are compared. It bounds no error: the intervals do.
    ///
    /// A guard that is zero at the start must rise from there, by its first derivative that is not zero.
    ///
    /// # Errors
    /// [`Error::BadTolerance`], [`Error::BadArgument`] for a start with more or fewer states than the system
    /// [has](System::dim), [`Error::NonFinite`] for one that is not finite.
    pub fn new(
        problem: &'p P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        tolerance: Tolerance,
    ) -> Result<Self, Error> {
        tolerance.check(problem.dim())?;
        check_length(problem, y)?;
        check_finite::<P>(&Point { t, y: y.clone(), mode: mode.clone() }, y)?;
        let set = Set::point(y.as_ref(), &tolerance.atol);
        let field = Field { problem, mode };
        let (h, begun) = (f64::INFINITY, Some(0.0));
        Ok(Self { field, t, set, tolerance, h, begun, is_over: false, n_steps: 0 })
    }

    /// The time to which it is computed. After an event it is near the event's, and may be within its bounds; the next
    /// time that can be reached is beyond these.
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The mode.
    pub fn mode(&self) -> &P::Mode {
        &self.field.mode
    }

    /// Bounds of the states at [`t`](Self::t). Right after an event they are those that the new mode leads to its own
    /// states from; after a terminal one, those that the old mode leads to there, as if it had not ended.
    pub fn state(&self) -> Vec<Interval> {
        self.set.hull()
    }

    /// Number of steps taken.
    pub fn n_steps(&self) -> usize {
        self.n_steps
    }

    /// Goes on to the next event, or to the time `to` where there is none before it; `None` then, and after a terminal
    /// event.
    ///
    /// # Errors
    /// [`Error::NotProven`] where it cannot be shown what follows. [`Error::BadArgument`] where `to` is not finite, or
    /// before the time that is reached.
    pub fn advance(&mut self, to: f64) -> Result<Option<ProvenEvent<P::Mode>>, Error> {
        if !to.is_finite() || to < self.t {
            let allowed = "a finite time, not before the one that is reached";
            return Err(Error::BadArgument { name: "to", value: to, allowed });
        }
        while self.t < to && !self.is_over {
            let event = self.step(to).map_err(|doubt| self.not_proven(doubt))?;
            if event.is_some() {
                return Ok(event);
            }
        }
        Ok(None)
    }

    fn not_proven(&self, doubt: Doubt) -> Error {
        Error::NotProven { t: self.t, mode: format!("{:?}", self.field.mode), doubt }
    }

    /// One step, at most to the time `to`. A step that is too long for something to be shown is halved.
    fn step(&mut self, to: f64) -> Result<Option<ProvenEvent<P::Mode>>, Doubt> {
        let (t, back) = (self.t, self.begun.unwrap_or(0.0));
        // The mode is that of the end of a step only where it has surely begun by then.
        let has_begun = |end: f64| (Interval::from(end) - t).lo() > back;
        if !has_begun(to) {
            return Err(Doubt::Begin);
        }
        let (mut h, mut doubt) = (self.h.max(2.0 * back).min(to - t), Doubt::NoBox);
        for _ in 0..SHORTEST {
            let end = if self.t + h >= to { to } else { self.t + h };
            if !has_begun(end) {
                break;
            }
            let span = (Interval::from(end) - self.t).hull(Interval::from(-back));
            match Step::attempt(&self.field, self.t, &self.set, span, &self.tolerance)? {
                Tried::TooLong(factor) => h *= factor.clamp(SHRINK, SAFETY),
                Tried::Step(step) => match self.pass(&step, end) {
                    Ok(event) => {
                        self.n_steps += 1;
                        let next = h * step.factor().clamp(SHRINK, GROWTH);
                        self.h = if end == to { self.h.max(next) } else { next };
                        return Ok(event);
                    }
                    // No shorter step would tell.
                    Err(why @ (Doubt::Order { .. } | Doubt::Transition { .. })) => return Err(why),
                    Err(why) => (h, doubt) = (0.5 * h, why),
                },
            }
        }
        Err(doubt)
    }

    /// Moves on to the end of the step, or through the first event on the way.
    fn pass(&mut self, step: &Step, end: f64) -> Result<Option<ProvenEvent<P::Mode>>, Doubt> {
        let first = self.first_fall(step)?;
        let to = first.map_or(end, |(_, fall)| end.min(self.t + fall));
        let set = step.end(&self.field, &self.set, to).ok_or(Doubt::NoBox)?;
        let Some((guard, _)) = first else {
            (self.t, self.set, self.begun) = (to, set, None);
            return Ok(None);
        };
        let fall = Fall::new(&self.field, (guard, to), &set)?;
        self.is_first(step, guard, (Interval::from(to) - self.t, fall.around()))?;
        let passage = fall.pass(&self.field, &set)?;
        let before = self.field.mode.clone();
        let after = match passage.next {
            Next::Stop => {
                self.set = set;
                None
            }
            Next::Mode((mode, set)) => {
                self.set = set;
                self.field.mode = mode.clone();
                Some(mode)
            }
        };
        (self.t, self.begun, self.is_over) = (to, Some(fall.around()), after.is_none());
        let (t, y_before, y_after) =
            (Interval::from(to) + passage.time, passage.before, passage.after);
        Ok(Some(ProvenEvent { t, guard, before, after, y_before, y_after }))
    }

    /// The guard that seems to fall first in the step, and when, from its start; none where every guard is shown to be
    /// above zero all over the step.
    fn first_fall(&self, step: &Step) -> Result<Option<(usize, f64)>, Doubt> {
        let span = step.span();
        let mut first: Option<(usize, f64)> = None;
        for (guard, g) in step.guards.iter().enumerate() {
            if g.is_constant() && g.coefficient(0).lo() > 0.0 || self.rises(step, guard)? {
                continue;
            }
            let Some(doubt) = g.first_doubt(span) else { continue };
            let fall = g.fall_after(doubt.max(0.0), span.hi()).ok_or(Doubt::Touch { guard })?;
            if first.is_none_or(|(_, earliest)| fall < earliest) {
                first = Some((guard, fall));
            }
        }
        Ok(first)
    }

    /// Whether `guard` is about zero where the mode begins, and is shown to rise from there all over the step. It is
    /// not below zero there. If its derivatives of order 1 to k − 1 are zero at the start, then
    /// `g(s) = g(0) + g⁽ᵏ⁾(ξ) sᵏ/k!`.
    fn rises(&self, step: &Step, guard: usize) -> Result<bool, Doubt> {
        let (g, span) = (&step.guards[guard], step.span());
        let Some(back) = self.begun else { return Ok(false) };
        if g.first_doubt(Interval::new(-back, 0.0)).is_none() {
            return Ok(false);
        }
        if g.at(Interval::ZERO).hi() < 0.0 {
            return Err(Doubt::Rise { guard });
        }
        let is_zero = |k: usize| g.coefficient(k) == Interval::ZERO;
        let first = (1..=ORDER).find(|k| !is_zero(*k)).unwrap_or(1);
        // Where the time of the start is not exact, only the first derivative tells.
        let order = if back == 0.0 { first } else { 1 };
        match g.derived(order).first_doubt(span) {
            None => Ok(true),
            Some(_) => Err(Doubt::Rise { guard }),
        }
    }

    /// That `guard`, which falls within `around` of the time `fall` from the start, does not fall before, and no other
    /// guard does.
    fn is_first(
        &self,
        step: &Step,
        guard: usize,
        (fall, around): (Interval, f64),
    ) -> Result<(), Doubt> {
        let span = step.span();
        let last = (fall + around).hi();
        if last > span.hi() {
            return Err(Doubt::End { guard });
        }
        for (other, g) in step.guards.iter().enumerate() {
            let is_clear = |to: f64| g.first_doubt(Interval::new(span.lo(), to)).is_none();
            if other != guard {
                if !(is_clear(last) || self.rises(step, other)?) {
                    return Err(Doubt::Order { guards: [guard, other] });
                }
                continue;
            }
            // It falls all over a span about the event, and is above zero before. The mode has begun by then.
            let (falling, ahead) = (g.derived(1).negated(), fall.lo() - span.lo());
            let begin = (1..SHORTEST)
                .map(|n| fall.lo() - ahead * libm::ldexp(1.0, -(n as i32)))
                .find(|begin| falling.first_doubt(Interval::new(*begin, last)).is_none());
            if !begin.is_some_and(|begin| begin > -span.lo() && is_clear(begin)) {
                return Err(Doubt::Touch { guard });
            }
        }
        Ok(())
    }
}
