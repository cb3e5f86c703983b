//! The Taylor method with twice the digits of an `f64`, for reference solutions.
//!
//! Time, state, coefficients and transitions are double-double numbers. Falling guards are detected on polynomials
//! with the nearest `f64` coefficients, as in [`method`](super::method); Newton's iteration with all digits then
//! converges to the zero of the guard. Recorders are shown the nearest `f64` of everything.

use std::ops::ControlFlow;

use super::coefficient::Coefficient;
use super::guards::{Look, StepSeries};
use super::method::{TaylorMethod, TaylorStep};
use super::order::{self, Reach};
use super::rows::MAX_ORDER;
use crate::double_double::DoubleDouble;
use crate::erk::InMode;
use crate::error::{Error, Outcome};
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::integrate::{Instant, Transitions, check_length, check_span, of_its_length, rounded};
use crate::phase::{PhaseEnd, check_finite};
use crate::point::Point;
use crate::real::Real;
use crate::record::{Accepted, Record, reject};
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;

/// Largest number of Newton iterations for the time of an event. It is enough to come close to a root of order four.
const MOST_ITERATIONS: usize = 40;
/// Largest ratio of one correction to the one before at which the iteration continues. At a root of order four the
/// ratio is 3/4.
const CONTRACTION: f64 = 0.9;
/// Precision of the time of an event, as a fraction of the time.
const PRECISION: f64 = 1e-30;

impl Coefficient for DoubleDouble {
    // An operation takes about twenty instructions, so a loop costs little in comparison.
    const HIGHEST_UNROLLED: usize = 0;

    // Their instructions in place, for all operations of a right-hand side, would be hundreds of kilobytes.
    const IS_TRACED: bool = true;

    type Rounded = f64;

    fn rounded(self) -> f64 {
        self.value()
    }
}

/// An integration with double-double numbers: its present point and the work done so far.
///
/// ```
/// use deltazero_solvers::double_double::DoubleDouble;
/// use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::taylor::ExtendedIntegration;
/// use deltazero_solvers::{Error, Real, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-28, atol: vec![1e-28; 2] };
/// let mut run = ExtendedIntegration::new(&ball, 0.0, &ball.start(), tolerance);
/// run.run(0.8, &mut ())?;
/// // After the first bounce: y = ½ g s (t₀ − s), s = t − t₀.
/// let g = DoubleDouble::from(9.8);
/// let fall_time = (DoubleDouble::from(2.0) / g).sqrt();
/// let s = DoubleDouble::from(0.8) - fall_time;
/// let height = g * s * (fall_time - s) * 0.5;
/// assert!((run.state()[0] - height).hi().abs() < 1e-29);
/// # Ok::<(), Error>(())
/// ```
pub struct ExtendedIntegration<'a, P: System> {
    problem: &'a P,
    /// Mode.
    pub mode: P::Mode,
    /// Work so far.
    pub stats: Stats,
    tolerance: Tolerance,
    /// Its step begins at the present time and state.
    method: TaylorMethod<P::State<DoubleDouble>, P::Guards<f64>, DoubleDouble>,
    /// The same step in the nearest `f64`.
    step: TaylorStep<P::State<f64>>,
    watch: GuardWatch<P>,
    transitions: Transitions<P>,
}

impl<'a, P: System> ExtendedIntegration<'a, P> {
    /// An integration that starts at `(t, y)` in the mode that the system gives it, with series of the highest order.
    /// Tolerances may be as small as 1e-28. A tolerance that is not valid is an error of the first run.
    pub fn new(problem: &'a P, t: f64, y: &P::State<f64>, tolerance: Tolerance) -> Self {
        let n = y.as_ref().len();
        let mut method = TaylorMethod::new(n, problem.n_guards(), MAX_ORDER);
        method.step.t0 = DoubleDouble::from(t);
        method.step.y[0] = Vector::from_fn(n, |i| DoubleDouble::from(y.as_ref()[i]));
        Self {
            problem,
            mode: problem.initial_mode(t, &of_its_length(problem, y)),
            stats: Stats::default(),
            tolerance,
            method,
            step: TaylorStep::new(n, MAX_ORDER),
            watch: GuardWatch::new(problem),
            transitions: Transitions::new(problem, t),
        }
    }

    /// The present time.
    pub fn t(&self) -> DoubleDouble {
        self.method.step.t0
    }

    /// The present state.
    pub fn state(&self) -> &P::State<DoubleDouble> {
        &self.method.step.y[0]
    }

    /// The nearest `f64` of the present state.
    pub fn rounded(&self) -> P::State<f64> {
        rounded::<P, _>(self.state())
    }

