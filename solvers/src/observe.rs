//! Observing a run without switching: zeros of functions of mode, time and state.
//!
//! [`Observations`] are a recorder. So any run can be observed, by any method, alone or in a batch, and the model is not
//! changed: no step is retaken for a zero, none is shorter, and no count of work is another one. The zeros are those of
//! the dense output, so a zero is as exact as that.
//!
//! A ball that passes half of its height, and turns:
//!
//! ```
//! use deltazero_solvers::observe::Observations;
//! use deltazero_solvers::problems::BouncingBall;
//! use deltazero_solvers::{Control, Error, Integration, Method, Tolerance};
//!
//! let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
//! let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
//! let mut seen = Observations::<BouncingBall>::default()
//!     .of(1e-15, |_mode, _t, y| y[0] - 0.5)
//!     .of(1e-14, |_mode, _t, y| y[1]);
//! let mut run = Integration::new(&ball, 0.0, ball.start());
//! if let Some(method) = Method::named("dop853") {
//!     run.run(1.2, &mut *method.solver(&ball, control)?, &mut seen)?;
//! }
//! let zeros: Vec<_> = seen.zeros.iter().map(|zero| (zero.function, zero.rises)).collect();
//! // Down through the half, up through it, at the top, and down again. The bounce itself is no zero of the velocity.
//! assert_eq!(zeros, [(0, false), (0, true), (1, false), (0, false)]);
//! assert!((seen.zeros[0].t - (1.0_f64 / 9.8).sqrt()).abs() < 1e-9);
//! # Ok::<(), Error>(())
//! ```
//!
//! # What is a zero
//!
//! Each function has a side, above or below zero: that of its last value beyond its rounding bound. A zero is where a
//! function changes its side within a step. Zero at the start of a run is none, nor is a touch, nor a jump over zero at
//! an event of the run, after which the side is that of the new value.
//!
//! # What is found within one step
//!
//! Each function is followed on the dense output of each step by the march that follows the guards which move faster
//! than the states ([`event_location`](crate::event_location), stage 4): intervals that begin short, and grow while parabolas through the
//! values follow the function. Two zeros within one step are found by the minimum between them. It takes some twenty
//! evaluations of the dense output and the function for each step, and the stages that dense output needs. A step on
//! which a function is not finite, or cannot be followed, is [listed](Observations::unfollowed).

use std::ops::ControlFlow;

use crate::error::Error;
use crate::event_location::march::{Found, first_fall, first_width};
use crate::point::Point;
use crate::record::{Accepted, Event, Record};
use crate::root::{Bracket, find_root};
use crate::step::Step;
use crate::system::System;

/// Fraction of the step over which the slopes at both ends are differences.
const NEXT: f64 = 1e-6;
/// Zeros of a function in one step beyond which it is not followed: one that is rounded by more than its bound has as many
/// as are looked for.
const MOST_ZEROS: usize = 10_000;
/// Fractions of a step at which a function without a side is looked at.
const FIRST_LOOKS: [f64; 5] = [1e-6, 1e-4, 1e-2, 0.2, 1.0];

/// A zero of an observed function.
///
/// ```
/// use deltazero_solvers::observe::{Observations, Zero};
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Control, Integration, Method, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&ball, control)?;
/// let mut seen = Observations::default().of(1e-14, |_: &BouncingMode, _t, y: &[f64; 2]| y[1]);
/// Integration::new(&ball, 0.0, ball.start()).run(1.0, &mut *solver, &mut seen)?;
/// let [Zero { t, rises: false, y, .. }] = seen.zeros[..] else { panic!("it turns once") };
/// // At the height e² of the drop, in the middle between two bounces.
/// assert!((y[0] - 0.25).abs() < 1e-9);
/// assert!((t - 0.5 * (ball.bounce_time(0) + ball.bounce_time(1))).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Zero<Y, M> {
    /// Time.
    pub t: f64,
    /// The function, numbered in the order in which they were given.
    pub function: usize,
    /// Whether it rises there, in the direction in which the run goes.
    pub rises: bool,
    /// Mode.
    pub mode: M,
    /// State on the dense output.
    pub y: Y,
}

