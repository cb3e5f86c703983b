//! The elementary functions that [`Real`] does not have, for every kind of number.
//!
//! Each function decides on the [value](Real::value) of its argument alone, so a Taylor series makes the same
//! operations at every order, and each is right to the precision of the number: f64, dual, double-double or series.

use deltazero_solvers::Real;
use deltazero_solvers::real::{Function, Functions};

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Elementary {
    Sqrt,
    /// The root of a sum of squares.
    Norm,
    Sin,
    Cos,
    Exp,
    Ln,
    Log10,
    Sinh,
    Cosh,
    Tanh,
    Abs,
    Sign,
}

impl Elementary {
    /// Its value.
    pub(crate) fn of<S: Real>(self, x: S) -> S {
        match self {
            Self::Sqrt => x.sqrt(),
            Self::Norm => norm(x),
            Self::Sin => x.sin_cos().0,
            Self::Cos => x.sin_cos().1,
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Log10 => x.ln() / S::cst(10.0).ln(),
            Self::Sinh => x.outlined(&Sinh),
            Self::Cosh => x.outlined(&Cosh),
            Self::Tanh => x.outlined(&Tanh),
            Self::Abs => abs(x),
            Self::Sign => sign(x),
        }
    }
}

/// √x of a sum of squares. Where it is zero its slope is taken for zero; a dual number would divide zero by zero. A Taylor
/// series has no such value, because its higher orders would be wrong.
fn norm<S: Real>(x: S) -> S {
    // One step: a number with its slope, or with its rounding, which is zero there, too.
    let is_of_first_order = S::NEWTON_STEPS == 1;
    if is_of_first_order && x.value() == 0.0 { S::cst(0.0) } else { x.sqrt() }
}

/// |x|; the branch at zero is that of positive numbers.
pub(crate) fn abs<S: Real>(x: S) -> S {
    if x.value() < 0.0 { -x } else { x }
}

/// −1, 0 or 1.
pub(crate) fn sign<S: Real>(x: S) -> S {
    let value = x.value();
    S::cst(if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        value
    })
}

/// The smaller one; the first where they are equal, NaN where one of them is.
pub(crate) fn smaller<S: Real>(a: S, b: S) -> S {
    if b.value() < a.value() || b.value().is_nan() { b } else { a }
}

/// The larger one; the first where they are equal, NaN where one of them is.
pub(crate) fn larger<S: Real>(a: S, b: S) -> S {
    if b.value() > a.value() || b.value().is_nan() { b } else { a }
}

/// `xᵖ`. Where p is above one and not whole, it is continued past zero as an odd function, −(−x)ᵖ, because a law of contact
/// `F = K δⁿ` is evaluated a little beyond its surface; below one it is NaN there.
pub(crate) fn power<S: Real>(x: S, p: f64) -> S {
    let is_whole = p.fract() == 0.0;
    if x.value() >= 0.0 || !(is_whole || p > 1.0) {
        x.powf(p)
    } else if is_whole && p % 2.0 == 0.0 {
        (-x).powf(p)
    } else {
        -(-x).powf(p)
    }
}

/// The angle of the point (x, y).
pub(crate) fn arc_tangent<S: Real>(y: S, x: S) -> S {
    let [angle] = S::all_outlined([y, x], &ArcTangent);
    angle
}

/// Magnitude below which sinh is summed as a series, because its exponentials cancel.
const SMALL: f64 = 0.5;
/// Terms of that series after which the next is below 1e-33 of the sum.
const SINH_TERMS: u32 = 13;

struct Sinh;

impl Function for Sinh {
    fn of<S: Real>(&self, x: S) -> S {
        if x.value().abs() > SMALL {
            let (up, down) = (x.exp(), (-x).exp());
            return (up - down) * 0.5;
        }
        // x (1 + x²/(2·3) (1 + x²/(4·5) (1 + …)))
        let square = x * x;
        let mut sum = square * 0.0 + 1.0;
        for n in (1..=SINH_TERMS).rev() {
            let n = 2.0 * f64::from(n);
            sum = (square * sum) / (n * (n + 1.0)) + 1.0;
        }
        x * sum
    }
}

struct Cosh;

impl Function for Cosh {
    fn of<S: Real>(&self, x: S) -> S {
        if x.value().abs() > SMALL {
            return (x.exp() + (-x).exp()) * 0.5;
        }
        // 1 + 2 sinh²(x/2), whose derivative is right near zero too.
        let sinh = Sinh.of(x * 0.5);
        sinh * sinh * 2.0 + 1.0
    }
}

struct Tanh;

impl Function for Tanh {
    fn of<S: Real>(&self, x: S) -> S {
        if x.value().abs() <= SMALL {
            let sinh = Sinh.of(x);
            return sinh / (sinh * sinh + 1.0).sqrt();
        }
        // (1 − q)/(1 + q) with q = e^(−2|x|), which cannot overflow.
        let is_below = x.value() < 0.0;
        let q = (if is_below { x * 2.0 } else { x * -2.0 }).exp();
        let tanh = (-q + 1.0) / (q + 1.0);
        if is_below { -tanh } else { tanh }
    }
}

/// Whether numbers of this kind have more digits than f64.
fn is_extended<S: Real>() -> bool {
    (S::cst(1.0) + f64::EPSILON / 16.0 - 1.0).value() != 0.0
}

/// `(y, x) ↦ atan2(y, x)`.
///
/// With φ₀ the angle of the values in f64, the rest `φ − φ₀ = atan z`, `z = (y cos φ₀ − x sin φ₀)/(x cos φ₀ + y sin φ₀)`, is
/// zero up to rounding, so that a short series gives it: one term of a number, and half as many as there are orders of a Taylor
/// series.
struct ArcTangent;

impl Functions<2, 1> for ArcTangent {
    fn of<S: Real>(&self, [y, x]: [S; 2]) -> [S; 1] {
        let angle = libm::atan2(y.value(), x.value());
        if S::NEWTON_STEPS == 0 {
            return [S::cst(angle)];
        }
        let (sin, cos) = S::cst(angle).sin_cos();
        let z = (y * cos - x * sin) / (x * cos + y * sin);
        // In plain precision the value of z is the rounding error of this formula.
        let z = if is_extended::<S>() { z } else { z - z.value() };
        // atan z = z (1 − z²/3 + z⁴/5 − …)
        let terms = if S::NEWTON_STEPS <= 2 { 0 } else { 1 << (S::NEWTON_STEPS - 2) };
        let square = z * z;
        let mut sum = square * 0.0 + 1.0;
        for n in (1..=terms).rev() {
            sum = -(square * sum_step(sum, n)) + 1.0;
        }
        [z * sum + angle]
    }
}

/// One step of Horner's scheme for `Σ (−w)ⁿ/(2n + 1)`, whose term n is `(2n − 1)/(2n + 1)` times the one before.
fn sum_step<S: Real>(sum: S, n: u32) -> S {
    let n = f64::from(n);
    (sum * (2.0 * n - 1.0)) / (2.0 * n + 1.0)
}
