//! Dual numbers of several runs: [`Dual64`] of each, with the same bits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

use super::scalar::{LANES, Lanes, Own, Simd};
use crate::real::{Function, Over, Real};

/// Values and their derivatives along one direction each.
#[derive(Clone, Copy, Debug)]
pub struct DualLanes<V> {
    /// Values.
    pub re: Lanes<V>,
    /// Derivatives.
    pub eps: Lanes<V>,
}

impl<V: Simd> DualLanes<V> {
    /// Of values and derivatives.
    #[inline(always)]
    pub fn new(re: Lanes<V>, eps: Lanes<V>) -> Self {
        Self { re, eps }
    }

    fn map(self, f: impl Fn(Dual64) -> Dual64) -> Self {
        let mut eps = [0.0; LANES];
        let re = Lanes::from_fn(|i| {
            let each = f(Dual64::new(self.re.lane(i), self.eps.lane(i)));
            eps[i] = each.eps;
            each.re
        });
        Self::new(re, Lanes::from_fn(|i| eps[i]))
    }
}

impl<V: Simd> Neg for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.eps)
    }
}

impl<V: Simd> Add for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.eps + other.eps)
    }
}

impl<V: Simd> Sub for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.eps - other.eps)
    }
}

impl<V: Simd> Mul for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re, self.eps * other.re + other.eps * self.re)
    }
}

impl<V: Simd> Div for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = Lanes::cst(1.0) / other.re;
        let change = self.eps * other.re - other.eps * self.re;
        Self::new(self.re * inverse, change * inverse * inverse)
    }
}

impl<V: Simd> Add<f64> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self::new(self.re + other, self.eps)
    }
}

impl<V: Simd> Sub<f64> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self::new(self.re - other, self.eps)
    }
}

impl<V: Simd> Mul<f64> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self::new(self.re * other, self.eps * other)
    }
}

impl<V: Simd> Div<f64> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Self::new(self.re / other, self.eps / other)
    }
}

impl<V: Simd> Add<Own<V>> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, own: Own<V>) -> Self {
        Self::new(self.re + own, self.eps)
    }
}

impl<V: Simd> Sub<Own<V>> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, own: Own<V>) -> Self {
        Self::new(self.re - own, self.eps)
    }
}

impl<V: Simd> Mul<Own<V>> for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, own: Own<V>) -> Self {
        Self::new(self.re * own, self.eps * own)
    }
}

impl<V: Simd> Over<Own<V>> for DualLanes<V> {
    #[inline(always)]
    fn of(constant: Own<V>) -> Self {
        Self::new(constant.number(), Lanes::cst(0.0))
    }
}

impl<V: Simd> Real for DualLanes<V> {
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

    fn outlined<F: Function>(self, f: &F) -> Self {
        self.map(|x| f.of(x))
    }
}

#[cfg(test)]
mod tests {
    use wide::{f64x2, f64x8};

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
        each_run_has_its_own::<f64x8>();
        each_run_has_its_own::<f64x2>();
    }

    fn each_run_has_its_own<V: Simd>() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..1000 {
            let each: [f64; LANES] = std::array::from_fn(|_| 1.1 * random.f64());
            let rates: [f64; LANES] = std::array::from_fn(|_| random.f64() - 0.5);
            let value = Lanes::<V>::from_fn(|i| each[i]);
            let lanes = DualLanes::new(value, Lanes::from_fn(|i| rates[i]));
            let own = Own::<V>::from_fn(|i| rates[i]);
            let (whole, outlined) = (Everything.of(lanes), lanes.outlined(&Everything));
            let with_own = (lanes + own) * own - own;
            for i in 0..V::N {
                let alone = Dual64::new(each[i], rates[i]);
                let bits = |x: DualLanes<V>| [x.re, x.eps].map(|x| x.lane(i).to_bits());
                let expected = |x: Dual64| [x.re, x.eps].map(f64::to_bits);
                assert_eq!(bits(whole), expected(Everything.of(alone)));
                assert_eq!(bits(outlined), expected(Everything.of(alone)));
                assert_eq!(bits(with_own), expected((alone + rates[i]) * rates[i] - rates[i]));
                let plain = Everything.of(value).lane(i);
                assert_eq!(plain.to_bits(), Everything.of(each[i]).to_bits());
            }
        }
    }
}