/// A step on which a function is not finite, or moves too fast to be followed.
///
/// ```
/// use deltazero_solvers::observe::Observations;
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Control, Integration, Method};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let method = Method::named("rk4").ok_or("no such method")?;
/// let mut solver = method.solver(&ball, Control::Fixed(0.1))?;
/// // The root of a height above 0.5 m, which the ball passes in the fourth step.
/// let root = |_: &BouncingMode, _t: f64, y: &[f64; 2]| (y[0] - 0.5).sqrt();
/// let mut seen = Observations::default().of(1e-15, root);
/// Integration::new(&ball, 0.0, ball.start()).run(0.4, &mut *solver, &mut seen)?;
/// let [step] = seen.unfollowed[..] else { panic!("one step passes it") };
/// assert!(step.t0 < (1.0_f64 / 9.8).sqrt() && step.t1 == 0.4 && seen.zeros.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unfollowed {
    /// The function.
    pub function: usize,
    /// Time at the start of the step.
    pub t0: f64,
    /// Time at its end.
    pub t1: f64,
}

/// A function to observe a run by.
type Function<'f, P> =
    Box<dyn Fn(&<P as System>::Mode, f64, &<P as System>::State<f64>) -> f64 + 'f>;

/// A recorder of the zeros of functions along a run.
///
/// ```
/// use deltazero_solvers::observe::Observations;
/// use deltazero_solvers::problems::FrictionOscillator;
/// use deltazero_solvers::{Control, Integration, Method, Tolerance};
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&slider, control)?;
/// let mut seen = Observations::<FrictionOscillator>::default().of(1e-15, |_mode, _t, y| y[0]);
/// Integration::new(&slider, 0.0, slider.start()).run(10.0, &mut *solver, &mut seen)?;
/// let [first, second, third] = &seen.zeros[..] else { panic!("it passes the middle three times") };
/// assert!(!first.rises && second.rises && !third.rises);
/// // It swings about 0.15 m at first: 0.15 + 0.85 cos t = 0.
/// assert!((first.t - (-0.15_f64 / 0.85).acos()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Observations<'f, P: System> {
    /// The zeros, in the order of the run.
    pub zeros: Vec<Zero<P::State<f64>, P::Mode>>,
    /// Steps of which the zeros of a function are not known.
    pub unfollowed: Vec<Unfollowed>,
    observed: Vec<Observed<'f, P>>,
    /// Where the last step ended.
    t: Option<f64>,
}

/// A function with its side.
struct Observed<'f, P: System> {
    function: Function<'f, P>,
    side: Side,
}

/// The side of zero that a function is on.
struct Side {
    /// 1 above zero, −1 below, 0 where the function was never beyond its bound.
    sign: f64,
    bound: f64,
}

impl<P: System> Default for Observations<'_, P> {
    /// Observations of no function.
    fn default() -> Self {
        Self { zeros: Vec::new(), unfollowed: Vec::new(), observed: Vec::new(), t: None }
    }
}

impl<'f, P: System> Observations<'f, P> {
    /// Observes the run by `function(mode, t, y)` too, whose values are rounded by at most `bound`. It must be smooth
    /// within a mode.
    #[must_use]
    pub fn of(
        mut self,
        bound: f64,
        function: impl Fn(&P::Mode, f64, &P::State<f64>) -> f64 + 'f,
    ) -> Self {
        let side = Side { sign: 0.0, bound };
        self.observed.push(Observed { function: Box::new(function), side });
        self
    }
}

