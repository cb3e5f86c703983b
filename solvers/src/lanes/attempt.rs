//! A step of several runs at once, and what can be said of it before they part.

use super::dual::DualLanes;
use super::field::Field;
use super::scalar::{Lanes, Own, Simd};
use crate::control::{Control, StepController, Verdict};
use crate::erk::{ExplicitRk, sharpened};
use crate::event::is_far;
use crate::real::{Ordered, Real};
use crate::step::TableauStep;
use crate::system::{System, Vector};
use crate::tableau::Tableau;

/// Where a step of one run is to end, its size, and the step before it, whose end is its start.
pub(super) struct Aim<'a, Y, const S: usize> {
    pub(super) t1: f64,
    pub(super) h: f64,
    pub(super) from: &'a TableauStep<Y, S>,
}

/// A step of an explicit tableau method with `S` stages, of several runs.
pub(super) struct Attempt<P: System, V: Simd, const S: usize> {
    pub(super) method: ExplicitRk<P::State<Lanes<V>>, S, Lanes<V>>,
    /// Relative and absolute tolerances of each run, where errors of any are weighed; NaN where not of all.
    tolerance: Option<(Own<V>, Vec<Own<V>>)>,
    start: P::Guards<DualLanes<V>>,
    end: P::Guards<DualLanes<V>>,
    /// Squares of the norms of the errors.
    error_sq: Lanes<V>,
    /// A bit for each run whose end is finite and whose guards are far from falling.
    plain: u32,
}

