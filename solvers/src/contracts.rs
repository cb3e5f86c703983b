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

mod values;

use std::collections::HashMap;
use std::ops::ControlFlow;

use num_dual::Dual64;

use crate::erk::InMode;
use crate::real::Real;
use crate::record::{Accepted, Event, Needs, Record};
use crate::sensitivity::Tangent;
use crate::system::{System, Vector, differentiated, differentiated_by_time};
use crate::taylor::expand::{Expansion, begins_with_rhs};
use values::{BITS, check_transition};

/// Two ways to one number agree to this fraction of it, or to the second fraction of the terms that it is a sum of.
const AGREE: [f64; 2] = [1e-6, 1e-11];
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
    /// The same in a guard.
    #[error(
        "guard {guard} changes by {change:e} a unit of time along the solution, and by {derivative:e} by its derivative; a number that \
         was taken by Real::value has no derivative: decide by it, and compute with the number itself"
    )]
    ValueOfGuard {
        /// The guard.
        guard: usize,
        /// By a difference quotient.
        change: f64,
        /// By the derivative.
        derivative: f64,
    },
    /// The same in a transition.
    #[error(
        "state {state} after the transition of guard {guard} changes by {change:e} a unit of time along the solution, and by \
         {derivative:e} by its derivative; a number that was taken by Real::value has no derivative: decide by it, and compute with the \
         number itself"
    )]
    ValueOfTransition {
        /// The guard.
        guard: usize,
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
/// Where `y` has more or fewer states than the system [has](System::dim). In a build with debug assertions, where a [curve](crate::real::Shortcuts::turning) is not ended.
///
/// ```
/// use deltazero_solvers::contracts::{Breach, check};
/// use deltazero_solvers::{Next, Real, System};
///
/// /// `ẋ = v, v̇ = −x`, by a number that has lost its derivative.
/// struct Spring;
///
/// impl System for Spring {
///     type Mode = ();
///     type State<S: Real> = [S; 2];
///     type Guards<S: Real> = [S; 0];
///     fn initial_mode(&self, _t: f64, _: &[f64; 2]) {}
///     fn rhs<S: Real>(&self, (): (), _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
///         *dydt = [v, S::cst(-x.value())];
///     }
///     fn guards<S: Real>(&self, (): (), _t: S, _: &[S; 2], _: &mut [S; 0]) {}
///     fn transition<S: Real>(&self, (): (), _: usize, _t: S, _: &mut [S; 2]) -> Next<()> {
///         Next::Stop
///     }
/// }
///
/// let found = check(&Spring, &(), 0.0, &[1.0, 0.5]);
/// assert!(matches!(found, Err(Breach::Value { state: 1, derivative: 0.0, .. })));
/// ```
pub fn check<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<(), Breach> {
    assert_eq!(y.as_ref().len(), problem.dim(), "number of states");
    if !begins_with_rhs(problem, mode, t, y) {
        return Err(Breach::Together);
    }
    let place = Place { problem, mode, t, y };
    let jacobian = place.check_jacobian()?;
    let by_time = place.check_time_derivative()?;
    place.check_guard_span()?;
    let derivatives = place.derivatives();
    let mut sizes = sizes_of_product(&jacobian, y);
    for (i, size) in sizes.as_mut().iter_mut().enumerate() {
        *size = size.max(derivatives.first.as_ref()[i].abs()) + (by_time.as_ref()[i] * t).abs();
    }
    place.check_series(&derivatives, &jacobian, &sizes)?;
    place.check_values(derivatives, &jacobian, sizes)
}

/// The entries of a Jacobian by row and column.
type Entries = HashMap<[usize; 2], f64>;

/// Whether two ways to one number agree to a fraction of it or to `allowed`, or are no numbers.
fn agree(a: f64, b: f64, allowed: f64) -> bool {
    // False where one is not a finite number.
    let differ = (a - b).abs() > AGREE[0] * a.abs().max(b.abs()) + allowed && (a - b).is_finite();
    !differ
}

/// The sizes of the terms whose sums are the product of a Jacobian and `of`.
fn sizes_of_product<Y: Vector<f64>>(jacobian: &Entries, of: &Y) -> Y {
    let mut sizes = Y::from_fn(of.as_ref().len(), |_| 0.0);
    for ([i, j], d) in jacobian {
        sizes.as_mut()[*i] += (d * of.as_ref()[*j]).abs();
    }
    sizes
}

/// The derivatives of a solution by time.
struct Derivatives<Y> {
    first: Y,
    second: Y,
    third: Y,
}

/// Where a model is checked.
struct Place<'a, P: System> {
    problem: &'a P,
    mode: &'a P::Mode,
    t: f64,
    y: &'a P::State<f64>,
}

