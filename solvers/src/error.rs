//! Errors and outcomes.

use crate::doubt::Doubt;

/// How an integration without an error ended.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Outcome, Run};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let run = Run::of(&ball, ball.start()).tolerance(1e-6, 1e-6);
/// assert_eq!(run.most_work(100).longest_step(1e-3).to(1.0)?.outcome, Outcome::Interrupted);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outcome {
    /// It reached the end of the requested span.
    Finished,
    /// A terminal event ended it.
    Stopped,
    /// The recorder ended it.
    Interrupted,
}

/// Why an integration cannot go on. What was reached before the error stays valid.
///
/// ```
/// # use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Error, Run};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let error = Run::of(&ball, [f64::NAN, 0.0]).tolerance(1e-6, 1e-6).to(1.0).err();
/// assert!(matches!(error, Some(Error::NonFinite { component: 0, .. })));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A step is below the resolution of the time, either because of its error estimate or because the user chose it
    /// so.
    #[error(
        "step fell to {h:e} at t = {t} in mode {mode}; that is beyond f64 here: raise rtol, atol or the fixed step"
    )]
    StepUnderflow {
        /// Time of the last accepted step, or the end of the run where that does not resolve a fixed step.
        t: f64,
        /// Step size that was asked for.
        h: f64,
        /// Mode.
        mode: String,
    },
    /// The equations of an implicit step were not solved.
    #[error(
        "the iteration of a step of {h:e} from t = {t} in mode {mode} does not converge; take a smaller step or a tolerance, locate events where the slope jumps, or use a method without iteration"
    )]
    NoConvergence {
        /// Time of the last accepted step.
        t: f64,
        /// Step size that was tried.
        h: f64,
        /// Mode.
        mode: String,
    },
    /// A state or slope is infinite or not a number.
    #[error(
        "state {component} is not finite at t = {t} in mode {mode}; take a smaller step, or check the right-hand side there"
    )]
    NonFinite {
        /// Time of the last accepted step.
        t: f64,
        /// Mode.
        mode: String,
        /// Index of the state.
        component: usize,
    },
    /// A guard is infinite or not a number.
    #[error(
        "guard {guard} is not finite at t = {t} in mode {mode}, or is not written there; check its definition"
    )]
    NonFiniteGuard {
        /// Time.
        t: f64,
        /// Mode.
        mode: String,
        /// Index of the guard.
        guard: usize,
    },
    /// The rounding bound of a guard is not usable.
    #[error(
        "the rounding bound of guard {guard} is {bound} at t = {t} in mode {mode}: it must be finite and above zero; state some 4 ε times the largest term of the guard"
    )]
    BadGuardBound {
        /// Time.
        t: f64,
        /// Mode.
        mode: String,
        /// Index of the guard.
        guard: usize,
        /// The bound; NaN where none is written.
        bound: f64,
    },
    /// A guard moves too fast to be followed within a step, or its values are too noisy.
    #[error(
        "guard {guard} turns too often to be followed in the step of {h:e} from t = {t} in mode {mode}; take smaller steps, or, in Rust, state its rounding bound if it is noise"
    )]
    UnresolvedGuard {
        /// Time of the last accepted step.
        t: f64,
        /// Step size.
        h: f64,
        /// Mode.
        mode: String,
        /// Index of the guard.
        guard: usize,
    },
    /// Transitions at one instant did not end in a mode whose guards all hold.
    #[error(
        "{n} transitions at t = {t} without rest, the last one from mode {mode} by guard {guard}: {cure}"
    )]
    Chatter {
        /// Time.
        t: f64,
        /// Number of transitions.
        n: usize,
        /// Mode before the last transition.
        mode: String,
        /// Guard of the last transition.
        guard: usize,
        /// What to change.
        cure: &'static str,
    },
    /// Events accumulate at a time for which the model gives no limiting mode.
    #[error("{n} events within {span:e} before t = {t} in mode {mode}: {}", why_so_many(*.span, *.t))]
    EventStorm {
        /// Time of the last event.
        t: f64,
        /// Number of events.
        n: usize,
        /// Time between the first and the last of them.
        span: f64,
        /// Mode.
        mode: String,
    },
    /// The right-hand side or the guards by the [parameters](crate::Alike::parameters) of a mode are others than those
    /// of the mode itself.
    #[error(
        "component {component} of {function} is {found:e} at t = {t} in mode {mode}, but {expected:e} by the mode itself; correct {function} or the parameters, or give none of this mode"
    )]
    UnlikeParameters {
        /// Time at the end of the first step in the mode.
        t: f64,
        /// Mode.
        mode: String,
        /// The function: `rhs_of` or `guards_of`.
        function: &'static str,
        /// Index of the state or of the guard.
        component: usize,
        /// What the function computed from the parameters.
        found: f64,
        /// What `rhs` or `guards` computed.
        expected: f64,
    },
    /// There is no method of this name.
    #[error("no method {name}; there are {known}")]
    UnknownMethod {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A model whose values do not go together, or that has no run of this kind. Integrations in this crate never return this
    /// error; it is for code that looks at a model before a run.
    #[error("no run can begin: {reason}")]
    Refused {
        /// Why not, with numbers, and what to change.
        reason: String,
    },
    /// The model is no longer valid. Integrations in this crate never return this error; it is for code that checks
    /// the validity of a model during a run.
    #[error("the model ends at t = {t} in mode {mode}: {reason}")]
    OutsideModel {
        /// Time.
        t: f64,
        /// Mode.
        mode: String,
        /// Why the model ends, with numbers, and what to change.
        reason: String,
    },
    /// A tolerance is not usable.
    #[error(
        "rtol = {rtol:e} and atol = {atol:?} for {n} states: they must be finite and above zero, one atol a state"
    )]
    BadTolerance {
        /// Relative tolerance.
        rtol: f64,
        /// Absolute tolerances.
        atol: Vec<f64>,
        /// Number of states.
        n: usize,
    },
    /// A step size or an end of time is not usable.
    #[error("{name} = {value} is not usable: {allowed}")]
    BadArgument {
        /// Name of the argument.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A method that needs a tolerance was given a fixed step, or the other way round.
    #[error("{method} needs {needs}")]
    BadControl {
        /// The method.
        method: &'static str,
        /// What the method needs.
        needs: &'static str,
    },
    /// Sensitivities were asked of a system that [reads its mode off the state](System::IS_BLIND).
    #[error(
        "no derivatives go through the switches of a system that reads its mode off the state; take the system that locates them"
    )]
    BlindSensitivities,
    /// A solver of the library `diffsol` stopped with an error.
    #[error(
        "diffsol stopped at t = {t} in mode {mode}: {message}; raise rtol, or use an explicit method"
    )]
    Diffsol {
        /// Time of the last accepted step.
        t: f64,
        /// Mode.
        mode: String,
        /// The message of the library.
        message: String,
    },
    /// A solution cannot be [enclosed](crate::enclosure) further.
    #[error(
        "nothing is proven beyond t = {t} in mode {mode}: {doubt}; begin with a smaller set, or ask for less"
    )]
    NotProven {
        /// Time to which the solution is enclosed.
        t: f64,
        /// Mode.
        mode: String,
        /// Why.
        doubt: Doubt,
    },
}

/// What events within a time `span` before `t` tell, and the way out.
fn why_so_many(span: f64, t: f64) -> &'static str {
    if span <= f64::EPSILON * t.abs() {
        "the condition of an event holds again right after it; after an event no condition of the new mode may hold: change it, or the state"
    } else {
        "they accumulate; give the model the mode that they tend to, or tighten the tolerance if they are spurious"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_that_take_no_time_do_not_tend_to_a_mode() {
        let told =
            |span| Error::EventStorm { t: 0.5, n: 100, span, mode: "slip".to_owned() }.to_string();
        let at_once = "100 events within 0e0 before t = 0.5 in mode slip: the condition of an event holds again";
        assert!(told(0.0).starts_with(at_once), "{}", told(0.0));
        assert!(
            told(1e-12).contains("they accumulate; give the model the mode"),
            "{}",
            told(1e-12)
        );
    }
}
