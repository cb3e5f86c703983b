//! Numbers of twice the digits of an `f64`, for reference solutions.
//!
//! Sums and products are those of the crate `twofloat`. Its quotients (0.8) are right to 2e-17 only, its sines to
//! 1e-21 and its exponentials to 2e-14, measured against 60 digits; they are computed here.

use std::ops::{Add, Div, Mul, Neg, Sub};

use twofloat::TwoFloat;
use twofloat::consts::FRAC_PI_2;

use crate::real::{Real, Shortcuts};

/// An unevaluated sum of two `f64`, with about 31 digits where values are finite.
///
/// ```
/// use deltazero_solvers::Real;
/// use deltazero_solvers::double_double::DoubleDouble;
///
/// let sum = DoubleDouble::sum(1.0, 1e-20);
/// assert_eq!((sum.hi(), sum.lo()), (1.0, 1e-20));
/// let root = DoubleDouble::from(2.0).sqrt();
/// assert!((root * root - 2.0).hi().abs() < 1e-30);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble(TwoFloat);

impl DoubleDouble {
    /// The sum of two `f64`, without rounding.
    pub fn sum(a: f64, b: f64) -> Self {
        Self(TwoFloat::new_add(a, b))
    }

    /// The nearest `f64`.
    pub fn hi(self) -> f64 {
        self.0.hi()
    }

    /// What the nearest `f64` leaves out.
    pub fn lo(self) -> f64 {
        self.0.lo()
    }

