//! One-step methods and the phase solver that they share: take a step, judge its error, land on the first violated
//! guard.

mod first;
mod graze;
mod land;
mod paced;
mod size;
mod state;

use crate::control::{Control, StepController, Steps, Verdict};
use crate::error::Error;
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::phase::{PhaseEnd, PhaseSolver, check_finite};
use crate::point::Point;
use crate::record::{Accepted, Needs, Record};
use crate::step::Step;
use crate::system::{System, Vector};
use crate::tolerance::Tolerance;
use crate::work::Stats;
pub(crate) use paced::Paced;
use state::underflow;
pub(crate) use state::{Due, PhaseContext, PhaseState};

/// The last step of a phase may be longer than the chosen size by up to this factor, so that no tiny step remains.
/// DOPRI5.
const STRETCH_ADAPTIVE: f64 = 1.01;
/// The same factor for fixed steps. It allows for the rounding of the sum of the steps only.
const STRETCH_FIXED: f64 = 1.0 + 1e-9;
/// Smallest first step of a phase under adaptive control, as a fraction of the time, so that adding the step changes
/// the time.
const LEAST_START: f64 = 16.0 * f64::EPSILON;
/// How closely the time of an event is located on the dense output, as a fraction of the step. The retaken steps then
/// locate it to rounding.
pub(crate) const PREDICTION: f64 = 1e-9;

/// A method whose step depends on its start alone: explicit Runge–Kutta, Rosenbrock, Radau or Taylor.
///
/// It neither chooses step sizes nor knows of transitions. It may [propose](Self::propose) a step size, and it may
/// [locate guard crossings](Self::first_to_fall) in a way of its own.
pub trait OneStep<P: System> {
    /// The type of its steps.
    type Step: Step<P::State<f64>>;

    /// Whether the method [proposes](Self::propose) step sizes. If not, `propose` is never called.
    const PROPOSES: bool = false;

    /// Order of the embedded solution, which is one below the order of the error estimate; `None` where the method
    /// has no embedded solution.
    fn embedded_order(&self) -> Option<usize>;

    /// Starts a phase at `(t, y)` in `mode` and forgets all earlier steps.
    fn restart(&mut self, problem: &P, mode: P::Mode, t: f64, y: &P::State<f64>, stats: &mut Stats);

    /// A step size from the present start that `tolerance` allows, where the method knows one before it takes the
    /// step; `None` leaves the choice to the controller. It is above zero, and infinite where nothing limits it.
    /// Called only where [`PROPOSES`](Self::PROPOSES) is true.
    fn propose(
        &mut self,
        _problem: &P,
        _mode: P::Mode,
        _tolerance: &Tolerance,
        _stats: &mut Stats,
    ) -> Option<f64> {
        None
    }

    /// Takes a step of size `h` to `t1 = t0 + h`. It may be called any number of times from the same start.
    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats);

    /// Whether the last attempt gave a state at its end. An implicit step whose equations were not solved did not.
    fn has_converged(&self) -> bool {
        true
    }

    /// Whether a step that is retaken with the size of the attempt before it ends in the same bits.
    fn repeats(&self) -> bool {
        true
    }

    /// Computes the slope at the end of the last attempt.
    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats);

    /// Computes what the dense output of the completed step needs beyond the step itself, such as extra stages.
    fn densify(&mut self, _problem: &P, _mode: P::Mode, _stats: &mut Stats) {}

    /// The guard that falls first on the completed step, or `None` where no guard falls.
    ///
    /// The default searches [the guards](GuardWatch) by their values and rates at both ends and then on the dense
    /// output. A method that knows its guards on a part of the step only may take the step again up to there.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`] for a guard that is not finite at the end of the step, [`Error::UnresolvedGuard`] for one
    /// that cannot be followed.
    fn first_to_fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        watch: &mut GuardWatch<P>,
        stats: &mut Stats,
    ) -> Result<Option<GuardCrossing>, Error> {
        if watch.is_clear(problem, mode.clone(), self.step()) {
            return Ok(None);
        }
        self.densify(problem, mode.clone(), stats);
        watch.first_to_fall(problem, mode, self.step(), PREDICTION, None)
    }

    /// Makes the end of the completed step the start of the next one.
    fn advance(&mut self);

    /// The last attempt.
    fn step(&self) -> &Self::Step;

    /// Estimate of the local error of the last attempt, where the method has one.
    fn error(&self) -> &P::State<f64>;

    /// Square of the [norm](Tolerance::norm) of that estimate, or of a sharper estimate that the method makes of two.
    fn error_norm_sq(&self, tolerance: &Tolerance) -> f64 {
        let step = self.step();
        tolerance.norm_sq(self.error().as_ref(), step.y0().as_ref(), step.y1().as_ref())
    }
}

