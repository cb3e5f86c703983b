//! The scalar type that a right-hand side and its guards are generic over.
//!
//! A model is written once, generic over [`Real`]. With `f64` it is integrated, with dual numbers differentiated,
//! with extended-precision numbers computed to more digits, and with Taylor coefficients expanded in a series.

mod elementary;
mod numbers;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Sub};

/// A real number, or a type that follows the same arithmetic, such as a dual number or a Taylor series.
///
/// Elementary functions of `f64` come from `libm`, not from the platform, so that the same input
/// gives the same bits on every machine.
///
/// A constant stands to the right of an operator: `y * 2.0`, `-y + 1.0`. Rust cannot promise `2.0 * y` for every such type.
///
/// The functions from [`sinh`](Self::sinh) to [`atan2`](Self::atan2), and [`sign`](Self::sign), decide on the value of a number. So a
/// mode with [parameters](crate::Alike::parameters), of which several runs are computed at once, must not use them.
pub trait Real:
    Copy
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
    /// sensitivities and Taylor coefficients lack its derivative, and nothing tells: for `ẏ = −y` so written, `taylor`
    /// was off by 8.0e-5 at a tolerance of 1e-8, after 3149 steps and 50 392 rejected ones. Only a function whose
    /// derivative is meant to be zero may be so written, such as a step function.
    fn value(self) -> f64;

    /// Square root; NaN below zero.
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

    /// `selfᵃ` for a base of at least zero.
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

    /// Arc sine, in radians from −π/2 to π/2; NaN beyond ±1. At ±1 its slope is not a number.
    fn asin(self) -> Self {
        self.atan2(elementary::leg(self))
    }

    /// Arc cosine, in radians from 0 to π; NaN beyond ±1. At ±1 its slope is not a number.
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
        let [angle] = Self::all_outlined([self, x], &elementary::ArcTangent);
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

    /// This number prepared as a [divisor](Self::over), with its reciprocal.
    #[inline(always)]
    fn divisor(self) -> Divisor<Self> {
        Divisor { value: self, reciprocal: Self::cst(1.0) / self }
    }

    /// `self/by`, computed as a product with the reciprocal, which can be computed before `self` is known. The result
    /// is rounded twice, and is not finite where the reciprocal is not. A Taylor series divides instead, and expands
    /// no reciprocal.
    #[inline(always)]
    fn over(self, by: &Divisor<Self>) -> Self {
        self * by.reciprocal
    }

    /// The length `ρ = √(d·d)` of the plane vector `d`, and its rate ρ̇. The vector `v` must be the time derivative
    /// of `d` along every solution: a Taylor series computes the coefficients of ρ from those of ρ̇, so another `v`
    /// gives wrong coefficients. Where `d` is zero, ρ̇ and quotients by ρ are not finite.
    #[inline(always)]
    fn length(d: [Self; 2], v: [Self; 2]) -> Length<Self> {
        length_of_values(d, v)
    }

    /// The curve `r = (p sin θ, q cos θ)` at `turn = (θ, θ̇)`, whose second derivative
    /// [`less_turning`](Self::less_turning) computes; `arms = (p, q)` are constants.
    ///
    /// Along every solution θ̇ must be the time derivative of θ. Every evaluation that calls `turning` must also call
    /// `less_turning` with the result: a Taylor series stores coefficients there that the next order needs, and
    /// without them all coefficients from order one on are wrong. So guards cannot use a curve.
    ///
    /// # Panics
    /// In a build with debug assertions, where a series finds that `less_turning` was not called at the order before, or a trace
    /// at its end.
    #[inline(always)]
    fn turning(arms: [Self; 2], turn: [Self; 2]) -> Turning<Self> {
        turning_of_values(arms, turn)
    }

    /// `a − r̈` for a curve whose angular acceleration θ̈ is `theta_dd`:
    ///
    /// ```text
    /// r̈ = (∂r/∂θ) θ̈ − r θ̇²,   ∂r/∂θ = (p cos θ, −q sin θ)
    /// ```
    ///
    /// Along every solution θ̈ must be the time derivative of θ̇: a Taylor series computes the coefficients of r̈
    /// from those of ṙ one order higher.
    #[inline(always)]
    fn less_turning(a: [Self; 2], turning: Turning<Self>, theta_dd: Self) -> [Self; 2] {
        let Turning { along, rates, arms, omega, .. } = turning;
        less_turning_of_values(a, [along, rates, arms], omega, theta_dd)
    }

    /// Number of Newton iterations that take a root from the precision of an `f64` to the precision of this type.
    /// Each iteration doubles the number of digits and, for a Taylor series, the order.
    const NEWTON_STEPS: usize = 6;

    /// These numbers, if they are of the type `f64`: what is made for it alone, as machine code, is given them so.
    #[inline(always)]
    fn as_f64s(_numbers: &[Self]) -> Option<&[f64]> {
        None
    }

    /// These numbers to be written, if they are of the type `f64`.
    #[inline(always)]
    fn as_f64s_mut(_numbers: &mut [Self]) -> Option<&mut [f64]> {
        None
    }

    /// `f(self)` for a long function `f`, compiled to a function of its own so that its code does not slow down the
    /// code around the call.
    fn outlined<F: Function>(self, f: &F) -> Self {
        f.of(self)
    }

    /// `f(x)` for a long function of several numbers, as [`outlined`](Self::outlined).
    fn all_outlined<F: Functions<N, M>, const N: usize, const M: usize>(
        x: [Self; N],
        f: &F,
    ) -> [Self; M] {
        f.of(x)
    }
}

