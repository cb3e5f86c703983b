//! The methods of the library `diffsol`, one smooth phase at a time.
//!
//! A new solver is made for each phase, so its history, Jacobian and failure counts start anew at every event. The
//! guards are those of this crate: they are evaluated after each step of the solver, and events are located on its
//! interpolant. An event time is therefore as exact as the interpolant.

mod algebra;
mod equations;
mod field;
mod graze;
mod lu;
mod stepper;

use crate::error::Error;
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::phase::{PhaseEnd, PhaseSolver, check_finite};
use crate::point::Point;
use crate::record::{Accepted, Record};
use crate::step::{Step, end_accessors};
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;
use equations::Places;
use field::OfSystem;
use graze::Place;
use stepper::{Phase, RESOLUTION, Stepper};

/// A method of `diffsol`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiffsolScheme {
    /// Variable-order BDF (NDF, orders 1 to 5). L. F. Shampine, M. W. Reichelt, "The MATLAB ODE
    /// suite", SIAM J. Sci. Comput. 18(1), 1–22 (1997).
    Bdf,
    /// TR-BDF2, second order, L-stable. M. E. Hosea, L. F. Shampine, "Analysis and implementation of
    /// TR-BDF2", Appl. Numer. Math. 20(1–2), 21–37 (1996).
    TrBdf2,
    /// ESDIRK, third order with a fourth-order estimate, L-stable.
    Esdirk34,
    /// Tsitouras 5(4), explicit. Ch. Tsitouras, "Runge–Kutta pairs of order 5(4) satisfying only the
    /// first column simplifying assumption", Comput. Math. Appl. 62(2), 770–775 (2011).
    Tsit45,
}

impl DiffsolScheme {
    /// Whether every step is implicit.
    pub(crate) fn is_implicit(self) -> bool {
        self != Self::Tsit45
    }

    /// The method applied to `problem` with `tolerance`, and a first step where one is given.
    pub(crate) fn solver<'p, P: System + 'p>(
        self,
        problem: &P,
        tolerance: Tolerance,
        first: Option<f64>,
    ) -> Box<dyn PhaseSolver<P> + 'p>
    where
        P::Mode: 'p,
    {
        Box::new(DiffsolSolver { first, ..DiffsolSolver::new(problem, self, tolerance) })
    }

    /// Order with which the method starts, from which its first step follows.
    fn starting_order(self) -> usize {
        match self {
            Self::Bdf => 1,
            Self::TrBdf2 => 2,
            Self::Esdirk34 => 3,
            Self::Tsit45 => 5,
        }
    }
}

/// A method of `diffsol` as a phase solver.
pub struct DiffsolSolver<P: System> {
    scheme: DiffsolScheme,
    tolerance: Tolerance,
    /// Size of the first step of the run, until it is taken.
    first: Option<f64>,
    watch: GuardWatch<P>,
}

impl<P: System> DiffsolSolver<P> {
    /// A solver that applies `scheme` to `problem` with `tolerance`.
    pub fn new(problem: &P, scheme: DiffsolScheme, tolerance: Tolerance) -> Self {
        Self { scheme, tolerance, first: None, watch: GuardWatch::new(problem) }
    }

    /// Checks an Euler step from `point`, where the states have the `slope`, to `y` at `t_end`: by half the change of the slope
    /// over it, where the states change by more than the tolerance.
    fn check_euler(
        &self,
        problem: &P,
        point: &Point<P>,
        (t_end, y): (f64, &P::State<f64>),
        slope: &P::State<f64>,
        stats: &mut Stats,
    ) -> Result<(), Error> {
        let (h, y0, y1) = (t_end - point.t, point.y.as_ref(), y.as_ref());
        let norm = |error: &P::State<f64>| self.tolerance.norm(error.as_ref(), y0, y1);
        let mut change = P::State::from_fn(y1.len(), |i| h * slope.as_ref()[i]);
        if norm(&change) <= 1.0 {
            return Ok(());
        }
        problem.rhs(point.mode.clone(), t_end, y, &mut change);
        stats.work.n_rhs += 1;
        stats.restart.n_rhs += 1;
        let ends = change.as_mut().iter_mut().zip(slope.as_ref());
        ends.for_each(|(change, slope)| *change = 0.5 * h * (*change - slope));
        if norm(&change) <= 1.0 {
            return Ok(());
        }
        Err(Error::StepUnderflow { t: point.t, h, mode: format!("{:?}", point.mode) })
    }

