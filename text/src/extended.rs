//! Quotients, roots, exponentials and logarithms that keep all digits of numbers with more digits than f64.
//!
//! The pairs of f64 of the crate `twofloat` (0.8) lose digits there: measured against 60 digits, a quotient of two pairs
//! is right to 2e-17, an exponential to 2e-14. Each function here takes that result where numbers have the digits of f64, to
//! the bit, and otherwise corrects it by a step of Newton's iteration or computes it anew.

use deltazero_solvers::Real;

/// Whether numbers of this kind have more digits than f64.
#[inline(always)]
pub(crate) fn is_extended<S: Real>() -> bool {
    (S::cst(1.0) + f64::EPSILON / 16.0 - 1.0).value() != 0.0
}

/// `a/b`.
#[inline(always)]
pub(crate) fn quotient<S: Real>(a: S, b: S) -> S {
    let quotient = a / b;
    if is_extended::<S>() { quotient + (a - quotient * b) / b } else { quotient }
}

/// `a/c`.
#[inline(always)]
pub(crate) fn over<S: Real>(a: S, c: f64) -> S {
    if is_extended::<S>() { quotient(a, S::cst(c)) } else { a / c }
}

/// `√x`.
#[inline(always)]
pub(crate) fn root<S: Real>(x: S) -> S {
    let root = x.sqrt();
    if is_extended::<S>() && root.value() > 0.0 {
        root + (x - root * root) / (root * 2.0)
    } else {
        root
    }
}

/// `eˣ`.
#[inline(always)]
pub(crate) fn exponential<S: Real>(x: S) -> S {
    let value = x.value();
    if is_extended::<S>() && value.abs() < LARGEST {
        // The exponential of the rest, which is below one unit of rounding, has all digits.
        (x - value).exp() * exponential_of_value::<S>(value)
    } else {
        x.exp()
    }
}

/// `ln x`.
#[inline(always)]
pub(crate) fn logarithm<S: Real>(x: S) -> S {
    let value = libm::log(x.value());
    if is_extended::<S>() && value.abs() < LARGEST {
        (x * exponential_of_value::<S>(-value)).ln() + value
    } else {
        x.ln()
    }
}

/// `xᵖ`.
#[inline(always)]
pub(crate) fn raised<S: Real>(x: S, p: f64) -> S {
    if is_extended::<S>() && x.value() > 0.0 { exponential(logarithm(x) * p) } else { x.powf(p) }
}

/// Exponents whose exponential is neither infinite nor below the normal numbers.
const LARGEST: f64 = 700.0;
/// Halvings of the exponent, after which it is below 0.05.
const HALVINGS: i32 = 14;
/// Terms of the series of the halved exponent, of which the last is below 1e-34.
const TERMS: u32 = 16;

/// `eˣ` of a constant x: `e^r − 1` of `r = x/2ⁿ` by its series, then doubled n times by `e^(2r) − 1 = (e^r − 1)(e^r + 1)`.
fn exponential_of_value<S: Real>(x: f64) -> S {
    let r = S::cst(libm::ldexp(x, -HALVINGS));
    let mut sum = S::cst(1.0);
    for n in (2..=TERMS).rev() {
        sum = over(r * sum, f64::from(n)) + 1.0;
    }
    let mut less_one = r * sum;
    for _ in 0..HALVINGS {
        less_one = less_one * (less_one + 2.0);
    }
    less_one + 1.0
}
