//! Dual numbers of several runs: [`Dual64`] of each, with the same bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

use super::scalar::Lanes;
use crate::real::{Function, Real};

/// Values and their derivatives along one direction each.
#[derive(Clone, Copy, Debug)]
pub struct DualLanes {
    /// Values.
    pub re: Lanes,
    /// Derivatives.
    pub eps: Lanes,
}

impl DualLanes {
    /// Of values and derivatives.
    #[inline(always)]
    pub fn new(re: Lanes, eps: Lanes) -> Self {
        Self { re, eps }
    }

    fn map(self, f: impl Fn(Dual64) -> Dual64) -> Self {
        let (re, eps) = (self.re.each(), self.eps.each());
        let each: [_; _] = std::array::from_fn(|i| f(Dual64::new(re[i], eps[i])));
        Self::new(Lanes::new(each.map(|dual| dual.re)), Lanes::new(each.map(|dual| dual.eps)))
    }
}

impl Neg for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.eps)
    }
}

impl Add for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.eps + other.eps)
    }
}

impl Sub for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.eps - other.eps)
    }
}

impl Mul for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re, self.eps * other.re + other.eps * self.re)
    }
}

impl Div for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = Lanes::cst(1.0) / other.re;
        let change = self.eps * other.re - other.eps * self.re;
        Self::new(self.re * inverse, change * inverse * inverse)
    }
}

impl Add<f64> for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self::new(self.re + other, self.eps)
    }
}

impl Sub<f64> for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self::new(self.re - other, self.eps)
    }
}

impl Mul<f64> for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self::new(self.re * other, self.eps * other)
    }
}

impl Div<f64> for DualLanes {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Self::new(self.re / other, self.eps / other)
    }
}

impl Real for DualLanes {
    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self::new(Lanes::cst(x), Lanes::cst(0.0))
    }

    fn value(self) -> f64 {
        self.re.value()
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Self::new(root, self.eps / (root * 2.0))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (Self::new(sin, cos * self.eps), Self::new(cos, -sin * self.eps))
    }

    fn exp(self) -> Self {
        self.map(Real::exp)
    }

    fn ln(self) -> Self {
        self.map(Real::ln)
    }

    fn powf(self, a: f64) -> Self {
        self.map(|x| Real::powf(x, a))
    }

    fn apart<F: Function>(self, f: &F) -> Self {
        self.map(|x| f.of(x))
    }
}

#[cfg(test)]
mod tests {
    use super::super::scalar::LANES;
    use super::*;

    /// Every operation, in numbers of any kind.
    struct Everything;

    impl Function for Everything {
        fn of<S: Real>(&self, x: S) -> S {
            let (sin, cos) = (x * 0.7).sin_cos();
            let quotient = (sin + 1.0) / (cos - x * 0.1) - -x / 3.0;
            (x.sqrt() + quotient * quotient).ln() + x.powf(1.7) * (x - 2.0).exp()
        }
    }

    #[test]
    fn each_run_has_the_dual_number_that_it_has_alone() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..1000 {
            let each: [f64; LANES] = std::array::from_fn(|_| 1.1 * random.f64());
            let rates: [f64; LANES] = std::array::from_fn(|_| random.f64() - 0.5);
            let of = |x: DualLanes| (x.re.each(), x.eps.each());
            let lanes = DualLanes::new(Lanes::new(each), Lanes::new(rates));
            let ((re, eps), (apart, apart_eps)) =
                (of(Everything.of(lanes)), of(lanes.apart(&Everything)));
            for i in 0..LANES {
                let alone = Everything.of(Dual64::new(each[i], rates[i]));
                let expected = [alone.re, alone.eps].map(f64::to_bits);
                assert_eq!([re[i], eps[i]].map(f64::to_bits), expected);
                assert_eq!([apart[i], apart_eps[i]].map(f64::to_bits), expected);
                let plain = Everything.of(Lanes::new(each)).each()[i];
                assert_eq!(plain.to_bits(), Everything.of(each[i]).to_bits());
            }
        }
    }
}
