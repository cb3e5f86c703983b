//! The scalar that a right-hand side and its guards are written over.
//!
//! A model is written once, generic over [`Real`]: plain `f64` integrates it, a dual number
//! differentiates it, an extended-precision number refines it, Taylor coefficients expand it.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Sub};

use num_dual::Dual64;
use twofloat::TwoFloat;

/// A real number, or something that computes like one.
///
/// Elementary functions of `f64` come from `libm`, not from the platform, so that the same input
/// gives the same bits on every machine.
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

    /// The nearest `f64`: what a decision (a sign, a branch) is taken on.
    fn value(self) -> f64;

    /// Square root; NaN below zero.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Exponential.
    fn exp(self) -> Self;

    /// Natural logarithm; NaN below zero.
    fn ln(self) -> Self;

    /// `selfᵃ` for a base of at least zero.
    fn powf(self, a: f64) -> Self;

    /// This number as one that others are [divided by](Self::over).
    #[inline(always)]
    fn divisor(self) -> Divisor<Self> {
        Divisor { value: self, reciprocal: Self::cst(1.0) / self }
    }

    /// `self/by`, as a product with the reciprocal, which does not wait for `self`: rounded twice, and not finite
    /// where the reciprocal is not. What expands divides, and makes no series of the reciprocal.
    #[inline(always)]
    fn over(self, by: &Divisor<Self>) -> Self {
        self * by.reciprocal
    }

    /// The length `ρ = √(d·d)` of the plane vector `d`, of which `v` is the rate along every solution: what
    /// expands makes the coefficients of ρ from those of ρ̇, and another `v` would make them wrong. Where `d` is
    /// zero, quotients by ρ, and ρ̇, are not finite.
    #[inline(always)]
    fn length(d: [Self; 2], v: [Self; 2]) -> Length<Self> {
        length_of_values(d, v)
    }

    /// The curve `r = (p sin θ, q cos θ)` at `turn = (θ, θ̇)`, for its second derivative by
    /// [`less_turning`](Self::less_turning); `arms = (p, q)` are constants.
    ///
    /// Along every solution θ̇ has to be the rate of θ. An evaluation that begins a curve has to end it, so guards
    /// cannot have one: what expands keeps coefficients from there to the next order, and else those from order
    /// one on are wrong.
    ///
    /// # Panics
    /// In a build with debug assertions, where a series finds that it was not ended.
    #[inline(always)]
    fn turning(arms: [Self; 2], turn: [Self; 2]) -> Turning<Self> {
        turning_of_values(arms, turn)
    }

    /// `a − r̈`, of a curve whose θ̈ is `theta_dd`:
    ///
    /// ```text
    /// r̈ = (∂r/∂θ) θ̈ − r θ̇²,   ∂r/∂θ = (p cos θ, −q sin θ)
    /// ```
    ///
    /// Along every solution θ̈ has to be the rate of θ̇: what expands makes the coefficients of r̈ from those of ṙ
    /// one order ahead.
    #[inline(always)]
    fn less_turning(a: [Self; 2], turning: Turning<Self>, theta_dd: Self) -> [Self; 2] {
        let Turning { along, rates, arms, omega, .. } = turning;
        less_turning_of_values(a, [along, rates, arms], omega, theta_dd)
    }

    /// Iterations of Newton's by which a root known to the digits of an `f64` has all of this number: each
    /// doubles digits and, of what expands, orders.
    const NEWTON_STEPS: usize = 6;

    /// `f(self)`, where `f` is long: code of its own, which does not slow down what is around it.
    fn outlined<F: Function>(self, f: &F) -> Self {
        f.of(self)
    }

    /// `f(x)` of several numbers, where `f` is long: as [`outlined`](Self::outlined).
    fn all_outlined<F: Functions<N, M>, const N: usize, const M: usize>(
        x: [Self; N],
        f: &F,
    ) -> [Self; M] {
        f.of(x)
    }
}

/// A number that others are divided by, with its reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Divisor<S> {
    /// The number.
    pub value: S,
    /// Its reciprocal; of a series good for order zero alone.
    pub(crate) reciprocal: S,
}

/// A length `ρ` of a vector `d` that moves at `v`.
#[derive(Clone, Copy, Debug)]
pub struct Length<S> {
    /// `ρ`.
    pub rho: Divisor<S>,
    /// `ρ̇ = d·v/ρ`.
    pub rate: S,
}

