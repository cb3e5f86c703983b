//! Guards over a step: which guards fall below zero, which of them falls first, and when.
//!
//! A guard `g` is *violated* where `g < −bound`, its rounding bound. A *fall* is a crossing of a guard from above its surface to
//! below; a *dip* is a fall followed by a rise within the same step.
//!
//! An event is located as the root of `g` next to that of the cubic through values and rates at both ends. Where the guard
//! dips, and where the cubic does not lead to a root, the root of `g + bound/2` is located instead. Either lies at or past the
//! surface and within rounding of it.
//!
//! # What is found within one step
//!
//! A guard that is violated at the end of a step is always found. Whether another guard falls and rises within the
//! step is found by a search in stages, each more expensive than the one before:
//!
//! 0. Does the guard move as slowly as the states? Steps are as long as the states allow, and a guard such as
//!    `sin(1000 t)` may turn many times within one. Five values between the ends are compared with the cubic through
//!    values and rates at both ends. That is done in the first step of a phase, and where a step is longer by a third
//!    than the longest on which the guards were seen to follow their cubics. A guard that strays from its cubic is
//!    searched for by stage 4 alone.
//! 1. Values and rates at both ends determine a cubic. If the cubic has no minimum inside the step, or one far above
//!    zero, the guard is taken to hold. Every step pays for this stage: one evaluation of the guards and their rates,
//!    a few operations per guard, and a square root for a guard near its surface.
//! 2. Three values on the dense output, computed for all guards together, extend the cubic to a polynomial of degree
//!    six. Its values at sixteenths of the step show its minima.
//! 3. Each minimum that may be below zero is searched for on the dense output. The first one at whose deepest point
//!    the guard is violated counts, and the guard falls between the maximum before it and that point.
//! 4. A guard that strays is followed on the dense output by a march of intervals that begin short and grow while
//!    parabolas follow it.
//!
//! Tests drew 20 000 steps of guards that move like a sine (`tests/random_systems`), with damping up to 0.6 of the
//! angular frequency and steps up to three quarters of a period. In none of them was a fall of the dense output
//! missed, or a later fall taken for the first one. A guard that begins to move fast in the middle of a phase, and
//! rests at both ends of each step, is not seen to stray. Two falls less than an eighth of a step from each other may
//! be taken for one. A dip shallower than the error of the dense output may not appear on it.
//!
//! The search finds falls of the dense output. For a dip, [`one_step`](crate::one_step) therefore retakes the step to
//! the deepest point, and discards the dip if the retaken step does not show it. Where a stiff force holds a guard near
//! its surface, the dense output shows such a dip in almost every step; a Radau method looks only for dips deeper than
//! the error that the tolerance allows where its stages show none.
//!
//! # Grazing
//!
//! Where a guard turns nearer to its surface than the error of the method, or crosses it and would turn again no deeper than
//! that, the error decides whether there is an event. The recorder is told of it as [grazing](crate::Grazing). Each stage of
//! the search finds turns that are no dips without a further evaluation: by the cubic, at the nodes, in the march. A turn
//! near the surface is noted, and compared with the error when the step is accepted. At each event the depth of the turn that
//! would follow is estimated: from the rate ġ and the curvature g̈ > 0 there it is ġ²/(2 g̈).

mod along;
mod dip;
mod fall;
mod follow;
mod graze;
pub(crate) mod march;
mod shape;

use num_dual::Dual64;

use along::{along, along_flow};
use dip::Disproved;
use graze::Touches;
use shape::{has_no_dip, stays_above_zero};

pub(crate) use graze::{ERROR_GROWTH, FullStep, Graze};
pub(crate) use shape::{cubic_root, is_far, no_turn};

use crate::error::Error;
use crate::step::Step;
use crate::system::{System, Vector};

/// Rounding bounds are taken to be the same on this fraction of a step.
const ALIKE: f64 = 0.01;

/// The crossing of a guard that falls below zero within a step.
#[derive(Clone, Copy, Debug)]
pub struct GuardCrossing {
    /// Index of the guard.
    pub guard: usize,
    /// Time of the crossing on the step's dense output.
    pub t: f64,
    /// A later time at which the guard is violated: the end of the step, or, for a dip, a time within the step.
    pub violated_at: f64,
}

