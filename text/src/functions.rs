//! The functions of formulas, for every kind of number.

use deltazero_solvers::Real;

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
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Abs => x.abs(),
            Self::Sign => x.sign(),
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
