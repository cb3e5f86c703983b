//! The scalar type that a right-hand side and its guards are generic over.
//!
//! A model is written once, generic over [`Real`]. With `f64` it is integrated, with dual numbers differentiated,
//! with extended-precision numbers computed to more digits, and with Taylor coefficients expanded in a series.

mod elementary;
mod numbers;
mod shortcuts;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Sub};

pub(crate) use elementary::ArcTangent;
pub use shortcuts::{Divisor, Function, Functions, Length, Shortcuts, Turning};
pub(crate) use shortcuts::{length_of_values, less_turning_of_values, turning_of_values};

/// A real number, or a type that follows the same arithmetic, such as a dual number or a Taylor series.
///
/// Elementary functions of `f64` come from `libm`, not from the platform, so that the same input
/// gives the same bits on every machine.
///
/// A constant stands to the right of an operator: `y * 2.0`, `-y + 1.0`. Rust cannot promise `2.0 * y` for every such type.
///
/// The functions from [`sinh`](Self::sinh) to [`atan2`](Self::atan2), and [`sign`](Self::sign), decide on the value of a number. So a
/// mode with [parameters](crate::Alike::parameters), of which several runs are computed at once, must not use them.
///
/// What a model may use to be faster is in [`Shortcuts`]; it needs none of it.
///
/// ```
/// use deltazero_solvers::Real;
/// use num_dual::Dual64;
///
/// /// The force of a Hertzian contact.
/// fn force<S: Real>(delta: S) -> S {
///     delta.powf(1.5) * 4.0
/// }
///
/// assert_eq!(force(9.0), 108.0);
/// // A number that carries a derivative gives the stiffness too, 6 √δ.
/// assert_eq!(force(Dual64::new(9.0, 1.0)).eps, 18.0);
/// ```
pub trait Real:
    Shortcuts
    + Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The constant `x`.
    fn cst(x: f64) -> Self;

    /// The nearest `f64`, on which decisions (a sign, a branch) are taken.
    ///
    /// A branch has the derivatives and the Taylor series of the side that it takes. A step across it is not smooth, and
    /// belongs to a mode and a guard: where `ẏ` jumped from −1 to −½, `radau5` went over the jump in one step, off by
    /// 2.2e-2 at a tolerance of 1e-8, and told nothing; the other methods rejected steps there.
    ///
    /// A value that enters the result, as in `S::cst(x.value())`, is a constant there. Jacobians, rates of guards,
    /// sensitivities and Taylor coefficients lack its derivative, and the run does not tell, but
    /// [`contracts::check`](crate::contracts::check) does, and of transitions
    /// [`contracts::Checked`](crate::contracts::Checked): for `ẏ = −y` so written, `taylor`
    /// was off by 8.0e-5 at a tolerance of 1e-8, after 3149 steps and 50 392 rejected ones. Only a function whose
    /// derivative is meant to be zero may be so written, such as a step function.
    fn value(self) -> f64;

    /// Square root; NaN below zero. At zero its slope is infinite, and zero where that of the number is: of a constant, or of a
    /// sum of squares at rest.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Sine of an angle in radians. Where the cosine is needed too, [`sin_cos`](Self::sin_cos) costs half.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine of an angle in radians.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Tangent of an angle in radians.
    #[inline(always)]
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    /// `selfⁿ`, by products of squares; one for `n = 0`.
    #[inline]
    fn powi(self, n: u32) -> Self {
        let (mut power, mut square, mut n) = (None::<Self>, self, n);
        while n > 0 {
            if n % 2 == 1 {
                power = Some(power.map_or(square, |power| power * square));
            }
            n /= 2;
            if n > 0 {
                square = square * square;
            }
        }
        power.unwrap_or(Self::cst(1.0))
    }

    /// Exponential.
    fn exp(self) -> Self;

    /// Natural logarithm; NaN below zero.
    fn ln(self) -> Self;

    /// `selfᵃ` for a base of at least zero. Its slope at zero is that of a [root](Self::sqrt) where a is below one.
    fn powf(self, a: f64) -> Self;

    /// Hyperbolic sine.
    fn sinh(self) -> Self {
        self.outlined(&elementary::Sinh)
    }

    /// Hyperbolic cosine.
    fn cosh(self) -> Self {
        self.outlined(&elementary::Cosh)
    }

    /// Hyperbolic tangent; ±1 where the exponential overflows.
    fn tanh(self) -> Self {
        self.outlined(&elementary::Tanh)
    }

    /// Arc sine, in radians from −π/2 to π/2; NaN beyond ±1. At ±1 its slope is not a number, unless that of the number is zero.
    fn asin(self) -> Self {
        self.atan2(elementary::leg(self))
    }

    /// Arc cosine, in radians from 0 to π; NaN beyond ±1. At ±1 its slope is not a number, unless that of the number is zero.
    fn acos(self) -> Self {
        elementary::leg(self).atan2(self)
    }

    /// Arc tangent, in radians from −π/2 to π/2.
    fn atan(self) -> Self {
        self.atan2(Self::cst(1.0))
    }

    /// The angle of the point `(x, y)` in radians from −π to π, where this number is `y`. Of the origin it is that of
    /// `f64::atan2` for an `f64`, and NaN for what has a derivative.
    fn atan2(self, x: Self) -> Self {
        let [angle] = Self::all_outlined([self, x], &ArcTangent);
        angle
    }

    /// Absolute value, by a branch on the [value](Self::value): where that crosses zero a step is not smooth. At zero it is
    /// the branch of positive numbers.
    #[inline]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// −1, 0 or 1, a constant: its derivative is zero. It is a step, which belongs to a mode and a guard. (`f64::signum` is
    /// never zero.)
    #[inline]
    fn sign(self) -> Self {
        Self::cst(elementary::sign(self.value()))
    }

    /// The smaller of the two, by a branch on the sign of their difference; this one where they are equal, NaN where one of them is
    /// (`f64::min` then gives the other).
    #[inline]
    fn min(self, other: Self) -> Self {
        let above = (other - self).value();
        let is_known = above >= 0.0;
        if above < 0.0 || !is_known && other.value().is_nan() { other } else { self }
    }

    /// The larger of the two, as [`min`](Self::min).
    #[inline]
    fn max(self, other: Self) -> Self {
        let below = (self - other).value();
        let is_known = below >= 0.0;
        if below < 0.0 || !is_known && other.value().is_nan() { other } else { self }
    }

    /// Number of Newton iterations that take a root from the precision of an `f64` to the precision of this type.
    /// Each iteration doubles the number of digits and, for a Taylor series, the order.
    const NEWTON_STEPS: usize = 6;
}

