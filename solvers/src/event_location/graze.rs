//! Touches: places where a guard comes so near its surface that the error of the method may decide whether it falls.
//!
//! A step without a turn near a surface costs no evaluation. A guard touches where it turns, and the search of each step knows
//! the turns: from values and rates at both ends, from the nodes of the polynomial, from the intervals of a march. A turn
//! below a height that is known from the first step of the phase is noted. Only where one was noted, and at
//! events, is the error of the guard found and compared with its height.

use num_dual::Dual64;

use super::along::along_flow;
use super::shape::cubic_minimum;
use super::{ALIKE, GuardWatch};
use crate::real::Real;
use crate::record::Grazing;
use crate::step::Step;
use crate::system::{System, Vector};

/// Number of touches on one step for which there is room from the beginning.
const MOST_TOUCHES: usize = 16;
/// Errors add up along a run: a state is taken to be wrong by up to this many times what is allowed in one step. The
/// error of methods that extrapolate was 65 times that at most (bs32), over 12 units of time of the guards of
/// `tests/grazing`.
pub(crate) const ERROR_GROWTH: f64 = 100.0;
/// A turn is noted below this many times the error of the guard as found last: that error may grow by half, and on a step
/// whose guard [is far](super::is_far) a turn may be half as high as the lower end.
const LOW: f64 = 3.0;
/// The errors are found anew at a touch this many times later in the phase than when they were found last.
const LATER: f64 = 2.0;
/// Steps shorter than this fraction of the time are not looked at: their inside is rounded.
const RESOLVED: f64 = 1e3 * f64::EPSILON;
/// The curvature at an event is the change of the rate over this fraction of a full step, or less.
const LOCAL: f64 = 1e-4;

/// A turn of a guard near its surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    guard: usize,
    t: f64,
    /// Value of the guard there.
    pub(super) height: f64,
    /// Whether it was taken for a dip before a retaken step showed none.
    is_discarded: bool,
}

impl Touch {
    /// A turn of `guard` at `t`, which was not taken for a dip.
    pub(super) fn new(guard: usize, t: f64, height: f64) -> Self {
        Self { guard, t, height, is_discarded: false }
    }
}

/// A guard within the error of the method of its surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Graze {
    pub(crate) guard: usize,
    /// Where it is least, or the time of the event.
    pub(crate) t: f64,
    /// How far it falls below zero.
    pub(crate) depth: f64,
    /// What the error of the method may change it by.
    pub(crate) error: f64,
    pub(crate) is_event: bool,
}

impl Graze {
    /// As a recorder is told of it.
    pub(crate) fn in_mode<M>(self, mode: M) -> Grazing<M> {
        let Self { guard, t, depth, error, is_event } = self;
        Grazing { t, mode, guard, depth, error, is_event }
    }
}

/// The step that was tried, whose beginning an accepted step is where it was cut at an event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FullStep {
    /// Its size.
    pub(crate) h: f64,
    /// The guard at whose event it was cut, if any.
    pub(crate) landed_on: Option<usize>,
}

/// A guard at the end of a step.
#[derive(Clone, Copy, Debug)]
struct AtEnd {
    guard: usize,
    value: f64,
    rate: f64,
}

/// The touches on the present step, and the errors that they are judged by.
pub(crate) struct Touches<G> {
    /// Heights below which a turn of a guard is noted: infinite until one has turned, and below all numbers where no
    /// touches are [watched for](Self::watch).
    limits: G,
    /// When this phase began.
    phase_began: f64,
    /// When the errors of the guards were found last; not a number where they were not in this phase.
    errors_found_at: f64,
    /// The touches so far.
    pub(super) noted: Vec<Touch>,
    /// Guards that fall at the end of the last step, where steps have slopes that jump between them.
    falling_at_end: Vec<bool>,
}

impl<G: Vector<f64>> Touches<G> {
    /// Those of `n` guards, which are not watched for yet.
    pub(super) fn new(n: usize) -> Self {
        Self {
            limits: G::from_fn(n, |_| f64::NEG_INFINITY),
            phase_began: f64::NAN,
            errors_found_at: f64::NAN,
            noted: Vec::with_capacity(MOST_TOUCHES),
            falling_at_end: vec![false; n],
        }
    }