/// The guards of one system along a run, with the workspace of the search.
pub struct GuardWatch<P: System> {
    /// Values and rates at the start of a step.
    start: P::Guards<Dual64>,
    /// Values and rates at its end, or wherever the [rates](Self::rates) were asked for last.
    end: P::Guards<Dual64>,
    /// Values and derivatives along a [direction](Self::look_along), or a little past the end of a step.
    along: P::Guards<Dual64>,
    values: P::Guards<f64>,
    bounds: P::Guards<f64>,
    /// Time at which the bounds were found last; not a number where they were not, or the step was forgotten.
    bounded_at: f64,
    /// Depth beyond the bound that a dip must have to count.
    doubts: P::Guards<f64>,
    /// Workspace, as the next two.
    y: P::State<f64>,
    slope: P::State<f64>,
    seeded: P::State<Dual64>,
    /// Values in the middle of the step [looked at](Self::look_at_middle) last.
    middle: P::Guards<f64>,
    /// Values between the ends of a step: at the quarters on its dense output, or at two states that the method knows.
    quarters: [P::Guards<f64>; 3],
    /// Values at the time of the first fall found so far.
    at_first: P::Guards<f64>,
    /// Dips on the present step that retaken steps do not show.
    disproved: Disproved,
    /// Length of the last step of this phase on which all guards were seen to follow their cubics, also beside their range: one
    /// that is far from zero may follow beside its size, and need not when it is near.
    verified_step: f64,
    /// Guards that were seen to stray from their cubics on the present step.
    straying: Vec<bool>,
    /// Turns of guards near their surfaces.
    pub(crate) touches: Touches<P::Guards<f64>>,
    /// Values and rates at the start of a phase whose arcs are measured.
    #[cfg(feature = "diffsol")]
    arcs: P::Guards<Dual64>,
}

impl<P: System> GuardWatch<P> {
    /// Workspace for the guards of `problem`.
    pub fn new(problem: &P) -> Self {
        let n = problem.n_guards();
        let zeros = || Vector::from_fn(n, |_| 0.0);
        let duals = || Vector::from_fn(n, |_| Dual64::from_re(0.0));
        Self {
            start: duals(),
            end: duals(),
            along: duals(),
            values: zeros(),
            bounds: zeros(),
            bounded_at: f64::NAN,
            doubts: zeros(),
            y: Vector::from_fn(problem.dim(), |_| 0.0),
            slope: Vector::from_fn(problem.dim(), |_| 0.0),
            seeded: Vector::from_fn(problem.dim(), |_| Dual64::from_re(0.0)),
            middle: zeros(),
            quarters: std::array::from_fn(|_| zeros()),
            at_first: zeros(),
            disproved: Disproved::new(n),
            verified_step: 0.0,
            straying: vec![false; n],
            touches: Touches::new(n),
            #[cfg(feature = "diffsol")]
            arcs: duals(),
        }
    }

    /// Evaluates all guards of `mode` at `(t, y)`, and returns the first violated one.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`] for a guard or bound that is infinite or not a number.
    pub fn violated(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> Result<Option<usize>, Error> {
        self.evaluate(problem, mode.clone(), t, y);
        self.first_violated(mode, t)
    }

    /// The same as [`violated`](Self::violated) at the end of a step of size `h` to `t`, with the bounds found last where that
    /// was within [`ALIKE`] of the step.
    pub(crate) fn violated_beside(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t, h): (f64, f64),
        y: &P::State<f64>,
    ) -> Result<Option<usize>, Error> {
        problem.guards(mode.clone(), t, y, &mut self.values);
        self.find_bounds(problem, mode.clone(), (t, y), ALIKE * h.abs());
        self.first_violated(mode, t)
    }

    /// Evaluates all guards of `mode` and their bounds at `(t, y)`.
    fn evaluate(&mut self, problem: &P, mode: P::Mode, t: f64, y: &P::State<f64>) {
        problem.guards(mode.clone(), t, y, &mut self.values);
        problem.guard_bounds(mode, t, y, &mut self.bounds);
        self.bounded_at = t;
    }

