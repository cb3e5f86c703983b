//! What a model promises where it tells more than its equations, and whether it keeps it.
//!
//! A model may tell its Jacobian, which guards depend on which states, or terms that slope and guards share; it may compute
//! with [`Shortcuts`](crate::real::Shortcuts). A promise that is not kept gives wrong numbers, slow steps or a lost event, and
//! seldom an error. [`check`] compares each with what follows from [`rhs`](System::rhs) and [`guards`](System::guards)
//! alone; [`Checked`] does so along a run.
//!
//! ```
//! use deltazero_solvers::contracts::{Breach, check};
//! use deltazero_solvers::{Next, Real, System};
//!
//! /// `ẏ = −2 y`, with a Jacobian that forgets the 2.
//! struct Decay;
//!
//! impl System for Decay {
//!     type Mode = ();
//!     type State<S: Real> = [S; 1];
//!     type Guards<S: Real> = [S; 0];
//!     fn initial_mode(&self, _t: f64, _: &[f64; 1]) {}
//!     fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 1], dydt: &mut [S; 1]) {
//!         *dydt = [-y[0] * 2.0];
//!     }
//!     fn guards<S: Real>(&self, (): (), _t: S, _: &[S; 1], _: &mut [S; 0]) {}
//!     fn transition<S: Real>(&self, (): (), _: usize, _t: S, _: &mut [S; 1]) -> Next<()> {
//!         Next::Stop
//!     }
//!     fn jacobian(&self, (): (), _t: f64, _: &[f64; 1], mut entry: impl FnMut(usize, usize, f64)) {
//!         entry(0, 0, -1.0);
//!     }
//! }
//!
//! let breach = Breach::Jacobian { entry: [0, 0], told: -1.0, derivative: -2.0 };
//! assert_eq!(check(&Decay, &(), 0.0, &[1.0]), Err(breach));
//! ```

use std::collections::HashMap;
use std::ops::ControlFlow;

use num_dual::Dual64;

use crate::erk::InMode;
use crate::real::Real;
use crate::record::{Accepted, Event, Needs, Record};
use crate::sensitivity::Tangent;
use crate::system::{System, Vector, differentiated};
use crate::taylor::expand::{Expansion, begins_with_rhs};

/// Two ways to one number agree to this fraction of it, or to the second fraction of the terms that it is a sum of.
const AGREE: [f64; 2] = [1e-6, 1e-11];
/// A difference quotient agrees to the first fraction of the derivative, or the second of the terms that it is a sum of. A number
/// without a derivative is missing altogether.
const NEAR: [f64; 2] = [0.1, 1e-4];
/// Two difference quotients that differ by more than this fraction of what is to be told tell nothing.
const SURE: f64 = 0.1;
/// Slopes are taken to be rounded by this many last bits of their terms.
const BITS: f64 = 100.0;
/// Steps of the difference quotients, as fractions of the time in which a slope changes by its size.
const STEPS: [f64; 2] = [1e-4, 2e-5];
/// Number of phases of a run that are checked.
const PHASES: u32 = 8;