impl<P: System> Place<'_, P> {
    /// Compares the Jacobian with that of the right-hand side, which is returned.
    fn check_jacobian(&self) -> Result<Entries, Breach> {
        let (mut told, mut exact) = (Entries::new(), Entries::new());
        self.problem.jacobian(self.mode.clone(), self.t, self.y, |i, j, d| {
            told.insert([i, j], d);
        });
        let n = self.y.as_ref().len();
        let (mut of_row, mut of_column) = (vec![0.0_f64; n], vec![0.0_f64; n]);
        differentiated(self.problem, self.mode.clone(), self.t, self.y, |i, j, d| {
            exact.insert([i, j], d);
            of_row[i] = of_row[i].max(d.abs());
            of_column[j] = of_column[j].max(d.abs());
        });
        let mut entries: Vec<_> = told.keys().chain(exact.keys()).copied().collect();
        entries.sort_unstable();
        for entry in entries {
            let [told, derivative] = [&told, &exact].map(|d| d.get(&entry).copied().unwrap_or(0.0));
            let is_outside = entry.iter().any(|k| *k >= n);
            // Beside the largest of its row or column it is rounding.
            let largest = |[i, j]: [usize; 2]| of_row[i].max(of_column[j]);
            if is_outside || !agree(told, derivative, BITS * f64::EPSILON * largest(entry)) {
                return Err(Breach::Jacobian { entry, told, derivative });
            }
        }
        Ok(exact)
    }

    /// Compares the derivative by time with that of the right-hand side.
    fn check_time_derivative(&self) -> Result<P::State<f64>, Breach> {
        let mut told = self.y.clone();
        self.problem.time_derivative(self.mode.clone(), self.t, self.y, &mut told);
        let dydt = differentiated_by_time(self.problem, self.mode.clone(), self.t, self.y);
        for (state, (told, slope)) in told.as_ref().iter().zip(dydt.as_ref()).enumerate() {
            let (told, derivative) = (*told, slope.eps);
            if !agree(told, derivative, AGREE[1] * slope.re.abs()) {
                return Err(Breach::TimeDerivative { state, told, derivative });
            }
        }
        Ok(told)
    }

    /// Looks for a guard of two states that are a multiple of the span apart.
    fn check_guard_span(&self) -> Result<(), Breach> {
        let (span, y) = (self.problem.guard_span().max(1), self.y.as_ref());
        let mut known = HashMap::new();
        let n_guards = self.problem.n_guards();
        let mut g = P::Guards::<Dual64>::from_fn(n_guards, |_| Dual64::cst(0.0));
        for j in (0..y.len()).filter(|_| span < y.len()) {
            let seed = |i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 });
            let seeded = P::State::<Dual64>::from_fn(y.len(), seed);
            self.problem.guards(self.mode.clone(), Dual64::cst(self.t), &seeded, &mut g);
            let depends = |g: &Dual64| g.eps != 0.0 && g.eps.is_finite();
            for (guard, _) in g.as_ref().iter().enumerate().filter(|(_, g)| depends(g)) {
                if let Some(other) = known.insert((guard, j % span), j) {
                    return Err(Breach::GuardSpan { guard, states: [other, j] });
                }
            }
        }
        Ok(())
    }

    /// By numbers that differentiate.
    fn derivatives(&self) -> Derivatives<P::State<f64>> {
        let (problem, y) = (self.problem, self.y.as_ref());
        let mut first = self.y.clone();
        problem.rhs(self.mode.clone(), self.t, self.y, &mut first);
        let once = |i: usize| Dual64::new(y[i], first.as_ref()[i]);
        let along = P::State::<Dual64>::from_fn(y.len(), once);
        let mut dydt = along.clone();
        problem.rhs(self.mode.clone(), Dual64::new(self.t, 1.0), &along, &mut dydt);
        let second = P::State::<f64>::from_fn(y.len(), |i| dydt.as_ref()[i].eps);
        let along = P::State::<Tangent<Dual64>>::from_fn(y.len(), |i| {
            Tangent::new(once(i), Dual64::new(first.as_ref()[i], second.as_ref()[i]))
        });
        let mut twice = along.clone();
        let time = Tangent::new(Dual64::new(self.t, 1.0), Dual64::new(1.0, 0.0));
        problem.rhs(self.mode.clone(), time, &along, &mut twice);
        let third = P::State::<f64>::from_fn(y.len(), |i| twice.as_ref()[i].eps.eps);
        Derivatives { first, second, third }
    }

    /// Compares the series of the solution with its derivatives; the slopes are sums of terms of these `sizes`.
    fn check_series(
        &self,
        of: &Derivatives<P::State<f64>>,
        jacobian: &Entries,
        sizes: &P::State<f64>,
    ) -> Result<(), Breach> {
        let Self { problem, mode, t, y } = *self;
        let field = InMode { problem, mode };
        let mut coefficients = vec![y.clone(); 4];
        let mut g = [P::Guards::<f64>::from_fn(problem.n_guards(), |_| 0.0)];
        let mut expansion = Expansion::default();
        expansion.begin::<P, _>(&field, t, y, &mut coefficients[1], &mut g[0]);
        expansion.complete(&field, t, &mut coefficients, &mut g);
        let mut sizes = sizes.clone();
        for (order, derivatives, factorial) in [(2, &of.second, 2.0), (3, &of.third, 6.0)] {
            sizes = sizes_of_product(jacobian, &sizes);
            for (state, size) in sizes.as_ref().iter().enumerate() {
                let series = coefficients[order].as_ref()[state];
                let derivative = derivatives.as_ref()[state] / factorial;
                if !agree(series, derivative, AGREE[1] * size / factorial) {
                    return Err(Breach::Series { order, state, series, derivative });
                }
            }
        }
        Ok(())
    }
}

