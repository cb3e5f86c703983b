//! Bounds of the rounding errors of guards: each operation carries the bound of its result along with its value.
//!
//! N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., SIAM (2002), section 3.3: running error analysis.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

use crate::real::{Real, Shortcuts};
use crate::system::{System, Vector};

/// Rounding bound of a sum of a few terms, as a multiple of their size: for guards whose author writes the size down.
pub const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Half the spacing of numbers next to one.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Rounding error of an elementary function, over its value.
const OF_FUNCTION: f64 = 2.0 * f64::EPSILON;
/// Rounding error of a state, over its value: it is a sum of several terms.
const OF_STATE: f64 = 2.0 * f64::EPSILON;

/// Writes bounds of the rounding errors of the guards of `mode` at `(t, y)`, in the units of the guards and above zero:
///
/// ```text
/// bound of g = Σ (rounding of each operation, carried on to g) + ½ε |t ġ|,   |Δy_i| ≤ 2ε (|y_i| + least(i))
/// ```
///
/// A state is known to its own rounding, and to the rounding of the time at which it has its value, along which a guard moves by
/// its rate ġ. `least(i)` is a size of state i that is nothing beside its natural one, or zero.
///
/// It is what [`System::guard_bounds`] writes by default, with sizes of zero. It evaluates the right-hand side once, which is not
/// counted, and the guards twice, with numbers that carry a bound and with dual numbers. A guard whose bound is not a number,
/// as at the angle of the origin, has that of its rate alone.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::rounding::guard_bounds;
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let bound = |t, v, least| {
///     let mut bounds = [0.0];
///     guard_bounds(&ball, BouncingMode::Flight, t, &[1.0, v], |_| least, &mut bounds);
///     bounds[0] / f64::EPSILON
/// };
/// // At the start; where the height is a difference of numbers of 100 m; and late in a fall at 4 m/s.
/// assert_eq!([bound(0.0, 0.0, 0.0), bound(0.0, 0.0, 100.0)], [2.0, 202.0]);
/// assert_eq!(bound(1000.0, -4.0, 0.0), 2.0 + 0.5 * 4.0 * 1000.0);
/// ```
pub fn guard_bounds<P: System>(
    system: &P,
    mode: P::Mode,
    t: f64,
    y: &P::State<f64>,
    least: impl Fn(usize) -> f64,
    bounds: &mut P::Guards<f64>,
) {
    let (n, n_guards) = (system.dim(), system.n_guards());
    let mut slopes = P::State::<f64>::from_fn(n, |_| 0.0);
    system.rhs(mode.clone(), t, y, &mut slopes);
    let (y, slopes) = (y.as_ref(), slopes.as_ref());

    let state = |i: usize| Bounded { value: y[i], bound: OF_STATE * (y[i].abs() + least(i)) };
    let states = P::State::<Bounded>::from_fn(n, state);
    let time = Bounded { value: t, bound: UNIT * t.abs() };
    let mut own = P::Guards::<Bounded>::from_fn(n_guards, |_| Bounded::cst(f64::NAN));
    system.guards(mode.clone(), time, &states, &mut own);

    let along = P::State::<Dual64>::from_fn(n, |i| Dual64::new(y[i], slopes[i]));
    let mut rates = P::Guards::<Dual64>::from_fn(n_guards, |_| Dual64::cst(0.0));
    system.guards(mode, Dual64::new(t, 1.0), &along, &mut rates);

    let known = |x: f64| if x.is_nan() { 0.0 } else { x };
    let finite = |rate: f64| if rate.is_finite() { rate } else { 0.0 };
    let guards = own.as_ref().iter().zip(rates.as_ref());
    for (bound, (guard, rate)) in bounds.as_mut().iter_mut().zip(guards) {
        *bound = known(guard.bound) + UNIT * (t * finite(rate.eps)).abs() + f64::MIN_POSITIVE;
    }
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
    // An angle that is found from values alone has no bound; one iteration gives it that of its arguments.
    const NEWTON_STEPS: usize = 1;

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
        let (power, slope) = (libm::pow(self.value, a), a * libm::pow(self.value, a - 1.0));
        if self.value == 0.0 && slope.is_infinite() {
            return Self { value: power, bound: libm::pow(self.bound, a) };
        }
        self.function(power, slope)
    }
}

