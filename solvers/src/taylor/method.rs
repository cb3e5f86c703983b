//! The Taylor method: a series about the start of each step, summed at its end.

use super::coefficient::Coefficient;
use super::expand::{Expansion, SeriesField};
use super::guards::{GuardSeries, Look, StepSeries};
use super::order::{self, LOW, Reach};
use super::rows::MAX_ORDER;
use crate::erk::InMode;
use crate::error::Error;
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::one_step::OneStep;
use crate::real::Real;
use crate::step::{Step, end_accessors};
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;

/// The Taylor method applied to one system, or to several at once in lanes.
#[derive(Debug)]
pub struct TaylorMethod<Y, G, B: Copy = f64> {
    pub(crate) step: TaylorStep<Y, B>,
    expansion: Expansion<B>,
    pub(crate) guards: GuardSeries<G, B>,
    /// Whether the series is complete; otherwise only its first order is known.
    pub(crate) is_expanded: bool,
    /// Degree that follows from the tolerance; `None` to choose it by the step size.
    pub(crate) degree: Option<usize>,
    pub(crate) error: Y,
}

/// A step of the Taylor method: a polynomial.
#[derive(Debug)]
pub struct TaylorStep<Y, B = f64> {
    pub(crate) t0: B,
    /// Low part of the time at the start, where that has more digits than `t0`.
    pub(super) t0_low: f64,
    pub(crate) t1: B,
    pub(crate) y1: Y,
    pub(crate) slope1: Y,
    /// Coefficients by order; the first two are the state and the slope at the start.
    pub(crate) y: Vec<Y>,
    /// Degree of the polynomial that the step is taken with.
    pub(crate) degree: usize,
    /// Weights of the states in the norm, from the tolerance at the start.
    pub(crate) weights: Y,
}

impl<Y: Vector<B>, B: Real> TaylorStep<Y, B> {
    /// Workspace for a step of `order` for systems of `n` states.
    pub(super) fn new(n: usize, order: usize) -> Self {
        let zero = || Y::from_fn(n, |_| B::cst(0.0));
        let y = (0..=order).map(|_| zero()).collect();
        Self {
            t0: B::cst(0.0),
            t0_low: 0.0,
            t1: B::cst(0.0),
            y1: zero(),
            slope1: zero(),
            y,
            degree: order,
            weights: zero(),
        }
    }

    /// Coefficients of the polynomial that the step is taken with.
    pub(super) fn polynomial(&self) -> &[Y] {
        &self.y[..=self.degree]
    }
}

impl<Y: Vector<B>, G: Vector<B::Rounded>, B: Coefficient> TaylorMethod<Y, G, B> {
    /// The method of `order`, or of the nearest from 3 to [`MAX_ORDER`], for systems of `n` states and `n_guards` guards.
    pub fn new(n: usize, n_guards: usize, order: usize) -> Self {
        let order = order.clamp(LOW, MAX_ORDER);
        Self {
            step: TaylorStep::new(n, order),
            expansion: Expansion::default(),
            guards: GuardSeries::new(n_guards, order),
            is_expanded: false,
            degree: None,
            error: Y::from_fn(n, |_| B::cst(0.0)),
        }
    }

    /// Begins the series about the start of the step.
    pub(crate) fn begin<P>(&mut self, field: &impl SeriesField<P, B>)
    where
        P: System<State<B> = Y, Guards<B::Rounded> = G>,
    {
        let (start, rest) = self.step.y.split_at_mut(1);
        self.expansion.begin(field, self.step.t0, &start[0], &mut rest[0], self.guards.start());
    }

    /// Completes the series about the start of the step.
    #[inline(always)]
    pub(crate) fn finish<P>(&mut self, field: &impl SeriesField<P, B>)
    where
        P: System<State<B> = Y, Guards<B::Rounded> = G>,
    {
        self.expansion.complete(field, self.step.t0, &mut self.step.y, self.guards.low());
    }

    /// Sums the series at the end of the step, and begins the series of the next step: `y₁ = p(h)` and `ẏ₁ = f(t₁,
    /// y₁)` for the polynomial `p` of degree N.
    ///
    /// ```text
    /// error = h (p'(h) − ẏ₁)/(N + 1)
    /// ```
    ///
    /// To leading order the defect `p' − f(p)` is minus the derivative of the next term, `(N + 1) y_(N+1) hᴺ`. It is
    /// large where the series does not converge to the solution, or where the right-hand side branches.
    #[inline(always)]
    pub(crate) fn take<P>(&mut self, field: &impl SeriesField<P, B>, t1: B, h: B)
    where
        P: System<State<B> = Y, Guards<B::Rounded> = G>,
    {
        let step = &mut self.step;
        step.t1 = t1;
        sum_with_slope(&step.y[..=step.degree], h, &mut step.y1, &mut self.error);
        self.expansion.begin(field, t1, &step.y1, &mut step.slope1, &mut self.guards.end);
        to_defect(h, step.degree, &step.slope1, &mut self.error);
    }

    /// Makes the end of the step the start of the next one.
    #[inline(always)]
    pub(crate) fn go_on(&mut self) {
        let step = &mut self.step;
        step.t0 = step.t1;
        std::mem::swap(&mut step.y[0], &mut step.y1);
        std::mem::swap(&mut step.y[1], &mut step.slope1);
        self.guards.advance();
        self.is_expanded = false;
        self.degree = None;
    }
}

