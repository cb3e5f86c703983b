//! Step controllers: fixed, and proportional–integral.

use crate::magnitude::{exp2, log2};
use crate::tolerance::Tolerance;

/// Safety factor on the proposed step. Hairer, Nørsett, Wanner, DOPRI5.
const SAFETY: f64 = 0.9;
/// Smallest and largest factor from one step size to the next. Hairer, Nørsett, Wanner, DOPRI5.
const SHRINK: f64 = 0.2;
const GROWTH: f64 = 10.0;
/// Weight of the previous error; zero is the plain integral controller. DOPRI5.
const BETA: f64 = 0.04;
/// Growth limit per step after a step that failed, as by a Newton iteration that did not converge. With it, steps
/// come near the size that failed after about seven steps; the error estimates alone would lead there in two.
const CREEP: f64 = 1.1;
/// Binary logarithm of the floor of the remembered error, 1e-4. The floor keeps one step with a tiny error from
/// holding back the next. DOPRI5.
const LOG_ERROR_FLOOR: f64 = -13.287_712_379_549_449;

/// How the step size is chosen.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Control, Method, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let rk4 = Method::named("rk4").ok_or("no such method")?;
/// let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-9; 2] };
/// assert!(rk4.solver(&ball, Control::Fixed(1e-3)).is_ok());
/// assert!(rk4.solver(&ball, Control::Adaptive(tolerance)).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Control {
    /// Every step has this size [unit of time], whatever its error.
    Fixed(f64),
    /// Step sizes are chosen so that the estimated local error is within the tolerance.
    Adaptive(Tolerance),
}

impl Control {
    pub(crate) fn tolerance(&self) -> Option<&Tolerance> {
        match self {
            Self::Fixed(_) => None,
            Self::Adaptive(tolerance) => Some(tolerance),
        }
    }
}

/// How steps are chosen, with limits. The limits have defaults where a [`Control`] is given in its place:
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Control, Integration, Method, Steps, Tolerance};
///
/// # let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let method = Method::named("rk45").ok_or("no such method")?;
/// let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6; 2] });
/// let mut solver = method.solver(&ball, Steps { longest: 0.01, ..control.into() })?;
/// let mut run = Integration::new(&ball, 0.0, ball.start());
/// run.run(1.0, &mut *solver, &mut ())?;
/// assert!(run.stats.n_accepted > 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Steps {
    /// How the step size is chosen.
    pub control: Control,
    /// Size of the first step that the solver takes [unit of time], `None` to choose it by the tolerance. A Taylor series, which
    /// knows its range, takes a shorter first step where it allows no longer one.
    pub first: Option<f64>,
    /// Longest step [unit of time], infinite by default. The last step before the end of a run may be longer by 1 %.
    #[cfg_attr(feature = "serde", serde(default = "unlimited", with = "maybe_infinite"))]
    pub longest: f64,
}

/// The limits of [`Steps`], apart from the control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepLimits {
    /// As [`Steps::first`].
    pub(crate) first: Option<f64>,
    /// As [`Steps::longest`].
    pub(crate) longest: f64,
}

impl StepLimits {
    /// No limits.
    pub(crate) const NONE: Self = Self { first: None, longest: f64::INFINITY };

    /// Steps chosen by `control` within these limits.
    pub(crate) fn with(self, control: Control) -> Steps {
        let Self { first, longest } = self;
        Steps { control, first, longest }
    }
}

#[cfg(feature = "serde")]
fn unlimited() -> f64 {
    f64::INFINITY
}

/// Infinity as none, for JSON has none.
#[cfg(feature = "serde")]
mod maybe_infinite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        (*x != f64::INFINITY).then_some(*x).serialize(to)
    }

    pub(super) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

impl From<Control> for Steps {
    fn from(control: Control) -> Self {
        StepLimits::NONE.with(control)
    }
}

