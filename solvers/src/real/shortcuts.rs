//! What a right-hand side may call to be faster, and must then keep to.

use std::fmt::Debug;

use super::Real;

/// Terms that a [`Real`] number may compute faster than by its operators: a Taylor series saves sums, a number of several runs its
/// registers. Each has a default by the operators, which every other number takes.
///
/// No model needs them. One that uses them promises what each asks for, and
/// [`check`](crate::contracts::check) finds a promise that it does not keep.
///
/// ```
/// use deltazero_solvers::real::Shortcuts;
///
/// let length = f64::length([3.0, 4.0], [5.0, 0.0]);
/// assert_eq!((length.rho.value, length.rate), (5.0, 3.0));
/// assert_eq!(10.0_f64.over(&length.rho), 2.0);
/// // On a circle of radius 2 m, at 3 rad/s: r = (0, 2), r̈ = (0, −18).
/// let turning = f64::turning([2.0, 2.0], [0.0, 3.0]);
/// assert_eq!(f64::less_turning([0.0, 0.0], turning, 0.0), [0.0, 18.0]);
/// ```
pub trait Shortcuts: Copy + Debug {
    /// This number prepared as a [divisor](Self::over), with its reciprocal.
    #[inline(always)]
    fn divisor(self) -> Divisor<Self>
    where
        Self: Real,
    {
        Divisor { value: self, reciprocal: Self::cst(1.0) / self }
    }

    /// `self/by`, computed as a product with the reciprocal, which can be computed before `self` is known. The result
    /// is rounded twice, and is not finite where the reciprocal is not. A Taylor series divides instead, and expands
    /// no reciprocal.
    #[inline(always)]
    fn over(self, by: &Divisor<Self>) -> Self
    where
        Self: Real,
    {
        self * by.reciprocal
    }

    /// The length `ρ = √(d·d)` of the plane vector `d`, and its rate ρ̇. The vector `v` must be the time derivative
    /// of `d` along every solution: a Taylor series computes the coefficients of ρ from those of ρ̇, so another `v`
    /// gives wrong coefficients. Where `d` is zero, ρ̇ and quotients by ρ are not finite.
    #[inline(always)]
    fn length(d: [Self; 2], v: [Self; 2]) -> Length<Self>
    where
        Self: Real,
    {
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
    fn turning(arms: [Self; 2], turn: [Self; 2]) -> Turning<Self>
    where
        Self: Real,
    {
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
    fn less_turning(a: [Self; 2], turning: Turning<Self>, theta_dd: Self) -> [Self; 2]
    where
        Self: Real,
    {
        let Turning { along, rates, arms, omega, .. } = turning;
        less_turning_of_values(a, [along, rates, arms], omega, theta_dd)
    }

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
    fn outlined<F: Function>(self, f: &F) -> Self
    where
        Self: Real,
    {
        f.of(self)
    }

    /// `f(x)` for a long function of several numbers, as [`outlined`](Self::outlined).
    fn all_outlined<F: Functions<N, M>, const N: usize, const M: usize>(
        x: [Self; N],
        f: &F,
    ) -> [Self; M]
    where
        Self: Real,
    {
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

/// A point of a [curve](Shortcuts::turning) `r = (p sin θ, q cos θ)`.
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

/// [`Shortcuts::length`] by its definition.
#[inline(always)]
pub(crate) fn length_of_values<S: Real>(d: [S; 2], v: [S; 2]) -> Length<S> {
    let rho = (d[0] * d[0] + d[1] * d[1]).sqrt().divisor();
    Length { rho, rate: (d[0] * v[0] + d[1] * v[1]).over(&rho) }
}

/// [`Shortcuts::turning`] by its definition.
#[inline(always)]
pub(crate) fn turning_of_values<S: Real>(arms: [S; 2], [theta, omega]: [S; 2]) -> Turning<S> {
    let (sin, cos) = theta.sin_cos();
    let rates = [cos * omega, -(sin * omega)];
    Turning { sin, cos, along: [cos * arms[0], -(sin * arms[1])], rates, arms, omega }
}

/// [`Shortcuts::less_turning`] by its definition, from `[∂r/∂θ, rates of sine and cosine, arms]`. All terms without θ̈ are
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

/// `M` functions of `N` numbers, generic over the scalar type.
pub trait Functions<const N: usize, const M: usize> {
    /// Their values at `x`.
    fn of<S: Real>(&self, x: [S; N]) -> [S; M];
}

/// A function of one number, generic over the scalar type.
pub trait Function {
    /// Its value at `x`.
    fn of<S: Real>(&self, x: S) -> S;
}