    /// Crosses a span below the resolution of `diffsol` with one Euler step, which is exact to rounding over such a
    /// span where the states move at a rate that the time resolves.
    ///
    /// # Errors
    /// [`Error::StepUnderflow`] where the slopes at both ends of the step do not agree on where it ends.
    fn one_euler_step(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        let (mode, t0, y0) = (point.mode.clone(), point.t, point.y.clone());
        let mut slope = y0.clone();
        problem.rhs(mode.clone(), t0, &y0, &mut slope);
        check_finite(point, &slope)?;
        stats.work.n_rhs += 1;
        stats.restart.n_rhs += 1;
        let line = |t: f64, y: &mut P::State<f64>| {
            let ends = y0.as_ref().iter().zip(slope.as_ref());
            for (y, (y0, slope)) in y.as_mut().iter_mut().zip(ends) {
                *y = y0 + (t - t0) * slope;
            }
        };
        let mut y1 = y0.clone();
        line(t_end, &mut y1);
        self.check_euler(problem, point, (t_end, &y1), &slope, stats)?;
        let landed_on = self.watch.violated(problem, mode.clone(), t_end, &y1)?;
        stats.n_accepted += 1;
        point.y.clone_from(&y1);
        let step = SolverStep {
            interpolant: line,
            t0,
            t1: t_end,
            y0: &y0,
            y1,
            slope0: slope.clone(),
            slope1: slope.clone(),
        };
        point.t = t_end;
        let proposed = None;
        let go_on = record.step(&Accepted { mode, step: &step, landed_on, proposed, stats });
        Ok(match landed_on {
            _ if go_on.is_break() => PhaseEnd::Interrupted { landed_on },
            Some(guard) => PhaseEnd::Guard(guard),
            None => PhaseEnd::EndOfTime,
        })
    }