/// A promise that a model does not keep.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Breach {
    /// Of [`System::rhs_with_guards`].
    #[error(
        "System::rhs_with_guards does not give what System::rhs and System::guards give, by operations that begin with those of \
         rhs in the same order; write it so, or leave it out"
    )]
    Together,
    /// Of [`System::jacobian`].
    #[error(
        "System::jacobian gives {told:e} for the slope of state {} by state {}, which is {derivative:e}; mend it, or leave it out",
        entry[0], entry[1]
    )]
    Jacobian {
        /// Row and column.
        entry: [usize; 2],
        /// What it gives.
        told: f64,
        /// The derivative of the right-hand side.
        derivative: f64,
    },
    /// Of [`System::time_derivative`].
    #[error(
        "System::time_derivative gives {told:e} for the slope of state {state}, which is {derivative:e}; mend it, or leave it out"
    )]
    TimeDerivative {
        /// The state.
        state: usize,
        /// What it gives.
        told: f64,
        /// The derivative of the right-hand side.
        derivative: f64,
    },
    /// Of [`System::guard_span`].
    #[error(
        "guard {guard} depends on the states {} and {}, which are a multiple of System::guard_span apart; give a larger span, or leave \
         it out", states[0], states[1]
    )]
    GuardSpan {
        /// The guard.
        guard: usize,
        /// Two states that it depends on.
        states: [usize; 2],
    },
    /// Of [`Shortcuts`](crate::real::Shortcuts).
    #[error(
        "the Taylor coefficient of order {order} of state {state} is {series:e} by the series, and {derivative:e} by derivatives; a \
         velocity or an acceleration that was given to length, turning or less_turning is not the rate along the solution, or a \
         turning has no less_turning"
    )]
    Series {
        /// The order.
        order: usize,
        /// The state.
        state: usize,
        /// The coefficient of the series.
        series: f64,
        /// The same by derivatives.
        derivative: f64,
    },
    /// Of [`Real::value`].
    #[error(
        "the slope of state {state} changes by {change:e} a unit of time along the solution, and by {derivative:e} by its derivative; \
         a number that was taken by Real::value has no derivative: decide by it, and compute with the number itself"
    )]
    Value {
        /// The state.
        state: usize,
        /// By a difference quotient.
        change: f64,
        /// By the derivative.
        derivative: f64,
    },
}

/// Whether `problem` keeps what it promises, in `mode` at `(t, y)`. What is not a finite number there is passed over.
///
/// # Errors
/// The first [`Breach`].
///
/// # Panics
/// In a build with debug assertions, where a [curve](crate::real::Shortcuts::turning) is not ended.
pub fn check<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<(), Breach> {
    if !begins_with_rhs(problem, mode, t, y) {
        return Err(Breach::Together);
    }
    let entries = jacobian(problem, mode, t, y)?;
    time_derivative(problem, mode, t, y)?;
    guard_span(problem, mode, t, y)?;
    let derivatives = Derivatives::new(problem, mode, t, y);
    series(problem, mode, t, (y, &derivatives, &entries))?;
    value(problem, mode, t, (y, &derivatives, &entries))
}

/// Whether two ways to one number agree, whose terms have the size `terms`, or are no numbers.
fn agree(a: f64, b: f64, terms: f64) -> bool {
    let allowed = AGREE[0] * a.abs().max(b.abs()) + AGREE[1] * terms;
    // False where one is not a finite number.
    let differ = (a - b).abs() > allowed && (a - b).is_finite();
    !differ
}

/// The Jacobian, which agrees with that of the right-hand side.
fn jacobian<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<HashMap<[usize; 2], f64>, Breach> {
    let (mut told, mut exact) = (HashMap::new(), HashMap::new());
    problem.jacobian(mode.clone(), t, y, |i, j, d| {
        told.insert([i, j], d);
    });
    differentiated(problem, mode.clone(), t, y, |i, j, d| {
        exact.insert([i, j], d);
    });
    let largest = exact.values().filter(|d| d.is_finite()).fold(0.0, |a: f64, d| a.max(d.abs()));
    // Rounding beside the largest one has no consequence.
    let terms = largest * f64::EPSILON / AGREE[1];
    let mut entries: Vec<_> = told.keys().chain(exact.keys()).copied().collect();
    entries.sort_unstable();
    for entry in entries {
        let [told, derivative] = [&told, &exact].map(|d| d.get(&entry).copied().unwrap_or(0.0));
        if !agree(told, derivative, terms) {
            return Err(Breach::Jacobian { entry, told, derivative });
        }
    }
    Ok(exact)
}

fn time_derivative<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<(), Breach> {
    let mut told = y.clone();
    problem.time_derivative(mode.clone(), t, y, &mut told);
    let still = P::State::<Dual64>::from_fn(y.as_ref().len(), |i| Dual64::cst(y.as_ref()[i]));
    let mut dydt = still.clone();
    problem.rhs(mode.clone(), Dual64::new(t, 1.0), &still, &mut dydt);
    for (state, (told, slope)) in told.as_ref().iter().zip(dydt.as_ref()).enumerate() {
        let (told, derivative) = (*told, slope.eps);
        if !agree(told, derivative, slope.re.abs()) {
            return Err(Breach::TimeDerivative { state, told, derivative });
        }
    }
    Ok(())
}