    /// Integrates to `t_end`, backward where that is before the present time, and shows `record` the nearest `f64` of
    /// every accepted step and every event.
    ///
    /// # Errors
    /// As [`Integration::run`](crate::Integration::run).
    pub fn run(&mut self, t_end: f64, record: &mut dyn Record<P>) -> Result<Outcome, Error> {
        self.tolerance.check(self.problem.dim())?;
        check_length(self.problem, &self.rounded())?;
        check_span(self.t().value(), t_end)?;
        record.begin(&self.point(), t_end)?;
        let mut guard = self.transitions.begin(self.problem, &self.point(), t_end)?;
        let mut is_interrupted = false;
        loop {
            if let Some(guard) = guard {
                let (t, y) = (self.t(), &mut self.method.step.y[0]);
                let instant = Instant { t, y, mode: &mut self.mode };
                let ends = self.transitions.switch(
                    self.problem,
                    instant,
                    guard,
                    &mut self.stats,
                    record,
                )?;
                if let Some(outcome) = ends {
                    return Ok(outcome);
                }
            }
            if is_interrupted {
                return Ok(Outcome::Interrupted);
            }
            (guard, is_interrupted) = match self.phase(t_end, record)? {
                PhaseEnd::EndOfTime => return Ok(Outcome::Finished),
                PhaseEnd::Interrupted { landed_on } => (landed_on, true),
                PhaseEnd::Guard(fallen) => (Some(fallen), false),
            };
        }
    }

    fn point(&self) -> Point<P> {
        Point { t: self.t().value(), y: rounded::<P, _>(self.state()), mode: self.mode.clone() }
    }

    /// Integrates in the present mode to `t_end` or to the zero of the first guard that falls.
    fn phase(&mut self, t_end: f64, record: &mut dyn Record<P>) -> Result<PhaseEnd, Error> {
        let (problem, mode) = (self.problem, self.mode.clone());
        self.method.begin::<P>(&InMode { problem, mode: &mode });
        let (point, slope) = (self.point(), rounded::<P, _>(&self.method.step.y[1]));
        self.watch.begin(problem, mode.clone(), point.t, &point.y, &slope);
        while self.t().value() != t_end {
            if self.take_step(t_end, record)?.is_break() {
                return Ok(PhaseEnd::Interrupted { landed_on: None });
            }
            let landed_on = self.locate()?;
            self.stats.n_accepted += 1;
            let (step, stats, proposed) = (&self.step, &self.stats, None);
            let accepted = Accepted { mode: mode.clone(), step, landed_on, proposed, stats };
            let go_on = record.step(&accepted);
            self.method.go_on();
            match landed_on {
                _ if go_on.is_break() => return Ok(PhaseEnd::Interrupted { landed_on }),
                Some(guard) => return Ok(PhaseEnd::Guard(guard)),
                None => {}
            }
        }
        Ok(PhaseEnd::EndOfTime)
    }

    /// Expands about the present state, and takes a step whose size is limited by the last terms and by the defect at
    /// its end. Breaks where the recorder ends the run.
    fn take_step(
        &mut self,
        t_end: f64,
        record: &mut dyn Record<P>,
    ) -> Result<ControlFlow<()>, Error> {
        self.method.finish::<P>(&InMode { problem: self.problem, mode: &self.mode });
        self.stats.work.add_series();
        let t0 = self.t();
        (self.step.t0, self.step.t0_low) = (t0.hi(), t0.lo());
        for (rounded_y, y) in self.step.y.iter_mut().zip(&self.method.step.y) {
            *rounded_y = rounded::<P, _>(y);
        }
        let reach = order::reach(&self.step.y, &self.tolerance, &mut self.step.weights);
        let Some(Reach { degree, mut h }) = reach else {
            let point = self.point();
            check_finite(&point, &self.step.y[MAX_ORDER])?;
            return Err(self.underflow(0.0));
        };
        (self.step.degree, self.method.step.degree) = (degree, degree);
        let span = DoubleDouble::from(t_end) - t0;
        loop {
            let is_last = h >= span.value().abs();
            let ahead = t0 + h.copysign(span.value());
            let t1 = if is_last { DoubleDouble::from(t_end) } else { ahead };
            if t1.value() == self.step.t0 {
                return Err(self.underflow(h));
            }
            if self.attempt(t1) <= 1.0 {
                check_finite(&self.point(), &self.step.y1)?;
                return Ok(ControlFlow::Continue(()));
            }
            if reject(&mut self.stats, record).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            h = 0.5 * (t1 - t0).value().abs();
        }
    }

    fn underflow(&self, h: f64) -> Error {
        Error::StepUnderflow { t: self.t().value(), h, mode: format!("{:?}", self.mode) }
    }

    /// Sums the series at `t1`, and returns the norm of the error estimate, which follows from the defect there.
    fn attempt(&mut self, t1: DoubleDouble) -> f64 {
        let field = InMode { problem: self.problem, mode: &self.mode };
        self.method.take::<P>(&field, t1, t1 - self.t());
        let of_method = &self.method.step;
        self.step.t1 = t1.value();
        self.step.y1 = rounded::<P, _>(&of_method.y1);
        self.step.slope1 = rounded::<P, _>(&of_method.slope1);
        let error = rounded::<P, _>(&self.method.error);
        self.tolerance.norm(error.as_ref(), self.step.y[0].as_ref(), self.step.y1.as_ref())
    }

