//! The numbers themselves, and numbers with a derivative.

use num_dual::Dual64;

use super::{Ordered, Real, Shortcuts};

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

    #[inline]
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

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
}

impl Shortcuts for f64 {
    #[inline(always)]
    fn as_f64s(numbers: &[Self]) -> Option<&[f64]> {
        Some(numbers)
    }

    #[inline(always)]
    fn as_f64s_mut(numbers: &mut [Self]) -> Option<&mut [f64]> {
        Some(numbers)
    }
}

impl Ordered for f64 {
    type Mask = bool;

    fn lesser(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    fn is_above(self, other: Self) -> bool {
        self > other
    }
}

impl Shortcuts for Dual64 {}

/// A value and its derivative along one direction (forward-mode differentiation).
impl Real for Dual64 {
    const NEWTON_STEPS: usize = 1;

    #[inline]
    fn cst(x: f64) -> Self {
        Self::from_re(x)
    }

    fn value(self) -> f64 {
        self.re
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        let rests = root == 0.0 && self.eps == 0.0;
        Self::new(root, if rests { 0.0 } else { self.eps / (2.0 * root) })
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
        let rests = self.re == 0.0 && (self.eps == 0.0 || a == 0.0);
        let eps = if rests { 0.0 } else { a * libm::pow(self.re, a - 1.0) * self.eps };
        Self::new(libm::pow(self.re, a), eps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::Tangent;

    /// Functions that are steep at zero, of a number there.
    fn steep<S: Real>(x: S) -> [S; 6] {
        let one = x * x + 1.0;
        [x.sqrt(), (x * x).sqrt(), x.powf(0.5), x.powf(0.0), one.asin(), one.acos()]
    }

    #[test]
    fn what_rests_at_zero_has_the_slope_zero() {
        assert_eq!(steep(Dual64::cst(0.0)).map(|x| x.eps), [0.0; 6]);
        assert_eq!(steep(Tangent::<f64>::cst(0.0)).map(|x| x.eps), [0.0; 6]);
        let [root, of_square, power, one, ..] = steep(Dual64::new(0.0, 1.0)).map(|x| x.eps);
        assert_eq!([root, of_square, power, one], [f64::INFINITY, 0.0, f64::INFINITY, 0.0]);
    }

    #[test]
    fn dual_derivatives_agree_with_closed_forms() {
        let x = 0.7;
        let d = Dual64::new(x, 1.0);
        let (sin, cos) = d.sin_cos();
        let pairs = [
            (Real::sqrt(d).eps, 0.5 / x.sqrt()),
            (sin.eps, x.cos()),
            (cos.eps, -x.sin()),
            (Real::sin(d).eps, x.cos()),
            (Real::cos(d).eps, -x.sin()),
            (Real::tan(d).eps, 1.0 + x.tan() * x.tan()),
            (Real::powi(d, 0).eps, 0.0),
            (Real::powi(d, 5).eps, 5.0 * x.powi(4)),
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