/// A one-step method with a step controller.
///
/// ```
/// use deltazero_solvers::one_step::OneStepSolver;
/// use deltazero_solvers::problems::FrictionOscillator;
/// use deltazero_solvers::taylor::TaylorMethod;
/// use deltazero_solvers::{Control, Error, Integration};
///
/// // A series of an order of one's own, with fixed steps.
/// let error = |order| -> Result<f64, Error> {
///     let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
///     let method = TaylorMethod::new(2, 2, order);
///     let mut solver = OneStepSolver::new(&slider, method, Control::Fixed(0.5));
///     let mut run = Integration::new(&slider, 0.0, slider.start());
///     run.run(9.0, &mut solver, &mut ())?;
///     Ok((run.point.y[0] - slider.state(9.0)[0]).abs())
/// };
/// assert!(error(4)? > 1e-5 && error(12)? < 1e-12);
/// # Ok::<(), Error>(())
/// ```
pub struct OneStepSolver<P: System, M> {
    pub(crate) method: M,
    pub(crate) controller: StepController,
    pub(crate) watch: GuardWatch<P>,
    /// Order of the error estimate, from which the first step size follows.
    error_order: usize,
    /// Step size with which the next phase begins: that which the controller proposed last, after an event no longer than the step
    /// tried.
    next_h: Option<f64>,
    /// Size that the first step of the run does not exceed; infinite after it.
    first_limit: f64,
    /// Size that was proposed last, whatever the longest step.
    last_proposed: f64,
    /// Longest step at present, at most that of the run; [set](Paced::keep_below) between phases.
    longest_now: f64,
    /// Longest step of the run.
    longest_of_run: f64,
    /// Whether the method proposed the size of the step from the present start; the controller then only accepts or
    /// rejects it.
    pub(crate) is_proposed: bool,
    /// Estimated error of a fixed step.
    error_of_full: P::State<f64>,
}

impl<P: System, M: OneStep<P>> OneStepSolver<P, M> {
    /// A solver that applies `method` to `problem`, with steps chosen as `steps` says. The caller checks the tolerance
    /// and the limits.
    pub fn new(problem: &P, method: M, steps: impl Into<Steps>) -> Self {
        let Steps { control, first, longest } = steps.into();
        let embedded_order = method.embedded_order().unwrap_or(0);
        Self {
            method,
            next_h: first,
            first_limit: first.unwrap_or(f64::INFINITY),
            last_proposed: 0.0,
            longest_now: longest,
            longest_of_run: longest,
            is_proposed: false,
            controller: StepController::new(control, embedded_order),
            watch: GuardWatch::new(problem),
            error_of_full: Vector::from_fn(problem.dim(), |_| 0.0),
            error_order: embedded_order + 1,
        }
    }

    /// Begins a phase from `point` towards `t_end`, which must be another time. The size of the first step is chosen
    /// by [`choose_step`](Self::choose_step).
    pub(crate) fn begin(
        &mut self,
        problem: &P,
        point: &Point<P>,
        t_end: f64,
        stats: &mut Stats,
    ) -> Result<PhaseState, Error> {
        let mode = point.mode.clone();
        let before = stats.work;
        let (stretch, least) = match self.controller.control() {
            Control::Fixed(_) => (STRETCH_FIXED, 0.0),
            Control::Adaptive(_) => (STRETCH_ADAPTIVE, LEAST_START * point.t.abs()),
        };
        if let &Control::Fixed(h) = self.controller.control()
            && t_end + h == t_end
        {
            let t = if point.t + h == point.t { point.t } else { t_end };
            return Err(underflow(t, &point.mode, h));
        }
        self.method.restart(problem, mode.clone(), point.t, &point.y, stats);
        check_finite(point, self.method.step().slope0())?;
        self.watch.begin(problem, mode, point.t, &point.y, self.method.step().slope0());
        self.watch.touches.watch(point.t);
        stats.restart += stats.work - before;
        Ok(PhaseState { t_end, stretch, h: 0.0, due: Some(Due::First { least }) })
    }

    /// Takes steps to the end of a phase that has begun.
    // Never inlined: runs alone and those that leave a batch share it.
    #[inline(never)]
    pub(crate) fn finish(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
    ) -> Result<PhaseEnd, Error> {
        let (problem, mode) = (context.problem, context.point.mode.clone());
        loop {
            self.choose_step(problem, context.point, phase, context.stats);
            let Some((t1, h)) = phase.next(context.point)? else { return Ok(PhaseEnd::EndOfTime) };
            self.method.attempt(problem, mode.clone(), t1, h, context.stats);
            if let Some(end) = self.judge(context, phase, h)? {
                return Ok(end);
            }
        }
    }

    /// Judges the last attempt, of size `h`, and applies the verdict. Returns how the phase ended, if it did.
    #[inline(always)]
    pub(crate) fn judge(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        h: f64,
    ) -> Result<Option<PhaseEnd>, Error> {
        if !self.method.has_converged() {
            return self.unconverged(context, phase, h);
        }
        let is_proposed = M::PROPOSES && self.is_proposed;
        let error_sq = |tolerance: &_| self.method.error_norm_sq(tolerance);
        let verdict = self.controller.verdict(is_proposed, h, error_sq);
        self.apply_verdict(context, phase, h, verdict)
    }

