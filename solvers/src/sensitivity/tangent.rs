//! Numbers with their derivative along one direction, over any scalar.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Real, Shortcuts};

/// A number and its derivative along one direction. The scalar may be a Taylor series, or such a number again, for
/// which there are no dual numbers in `num-dual`. The number itself is computed as without the derivative, to the bit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent<S> {
    /// The number.
    pub(crate) re: S,
    /// Its derivative.
    pub(crate) eps: S,
}

impl<S: Real> Tangent<S> {
    pub(crate) fn new(re: S, eps: S) -> Self {
        Self { re, eps }
    }

    pub(crate) fn constant(re: S) -> Self {
        Self { re, eps: S::cst(0.0) }
    }
}

impl<S: Real> Neg for Tangent<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.eps)
    }
}

/// An operation with another number, and one with a constant, by the derivatives of their results.
macro_rules! operator {
    ($Trait:ident::$name:ident, |$x:ident, $y:ident| $by_number:expr, |$z:ident, $c:ident| $by_constant:expr) => {
        impl<S: Real> $Trait for Tangent<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, $y: Self) -> Self {
                let ($x, re) = (self, self.re.$name($y.re));
                Self::new(re, $by_number(re))
            }
        }

        impl<S: Real> $Trait<f64> for Tangent<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, $c: f64) -> Self {
                let $z = self;
                Self::new($z.re.$name($c), $by_constant)
            }
        }
    };
}

operator!(Add::add, |x, y| |_| x.eps + y.eps, |x, _c| x.eps);
operator!(Sub::sub, |x, y| |_| x.eps - y.eps, |x, _c| x.eps);
operator!(Mul::mul, |x, y| |_| x.eps * y.re + x.re * y.eps, |x, c| x.eps * c);
operator!(Div::div, |x, y| |quotient| (x.eps - y.eps * quotient) / y.re, |x, c| x.eps / c);

impl<S: Real> Real for Tangent<S> {
    const NEWTON_STEPS: usize = S::NEWTON_STEPS + 1;

    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self::constant(S::cst(x))
    }

    fn value(self) -> f64 {
        self.re.value()
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        let rests = root.value() == 0.0 && self.eps.value() == 0.0;
        Self::new(root, if rests { self.eps * 0.0 } else { self.eps / (root * 2.0) })
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (Self::new(sin, cos * self.eps), Self::new(cos, -(sin * self.eps)))
    }

    fn exp(self) -> Self {
        let e = self.re.exp();
        Self::new(e, e * self.eps)
    }

    fn ln(self) -> Self {
        Self::new(self.re.ln(), self.eps / self.re)
    }

    fn powf(self, a: f64) -> Self {
        let rests = self.re.value() == 0.0 && (self.eps.value() == 0.0 || a == 0.0);
        let eps = if rests { self.eps * 0.0 } else { self.re.powf(a - 1.0) * self.eps * a };
        Self::new(self.re.powf(a), eps)
    }
}

impl<S: Real> Shortcuts for Tangent<S> {}

#[cfg(test)]
mod tests {
    use super::*;

    fn derivatives(x: f64) -> impl Iterator<Item = [f64; 2]> {
        let once = |f: &dyn Fn(Tangent<Tangent<f64>>) -> Tangent<Tangent<f64>>| {
            let y = f(Tangent::new(Tangent::new(x, 1.0), Tangent::constant(1.0)));
            assert_eq!(y.re.eps, y.eps.re);
            [y.re.eps, y.eps.eps]
        };
        let found = [
            once(&|x| x * x * x - x),
            once(&|x| (x * 2.0 + 1.0) / x),
            once(&|x| -x.sqrt() / 4.0),
            once(&|x| x.sin_cos().0),
            once(&|x| x.sin_cos().1),
            once(&|x| (x - 0.5).exp()),
            once(&Real::ln),
            once(&|x| x.powf(2.5)),
        ];
        found.into_iter()
    }

    #[test]
    fn first_and_second_derivatives_agree_with_closed_forms() {
        let x: f64 = 0.7;
        let (sin, cos, e) = (x.sin(), x.cos(), (x - 0.5).exp());
        let expected = [
            [3.0 * x * x - 1.0, 6.0 * x],
            [-1.0 / (x * x), 2.0 / (x * x * x)],
            [-0.125 / x.sqrt(), 0.0625 / (x * x.sqrt())],
            [cos, -sin],
            [-sin, -cos],
            [e, e],
            [1.0 / x, -1.0 / (x * x)],
            [2.5 * x.powf(1.5), 3.75 * x.sqrt()],
        ];
        for (found, expected) in derivatives(x).zip(expected) {
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 3e-15, "{found} against {expected}");
            }
        }
    }
}