/// A [curve](Real::turning) `r = (p sin θ, q cos θ)` where it is.
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

/// [`Real::less_turning`] by its definition, of `[∂r/∂θ, rates of sine and cosine, arms]`: all that does not wait for
/// θ̈ first.
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

/// A number that constants of the kind `C` are added to and multiplied with: `f64` of any, and of the number of
/// several runs a constant of each.
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

/// `M` functions of `N` numbers, written over any.
pub trait Functions<const N: usize, const M: usize> {
    /// Their values at `x`.
    fn of<S: Real>(&self, x: [S; N]) -> [S; M];
}

/// A number that decisions are taken on, of one run or of each of several.
pub trait Ordered: Real {
    /// What a comparison gives: yes or no, of each.
    type Mask: Copy + BitAnd<Output = Self::Mask>;

    /// Yes, of all.
    const YES: Self::Mask;

    /// Absolute value.
    fn abs(self) -> Self;

    /// The larger one; the other where one is not a number.
    fn max(self, other: Self) -> Self;

    /// Whether it is above `other`.
    fn is_above(self, other: Self) -> Self::Mask;
}

/// A function of one number, written over any.
pub trait Function {
    /// Its value at `x`.
    fn of<S: Real>(&self, x: S) -> S;
}

impl Real for f64 {
    const NEWTON_STEPS: usize = 0;

    fn cst(x: f64) -> Self {
        x
    }

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }

    fn exp(self) -> Self {
        libm::exp(self)
    }

    fn ln(self) -> Self {
        libm::log(self)
    }

    fn powf(self, a: f64) -> Self {
        libm::pow(self, a)
    }
}

impl Ordered for f64 {
    type Mask = bool;

    const YES: bool = true;

    fn abs(self) -> Self {
        self.abs()
    }

    fn max(self, other: Self) -> Self {
        self.max(other)
    }

    fn is_above(self, other: Self) -> bool {
        self > other
    }
}

/// A value and its derivative along one direction (forward-mode differentiation).
impl Real for Dual64 {
    const NEWTON_STEPS: usize = 1;

    fn cst(x: f64) -> Self {
        Self::from_re(x)
    }

    fn value(self) -> f64 {
        self.re
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Self::new(root, self.eps / (2.0 * root))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = libm::sincos(self.re);
        (Self::new(sin, cos * self.eps), Self::new(cos, -sin * self.eps))
    }

    fn exp(self) -> Self {
        let e = libm::exp(self.re);
        Self::new(e, e * self.eps)
    }

    fn ln(self) -> Self {
        Self::new(libm::log(self.re), self.eps / self.re)
    }

    fn powf(self, a: f64) -> Self {
        Self::new(libm::pow(self.re, a), a * libm::pow(self.re, a - 1.0) * self.eps)
    }
}

/// A sum of two `f64`: some 31 digits, for finite values.
impl Real for TwoFloat {
    const NEWTON_STEPS: usize = 2;

    fn cst(x: f64) -> Self {
        Self::from(x)
    }

    fn value(self) -> f64 {
        self.hi()
    }

    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    fn sin_cos(self) -> (Self, Self) {
        Self::sin_cos(self)
    }

    fn exp(self) -> Self {
        Self::exp(self)
    }

    fn ln(self) -> Self {
        Self::ln(self)
    }

    fn powf(self, a: f64) -> Self {
        Self::powf(self, Self::from(a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dual_derivatives_agree_with_closed_forms() {
        let x = 0.7;
        let d = Dual64::new(x, 1.0);
        let (sin, cos) = d.sin_cos();
        let pairs = [
            (Real::sqrt(d).eps, 0.5 / x.sqrt()),
            (sin.eps, x.cos()),
            (cos.eps, -x.sin()),
            (Real::exp(d).eps, x.exp()),
            (Real::ln(d).eps, 1.0 / x),
            (Real::powf(d, 1.5).eps, 1.5 * x.sqrt()),
            ((d * d / (d + 1.0)).eps, (x * x + 2.0 * x) / (x + 1.0).powi(2)),
        ];
        for (found, expected) in pairs {
            assert!((found - expected).abs() < 1e-15, "{found} against {expected}");
        }
    }
}