    /// Steps by `stepper` on `field`, the equations of `problem`, to `t_end` or the first violated guard; `None` at the
    /// end of a step that outgrew the stepper.
    fn advance(
        &mut self,
        problem: &P,
        (stepper, field): (&mut dyn Stepper, &OfSystem<'_, P>),
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<Option<PhaseEnd>, Error> {
        let mode = point.mode.clone();
        let mut before = *stats;
        let mut begun = Stats::default();
        stepper.count(&mut begun);
        before.restart.n_rhs += begun.work.n_rhs;
        before.restart.n_jac += begun.work.n_jac;
        stepper.stop_at(t_end)?;
        let n = problem.dim();
        let vector = |of: &[f64]| P::State::<f64>::from_fn(n, |i| of[i]);
        let mut slope0 = vector(stepper.dydt());
        self.watch.begin(problem, mode.clone(), point.t, &point.y, &slope0);
        self.watch.touches.watch(point.t);
        self.watch.begin_arcs();
        let phase_from = point.t;
        loop {
            let at_end = stepper.step();
            *stats = before;
            stepper.count(stats);
            let at_end = at_end?;
            let y1 = vector(stepper.y());
            check_finite(point, &y1)?;
            let reached = stepper.t();
            // The slope that was evaluated last. The state at the end is one correction of the iteration away, but no
            // further evaluation is needed.
            let slope1 = field.last_slope();
            let interpolant = |t: f64, y: &mut P::State<f64>| stepper.interpolate(t, y.as_mut());
            // The stop time of `diffsol` is within rounding of the end.
            let t1 = if at_end { t_end } else { reached };
            let (t0, y0) = (point.t, &point.y);
            let mut step = SolverStep { interpolant, t0, t1, y0, y1, slope0, slope1 };
            let h = step.t1 - step.t0;
            let landed_on = self.cut_at_event(problem, point, &mut step, &*stepper)?;
            let at = Place { landed_on, h, phase_from, n_steps: stats.n_accepted };
            let told = self.tell_grazing((problem, &mode), &step, at, record);
            (before.n_grazing, stats.n_grazing) = (before.n_grazing + told, stats.n_grazing + told);
            let (mode, proposed) = (mode.clone(), None);
            let go_on = record.step(&Accepted { mode, step: &step, landed_on, proposed, stats });
            let SolverStep { t1, y1, slope1, .. } = step;
            (point.t, point.y, slope0) = (t1, y1, slope1);
            match landed_on {
                _ if go_on.is_break() => return Ok(Some(PhaseEnd::Interrupted { landed_on })),
                Some(guard) => return Ok(Some(PhaseEnd::Guard(guard))),
                None if at_end => return Ok(Some(PhaseEnd::EndOfTime)),
                None if stepper.is_outgrown() => return Ok(None),
                None => {}
            }
        }
    }

    /// Cuts `step`, the last one of `stepper`, at the guard that falls first on it, and returns that guard.
    fn cut_at_event<F: Fn(f64, &mut P::State<f64>)>(
        &mut self,
        problem: &P,
        point: &Point<P>,
        step: &mut SolverStep<'_, F, P::State<f64>>,
        stepper: &dyn Stepper,
    ) -> Result<Option<usize>, Error> {
        let mode = || point.mode.clone();
        if self.watch.is_clear(problem, mode(), step) {
            return Ok(None);
        }
        // The search works on the interpolant, so it needs the slopes of the interpolant.
        stepper.interpolate_slope(step.t0, step.slope0.as_mut())?;
        stepper.interpolate_slope(stepper.t(), step.slope1.as_mut())?;
        self.watch.note_falls(step.t1 - step.t0);
        self.watch.start_at(problem, mode(), step.t0, step.y0, &step.slope0);
        self.watch.rates(problem, mode(), step.t1, &step.y1, &step.slope1);
        // A dip of the interpolant cannot be checked by retaking the step, so the tolerance decides whether it counts.
        let doubt = Some(&self.tolerance);
        let mut landed_on = None;
        while let Some(GuardCrossing { guard, t, .. }) =
            self.watch.first_to_fall(problem, mode(), step, f64::EPSILON, doubt)?
        {
            let mut y = step.y1.clone();
            step.interpolate(t, &mut y);
            check_finite(point, &y)?;
            let is_much_shorter = (t - step.t0).abs() < 0.5 * (step.t1 - step.t0).abs();
            (step.t1, step.y1) = (t, y);
            stepper.interpolate_slope(t, step.slope1.as_mut())?;
            landed_on = Some(guard);
            // Where no cubic tells the fall, the search takes the rounding bound at the end of the step. Where that is larger
            // than the one at the event, the event may come too late by much more than the arc that it ends, and is searched
            // for again before there.
            self.watch.violated(problem, mode(), t, &step.y1)?;
            if !(is_much_shorter && self.watch.is_violated(guard)) {
                break;
            }
            self.watch.rates(problem, mode(), t, &step.y1, &step.slope1);
        }
        Ok(landed_on)
    }
}

impl<P: System> PhaseSolver<P> for DiffsolSolver<P> {
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        let mode = point.mode.clone();
        let (field, further) = (&OfSystem::new(problem, mode.clone()), &Places::default());
        let tolerance = self.tolerance.clone();
        loop {
            let span = t_end - point.t;
            if span == 0.0 {
                return Ok(PhaseEnd::EndOfTime);
            }
            if span.abs() <= RESOLUTION * (point.t.abs() + span.abs()) {
                return self.one_euler_step(problem, point, t_end, stats, record);
            }
            let (t, y) = (point.t, point.y.clone());
            let phase = Phase {
                scheme: self.scheme,
                tolerance: &tolerance,
                field,
                mode: &mode,
                t,
                y: y.as_ref(),
                further,
                span,
                first: self.first.take(),
            };
            let then = &mut |stepper: &mut dyn Stepper| {
                self.advance(problem, (stepper, field), point, t_end, stats, record)
            };
            // The condition is a constant, so a program with short states alone does not contain the other branch.
            let end = if const { <P::State<f64> as Vector<f64>>::IS_SHORT } {
                phase.with_dense(then)
            } else {
                phase.with_sparse(then)
            };
            if let Some(end) = end? {
                return Ok(end);
            }
        }
    }
}

/// The last step of a `diffsol` solver.
struct SolverStep<'s, F, Y> {
    /// Writes the solver's interpolant at a time to a state.
    interpolant: F,
    t0: f64,
    t1: f64,
    y0: &'s Y,
    y1: Y,
    slope0: Y,
    slope1: Y,
}

impl<F: Fn(f64, &mut Y), Y: Clone> Step<Y> for SolverStep<'_, F, Y> {
    end_accessors!(step => step.y0, &step.slope0);

    fn interpolate(&self, t: f64, y: &mut Y) {
        if t == self.t1 {
            y.clone_from(&self.y1);
        } else {
            (self.interpolant)(t, y);
        }
    }
}