impl<P: System, V: Simd, const S: usize> Attempt<P, V, S> {
    /// For systems like `problem`, by the method of `tableau`; `control(i)` is that of run `i`.
    pub(super) fn new<'c>(
        problem: &P,
        tableau: &'static Tableau<S>,
        control: impl Fn(usize) -> &'c Control,
    ) -> Self {
        let tolerance = |lane: usize| match control(lane) {
            Control::Fixed(_) => None,
            Control::Adaptive(tolerance) => Some(tolerance),
        };
        let number =
            |of: &dyn Fn(usize) -> Option<f64>| Own::from_fn(|lane| of(lane).unwrap_or(f64::NAN));
        let atol = |i: usize| number(&|lane| Some(tolerance(lane)?.atol[i]));
        let guards = || Vector::from_fn(problem.n_guards(), |_| DualLanes::cst(1.0));
        Self {
            method: ExplicitRk::new(tableau, problem.dim()),
            tolerance: (0..V::N).any(|lane| tolerance(lane).is_some()).then(|| {
                let rtol = number(&|lane| Some(tolerance(lane)?.rtol));
                (rtol, (0..problem.dim()).map(atol).collect())
            }),
            start: guards(),
            end: guards(),
            error_sq: Lanes::cst(0.0),
            plain: 0,
        }
    }

    /// Starts where the steps before `aims` end.
    #[inline(always)]
    pub(super) fn start(&mut self, field: &impl Field<P, V>, aims: &[Aim<'_, P::State<f64>, S>]) {
        let step = &mut self.method.step;
        step.t0 = Lanes::from_fn(|lane| aims[lane].from.t0);
        for (i, y) in step.y0.as_mut().iter_mut().enumerate() {
            *y = Lanes::from_fn(|lane| aims[lane].from.y0.as_ref()[i]);
        }
        for (i, slope) in step.k[0].as_mut().iter_mut().enumerate() {
            *slope = Lanes::from_fn(|lane| aims[lane].from.k[0].as_ref()[i]);
        }
        let (y0, slope0) = (step.y0.as_ref(), step.k[0].as_ref());
        along_flow(field, step.t0, (y0, slope0), &mut self.start);
    }

    /// Starts where the last steps ended.
    #[inline(always)]
    pub(super) fn go_on(&mut self) {
        let step = &mut self.method.step;
        step.t0 = step.t1;
        step.y0.clone_from(&step.y1);
        step.k[0].clone_from(&step.slope1);
        self.start.clone_from(&self.end);
    }

    /// Whether this run's step was taken as it is, to the time `t`.
    pub(super) fn is_before(&self, lane: usize, t: f64) -> bool {
        self.method.step.t1.lane(lane) == t
    }

    /// Takes the steps `aims` along `field`, with the slopes at their ends.
    #[inline(always)]
    pub(super) fn take(&mut self, field: &impl Field<P, V>, aims: &[Aim<'_, P::State<f64>, S>]) {
        let (t1, h) = (Lanes::from_fn(|lane| aims[lane].t1), Lanes::from_fn(|lane| aims[lane].h));
        self.method.take(t1, h, field);
        self.method.end_slope(field);
    }

    /// Weighs the errors where they are controlled.
    #[inline(always)]
    pub(super) fn weigh(&mut self) {
        let Some((rtol, atol)) = &self.tolerance else { return };
        let (errors_sq, lows_sq) = self.method.norms_sq((*rtol, atol));
        self.error_sq = match lows_sq {
            None => errors_sq,
            Some(lows_sq) => {
                let lows_sq = lows_sq();
                Lanes::from_fn(|lane| sharpened(errors_sq.lane(lane), || lows_sq.lane(lane)))
            }
        };
    }

    /// What `controller` makes of the step of size `h` in this lane, once [weighed](Self::weigh).
    #[inline(always)]
    pub(super) fn verdict(&self, lane: usize, h: f64, controller: &mut StepController) -> Verdict {
        controller.judge(h, |_| self.error_sq.lane(lane))
    }

    /// Looks at ends and guards.
    #[inline(always)]
    pub(super) fn look(&mut self, field: &impl Field<P, V>) {
        let step = &self.method.step;
        self.plain = Lanes::<V>::YES;
        let (y1, slope1) = (step.y1.as_ref(), step.slope1.as_ref());
        for x in y1.iter().chain(slope1) {
            self.plain &= Lanes::cst(f64::INFINITY).is_above(x.abs());
        }
        along_flow(field, step.t1, (y1, slope1), &mut self.end);
        let h = step.t1 - step.t0;
        for (g0, g1) in self.start.as_ref().iter().zip(self.end.as_ref()) {
            self.plain &= is_far([g0.re, g0.eps], [g1.re, g1.eps], h);
        }
    }

    /// Whether this run's end is finite and no guard can have fallen before it.
    pub(super) fn is_plain(&self, lane: usize) -> bool {
        self.plain & (1 << lane) != 0
    }
}

/// Values and rates of the guards at `(t, y)` along `dydt`.
#[inline(always)]
fn along_flow<P: System, V: Simd>(
    field: &impl Field<P, V>,
    t: Lanes<V>,
    (y, dydt): (&[Lanes<V>], &[Lanes<V>]),
    g: &mut P::Guards<DualLanes<V>>,
) {
    let along = P::State::<DualLanes<V>>::from_fn(y.len(), |i| DualLanes::new(y[i], dydt[i]));
    field.guards(DualLanes::new(t, Lanes::cst(1.0)), &along, g);
}

impl<Y: Vector<f64>, const S: usize> ExplicitRk<Y, S> {
    /// Takes over the start, at `t0`, of the attempt of one run from that of several.
    pub(super) fn take_start<V: Simd, L: Vector<Lanes<V>>>(
        &mut self,
        t0: f64,
        (all, lane): (&ExplicitRk<L, S, Lanes<V>>, usize),
    ) {
        self.step.t0 = t0;
        pick(&all.step.y0, lane, &mut self.step.y0);
        pick(&all.step.k[0], lane, &mut self.step.k[0]);
    }

    /// Takes over its end, without stages and errors.
    #[inline(always)]
    pub(super) fn take_end<V: Simd, L: Vector<Lanes<V>>>(
        &mut self,
        (t1, h): (f64, f64),
        (all, lane): (&ExplicitRk<L, S, Lanes<V>>, usize),
    ) {
        (self.step.t1, self.step.h) = (t1, h);
        self.is_dense = false;
        pick(&all.step.y1, lane, &mut self.step.y1);
        pick(&all.step.slope1, lane, &mut self.step.slope1);
    }

    /// Takes over its stages and errors.
    pub(super) fn take_stages<V: Simd, L: Vector<Lanes<V>>>(
        &mut self,
        (all, lane): (&ExplicitRk<L, S, Lanes<V>>, usize),
    ) {
        for (all, k) in all.step.k.iter().zip(&mut self.step.k) {
            pick(all, lane, k);
        }
        pick(&all.step.error, lane, &mut self.step.error);
        pick(&all.low_error, lane, &mut self.low_error);
    }
}

/// Writes the vector of one run among those of several to `one`.
#[inline(always)]
pub(super) fn pick<V: Simd, L: Vector<Lanes<V>>, Y: Vector<f64>>(
    all: &L,
    lane: usize,
    one: &mut Y,
) {
    for (all, one) in all.as_ref().iter().zip(one.as_mut()) {
        *one = all.lane(lane);
    }
}