/// A number to divide by, with its reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Divisor<S> {
    /// The number.
    pub value: S,
    /// The reciprocal. Of a series it is valid at order zero only.
    pub(crate) reciprocal: S,
}

/// The length `ρ` of a vector `d` that moves with the velocity `v`.
#[derive(Clone, Copy, Debug)]
pub struct Length<S> {
    /// `ρ`.
    pub rho: Divisor<S>,
    /// `ρ̇ = d·v/ρ`.
    pub rate: S,
}

/// A point of a [curve](Real::turning) `r = (p sin θ, q cos θ)`.
#[derive(Debug)]
#[must_use]
pub struct Turning<S> {
    /// `sin θ`.
    pub sin: S,
    /// `cos θ`.
    pub cos: S,
    /// `∂r/∂θ = (p cos θ, −q sin θ)`.
    pub along: [S; 2],
    /// Rates of sine and cosine, `(cos θ θ̇, −sin θ θ̇)`.
    pub rates: [S; 2],
    /// `(p, q)`.
    pub(crate) arms: [S; 2],
    /// `θ̇`.
    pub(crate) omega: S,
}

/// [`Real::length`] by its definition.
#[inline(always)]
pub(crate) fn length_of_values<S: Real>(d: [S; 2], v: [S; 2]) -> Length<S> {
    let rho = (d[0] * d[0] + d[1] * d[1]).sqrt().divisor();
    Length { rho, rate: (d[0] * v[0] + d[1] * v[1]).over(&rho) }
}

/// [`Real::turning`] by its definition.
#[inline(always)]
pub(crate) fn turning_of_values<S: Real>(arms: [S; 2], [theta, omega]: [S; 2]) -> Turning<S> {
    let (sin, cos) = theta.sin_cos();
    let rates = [cos * omega, -(sin * omega)];
    Turning { sin, cos, along: [cos * arms[0], -(sin * arms[1])], rates, arms, omega }
}

/// [`Real::less_turning`] by its definition, from `[∂r/∂θ, rates of sine and cosine, arms]`. All terms without θ̈ are
/// computed first, so that the result is ready soon after θ̈ is known.
#[inline(always)]
pub(crate) fn less_turning_of_values<S: Real>(
    a: [S; 2],
    [along, rates, arms]: [[S; 2]; 3],
    omega: S,
    theta_dd: S,
) -> [S; 2] {
    let x = a[0] - rates[1] * omega * arms[0];
    let y = a[1] + rates[0] * omega * arms[1];
    [x - along[0] * theta_dd, y - along[1] * theta_dd]
}

/// A number to which constants of type `C` can be added and by which it can be multiplied. `C` is `f64` for any
/// number; a number of several runs at once also takes a constant per run.
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

/// `M` functions of `N` numbers, generic over the scalar type.
pub trait Functions<const N: usize, const M: usize> {
    /// Their values at `x`.
    fn of<S: Real>(&self, x: [S; N]) -> [S; M];
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

/// A function of one number, generic over the scalar type.
pub trait Function {
    /// Its value at `x`.
    fn of<S: Real>(&self, x: S) -> S;
}
