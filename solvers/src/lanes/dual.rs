//! Dual numbers in lanes: in each lane the bits of a [`Dual64`].

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

use super::{LANES, Lanes, Simd};
use crate::real::{Over, Real, Shortcuts};

/// Values and their derivatives along one direction each.
///
/// ```
/// use deltazero_solvers::Real;
/// use deltazero_solvers::lanes::Lanes;
/// use deltazero_solvers::lanes::dual::DualLanes;
/// use wide::f64x2;
///
/// let x = Lanes::<f64x2>::from_fn(|i| [1.0, 2.0][i]);
/// let cube = DualLanes::new(x, Lanes::cst(1.0)).powi(3);
/// assert_eq!((cube.re.lane(1), cube.eps.lane(1)), (8.0, 12.0));
/// ```
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

    fn lane(&self, i: usize) -> Dual64 {
        Dual64::new(self.re.lane(i), self.eps.lane(i))
    }

    fn from_fn(each: impl Fn(usize) -> Dual64) -> Self {
        let mut eps = [0.0; LANES];
        let re = Lanes::from_fn(|i| {
            let each = each(i);
            eps[i] = each.eps;
            each.re
        });
        Self::new(re, Lanes::from_fn(|i| eps[i]))
    }

    fn map(self, f: impl Fn(Dual64) -> Dual64) -> Self {
        Self::from_fn(|i| f(self.lane(i)))
    }
}

impl<V: Simd> Neg for DualLanes<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.eps)
    }
}

/// A sum or a difference.
macro_rules! sum {
    ($trait:ident, $name:ident) => {
        impl<V: Simd> $trait for DualLanes<V> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::new(self.re.$name(other.re), self.eps.$name(other.eps))
            }
        }
    };
}

sum!(Add, add);
sum!(Sub, sub);

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

/// An operation with a constant, and the derivative of its result.
macro_rules! with_constant {
    ($trait:ident<$constant:ty>, $name:ident, |$x:ident, $c:ident| $eps:expr) => {
        impl<V: Simd> $trait<$constant> for DualLanes<V> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, $c: $constant) -> Self {
                let $x = self;
                Self::new($x.re.$name($c), $eps)
            }
        }
    };
}

with_constant!(Add<f64>, add, |x, c| x.eps);
with_constant!(Sub<f64>, sub, |x, c| x.eps);
with_constant!(Mul<f64>, mul, |x, c| x.eps * c);
with_constant!(Div<f64>, div, |x, c| x.eps / c);
with_constant!(Add<Lanes<V>>, add, |x, c| x.eps);
with_constant!(Sub<Lanes<V>>, sub, |x, c| x.eps);
with_constant!(Mul<Lanes<V>>, mul, |x, c| x.eps * c);

impl<V: Simd> Over<Lanes<V>> for DualLanes<V> {
    #[inline(always)]
    fn of(constant: Lanes<V>) -> Self {
        Self::new(constant, Lanes::cst(0.0))
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
        let n_above = root.0.is_above(V::splat(0.0)).count_ones();
        if n_above as usize != V::N {
            return self.map(Real::sqrt);
        }
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

    fn abs(self) -> Self {
        self.map(Real::abs)
    }

    fn min(self, other: Self) -> Self {
        Self::from_fn(|i| Real::min(self.lane(i), other.lane(i)))
    }

    fn max(self, other: Self) -> Self {
        Self::from_fn(|i| Real::max(self.lane(i), other.lane(i)))
    }
}

impl<V: Simd> Shortcuts for DualLanes<V> {}

#[cfg(test)]
mod tests {
    use wide::{f64x2, f64x8};

    use super::*;
    use crate::real::Function;

    /// Every operation, in numbers of any kind.
    struct Everything;

    impl Function for Everything {
        fn of<S: Real>(&self, x: S) -> S {
            let (sin, cos) = (x * 0.7).sin_cos();
            let quotient = (sin + 1.0) / (cos - x * 0.1) - -x / 3.0;
            let folded = (x - 0.5).abs().max(sin).min(cos + 1.0);
            (x.sqrt() + quotient * quotient).ln() + x.powf(1.7) * (x - 2.0).exp() + folded
        }
    }

    #[test]
    fn each_lane_has_the_dual_number_that_it_has_alone() {
        each_lane_has_its_own::<f64x8>();
        each_lane_has_its_own::<f64x2>();
    }

    fn each_lane_has_its_own<V: Simd>() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..1000 {
            // One in eight rests at zero.
            let rest: [f64; LANES] = std::array::from_fn(|_| f64::from(random.u8(0..8).min(1)));
            let each: [f64; LANES] = std::array::from_fn(|i| 1.1 * random.f64() * rest[i]);
            let rates: [f64; LANES] = std::array::from_fn(|i| (random.f64() - 0.5) * rest[i]);
            let value = Lanes::<V>::from_fn(|i| each[i]);
            let lanes = DualLanes::new(value, Lanes::from_fn(|i| rates[i]));
            let constant = Lanes::<V>::from_fn(|i| rates[i]);
            let whole = Everything.of(lanes);
            let with_constant = (lanes + constant) * constant - constant;
            for i in 0..V::N {
                let alone = Dual64::new(each[i], rates[i]);
                let bits = |x: DualLanes<V>| [x.re, x.eps].map(|x| x.lane(i).to_bits());
                let expected = |x: Dual64| [x.re, x.eps].map(f64::to_bits);
                assert_eq!(bits(whole), expected(Everything.of(alone)));
                assert_eq!(bits(with_constant), expected((alone + rates[i]) * rates[i] - rates[i]));
                let plain = Everything.of(value).lane(i);
                assert_eq!(plain.to_bits(), Everything.of(each[i]).to_bits());
            }
        }
    }
}