/// A number to which constants of type `C` can be added and by which it can be multiplied. `C` is `f64` for any
/// number; a number of several runs at once also takes a constant per run.
///
/// ```
/// use deltazero_solvers::lanes::Lanes;
/// use deltazero_solvers::{Over, Real};
/// use wide::f64x2;
///
/// fn force<S: Over<C>, C>(mass: S, gravity: C) -> S {
///     mass * gravity
/// }
///
/// assert_eq!(force(2.0, 9.8), 19.6);
/// let gravities = Lanes::<f64x2>::from_fn(|run| [9.8, 1.6][run]);
/// assert_eq!(force(Lanes::cst(2.0), gravities).lane(1), 3.2);
/// ```
pub trait Over<C>:
    Real + Add<C, Output = Self> + Sub<C, Output = Self> + Mul<C, Output = Self>
{
    /// The constant as a number.
    fn of(constant: C) -> Self;
}

impl<S: Real> Over<f64> for S {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        S::cst(constant)
    }
}

/// A number that can be compared, of one run or of several at once.
pub trait Ordered: Real {
    /// The result of a comparison: true or false for each run.
    type Mask: Copy + BitAnd<Output = Self::Mask>;

    /// The smaller of the two; where one is NaN, any of both. A vector has one instruction for it.
    fn lesser(self, other: Self) -> Self;

    /// The larger of the two; where one is NaN, any of both.
    fn larger(self, other: Self) -> Self;

    /// Whether this number is above `other`.
    fn is_above(self, other: Self) -> Self::Mask;
}