impl Shortcuts for Bounded {}

#[cfg(test)]
mod tests {
    use super::*;

    /// An operation of two numbers, with bounds and as it is.
    type Operation = (&'static str, fn(Bounded, Bounded) -> Bounded, fn(f64, f64) -> f64, Rounding);

    #[derive(Clone, Copy, Debug)]
    enum Rounding {
        None,
        Once,
        OfFunction,
        /// Of a formula with functions.
        OfFormula,
    }

    macro_rules! operations {
        ($a:ident, $b:ident: $($of:expr => $rounding:ident),* $(,)?) => {
            [$((
                stringify!($of),
                |$a: Bounded, $b: Bounded| { let _ = ($a, $b); $of },
                |$a: f64, $b: f64| { let _ = ($a, $b); $of },
                Rounding::$rounding,
            )),*]
        };
    }

    fn all() -> [Operation; 19] {
        operations!(a, b:
            a + b => Once,
            a - b => Once,
            a * b => Once,
            a / b => Once,
            b / a => Once,
            a + 2.5 => Once,
            a - 2.5 => Once,
            a * -2.5 => Once,
            b / 2.5 => Once,
            -b => None,
            Real::sqrt(a) => OfFunction,
            Real::sin_cos(a).0 => OfFunction,
            Real::sin_cos(b).1 => OfFunction,
            Real::exp(b) => OfFunction,
            Real::ln(a) => OfFunction,
            Real::powf(a, 1.7) => OfFunction,
            Real::atan2(a, b) => OfFormula,
            Real::atan(b) => OfFormula,
            Real::atan2(a, Real::sqrt(-(a * a) + 1.0)) => OfFormula,
        )
    }

    const A: f64 = 0.7;
    const B: f64 = -1.3;

    #[test]
    fn a_bound_is_the_largest_change_by_the_errors_of_the_operands() {
        let errors = [1e-7, 3e-7];
        for (name, bounded, plain, _) in all() {
            let [a, b] = [(A, errors[0]), (B, errors[1])];
            let own =
                bounded(Bounded { value: a.0, bound: a.1 }, Bounded { value: b.0, bound: b.1 });
            assert_eq!(own.value, plain(A, B), "{name}");
            let signs = [-1.0, 1.0].into_iter().flat_map(|i| [(i, -1.0), (i, 1.0)]);
            let changes =
                signs.map(|(i, j)| (plain(A + i * errors[0], B + j * errors[1]) - own.value).abs());
            let largest = changes.fold(0.0, f64::max);
            assert!((own.bound / largest - 1.0).abs() < 1e-6, "{name}: {own:?}, {largest:e}");
        }
    }

    #[test]
    fn what_is_exact_is_rounded() {
        for (name, bounded, _, rounding) in all() {
            let own = bounded(Bounded::cst(A), Bounded::cst(B));
            let rounding = match rounding {
                Rounding::None => 0.0,
                Rounding::Once => UNIT,
                Rounding::OfFunction => OF_FUNCTION,
                Rounding::OfFormula => {
                    // Measured: 0.64, 1.6 and 2.7.
                    let times = own.bound / (OF_FUNCTION * own.value.abs());
                    assert!((0.5..10.0).contains(&times), "{name}: {times}");
                    continue;
                }
            };
            assert_eq!(own.bound, rounding * own.value.abs(), "{name}");
        }
    }

    #[test]
    fn a_root_at_zero_has_the_root_of_the_bound() {
        assert_eq!(Real::sqrt(Bounded { value: 0.0, bound: 1e-12 }).bound, 1e-6);
        assert_eq!(Real::powf(Bounded { value: 0.0, bound: 1e-12 }, 0.25).bound, 1e-3);
    }
}
