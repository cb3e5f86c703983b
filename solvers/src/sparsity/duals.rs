//! Dual numbers along several directions at once: along each the bits of a [`Dual64`](num_dual::Dual64).

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Real, Shortcuts};

/// Number of directions.
pub(super) const DIRECTIONS: usize = 8;

/// A value and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Duals {
    pub(super) re: f64,
    pub(super) eps: [f64; DIRECTIONS],
}

impl Duals {
    #[inline(always)]
    fn new(re: f64, eps: impl FnMut(usize) -> f64) -> Self {
        Self { re, eps: std::array::from_fn(eps) }
    }
}

impl Neg for Duals {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, |k| -self.eps[k])
    }
}

/// A sum or a difference, with another number and with a constant.
macro_rules! sum {
    ($Trait:ident::$name:ident) => {
        impl $Trait for Duals {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::new(self.re.$name(other.re), |k| self.eps[k].$name(other.eps[k]))
            }
        }

        impl $Trait<f64> for Duals {
            type Output = Self;

            #[inline(always)]
            fn $name(self, constant: f64) -> Self {
                Self { re: self.re.$name(constant), ..self }
            }
        }
    };
}

sum!(Add::add);
sum!(Sub::sub);

/// `ab + cd`, the derivative of a product.
#[inline(always)]
fn sum_of_products([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * b + c * d
}

impl Mul for Duals {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let derivative = |k| sum_of_products([self.eps[k], other.re], [other.eps[k], self.re]);
        Self::new(self.re * other.re, derivative)
    }
}

impl Div for Duals {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.re;
        Self::new(self.re * inverse, |k| {
            (self.eps[k] * other.re - other.eps[k] * self.re) * inverse * inverse
        })
    }
}

impl Mul<f64> for Duals {
    type Output = Self;

    #[inline(always)]
    fn mul(self, constant: f64) -> Self {
        Self::new(self.re * constant, |k| self.eps[k] * constant)
    }
}

impl Div<f64> for Duals {
    type Output = Self;

    #[inline(always)]
    fn div(self, constant: f64) -> Self {
        Self::new(self.re / constant, |k| self.eps[k] / constant)
    }
}

impl Real for Duals {
    const NEWTON_STEPS: usize = 1;

    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self { re: x, eps: [0.0; DIRECTIONS] }
    }

    fn value(self) -> f64 {
        self.re
    }

    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        let rests = |k: usize| root == 0.0 && self.eps[k] == 0.0;
        Self::new(root, |k| if rests(k) { 0.0 } else { self.eps[k] / (2.0 * root) })
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.re);
        (Self::new(sin, |k| cos * self.eps[k]), Self::new(cos, |k| -sin * self.eps[k]))
    }

    fn exp(self) -> Self {
        let e = Real::exp(self.re);
        Self::new(e, |k| e * self.eps[k])
    }

    fn ln(self) -> Self {
        Self::new(Real::ln(self.re), |k| self.eps[k] / self.re)
    }

    fn powf(self, a: f64) -> Self {
        let slope = a * Real::powf(self.re, a - 1.0);
        let rests = |k: usize| self.re == 0.0 && (self.eps[k] == 0.0 || a == 0.0);
        Self::new(Real::powf(self.re, a), |k| if rests(k) { 0.0 } else { slope * self.eps[k] })
    }
}

impl Shortcuts for Duals {}