impl<P: System> Record<P> for Observations<'_, P> {
    fn begin(&mut self, start: &Point<P>, _t_end: f64) -> Result<(), Error> {
        if self.t != Some(start.t) {
            self.t = None;
            self.observed.iter_mut().for_each(|observed| observed.side.sign = 0.0);
        }
        Ok(())
    }

    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let (t0, t1) = (step.t0(), step.t1());
        let goes_on = self.t == Some(t0);
        let n = self.zeros.len();
        let mut y = step.y1().clone();
        for (number, Observed { function, side }) in self.observed.iter_mut().enumerate() {
            let along = Along::<P> { step, mode: &accepted.mode, function };
            if !goes_on {
                side.look(along.value(0.0, &mut y));
            }
            let mut zero = |theta: f64, rises: bool, y: &mut P::State<f64>| {
                let (t, mode) = (along.time(theta), accepted.mode.clone());
                step.interpolate(t, y);
                self.zeros.push(Zero { t, function: number, rises, mode, y: y.clone() });
            };
            if !side.follow(&along, &mut y, &mut zero) {
                self.unfollowed.push(Unfollowed { function: number, t0, t1 });
            }
        }
        self.zeros[n..].sort_by(|a, b| (a.t - t0).abs().total_cmp(&(b.t - t0).abs()));
        self.t = Some(t1);
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        self.t = None;
        ControlFlow::Continue(())
    }
}

impl Side {
    /// Takes the side of `value`, if it is beyond the bound.
    fn look(&mut self, value: f64) {
        if value.abs() > self.bound {
            self.sign = value.signum();
        }
    }

    /// Follows the function along a step, and tells `zero` of the fraction of each zero and whether the function rises
    /// there. Returns whether it could be followed.
    fn follow<P: System>(
        &mut self,
        along: &Along<'_, P>,
        y: &mut P::State<f64>,
        zero: &mut impl FnMut(f64, bool, &mut P::State<f64>),
    ) -> bool {
        for theta in FIRST_LOOKS {
            if self.sign == 0.0 {
                self.look(along.value(theta, y));
            }
        }
        let ends = [0.0, NEXT, 1.0 - NEXT, 1.0].map(|theta| along.value(theta, y));
        let slopes = [ends[1] - ends[0], ends[3] - ends[2]].map(|change| change / NEXT);
        let width = first_width([ends[0], ends[3]], slopes);
        let (mut from, bound, mut n_zeros) = (0.0, self.bound, 0);
        // Dense output may begin off the end of the step before.
        if self.sign * ends[0] < -bound {
            zero(0.0, self.sign < 0.0, y);
            self.sign = -self.sign;
        }
        while from < 1.0 {
            n_zeros += 1;
            let sign = self.sign;
            let falls = from == 0.0 && sign * slopes[0] < 0.0;
            let raised = |theta| sign * along.value(theta, y) + bound;
            let rises = sign * slopes[1] > 0.0;
            let found = match n_zeros {
                ..=MOST_ZEROS => first_fall(raised, from, width, bound, (falls, rises), |_, _| {}),
                _ => Found::Lost,
            };
            match found {
                Found::Fall(above, below) => {
                    let root = |theta| sign * along.value(theta, y);
                    let at = find_root(root, Bracket { above, below }, f64::EPSILON);
                    zero(at, sign < 0.0, y);
                    (self.sign, from) = (-sign, below);
                }
                Found::Nothing(_) => break,
                Found::NotFinite | Found::Lost => {
                    self.look(ends[3]);
                    return false;
                }
            }
        }
        true
    }
}

/// A function along a step.
struct Along<'a, P: System> {
    step: &'a dyn Step<P::State<f64>>,
    mode: &'a P::Mode,
    function: &'a Function<'a, P>,
}

impl<P: System> Along<'_, P> {
    /// The time at a fraction of the step.
    fn time(&self, theta: f64) -> f64 {
        let (t0, t1) = (self.step.t0(), self.step.t1());
        if theta == 1.0 { t1 } else { t0 + theta * (t1 - t0) }
    }

    /// The value at a fraction of the step, with `y` for the state there.
    fn value(&self, theta: f64, y: &mut P::State<f64>) -> f64 {
        let t = self.time(theta);
        self.step.interpolate(t, y);
        (self.function)(self.mode, t, y)
    }
}