    fn is_finite(self) -> bool {
        self.hi().is_finite() && self.lo().is_finite()
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self(TwoFloat::from(x))
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Operators that are those of `twofloat`, with a number of the same type and with an `f64`.
macro_rules! operators {
    ($($Operator:ident::$operator:ident by $by:ty: $with:expr;)*) => {$(
        impl $Operator<$by> for DoubleDouble {
            type Output = Self;

            #[inline]
            fn $operator(self, by: $by) -> Self {
                let with: fn(TwoFloat, $by) -> TwoFloat = $with;
                Self(with(self.0, by))
            }
        }
    )*};
}

operators! {
    Add::add by Self: |a, b| a + b.0;
    Sub::sub by Self: |a, b| a - b.0;
    Mul::mul by Self: |a, b| a * b.0;
    Add::add by f64: |a, b| a + b;
    Sub::sub by f64: |a, b| a - b;
    Mul::mul by f64: |a, b| a * b;
    Div::div by f64: |a, b| a / b;
}

impl Div for DoubleDouble {
    type Output = Self;

    /// A quotient to the digits of an `f64`, and two steps of Newton's iteration.
    fn div(self, by: Self) -> Self {
        let quotient = self.0.hi() / by.0.hi();
        let rest = (self.0 - by.0 * quotient).hi() / by.0.hi();
        let next = TwoFloat::new_add(quotient, rest);
        let last = (self.0 - by.0 * next).hi() / by.0.hi();
        Self(if last.is_finite() { next + last } else { TwoFloat::from(quotient) })
    }
}

/// Terms of the series of sine and cosine on `|r| ≤ π/4`, of which the last is below 1e-33.
const SINE_TERMS: u32 = 14;
/// Halvings of an exponent below [`LARGEST`], after which it is below 0.05.
const HALVINGS: i32 = 14;
/// Terms of the series of the halved exponent, of which the last is below 1e-34.
const EXPONENTIAL_TERMS: u32 = 16;
/// Exponents whose exponential is neither infinite nor below the normal numbers.
const LARGEST: f64 = 700.0;

impl Real for DoubleDouble {
    const NEWTON_STEPS: usize = 2;

    fn cst(x: f64) -> Self {
        Self::from(x)
    }

    fn value(self) -> f64 {
        self.hi()
    }

    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    /// By the series of the distance from the nearest multiple of π/2. Digits are lost in proportion to the angle.
    fn sin_cos(self) -> (Self, Self) {
        let quarters = libm::round(self.hi() / FRAC_PI_2.hi());
        let r = Self(self.0 - FRAC_PI_2 * quarters);
        let square = r * r;
        let (mut sin, mut cos) = (Self::from(1.0), Self::from(1.0));
        for n in (1..=SINE_TERMS).rev() {
            let n = 2.0 * f64::from(n);
            sin = -(square * sin) / (n * (n + 1.0)) + 1.0;
            cos = -(square * cos) / (n * (n - 1.0)) + 1.0;
        }
        let sin = sin * r;
        match quarters.rem_euclid(4.0) {
            1.0 => (cos, -sin),
            2.0 => (-sin, -cos),
            3.0 => (-cos, sin),
            // NaN where the angle is not finite.
            _ => (sin, cos),
        }
    }

    /// `e^r − 1` of `r = x/2ⁿ` by its series, then doubled n times by `e^(2r) − 1 = (e^r − 1)(e^r + 1)`.
    fn exp(self) -> Self {
        if !self.is_finite() || self.hi().abs() >= LARGEST {
            return Self::from(libm::exp(self.hi()));
        }
        let r = self * libm::ldexp(1.0, -HALVINGS);
        let mut sum = Self::from(1.0);
        for n in (2..=EXPONENTIAL_TERMS).rev() {
            sum = (r * sum) / f64::from(n) + 1.0;
        }
        let mut less_one = r * sum;
        for _ in 0..HALVINGS {
            less_one = less_one * (less_one + 2.0);
        }
        less_one + 1.0
    }

    /// `ln x = y + ln(x e⁻ʸ)`, with y the logarithm in `f64`, after which two terms of the series suffice.
    fn ln(self) -> Self {
        let y = libm::log(self.hi());
        if !y.is_finite() || y.abs() >= LARGEST {
            return Self::from(y);
        }
        let rest = self * Self::from(-y).exp() - 1.0;
        rest - rest * rest * 0.5 + y
    }

    fn powf(self, a: f64) -> Self {
        if self.hi() > 0.0 { (self.ln() * a).exp() } else { Self::from(libm::pow(self.hi(), a)) }
    }
}

impl Shortcuts for DoubleDouble {}

#[cfg(test)]
mod tests {
    use super::*;

    type Exact = (f64, f64);

    /// Arguments, with sine, cosine, exponential, `1/(3x + 0.1)`, logarithm, root and `x^1.7`, each by 80 digits in
    /// decimals, rounded to a sum of two numbers.
    const EXACT: [(Exact, [Exact; 7]); 3] = [
        (
            (0.3, 1e-18),
            [
                (0.29552020666133955, 1.9270693765918142e-17),
                (0.955336489125606, 4.1640080091246125e-17),
                (1.3498588075760032, -9.312328792674787e-17),
                (1.0, 2.4755575615628914e-17),
                (-1.2039728043259361, 9.268854916737109e-17),
                (0.5477225575051661, 2.981413816637315e-17),
                (0.12915348607498026, 1.0722344356243488e-17),
            ],
        ),
        (
            (7.0, 1e-16),
            [
                (0.6569865987187892, -6.259459162753055e-18),
                (0.7539022543433046, -2.8416206274778195e-17),
                (1096.6331584284587, -1.9012833196045258e-14),
                (0.04739336492890995, 2.6351532192415797e-18),
                (1.9459101490553132, 8.752157636476336e-17),
                (2.6457513110645907, -1.06771257169716e-16),
                (27.331701439859053, -3.464417831944416e-16),
            ],
        ),
        (
            (120.7, 5e-15),
            [
                (0.9685857099203458, 1.1577119279132274e-17),
                (0.2486799600653414, -5.581715073760414e-18),
                (2.626297774896422e52, 1.055754880238315e36),
                (0.002760905577029265, 2.083270535550775e-19),
                (4.793308128103486, 1.612503662201174e-16),
                (10.986355173577815, -5.052309819231802e-16),
                (3458.6161028782485, -3.235414079067192e-14),
            ],
        ),
    ];

    #[test]
    fn functions_have_thirty_digits() {
        for ((hi, lo), exact) in EXACT {
            let x = DoubleDouble::sum(hi, lo);
            let (sin, cos) = x.sin_cos();
            let quotient = DoubleDouble::from(1.0) / (x * 3.0 + 0.1);
            let found = [sin, cos, x.exp(), quotient, x.ln(), x.sqrt(), x.powf(1.7)];
            for (i, (found, (hi, lo))) in found.into_iter().zip(exact).enumerate() {
                let error = (found - DoubleDouble::sum(hi, lo)).hi().abs() / hi.abs();
                // Measured: 8.4e-32, and 2.8e-29 for the sine of the largest angle.
                let most = 5e-31 * x.hi().max(1.0);
                assert!(error < most, "function {i} of {x:?}: {error:e}");
            }
        }
    }

    #[test]
    fn numbers_that_are_not_finite_stay_so() {
        let [zero, one, infinite] = [0.0, 1.0, f64::INFINITY].map(DoubleDouble::from);
        assert_eq!((one / zero).hi(), f64::INFINITY);
        assert_eq!((one / infinite).hi(), 0.0);
        assert_eq!(infinite.exp().hi(), f64::INFINITY);
        assert_eq!((-infinite).exp().hi(), 0.0);
        assert_eq!(zero.ln().hi(), f64::NEG_INFINITY);
        assert_eq!(zero.powf(1.5).hi(), 0.0);
        let no_number = [zero / zero, (-one).ln(), (-one).sqrt(), infinite.sin_cos().0];
        assert!(no_number.iter().all(|x| x.hi().is_nan()), "{no_number:?}");
    }

    #[test]
    fn a_sum_is_its_nearest_number_and_the_rest() {
        let sum = DoubleDouble::sum(1.0, 1e-20);
        assert_eq!((sum.hi(), sum.lo()), (1.0, 1e-20));
        assert_eq!(DoubleDouble::sum(0.5, 0.25).lo(), 0.0);
    }
}
