//! A step of several runs at once, and what can be said of it before they part.

use super::dual::DualLanes;
use super::log_exp::{exp, log};
use super::scalar::{LANES, Lanes};
use crate::control::{Control, StepController, Verdict};
use crate::erk::{ExplicitRk, sharpened};
use crate::event::is_far;
use crate::real::{Ordered, Real};
use crate::step::TableauStep;
use crate::system::{System, Vector};
use crate::tableau::Tableau;
use crate::tolerance::Tolerance;

/// Where a step of one run is to end, its size, and the step before it, whose end is its start.
pub(super) struct Aim<'a, Y, const S: usize> {
    pub(super) t1: f64,
    pub(super) h: f64,
    pub(super) from: &'a TableauStep<Y, S>,
}

/// A step of an explicit tableau method with `S` stages, of several runs.
pub(super) struct Attempt<P: System, const S: usize> {
    pub(super) method: ExplicitRk<P::State<Lanes>, S, Lanes>,
    start: P::Guards<DualLanes>,
    end: P::Guards<DualLanes>,
    /// Squares of the norms of the errors, the logarithms of the norms, and the factors they give.
    error_sq: [f64; LANES],
    log_error: [f64; LANES],
    factor: [f64; LANES],
    /// A bit for each run whose end is finite and whose guards are far from falling.
    plain: u32,
}

impl<P: System, const S: usize> Attempt<P, S> {
    pub(super) fn new(problem: &P, tableau: &'static Tableau<S>) -> Self {
        let guards = || Vector::from_fn(problem.n_guards(), |_| DualLanes::cst(1.0));
        Self {
            method: ExplicitRk::new(tableau, problem.dim()),
            start: guards(),
            end: guards(),
            error_sq: [0.0; LANES],
            log_error: [0.0; LANES],
            factor: [0.0; LANES],
            plain: 0,
        }
    }

    /// Takes the steps `aims` in `mode`, with the slopes at their ends.
    pub(super) fn take(
        &mut self,
        problem: &P,
        mode: &P::Mode,
        aims: &[Aim<'_, P::State<f64>, S>; LANES],
    ) {
        let step = &mut self.method.step;
        step.t0 = Lanes::of(aims, |aim| aim.from.t0);
        for (i, y) in step.y0.as_mut().iter_mut().enumerate() {
            *y = Lanes::of(aims, |aim| aim.from.y0.as_ref()[i]);
        }
        for (i, slope) in step.k[0].as_mut().iter_mut().enumerate() {
            *slope = Lanes::of(aims, |aim| aim.from.k[0].as_ref()[i]);
        }
        let (t1, h) = (Lanes::of(aims, |aim| aim.t1), Lanes::of(aims, |aim| aim.h));
        self.method.take(problem, mode, t1, h);
        self.method.end_slope(problem, mode);
    }

    /// Weighs the errors in the norm of `tolerance`; each run's controller gives the logarithm of a factor.
    pub(super) fn weigh(
        &mut self,
        tolerance: &Tolerance,
        log_factor: impl Fn(usize, f64, f64) -> f64,
    ) {
        self.error_sq = self.method.error_norms_sq(tolerance);
        self.log_error = log(self.error_sq).map(|log| 0.5 * log);
        self.factor = exp(std::array::from_fn(|lane| {
            log_factor(lane, self.error_sq[lane], self.log_error[lane])
        }));
    }

    /// What `controller` makes of the step of size `h` in this lane, once [weighed](Self::weigh).
    pub(super) fn verdict(&self, lane: usize, h: f64, controller: &mut StepController) -> Verdict {
        match controller.control() {
            Control::Fixed(step) => Verdict::Accept(step.copysign(h)),
            Control::Adaptive(_) => {
                controller.verdict(h, self.error_sq[lane], self.log_error[lane], self.factor[lane])
            }
        }
    }

    /// Looks at ends and guards.
    pub(super) fn look(&mut self, problem: &P, mode: &P::Mode) {
        let step = &self.method.step;
        self.plain = Lanes::YES;
        for x in step.y1.as_ref().iter().chain(step.slope1.as_ref()) {
            self.plain &= Lanes::cst(f64::INFINITY).is_above(x.abs());
        }
        along_flow(problem, mode, step.t0, (&step.y0, &step.k[0]), &mut self.start);
        along_flow(problem, mode, step.t1, (&step.y1, &step.slope1), &mut self.end);
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
fn along_flow<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: Lanes,
    (y, dydt): (&P::State<Lanes>, &P::State<Lanes>),
    g: &mut P::Guards<DualLanes>,
) {
    let (y, dydt) = (y.as_ref(), dydt.as_ref());
    let along = P::State::<DualLanes>::from_fn(y.len(), |i| DualLanes::new(y[i], dydt[i]));
    problem.guards(mode.clone(), DualLanes::new(t, Lanes::cst(1.0)), &along, g);
}

impl<Y: Vector<Lanes>, const S: usize> ExplicitRk<Y, S, Lanes> {
    /// [`error_norm_sq`](crate::one_step::OneStep::error_norm_sq) of each run.
    fn error_norms_sq(&self, tolerance: &Tolerance) -> [f64; LANES] {
        let errors_sq = self.norm_sq(&self.step.error, tolerance).each();
        if self.low_weights.is_none() {
            return errors_sq;
        }
        let lows_sq = self.norm_sq(&self.low_error, tolerance).each();
        std::array::from_fn(|lane| sharpened(errors_sq[lane], || lows_sq[lane]))
    }
}

impl<Y: Vector<f64>, const S: usize> ExplicitRk<Y, S> {
    /// Takes over the attempt of one run from that of several, without its stages and errors.
    pub(super) fn take_end<L: Vector<Lanes>>(
        &mut self,
        (t1, h): (f64, f64),
        (all, lane): (&ExplicitRk<L, S, Lanes>, usize),
    ) {
        (self.step.t1, self.step.h) = (t1, h);
        self.is_dense = false;
        pick(&all.step.y1, lane, &mut self.step.y1);
        pick(&all.step.slope1, lane, &mut self.step.slope1);
    }

    /// The same with its stages and errors.
    pub(super) fn take_over<L: Vector<Lanes>>(
        &mut self,
        aim: (f64, f64),
        (all, lane): (&ExplicitRk<L, S, Lanes>, usize),
    ) {
        self.take_end(aim, (all, lane));
        for (all, k) in all.step.k.iter().zip(&mut self.step.k) {
            pick(all, lane, k);
        }
        pick(&all.step.error, lane, &mut self.step.error);
        pick(&all.low_error, lane, &mut self.low_error);
    }
}

/// Writes the vector of one run among those of several to `one`.
#[inline(always)]
fn pick<L: Vector<Lanes>, Y: Vector<f64>>(all: &L, lane: usize, one: &mut Y) {
    for (all, one) in all.as_ref().iter().zip(one.as_mut()) {
        *one = all.each()[lane];
    }
}