    /// Has touches noted in a phase that began at `t`, by errors that are found anew at the next turn of a guard. Whoever
    /// asks for it looks after each accepted step whether [there is one](Self::are_noted).
    pub(crate) fn watch(&mut self, t: f64) {
        self.limits.as_mut().fill(f64::INFINITY);
        (self.phase_began, self.errors_found_at) = (t, f64::NAN);
    }

    /// Heights below which a turn of each guard is noted.
    #[inline(always)]
    pub(crate) fn limits(&self) -> &G {
        &self.limits
    }

    /// Begins to search a step, or one more time after a dip of it was discarded.
    #[inline(always)]
    pub(crate) fn begin_search(&mut self) {
        if !self.noted.is_empty() {
            self.noted.retain(|touch| touch.is_discarded);
        }
    }

    /// Forgets those of a step that is not accepted.
    pub(super) fn forget(&mut self) {
        self.noted.clear();
    }

    /// Notes that guard `i` turns at `t` with the value `height`.
    pub(crate) fn note(&mut self, i: usize, t: f64, height: f64) {
        self.note_low(Touch::new(i, t, height));
    }

    /// Notes a touch, if it is low.
    fn note_low(&mut self, touch: Touch) {
        if touch.height < self.limits.as_ref()[touch.guard] {
            self.noted.push(touch);
        }
    }

    /// Whether a guard touches on the accepted step.
    #[inline(always)]
    pub(crate) fn are_noted(&self) -> bool {
        !self.noted.is_empty()
    }

    /// Whether errors are to be found anew at one of the touches, because they are not known or are old.
    fn are_new(&self) -> bool {
        self.noted.iter().any(|touch| {
            let began = self.phase_began;
            // False where they are not known.
            let is_known = (touch.t - began).abs() <= LATER * (self.errors_found_at - began).abs();
            !is_known
        })
    }

    /// Tells `told` of the touches on an accepted step of size `h` to `t1`, by the errors found last; false where errors are
    /// to be found anew.
    pub(crate) fn tell_known(&mut self, t1: f64, h: f64, told: &mut dyn FnMut(Graze)) -> bool {
        if self.are_new() {
            return false;
        }
        let mut noted = std::mem::take(&mut self.noted);
        noted.drain(..).filter_map(|touch| self.grazing(touch, t1, h)).for_each(told);
        self.noted = noted;
        true
    }

    /// What is told of a touch on a step of size `h` to `t1`: it is within the error.
    fn grazing(&self, Touch { guard, t, height, .. }: Touch, t1: f64, h: f64) -> Option<Graze> {
        let error = self.error_of(guard);
        let is_within = height.abs() <= error && error.is_finite();
        let graze = Graze { guard, t, depth: -height, error, is_event: false };
        (is_resolved(t1, h) && is_within).then_some(graze)
    }

    /// The error of guard `i`, as found last.
    fn error_of(&self, i: usize) -> f64 {
        self.limits.as_ref()[i] / LOW
    }

    /// Sets the errors of the guards, found at `t`, and from them the heights below which turns are noted.
    fn set_errors(&mut self, t: f64, errors: impl Iterator<Item = f64>) {
        for (limit, error) in self.limits.as_mut().iter_mut().zip(errors) {
            // Not a number where a derivative is infinite.
            *limit = if error.is_nan() { f64::INFINITY } else { LOW * error };
        }
        self.errors_found_at = t;
    }
}

/// What is noted on a step.
impl<P: System> GuardWatch<P> {
    /// Notes the turn of guard `i` at a dip that is to be discarded: beside the end of `step`, which was retaken up to there,
    /// by the curvature over a part of the size `h`.
    pub(crate) fn note_discarded(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        h: f64,
    ) {
        let at = self.at_end_of(problem, mode.clone(), step, i);
        let curvature = self.curvature(problem, mode, step, at, LOCAL * h);
        // Where rounding hides the curvature the turn is taken to be at the end.
        let to_turn = if curvature > 0.0 { 0.5 * at.rate * at.rate / curvature } else { 0.0 };
        let height = at.value - to_turn;
        let touch = Touch { is_discarded: true, ..Touch::new(i, step.t1(), height) };
        self.touches.note_low(touch);
    }