/// A recorder that [checks](check) a model in the first phases of a run, after the first step of each, and the transitions between
/// them for numbers that were taken by [`Real::value`].
///
/// ```
/// use deltazero_solvers::contracts::{Breach, Checked};
/// use deltazero_solvers::{Control, Integration, Method, Next, Real, System, Tolerance};
///
/// /// A mass that flies up to a spring at 0, whose force has lost its derivative.
/// struct Stop;
///
/// impl System for Stop {
///     type Mode = bool;
///     type State<S: Real> = [S; 2];
///     type Guards<S: Real> = [S; 1];
///     fn initial_mode(&self, _t: f64, y: &[f64; 2]) -> bool {
///         y[0] >= 0.0
///     }
///     fn rhs<S: Real>(&self, touches: bool, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
///         *dydt = [v, S::cst(if touches { -x.value() } else { 0.0 })];
///     }
///     fn guards<S: Real>(&self, touches: bool, _t: S, y: &[S; 2], g: &mut [S; 1]) {
///         *g = [if touches { y[0] } else { -y[0] }];
///     }
///     fn transition<S: Real>(&self, touches: bool, _: usize, _t: S, _: &mut [S; 2]) -> Next<bool> {
///         Next::Mode(!touches)
///     }
/// }
///
/// let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6; 2] });
/// let mut solver = Method::named("rk45").ok_or("no such method")?.solver(&Stop, control)?;
/// let mut checked = Checked::new(&Stop);
/// Integration::new(&Stop, 0.0, [-1.0, 1.0]).run(2.0, &mut *solver, &mut checked)?;
/// let (t, touches, breach) = checked.breach().ok_or("every promise is kept")?;
/// assert!(*t > 1.0 && *touches && matches!(breach, Breach::Value { state: 1, .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        if self.n_left > 0
            && let Err(breach) = check_transition(self.problem, event)
        {
            self.breach.get_or_insert((event.t, event.before.clone(), breach));
        }
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