fn guard_span<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<(), Breach> {
    let (n, span, y) = (y.as_ref().len(), problem.guard_span().max(1), y.as_ref());
    let mut known = HashMap::new();
    let mut g = P::Guards::<Dual64>::from_fn(problem.n_guards(), |_| Dual64::cst(0.0));
    for j in (0..n).filter(|_| span < n) {
        let seeded =
            P::State::<Dual64>::from_fn(n, |i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 }));
        problem.guards(mode.clone(), Dual64::cst(t), &seeded, &mut g);
        for (guard, _) in g.as_ref().iter().enumerate().filter(|(_, g)| g.eps != 0.0) {
            if let Some(other) = known.insert((guard, j % span), j) {
                return Err(Breach::GuardSpan { guard, states: [other, j] });
            }
        }
    }
    Ok(())
}

/// The derivatives of a solution by time, from numbers that differentiate.
struct Derivatives<Y> {
    first: Y,
    second: Y,
    third: Y,
}

impl<Y: Vector<f64>> Derivatives<Y> {
    fn new<P: System<State<f64> = Y>>(problem: &P, mode: &P::Mode, t: f64, y: &Y) -> Self {
        let n = y.as_ref().len();
        let of = |derivative: &dyn Fn(usize) -> f64| Y::from_fn(n, derivative);
        let mut first = y.clone();
        problem.rhs(mode.clone(), t, y, &mut first);
        let once = |i: usize| Dual64::new(y.as_ref()[i], first.as_ref()[i]);
        let along = P::State::<Dual64>::from_fn(n, once);
        let mut dydt = along.clone();
        problem.rhs(mode.clone(), Dual64::new(t, 1.0), &along, &mut dydt);
        let second = of(&|i| dydt.as_ref()[i].eps);
        let along = P::State::<Tangent<Dual64>>::from_fn(n, |i| {
            Tangent::new(once(i), Dual64::new(first.as_ref()[i], second.as_ref()[i]))
        });
        let mut twice = along.clone();
        let time = Tangent::new(Dual64::new(t, 1.0), Dual64::new(1.0, 0.0));
        problem.rhs(mode.clone(), time, &along, &mut twice);
        let third = of(&|i| twice.as_ref()[i].eps.eps);
        Self { first, second, third }
    }
}

/// The sizes of the terms whose sum is the Jacobian times what has the sizes `of`.
fn terms<Y: Vector<f64>>(entries: &HashMap<[usize; 2], f64>, of: &Y) -> Y {
    let mut terms = Y::from_fn(of.as_ref().len(), |_| 0.0);
    for ([i, j], d) in entries {
        terms.as_mut()[*i] += (d * of.as_ref()[*j]).abs();
    }
    terms
}

/// The sizes of the terms that the slopes are sums of: as of the Jacobian times the state, or the slopes themselves.
fn slope_sizes<Y: Vector<f64>>((y, slope): (&Y, &Y), entries: &HashMap<[usize; 2], f64>) -> Y {
    let mut sizes = terms(entries, y);
    for (size, slope) in sizes.as_mut().iter_mut().zip(slope.as_ref()) {
        *size = size.max(slope.abs());
    }
    sizes
}