/// A step size controller: accepts or rejects a step by its error and proposes the next size.
///
/// ```
/// use deltazero_solvers::control::{StepController, Verdict};
/// use deltazero_solvers::{Control, Tolerance};
///
/// let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6] });
/// let mut controller = StepController::new(control, 4);
/// // An error of 32 times the tolerance: 0.9 · 32^(−1/5) = 0.45.
/// let Verdict::Reject(h) = controller.judge(1.0, |_| 32.0 * 32.0) else { panic!("too large") };
/// assert!((h - 0.45).abs() < 1e-3);
/// // After a rejection the step does not grow at once.
/// assert_eq!(controller.judge(h, |_| 1e-6), Verdict::Accept(h));
/// assert!(matches!(controller.judge(h, |_| 1e-6), Verdict::Accept(next) if next > h));
/// ```
#[derive(Clone, Debug)]
pub struct StepController {
    control: Control,
    /// `1/(q + 1)` for an embedded method of order q, whose local error estimate is of order q + 1.
    exponent: f64,
    log_last_err: f64,
    rejected: bool,
    /// Largest size of the next step; finite after a step whose Newton iteration failed, or that left the domain of
    /// the model.
    ceiling: f64,
}

/// The controller's decision on an attempted step.
///
/// ```
/// use deltazero_solvers::Control;
/// use deltazero_solvers::control::{StepController, Verdict};
///
/// // A fixed step is accepted whatever its error, and so is one that was cut short.
/// let mut controller = StepController::new(Control::Fixed(0.1), 4);
/// assert_eq!(controller.judge(0.07, |_| 1e9), Verdict::Accept(0.1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The error is within the tolerance, or steps are of fixed size; the next step should have this size.
    Accept(f64),
    /// The error is too large; the step should be tried again with this size.
    Reject(f64),
}

impl StepController {
    /// The controller of a method whose error estimate has embedded order `embedded_order`.
    pub fn new(control: Control, embedded_order: usize) -> Self {
        Self {
            control,
            exponent: 1.0 / (embedded_order + 1) as f64,
            log_last_err: LOG_ERROR_FLOOR,
            rejected: false,
            ceiling: f64::INFINITY,
        }
    }

    /// The control that this controller was made with.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// Judges a step of size `h` by the square of the norm of its local error estimate, which `err_sq` computes for
    /// the tolerance; it is not called under fixed steps.
    ///
    /// ```text
    /// accepted:  h ← h · clamp(0.9 err^−(1/(q+1) − 0.75 β) · err_last^β),  β = 0.04
    /// rejected:  h ← h · max(0.2, 0.9 err^−1/(q+1))
    /// ```
    ///
    /// K. Gustafsson, "Control theoretic techniques for stepsize selection in explicit Runge–Kutta methods", ACM TOMS
    /// 17(4), 533–554 (1991). The constants are those of DOPRI5 for every method; unlike here, DOPRI5 keeps the term
    /// 0.75 β in a rejection too. A step whose error is not a number is rejected.
    #[inline]
    pub fn judge(&mut self, h: f64, err_sq: impl FnOnce(&Tolerance) -> f64) -> Verdict {
        let tolerance = match &self.control {
            Control::Fixed(step) => return Verdict::Accept(step.copysign(h)),
            Control::Adaptive(tolerance) => tolerance,
        };
        let err_sq = err_sq(tolerance);
        self.weigh(h, err_sq)
    }

    /// As [`judge`](Self::judge), for a method that itself proposes the next step size. The size after an accepted
    /// step is left as it is, which saves a logarithm, and the error is not remembered.
    #[inline]
    fn check(&mut self, h: f64, err_sq: impl FnOnce(&Tolerance) -> f64) -> Verdict {
        let Control::Adaptive(tolerance) = &self.control else { return self.judge(h, err_sq) };
        let err_sq = err_sq(tolerance);
        if err_sq <= 1.0 {
            self.rejected = false;
            self.log_last_err = LOG_ERROR_FLOOR;
            return Verdict::Accept(h);
        }
        self.judge(h, |_| err_sq)
    }

    /// Judges by [`check`](Self::check) where the step size was proposed by the method, and by [`judge`](Self::judge)
    /// otherwise.
    #[inline]
    pub(crate) fn verdict(
        &mut self,
        is_proposed: bool,
        h: f64,
        err_sq: impl FnOnce(&Tolerance) -> f64,
    ) -> Verdict {
        if is_proposed { self.check(h, err_sq) } else { self.judge(h, err_sq) }
    }

    /// Decides on a step of size `h` by the square of the norm of its error. An error of zero gives the largest
    /// growth.
    #[inline]
    fn weigh(&mut self, h: f64, err_sq: f64) -> Verdict {
        let log_err = 0.5 * log2(err_sq);
        if err_sq <= 1.0 {
            let log_factor = BETA * self.log_last_err - (self.exponent - 0.75 * BETA) * log_err;
            let most = if self.rejected { 1.0 } else { GROWTH };
            self.log_last_err = log_err.max(LOG_ERROR_FLOOR);
            self.rejected = false;
            self.ceiling *= CREEP;
            let growth = (SAFETY * exp2(log_factor)).clamp(SHRINK, most);
            Verdict::Accept((h.abs() * growth).min(self.ceiling).copysign(h))
        } else {
            self.rejected = true;
            Verdict::Reject(h * self.shrunk(log_err))
        }
    }

