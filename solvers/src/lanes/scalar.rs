//! The scalar of several runs: a number of each, computed with at once.

use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::f64x8;

use super::sin_cos::sin_cos;
use crate::real::{Function, Ordered, Real};

/// How many runs are computed with at once: two vectors of AVX2, which do not wait for each other.
pub const LANES: usize = 8;

/// A number of each of several runs; what is computed with it has the bits that each would have alone.
#[derive(Clone, Copy, Debug)]
pub struct Lanes(f64x8);

impl Lanes {
    /// The numbers of the runs, in their order.
    #[inline(always)]
    pub fn new(each: [f64; LANES]) -> Self {
        Self(f64x8::new(each))
    }

    /// The numbers of the runs.
    #[inline(always)]
    pub fn each(self) -> [f64; LANES] {
        self.0.to_array()
    }

    /// A number of each of these.
    #[inline(always)]
    pub(super) fn of<X>(each: &[X; LANES], number: impl Fn(&X) -> f64) -> Self {
        Self::new(std::array::from_fn(|lane| number(&each[lane])))
    }

    fn map(self, f: impl FnMut(f64) -> f64) -> Self {
        Self::new(self.each().map(f))
    }
}

/// An operation between numbers of the same runs, and with a constant.
macro_rules! operation {
    ($trait:ident, $name:ident) => {
        impl $trait for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0.$name(other.0))
            }
        }

        impl $trait<f64> for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                Self(self.0.$name(f64x8::splat(other)))
            }
        }
    };
}

operation!(Add, add);
operation!(Sub, sub);
operation!(Mul, mul);
operation!(Div, div);

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self(f64x8::splat(x))
    }

    /// The number that all runs have.
    ///
    /// # Panics
    /// Where they differ: what is decided on it would be decided for one of them. A model that asks for
    /// it in a mode is not [for lanes](crate::System::IN_LANES).
    fn value(self) -> f64 {
        let [first, others @ ..] = self.each();
        let same = others.iter().all(|other| other.to_bits() == first.to_bits());
        assert!(
            same,
            "a decision on a number of several runs, {:?}: set IN_LANES to false",
            self.0
        );
        first
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = sin_cos(self.0);
        (Self(sin), Self(cos))
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

impl Ordered for Lanes {
    /// A bit a run.
    type Mask = u32;

    const YES: u32 = (1 << LANES) - 1;

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> u32 {
        self.0.simd_gt(other.0).to_bitmask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_run_is_compared_as_it_is_alone() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let (a, b) = (
            [1.0, -2.0, nan, 3.0, nan, -inf, 0.0, 5.0],
            [2.0, -3.0, 1.0, nan, nan, inf, -0.0, 5.0],
        );
        let (x, y) = (Lanes::new(a), Lanes::new(b));
        for i in 0..LANES {
            let same = |found: f64, alone: f64| found == alone || found.is_nan() && alone.is_nan();
            assert!(same(x.max(y).each()[i], a[i].max(b[i])), "{i}");
            assert_eq!((-x).each()[i].to_bits(), (-a[i]).to_bits(), "{i}");
            assert!(same(x.abs().each()[i], a[i].abs()), "{i}");
            assert_eq!(x.is_above(y) & (1 << i) != 0, a[i] > b[i], "{i}");
        }
        assert_eq!(Lanes::cst(1.0).is_above(Lanes::cst(0.0)), Lanes::YES);
    }

    #[test]
    fn the_number_that_all_runs_have_is_their_value() {
        assert_eq!(Lanes::cst(2.5).value(), 2.5);
    }

    #[test]
    #[should_panic(expected = "a decision on a number of several runs")]
    fn a_decision_on_different_numbers_is_refused() {
        Lanes::new(std::array::from_fn(|i| i as f64)).value();
    }
}