impl<Y: Vector<f64>, G: Vector<f64>> TaylorMethod<Y, G> {
    /// Expands about the start of the step, unless that is done already.
    fn expand<P>(&mut self, problem: &P, mode: &P::Mode, stats: &mut Stats)
    where
        P: System<State<f64> = Y, Guards<f64> = G>,
    {
        if !std::mem::replace(&mut self.is_expanded, true) {
            self.finish::<P>(&InMode { problem, mode });
            stats.work.add_series();
        }
    }

    /// Stores the degree of `reach`, and returns the step size to propose.
    #[inline]
    pub(crate) fn reaches(&mut self, reach: Option<Reach>) -> Option<f64> {
        self.degree = reach.map(|reach| reach.degree);
        reach.map(|reach| reach.h)
    }
}

impl<P: System> OneStep<P> for TaylorMethod<P::State<f64>, P::Guards<f64>> {
    type Step = TaylorStep<P::State<f64>>;

    const PROPOSES: bool = true;

    fn embedded_order(&self) -> Option<usize> {
        Some(self.step.y.len() - 1)
    }

    fn restart(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        _stats: &mut Stats,
    ) {
        let step = &mut self.step;
        (step.t0, step.t1) = (t, t);
        step.y[0].clone_from(y);
        step.y1.clone_from(y);
        self.begin::<P>(&InMode { problem, mode: &mode });
        self.is_expanded = false;
        self.degree = None;
    }

    fn propose(
        &mut self,
        problem: &P,
        mode: P::Mode,
        tolerance: &Tolerance,
        stats: &mut Stats,
    ) -> Option<f64> {
        self.expand(problem, &mode, stats);
        let reach = order::reach(&self.step.y, tolerance, &mut self.step.weights);
        self.reaches(reach)
    }

    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        self.expand(problem, &mode, stats);
        let step = &mut self.step;
        step.degree = self.degree.unwrap_or_else(|| order::convergent_degree(&step.y, h));
        self.take::<P>(&InMode { problem, mode: &mode }, t1, h);
    }

    fn complete(&mut self, _problem: &P, _mode: P::Mode, _stats: &mut Stats) {}

    fn first_to_fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        watch: &mut GuardWatch<P>,
        stats: &mut Stats,
    ) -> Result<Option<GuardCrossing>, Error> {
        let whole = self.step.t1 - self.step.t0;
        loop {
            let mode = mode.clone();
            let of = StepSeries { step: &self.step, series: &self.step, whole };
            let look = self.guards.first_to_fall(problem, mode.clone(), &of, watch)?;
            let range = match look {
                Look::Clear => return Ok(None),
                Look::Falls(crossing) => return Ok(Some(crossing)),
                Look::Within(range) => range,
            };
            let h = range * (self.step.t1 - self.step.t0);
            // They are fractions of the longer step.
            watch.forget_step();
            self.attempt(problem, mode, self.step.t0 + h, h, stats);
            stats.n_retaken += 1;
        }
    }

    fn advance(&mut self) {
        self.go_on();
    }

    fn step(&self) -> &Self::Step {
        &self.step
    }

    fn error(&self) -> &P::State<f64> {
        &self.error
    }
}

/// Sums the polynomial with the coefficients `c` at `h`.
#[inline]
fn sum<Y: Vector<f64>>(c: &[Y], h: f64, y: &mut Y) {
    let [rest @ .., last] = c else { return };
    y.clone_from(last);
    for c in rest.iter().rev() {
        for (y, c) in y.as_mut().iter_mut().zip(c.as_ref()) {
            *y = Coefficient::fma(*y, h, *c);
        }
    }
}

/// Sums the polynomial with the coefficients `c` at `h`, and its derivative.
#[inline]
pub(super) fn sum_with_slope<T: Coefficient, Y: Vector<T>>(
    c: &[Y],
    h: T,
    y: &mut Y,
    slope: &mut Y,
) {
    let [rest @ .., last] = c else { return };
    y.clone_from(last);
    slope.as_mut().fill(T::cst(0.0));
    for c in rest.iter().rev() {
        let both = y.as_mut().iter_mut().zip(slope.as_mut());
        for ((y, slope), c) in both.zip(c.as_ref()) {
            *slope = T::fma(*slope, h, *y);
            *y = T::fma(*y, h, *c);
        }
    }
}

/// Replaces the `derivative` of a polynomial of `degree` N by the error estimate, `h/(N + 1)` times its difference
/// from `slope`.
#[inline]
fn to_defect<T: Real, Y: Vector<T>>(h: T, degree: usize, slope: &Y, derivative: &mut Y) {
    let share = h / (degree + 1) as f64;
    for (derivative, slope) in derivative.as_mut().iter_mut().zip(slope.as_ref()) {
        *derivative = share * (*derivative - *slope);
    }
}

impl<Y: Vector<f64>> Step<Y> for TaylorStep<Y> {
    end_accessors!(step => &step.y[0], &step.y[1]);

    fn interpolate(&self, t: f64, y: &mut Y) {
        if t == self.t1 {
            y.clone_from(&self.y1);
        } else {
            sum(self.polynomial(), (t - self.t0) - self.t0_low, y);
        }
    }
}