/// Compares the series with the derivatives.
fn series<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    (y, of, entries): (&P::State<f64>, &Derivatives<P::State<f64>>, &HashMap<[usize; 2], f64>),
) -> Result<(), Breach> {
    let field = InMode { problem, mode };
    let mut coefficients = vec![y.clone(); 4];
    let mut g = [P::Guards::<f64>::from_fn(problem.n_guards(), |_| 0.0)];
    let mut expansion = Expansion::default();
    expansion.begin::<P, _>(&field, t, y, &mut coefficients[1], &mut g[0]);
    expansion.complete(&field, t, &mut coefficients, &mut g);
    let mut sizes = slope_sizes((y, &of.first), entries);
    for (order, derivatives, factorial) in [(2, &of.second, 2.0), (3, &of.third, 6.0)] {
        sizes = terms(entries, &sizes);
        for (state, terms) in sizes.as_ref().iter().enumerate() {
            let series = coefficients[order].as_ref()[state];
            let derivative = derivatives.as_ref()[state] / factorial;
            if !agree(series, derivative, terms / factorial) {
                return Err(Breach::Series { order, state, series, derivative });
            }
        }
    }
    Ok(())
}

/// Compares the derivative of the slope along the solution with difference quotients ahead.
fn value<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    (y, of, entries): (&P::State<f64>, &Derivatives<P::State<f64>>, &HashMap<[usize; 2], f64>),
) -> Result<(), Breach> {
    let (terms, sizes) = (terms(entries, &of.first), slope_sizes((y, &of.first), entries));
    let (y, first) = (y.as_ref(), of.first.as_ref());
    let changes = first.iter().zip(of.second.as_ref()).map(|(f, d)| (f / d).abs());
    let time = changes.filter(|time| *time > 0.0).fold(f64::INFINITY, f64::min);
    if !time.is_finite() {
        return Ok(());
    }
    let slope_at = |h: f64| {
        let ahead = P::State::<f64>::from_fn(y.len(), |i| y[i] + h * first[i]);
        let mut slope = ahead.clone();
        problem.rhs(mode.clone(), t + h, &ahead, &mut slope);
        slope
    };
    let [coarse, fine] = STEPS.map(|part| {
        let h = part * time;
        let [once, twice] = [slope_at(h), slope_at(2.0 * h)];
        let (once, twice) = (once.as_ref(), twice.as_ref());
        P::State::<f64>::from_fn(y.len(), |i| {
            (4.0 * once[i] - twice[i] - 3.0 * first[i]) / (2.0 * h)
        })
    });
    for (state, derivative) in of.second.as_ref().iter().enumerate() {
        let [coarse, change] = [coarse.as_ref()[state], fine.as_ref()[state]];
        let off = (change - derivative).abs();
        let is_sure = (coarse - change).abs() <= SURE * off && off.is_finite();
        let size = derivative.abs().max(change.abs());
        let rounded = BITS * f64::EPSILON * sizes.as_ref()[state] / (STEPS[1] * time);
        let allowed = (NEAR[0] * size).max(NEAR[1] * terms.as_ref()[state]).max(rounded);
        if is_sure && off > allowed {
            return Err(Breach::Value { state, change, derivative: *derivative });
        }
    }
    Ok(())
}

/// A recorder that [checks](check) a model in the first phases of a run, after the first step of each.
#[derive(Debug)]
pub struct Checked<'a, P: System> {
    problem: &'a P,
    n_left: u32,
    begins: bool,
    breach: Option<(f64, P::Mode, Breach)>,
}

impl<'a, P: System> Checked<'a, P> {
    /// Nothing checked yet.
    pub fn new(problem: &'a P) -> Self {
        Self { problem, n_left: PHASES, begins: true, breach: None }
    }

    /// The first breach that was found, when and in which mode.
    pub fn breach(&self) -> Option<&(f64, P::Mode, Breach)> {
        self.breach.as_ref()
    }
}

impl<P: System> Record<P> for Checked<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        if self.begins && accepted.landed_on.is_none() {
            self.begins = false;
            let (t, mode) = (accepted.step.t1(), &accepted.mode);
            if let Err(breach) = check(self.problem, mode, t, accepted.step.y1()) {
                self.breach.get_or_insert((t, mode.clone(), breach));
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        self.n_left = self.n_left.saturating_sub(1);
        self.begins = self.n_left > 0;
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        if self.begins { Needs::Ends } else { Needs::Nothing }
    }
}

#[cfg(test)]
mod tests;