    /// Cuts the step at the zero of the guard that falls first on it, and returns that guard.
    fn locate(&mut self) -> Result<Option<usize>, Error> {
        let (problem, mode) = (self.problem, self.mode.clone());
        let whole = self.step.t1 - self.step.t0;
        loop {
            let TaylorMethod { step, guards, .. } = &mut self.method;
            let (t0, t1) = (step.t0, step.t1);
            let of = StepSeries { step: &self.step, series: step, whole };
            let look = guards.first_to_fall(problem, mode.clone(), &of, &mut self.watch)?;
            let GuardCrossing { guard, t, violated_at } = match look {
                Look::Clear => return Ok(None),
                Look::Falls(crossing) => crossing,
                Look::Within(range) => {
                    self.watch.forget_step();
                    self.attempt(t0 + (t1 - t0) * range);
                    continue;
                }
            };
            if violated_at != self.step.t1 {
                self.attempt(DoubleDouble::from(violated_at));
                if self.watch.violated(problem, mode.clone(), violated_at, &self.step.y1)?.is_none()
                {
                    self.attempt(t1);
                    let of_step = (self.step.t0, self.step.t1 - self.step.t0);
                    self.watch.disprove_dip(guard, of_step, &mode)?;
                    continue;
                }
            }
            let zero = self.zero_of(guard, DoubleDouble::from(t) - t0);
            self.attempt(t0 + zero);
            return Ok(Some(guard));
        }
    }

    /// The zero of `guard` near the time `s` after the start of the step. Newton's iteration is applied to the guard
    /// itself along the series of the state, as long as corrections decrease.
    fn zero_of(&self, guard: usize, s: DoubleDouble) -> DoubleDouble {
        let n = self.problem.n_guards();
        let mut g = P::Guards::<DoubleDouble>::from_fn(n, |_| DoubleDouble::from(0.0));
        let TaylorStep { t0, y: series, degree, .. } = &self.method.step;
        let mut y = self.method.step.y1.clone();
        let close = PRECISION * self.step.t1.abs().max(self.step.t0.abs());
        let (mut zero, mut last) = (s, f64::INFINITY);
        for _ in 0..MOST_ITERATIONS {
            y.clone_from(&series[*degree]);
            for c in series[..*degree].iter().rev() {
                for (y, c) in y.as_mut().iter_mut().zip(c.as_ref()) {
                    *y = *y * zero + *c;
                }
            }
            self.problem.guards(self.mode.clone(), *t0 + zero, &y, &mut g);
            let rate = self.method.guards.rate(guard, zero.value(), *degree);
            let correction = g.as_ref()[guard] / rate;
            let size = correction.value().abs();
            let next = zero - correction;
            let is_before = (next.value() < 0.0) != (s.value() < 0.0);
            // False where a correction is NaN.
            let closes_in = size < CONTRACTION * last;
            if !closes_in || is_before {
                break;
            }
            (zero, last) = (next, size);
            if size <= close {
                break;
            }
        }
        zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{BouncingBall, CompliantBall, Exit};

    fn ends_at<P: System>(
        problem: &P,
        y0: P::State<f64>,
        t_end: f64,
        rtol: f64,
    ) -> Vec<DoubleDouble> {
        let tolerance = Tolerance { rtol, atol: vec![rtol; problem.dim()] };
        let mut run = ExtendedIntegration::new(problem, 0.0, &y0, tolerance);
        assert_eq!(run.run(t_end, &mut ()), Ok(Outcome::Finished));
        assert_eq!(run.t(), DoubleDouble::from(t_end));
        run.state().as_ref().to_vec()
    }

    #[test]
    fn bounces_are_exact_to_thirty_digits() {
        let ball = BouncingBall { restitution: 0.75, gravity: 9.81, height: 1.3 };
        let end = ends_at(&ball, ball.start(), 2.0, 1e-24);
        // The closed form after three bounces, in decimals of fifty digits.
        let exact = [
            (0.19725779362559154, -1.158941531916326e-17),
            (0.8181210843127956, 4.179952327285011e-18),
        ];
        for (found, (hi, lo)) in end.iter().zip(exact) {
            let exact = DoubleDouble::sum(hi, lo);
            // Measured: 5.3e-31 for the speed.
            assert!((*found - exact).hi().abs() < 5e-30, "{found:?}, {exact:?}");
        }
    }

    #[test]
    fn error_follows_the_tolerance_far_below_that_of_an_f64() {
        let (exit, start) = (Exit::Penetration, [0.5, 2.0]);
        let ball =
            CompliantBall { mass: 1.0, stiffness: 100.0, damping: 4.0, exit, gap: 1.0, start };
        let run = |rtol| ends_at(&ball, start, 2.0, rtol);
        let exact = run(1e-28);
        for rtol in [1e-16, 1e-20, 1e-24] {
            for (found, exact) in run(rtol).iter().zip(&exact) {
                let error = (*found - *exact).hi().abs();
                assert!(error < 10.0 * rtol, "{error:e} at {rtol:e}");
            }
        }
    }
}