    /// Notes the turns of all guards on a step of size `h` from `t0` on which all of them hold.
    #[cold]
    #[inline(never)]
    pub(super) fn note_turns(&mut self, t0: f64, h: f64) {
        for i in 0..self.end.as_ref().len() {
            self.note_turn(i, t0, h);
        }
    }

    /// Notes the turn of guard `i` on a step of size `h` from `t0` on which it holds, by its cubic.
    #[inline]
    pub(super) fn note_turn(&mut self, i: usize, t0: f64, h: f64) {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        self.note_turn_between(i, (t0, h), g0, g1);
    }

    /// The same, with the values and rates `g0` and `g1` at both ends.
    #[inline]
    pub(crate) fn note_turn_between(
        &mut self,
        i: usize,
        (t0, h): (f64, f64),
        g0: Dual64,
        g1: Dual64,
    ) {
        if g0.eps * h < 0.0 && g1.eps * h >= 0.0 {
            let least = cubic_minimum([g0.re, g1.re], [g0.eps * h, g1.eps * h]);
            let (theta, height) = least.unwrap_or((1.0, g1.re));
            self.touches.note(i, t0 + theta * h, height);
        }
    }

    /// Notes which guards fall at the end of the last step, whose slope is about to be replaced by that of the next
    /// interpolant.
    #[cfg(feature = "diffsol")]
    pub(crate) fn note_falls(&mut self, h: f64) {
        for (falls, start) in self.touches.falling_at_end.iter_mut().zip(self.start.as_ref()) {
            *falls = start.eps * h < 0.0;
        }
    }

    /// Notes the turn of guard `i` right at the start of a step of size `h`, where the slope of the interpolant jumps.
    pub(super) fn note_jump(&mut self, i: usize, t0: f64, h: f64) {
        let g0 = self.start.as_ref()[i];
        if self.touches.falling_at_end[i] && g0.eps * h >= 0.0 {
            self.touches.note(i, t0, g0.re);
        }
    }
}

/// What is told of an accepted step.
impl<P: System> GuardWatch<P> {
    /// Tells `told` of the touches on an accepted `step`, which may be a `full` one cut at an event, and of that
    /// event if the guard would rise again from within the error. `error` is the error that the run may have made in a state. Where the
    /// derivatives of a guard are not finite nothing is told of it.
    pub(crate) fn graze(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        FullStep { h, landed_on }: FullStep,
        error: &dyn Fn(usize) -> f64,
        told: &mut dyn FnMut(Graze),
    ) {
        let (t0, t1) = (step.t0(), step.t1());
        self.touches.noted.retain(|touch| (touch.t - t1) * (t1 - t0) <= 0.0);
        let landed = landed_on.map(|i| self.at_end_of(problem, mode.clone(), step, i));
        let shallow = landed.filter(|at| {
            self.is_straying(at.guard, h) || self.may_rise(problem, mode.clone(), step, *at, h)
        });
        if shallow.is_some() || self.touches.are_new() {
            self.find_errors(problem, mode.clone(), step, error);
        }
        self.touches.tell_known(t1, t1 - t0, told);
        if let Some(at) = shallow
            && is_resolved(t1, t1 - t0)
        {
            let (guard, error) = (at.guard, self.touches.error_of(at.guard));
            if let Some(depth) = self.depth_after(problem, mode, step, at, h) {
                told(Graze { guard, t: t1, depth, error, is_event: true });
            }
        }
    }

    /// Finds the errors of the guards at the end of `step`.
    fn find_errors(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        error: &dyn Fn(usize) -> f64,
    ) {
        self.doubt(problem, mode.clone(), step, error);
        let within = ALIKE * (step.t1() - step.t0()).abs();
        self.find_bounds(problem, mode, (step.t1(), step.y1()), within);
        let errors = self.doubts.as_ref().iter().zip(self.bounds.as_ref());
        self.touches.set_errors(step.t1(), errors.map(|(doubt, bound)| doubt + bound));
    }