    /// The factor that shortens a step whose error norm has the binary logarithm `log_err`.
    #[inline]
    fn shrunk(&self, log_err: f64) -> f64 {
        let factor = SAFETY * exp2(-self.exponent * log_err);
        if factor > SHRINK { factor.min(1.0) } else { SHRINK }
    }

    /// Half of `h`, to try a step again that failed: its Newton iteration did not converge, or its end was not
    /// finite. Returns `None` where the size is fixed. Afterwards step sizes grow by at most a tenth per step,
    /// starting from the halved size.
    pub fn halved(&mut self, h: f64) -> Option<f64> {
        self.rejected = true;
        self.ceiling = 0.5 * h.abs();
        matches!(self.control, Control::Adaptive(_)).then_some(0.5 * h)
    }

    /// A smaller size to try again with, if the error of a step of size `h` that lands on an event is not within the
    /// tolerance. The longer step that it was cut from was within the tolerance, but an error estimate may be small
    /// by chance.
    pub fn refusal(&self, h: f64, err_sq: impl FnOnce(&Tolerance) -> f64) -> Option<f64> {
        let Control::Adaptive(tolerance) = &self.control else {
            return None;
        };
        let err_sq = err_sq(tolerance);
        let is_tolerated = err_sq <= 1.0;
        (!is_tolerated).then(|| h * self.shrunk(0.5 * log2(err_sq)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> StepController {
        let tolerance = Tolerance { rtol: 1e-3, atol: vec![1e-3] };
        StepController::new(Control::Adaptive(tolerance), 4)
    }

    fn norm_sq(error: f64) -> impl FnOnce(&Tolerance) -> f64 {
        move |tolerance| tolerance.norm_sq(&[error], &[0.0], &[0.0])
    }

    #[test]
    fn a_small_error_grows_the_step_and_a_large_one_shrinks_it() {
        assert!(matches!(controller().judge(1.0, norm_sq(1e-9)), Verdict::Accept(h) if h > 1.0));
        assert!(matches!(controller().judge(1.0, norm_sq(1.0)), Verdict::Reject(h) if h < 1.0));
    }

    #[test]
    fn an_error_that_is_not_a_number_is_refused() {
        assert_eq!(controller().judge(1.0, norm_sq(f64::NAN)), Verdict::Reject(SHRINK));
    }

    #[test]
    fn a_check_leaves_the_size_of_a_good_step_and_judges_a_bad_one() {
        let mut checks = controller();
        assert_eq!(checks.check(-1.0, norm_sq(1e-9)), Verdict::Accept(-1.0));
        for bad in [1.0, f64::NAN] {
            assert_eq!(checks.check(1.0, norm_sq(bad)), controller().judge(1.0, norm_sq(bad)));
        }
        // The next accepted step ends the effect of the rejection.
        checks.check(0.5, norm_sq(1e-9));
        assert!(matches!(checks.judge(0.5, norm_sq(1e-9)), Verdict::Accept(h) if h > 0.5));
        let mut fixed = StepController::new(Control::Fixed(0.1), 4);
        assert_eq!(fixed.check(-0.05, norm_sq(1.0)), Verdict::Accept(-0.1));
    }

    #[test]
    fn the_step_does_not_grow_right_after_a_rejection() {
        let mut controller = controller();
        controller.judge(1.0, norm_sq(1.0));
        assert_eq!(controller.judge(0.5, norm_sq(1e-12)), Verdict::Accept(0.5));
    }

    #[test]
    fn steps_creep_towards_a_size_that_had_no_end() {
        let mut controller = controller();
        assert_eq!(controller.halved(-1.0), Some(-0.5));
        let mut h: f64 = -0.5;
        for n in 1..=8 {
            let Verdict::Accept(next) = controller.judge(h, norm_sq(1e-12)) else { panic!("{n}") };
            h = next;
            // The first step after a refusal does not grow.
            let most = if n == 1 { 0.5 } else { 0.5 * CREEP.powi(n) };
            assert!((h + most).abs() < 1e-12, "{n}: {h}");
        }
    }
}