    /// Finds the bounds at `(t, y)`, unless they were found `within` this time of it since a step was
    /// [forgotten](Self::forget_step).
    fn find_bounds(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t, y): (f64, &P::State<f64>),
        within: f64,
    ) {
        let is_known = (t - self.bounded_at).abs() <= within;
        if !is_known {
            problem.guard_bounds(mode, t, y, &mut self.bounds);
            self.bounded_at = t;
        }
    }

    /// The first guard that is violated, as last evaluated, in `mode` at `t`.
    fn first_violated(&self, mode: P::Mode, t: f64) -> Result<Option<usize>, Error> {
        let mut first = None;
        for (i, (g, bound)) in self.values.as_ref().iter().zip(self.bounds.as_ref()).enumerate() {
            let margin = g + bound;
            if !margin.is_finite() {
                let mode = format!("{mode:?}");
                return Err(Error::NonFiniteGuard { t, mode, guard: i });
            }
            if margin < 0.0 && first.is_none() {
                first = Some(i);
            }
        }
        Ok(first)
    }

    /// The same as [`violated`](Self::violated) where a mode is entered: guards and bounds that the model does not write
    /// are told from zeros.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`], [`Error::BadGuardBound`].
    pub(crate) fn violated_on_entry(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> Result<Option<usize>, Error> {
        self.values.as_mut().fill(f64::NAN);
        self.bounds.as_mut().fill(f64::NAN);
        self.evaluate(problem, mode.clone(), t, y);
        let is_good = |bound: &f64| bound.is_finite() && *bound > 0.0;
        if let Some(guard) = self.bounds.as_ref().iter().position(|bound| !is_good(bound)) {
            let bound = self.bounds.as_ref()[guard];
            return Err(Error::BadGuardBound { t, mode: format!("{mode:?}"), guard, bound });
        }
        self.first_violated(mode, t)
    }

    /// Whether guard `i`, as last evaluated, is violated.
    pub fn is_violated(&self, i: usize) -> bool {
        self.values.as_ref()[i] < -self.bounds.as_ref()[i]
    }

    /// Guard `i`, as last evaluated.
    pub fn value(&self, i: usize) -> f64 {
        self.values.as_ref()[i]
    }

    /// The rounding bound of guard `i`, as last found.
    pub fn bound(&self, i: usize) -> f64 {
        self.bounds.as_ref()[i]
    }

    /// Differentiates all guards at `(t, y)` along `direction`, a change of the states alone.
    pub(crate) fn look_along(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t, y): (f64, &P::State<f64>),
        direction: &P::State<f64>,
    ) {
        let t = Dual64::from_re(t);
        along(problem, mode, (t, y), direction, &mut self.seeded, &mut self.along);
    }

    /// The derivative of guard `i` [looked along](Self::look_along) last.
    pub(crate) fn slope_along(&self, i: usize) -> f64 {
        self.along.as_ref()[i].eps
    }

    /// Evaluates all guards in the middle of `step`.
    pub(crate) fn look_at_middle(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
    ) {
        let t = step.t0() + 0.5 * (step.t1() - step.t0());
        step.interpolate(t, &mut self.y);
        problem.guards(mode, t, &self.y, &mut self.middle);
    }

    /// Guard `i` in the middle of the step looked at last.
    pub(crate) fn middle(&self, i: usize) -> f64 {
        self.middle.as_ref()[i]
    }

    /// Whether guard `i`, as last evaluated, is at or past its surface.
    pub fn is_past(&self, i: usize) -> bool {
        self.values.as_ref()[i] <= 0.0
    }

    /// Difference of guard `i`, as last evaluated, from the value at which events are located.
    pub fn clearance(&self, i: usize) -> f64 {
        self.values.as_ref()[i] + 0.5 * self.bounds.as_ref()[i]
    }

    /// Begins to watch a phase at `(t, y)` with the slope `dydt` there.
    pub fn begin(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        dydt: &P::State<f64>,
    ) {
        self.start_at(problem, mode, t, y, dydt);
        self.forget_step();
        self.verified_step = 0.0;
    }

    /// Evaluates values and rates at the start of a step. Needed where they do not carry over from the end of the
    /// step before.
    pub(crate) fn start_at(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        dydt: &P::State<f64>,
    ) {
        along_flow(problem, mode, (t, y), dydt, &mut self.seeded, &mut self.start);
    }

    /// Forgets what was found on a step that is not accepted.
    pub(crate) fn forget_step(&mut self) {
        self.disproved.forget();
        self.touches.forget();
        self.bounded_at = f64::NAN;
    }

    /// Evaluates the rates `dg_i/dt` of all guards along the flow.
    pub fn rates(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        dydt: &P::State<f64>,
    ) {
        along_flow(problem, mode, (t, y), dydt, &mut self.seeded, &mut self.end);
    }

    /// The rate of guard `i`, as last evaluated.
    pub fn rate(&self, i: usize) -> f64 {
        self.end.as_ref()[i].eps
    }

    /// The value of guard `i` where the rates were evaluated last.
    pub(crate) fn end_value(&self, i: usize) -> f64 {
        self.end.as_ref()[i].re
    }

    /// Whether values and rates at both ends of a completed step show that no guard falls on it. If so, the end
    /// becomes the start of the next step.
    #[inline]
    pub fn is_clear(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &(impl Step<P::State<f64>> + ?Sized),
    ) -> bool {
        self.rates(problem, mode.clone(), step.t1(), step.y1(), step.slope1());
        self.touches.begin_search();
        let (t0, t1) = (step.t0(), step.t1());
        let h = t1 - t0;
        let ends = [(step.y0(), step.slope0()), (step.y1(), step.slope1())];
        if !self.is_verified_for(h) && !self.all_follow(problem, mode, (t0, t1), ends) {
            return false;
        }
        // All guards are tested without a branch between them, so that the tests run as vector instructions.
        let ends =
            self.start.as_ref().iter().zip(self.end.as_ref()).zip(self.touches.limits().as_ref());
        let (far, high) = ends.fold((true, true), |(far, high), ((g0, g1), limit)| {
            let (from, to) = ([g0.re, g0.eps], [g1.re, g1.eps]);
            (far & is_far(from, to, h), high & (no_turn(from, to, h, *limit) >= 0.0))
        });
        if far {
            if !high {
                self.note_turns(t0, h);
            }
            self.advance();
            return true;
        }
        let is_clear = (0..self.end.as_ref().len())
            .all(|i| (0.0..f64::INFINITY).contains(&self.end.as_ref()[i].re) && self.holds(i, h));
        if is_clear {
            self.note_turns(t0, h);
            self.advance();
        }
        is_clear
    }

    /// Whether each guard stays above zero on the cubic through its values at both ends of a step that
    /// [`is_clear`](Self::is_clear) could not clear and at two states between them, given with their times.
    pub(crate) fn is_clear_between(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t0, t1): (f64, f64),
        between: [(f64, &P::State<f64>); 2],
    ) -> bool {
        for ((t, y), values) in between.iter().zip(&mut self.quarters) {
            problem.guards(mode.clone(), *t, y, values);
        }
        let x = [0.0, between[0].0 - t0, between[1].0 - t0, t1 - t0].map(|t| t / (t1 - t0));
        (0..self.end.as_ref().len()).all(|i| {
            let [a, b] = [0, 1].map(|k| self.quarters[k].as_ref()[i]);
            let g = [self.start.as_ref()[i].re, a, b, self.end.as_ref()[i].re];
            stays_above_zero(x, g)
        })
    }

    /// Whether values and rates at both ends of a step of size `h` show that guard `i`, not violated at the end, has
    /// no dip inside.
    fn holds(&self, i: usize, h: f64) -> bool {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let (from, to) = ([g0.re, g0.eps], [g1.re, g1.eps]);
        let is_finite = g0.eps.is_finite() && g1.eps.is_finite();
        is_far(from, to, h) || is_finite && has_no_dip(from, to, h)
    }

    /// Makes the end of the present step the start of the next one.
    pub fn advance(&mut self) {
        self.start.clone_from(&self.end);
        self.disproved.forget();
    }

    /// The [`clearance`](Self::clearance) of guard `i` at `t` on the step's dense output.
    fn clearance_on(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        t: f64,
    ) -> f64 {
        self.value_on(problem, mode, step, i, t);
        self.clearance(i)
    }

    /// Guard `i` at `t` on the step's dense output.
    fn value_on(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        t: f64,
    ) -> f64 {
        step.interpolate(t, &mut self.y);
        problem.guards(mode, t, &self.y, &mut self.values);
        self.values.as_ref()[i]
    }
}