    /// Whether the guard on which `step`, cut from a full one of size `h`, landed would rise again by its curvature there, from
    /// no deeper than a turn that is noted. False where a rate is not finite.
    fn may_rise(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        at: AtEnd,
        h: f64,
    ) -> bool {
        let curvature = self.curvature(problem, mode, step, at, LOCAL * h);
        let limit = self.touches.limits().as_ref()[at.guard];
        curvature > 0.0 && 0.5 * at.rate * at.rate / curvature < limit
    }

    /// How far the guard on which `step` landed would fall below zero by its curvature there, where that is within its error.
    /// A full step has the size `h`.
    fn depth_after(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        at: AtEnd,
        h: f64,
    ) -> Option<f64> {
        let error = self.touches.error_of(at.guard);
        // A dip of that depth lasts twice as long.
        let short = (2.0 * error / at.rate.abs()).min(LOCAL * h.abs()).copysign(h);
        let curvature = self.curvature(problem, mode, step, at, short);
        let depth = 0.5 * at.rate * at.rate / curvature - at.value;
        // False where the time or a rate is not resolved.
        (curvature > 0.0 && depth <= error).then_some(depth)
    }

    /// Guard `i` at the end of `step`.
    fn at_end_of(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
    ) -> AtEnd {
        self.rates(problem, mode, step.t1(), step.y1(), step.slope1());
        AtEnd { guard: i, value: self.end_value(i), rate: self.rate(i) }
    }

    /// The curvature of a guard along the flow from the end of `step` over a `short` time.
    fn curvature(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        at: AtEnd,
        short: f64,
    ) -> f64 {
        let ahead = step.t1() + short;
        let short = ahead - step.t1();
        self.y.clone_from(step.y1());
        for (y, slope) in self.y.as_mut().iter_mut().zip(step.slope1().as_ref()) {
            *y += short * slope;
        }
        problem.rhs(mode.clone(), ahead, &self.y, &mut self.slope);
        let Self { y, slope, seeded, along, .. } = self;
        along_flow(problem, mode, (ahead, y), slope, seeded, along);
        (self.slope_along(at.guard) - at.rate) / short
    }

    /// Begins the arcs of guards at the start of a phase.
    #[cfg(feature = "diffsol")]
    pub(crate) fn begin_arcs(&mut self) {
        self.arcs.clone_from(&self.start);
    }

    /// How high guard `i` rose in a phase that took the time `span` until `step` landed on it, and what an `error` of each
    /// state would change it by. The arc is taken for a parabola, from values and rates at both ends of the phase: one too
    /// low to resolve is.
    #[cfg(feature = "diffsol")]
    pub(crate) fn arc(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        span: f64,
        error: &dyn Fn(usize) -> f64,
    ) -> (f64, f64) {
        self.doubt(problem, mode.clone(), step, error);
        self.rates(problem, mode, step.t1(), step.y1(), step.slope1());
        let (g0, g1) = (self.arcs.as_ref()[i], self.end.as_ref()[i]);
        let height = g0.re.max(0.0) + 0.25 * span.abs() * g0.eps.abs().max(g1.eps.abs());
        (height, self.doubts.as_ref()[i])
    }

    /// Writes `Σ_j |∂g_i/∂y_j| error_j` at the end of `step` to `doubts`: a bound of the change of each guard by such
    /// errors of the states.
    pub(super) fn doubt(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        error: &dyn Fn(usize) -> f64,
    ) {
        let y = step.y1().as_ref();
        let mut g = self.end.clone();
        let span = problem.guard_span();
        self.doubts.as_mut().fill(0.0);
        for j in 0..span.min(y.len()) {
            for (i, (seeded, y)) in self.seeded.as_mut().iter_mut().zip(y).enumerate() {
                *seeded = Dual64::new(*y, if i % span == j { error(i) } else { 0.0 });
            }
            problem.guards(mode.clone(), Dual64::cst(step.t1()), &self.seeded, &mut g);
            for (doubt, g) in self.doubts.as_mut().iter_mut().zip(g.as_ref()) {
                *doubt += g.eps.abs();
            }
        }
    }
}

/// Whether the time within a step of size `h` to `t1` has digits.
fn is_resolved(t1: f64, h: f64) -> bool {
    h.abs() >= RESOLVED * t1.abs()
}