    /// Completes the accepted attempt, and lands on the guard that falls first on it. Returns that guard, if any.
    ///
    /// # Errors
    /// [`Error::NonFinite`], [`Error::NonFiniteGuard`], [`Error::UnresolvedGuard`] or [`Error::NoConvergence`], each of
    /// which a shorter step may avoid.
    #[inline(always)]
    fn completed(&mut self, context: &mut PhaseContext<'_, P>) -> Result<Option<usize>, Error> {
        let PhaseContext { problem, point, stats, .. } = context;
        let mode = point.mode.clone();
        check_finite(point, self.method.step().y1())?;
        self.method.complete(problem, mode.clone(), stats);
        check_finite(point, self.method.step().slope1())?;
        let before = stats.work;
        let landed_on = self.locate(problem, mode, stats);
        if stats.work != before {
            stats.location += stats.work - before;
        }
        landed_on
    }

    /// Applies the `verdict` on the last attempt, of size `h`: sets another size to try, lands on an event, or
    /// accepts the step. Returns how the phase ended, if it did.
    #[inline(always)]
    pub(crate) fn apply_verdict(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        h: f64,
        verdict: Verdict,
    ) -> Result<Option<PhaseEnd>, Error> {
        match verdict {
            Verdict::Reject(smaller) => return self.rejected(context, phase, smaller),
            Verdict::Accept(next) => phase.h = self.next_size(next),
        }
        let landed_on = match self.completed(context) {
            // The step left the domain of the model, or its Newton iteration diverged when continued to rounding. The
            // error estimate accepted it by chance, so a shorter step is tried.
            Err(
                error @ (Error::NonFinite { .. }
                | Error::NonFiniteGuard { .. }
                | Error::UnresolvedGuard { .. }
                | Error::NoConvergence { .. }),
            ) => {
                self.watch.forget_step();
                return self.shortened(context, phase, h, || error);
            }
            landed_on => landed_on?,
        };
        let PhaseContext { problem, point, record, .. } = context;
        let mode = point.mode.clone();
        if landed_on.is_some() {
            let h_landed = self.method.step().t1() - point.t;
            let error_sq = |tolerance: &_| self.method.error_norm_sq(tolerance);
            if let Some(smaller) = self.controller.refusal(h_landed, error_sq) {
                self.watch.forget_step();
                return self.rejected(context, phase, smaller);
            }
            if matches!(self.controller.control(), Control::Adaptive(_)) {
                // How long a step the next mode allows is not known, so its phase begins with none longer than the last one tried.
                phase.h = phase.h.abs().min(h.abs()).copysign(h);
            }
        }
        let needs = record.needs(point.t, self.method.step().t1());
        if needs == Needs::DenseOutput {
            // The work of sampling is not counted.
            self.method.densify(problem, mode, &mut Stats::default());
        }
        self.tell_grazing(context, landed_on, h);
        Ok(self.accept(context, phase, landed_on, needs))
    }

    /// Accepts the last attempt as a step of the run. The attempt is complete and known either to cross no guard or
    /// to land on one.
    #[inline(always)]
    pub(crate) fn accept(
        &mut self,
        context: &mut PhaseContext<'_, P>,
        phase: &mut PhaseState,
        landed_on: Option<usize>,
        needs: Needs,
    ) -> Option<PhaseEnd> {
        let PhaseContext { point, stats, record, .. } = context;
        let step = self.method.step();
        point.y.clone_from(step.y1());
        self.arrive(step.t1(), &mut point.t, phase, stats);
        let go_on = if needs == Needs::Nothing {
            record.passed(point.t, stats)
        } else {
            let (mode, step) = (point.mode.clone(), self.method.step());
            let proposed = Some(self.last_proposed);
            record.step(&Accepted { mode, step, landed_on, proposed, stats })
        };
        if go_on.is_break() {
            return Some(PhaseEnd::Interrupted { landed_on });
        }
        if landed_on.is_none() {
            self.method.advance();
        }
        landed_on.map(PhaseEnd::Guard)
    }

    /// Counts an accepted step to `t1`. Where the method proposes step sizes, the choice of the next one is then due.
    #[inline(always)]
    pub(crate) fn arrive(
        &mut self,
        t1: f64,
        t: &mut f64,
        phase: &mut PhaseState,
        stats: &mut Stats,
    ) {
        stats.n_accepted += 1;
        *t = t1;
        self.next_h = Some(phase.h);
        phase.due = M::PROPOSES.then_some(Due::Next);
    }
}

impl<P: System, M: OneStep<P>> PhaseSolver<P> for OneStepSolver<P, M> {
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        if point.t == t_end {
            return Ok(PhaseEnd::EndOfTime);
        }
        let mut phase = self.begin(problem, point, t_end, stats)?;
        self.finish(&mut PhaseContext { problem, point, stats, record }, &mut phase)
    }
}
