//! Bounds of the rounding errors of guards: each operation carries the bound of its result along with its value.

use std::ops::{Add, Div, Mul, Neg, Sub};

use deltazero_solvers::Real;
use num_dual::Dual64;

use crate::evaluate::Inputs;
use crate::mode::Mode;
use crate::system::Model;

/// Half the spacing of numbers next to one.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Rounding error of an elementary function, over its value.
const OF_FUNCTION: f64 = 2.0 * f64::EPSILON;
/// Rounding error of a state, over its value: it is a sum of several terms.
const OF_STATE: f64 = 2.0 * f64::EPSILON;
/// What is nothing beside the natural size of a state: a bounce that is lower has no size of its own.
const LEAST: f64 = 1e-14;

/// Writes bounds of the rounding errors of the guards of `mode`.
///
/// A state is known to its own rounding, and to the rounding of the time at which it has its value.
pub(crate) fn guard_bounds(model: &Model, mode: Mode, t: f64, y: &[f64], bounds: &mut [f64]) {
    let mode_of = &model.modes[usize::from(mode.number)];
    bounds.fill(f64::EPSILON);
    let n = y.len();
    let state = |i: usize| {
        let least = LEAST * model.scales[i];
        Bounded { value: y[i], bound: OF_STATE * (y[i].abs() + least) }
    };
    let states: Vec<Bounded> = (0..n).map(state).collect();
    let time = Bounded { value: t, bound: UNIT * t.abs() };
    let n_own = mode_of.guards.first_outputs.len();
    let mut own = vec![Bounded::cst(0.0); n_own];
    let inputs = Inputs { t: time, y: &states, held: &mode.held };
    mode_of.guards.run(&inputs, &mut own);
    let rates = rates(model, mode, t, y);
    for ((bound, guard), rate) in bounds.iter_mut().zip(&own).zip(rates) {
        *bound = guard.bound + UNIT * (t * rate).abs() + f64::MIN_POSITIVE;
    }
}

/// Rates of the guards along the flow.
fn rates(model: &Model, mode: Mode, t: f64, y: &[f64]) -> Vec<f64> {
    let mode_of = &model.modes[usize::from(mode.number)];
    let mut slopes = vec![0.0; y.len()];
    mode_of.tape.run(&Inputs { t, y, held: &mode.held }, &mut slopes);
    let along: Vec<_> = y.iter().zip(slopes).map(|(y, slope)| Dual64::new(*y, slope)).collect();
    let mut rates = vec![Dual64::from_re(0.0); mode_of.guards.first_outputs.len()];
    let inputs = Inputs { t: Dual64::new(t, 1.0), y: &along, held: &mode.held };
    mode_of.guards.run(&inputs, &mut rates);
    let finite = |rate: f64| if rate.is_finite() { rate } else { 0.0 };
    rates.into_iter().map(|rate| finite(rate.eps)).collect()
}

/// A number with a bound of its error.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    value: f64,
    bound: f64,
}

impl Bounded {
    /// A result whose operands' errors amount to `inherited`, rounded.
    fn rounded(value: f64, inherited: f64) -> Self {
        Self { value, bound: inherited + UNIT * value.abs() }
    }

    /// A function of this number with this value and slope.
    fn function(self, value: f64, slope: f64) -> Self {
        let inherited = self.bound * slope.abs();
        let inherited = if inherited.is_finite() { inherited } else { self.bound.sqrt() };
        Self { value, bound: inherited + OF_FUNCTION * value.abs() }
    }
}

impl Neg for Bounded {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, bound: self.bound }
    }
}

impl Add for Bounded {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::rounded(self.value + other.value, self.bound + other.bound)
    }
}

impl Sub for Bounded {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Bounded {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let inherited = self.value.abs() * other.bound + other.value.abs() * self.bound;
        Self::rounded(self.value * other.value, inherited)
    }
}

impl Div for Bounded {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inherited = (self.bound + value.abs() * other.bound) / other.value.abs();
        Self::rounded(value, inherited)
    }
}

impl Add<f64> for Bounded {
    type Output = Self;

    fn add(self, x: f64) -> Self {
        Self::rounded(self.value + x, self.bound)
    }
}

impl Sub<f64> for Bounded {
    type Output = Self;

    fn sub(self, x: f64) -> Self {
        self + -x
    }
}

impl Mul<f64> for Bounded {
    type Output = Self;

    fn mul(self, x: f64) -> Self {
        Self::rounded(self.value * x, self.bound * x.abs())
    }
}

impl Div<f64> for Bounded {
    type Output = Self;

    fn div(self, x: f64) -> Self {
        Self::rounded(self.value / x, self.bound / x.abs())
    }
}

impl Real for Bounded {
    const NEWTON_STEPS: usize = 0;

    fn cst(x: f64) -> Self {
        Self { value: x, bound: 0.0 }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.function(root, 0.5 / root)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = libm::sincos(self.value);
        (self.function(sin, cos), self.function(cos, sin))
    }

    fn exp(self) -> Self {
        let e = libm::exp(self.value);
        self.function(e, e)
    }

    fn ln(self) -> Self {
        self.function(libm::log(self.value), 1.0 / self.value)
    }

    fn powf(self, a: f64) -> Self {
        let slope = a * libm::pow(self.value, a - 1.0);
        self.function(libm::pow(self.value, a), slope)
    }
}
