//! Numbers of several runs in the lanes of one vector: a scalar type whose every lane has the bits of an `f64` alone.
//!
//! A vector instruction rounds as the scalar one does, and elementary functions are those of `libm`, operation by
//! operation or lane by lane. So no lane depends on the others.

pub mod dual;
mod sin_cos;

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use wide::{f64x2, f64x8};

use crate::real::{Ordered, Over, Real, Shortcuts};
use sin_cos::sin_cos;

/// The largest number of lanes: two vectors of AVX2, which do not wait for each other.
pub const LANES: usize = 8;

/// Whether this build fuses `a b + c` into one operation with one rounding, where it may: the last bits of Taylor series
/// follow from it.
pub const FUSED: bool = cfg!(target_feature = "fma");

/// A vector of the processor, with a number in each of `N` lanes, at most [`LANES`].
pub trait Simd:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// Number of lanes.
    const N: usize;

    /// The numbers `number(0) … number(N − 1)`.
    fn from_fn(number: impl FnMut(usize) -> f64) -> Self;

    /// The same number in each lane.
    fn splat(x: f64) -> Self;

    /// The number in lane `i`. Of a vector in memory no more than this number is read.
    fn lane(&self, i: usize) -> f64;

    /// Writes `x` to lane `i`.
    fn set(&mut self, i: usize, x: f64);

    /// `self · by + plus`, fused where the target has an instruction for it.
    fn mul_add(self, by: Self, plus: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// The smaller one in each lane; where one is NaN, any of both.
    fn lesser(self, other: Self) -> Self;

    /// The larger one in each lane; where one is NaN, any of both.
    fn larger(self, other: Self) -> Self;

    /// A bit for each lane, set where it is above `other`.
    fn is_above(self, other: Self) -> u32;

    /// Sets the sign bit of each lane where `other` has it set.
    fn or_sign_of(self, other: Self) -> Self;
}

macro_rules! simd {
    ($vector:ty, $n:literal) => {
        impl Simd for $vector {
            const N: usize = $n;

            #[inline(always)]
            fn from_fn(number: impl FnMut(usize) -> f64) -> Self {
                Self::new(std::array::from_fn(number))
            }

            #[inline(always)]
            fn splat(x: f64) -> Self {
                <$vector>::splat(x)
            }

            #[inline(always)]
            fn lane(&self, i: usize) -> f64 {
                self.as_array()[i]
            }

            #[inline(always)]
            fn set(&mut self, i: usize, x: f64) {
                self.as_mut_array()[i] = x;
            }

            #[inline(always)]
            fn mul_add(self, by: Self, plus: Self) -> Self {
                // The vectors' own is fused on some targets where that of an `f64` is not.
                if FUSED { <$vector>::mul_add(self, by, plus) } else { self * by + plus }
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                <$vector>::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <$vector>::abs(self)
            }

            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                <$vector>::fast_min(self, other)
            }

            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                <$vector>::fast_max(self, other)
            }

            #[inline(always)]
            fn is_above(self, other: Self) -> u32 {
                self.simd_gt(other).to_bitmask()
            }

            #[inline(always)]
            fn or_sign_of(self, other: Self) -> Self {
                self | (other & <$vector>::splat(-0.0))
            }
        }
    };
}

simd!(f64x2, 2);
simd!(f64x8, 8);

/// A number in each lane.
///
/// ```
/// use deltazero_solvers::Real;
/// use deltazero_solvers::lanes::Lanes;
/// use wide::f64x2;
///
/// fn f<S: Real>(x: S) -> S {
///     (x * 2.0).sin() + 1.0
/// }
///
/// let x = Lanes::<f64x2>::from_fn(|i| [0.3, 0.7][i]);
/// let y = f(x);
/// assert_eq!([y.lane(0), y.lane(1)], [f(0.3), f(0.7)]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Lanes<V>(V);

impl<V: Simd> Lanes<V> {
    /// The numbers `number(0), number(1), …`.
    #[inline(always)]
    pub fn from_fn(number: impl FnMut(usize) -> f64) -> Self {
        Self(V::from_fn(number))
    }

    /// The number in lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> f64 {
        self.0.lane(i)
    }

    /// Writes `x` to lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, x: f64) {
        self.0.set(i, x);
    }

    /// `self · by + plus`, fused where the target has an instruction for it.
    #[inline(always)]
    pub fn mul_add(self, by: Self, plus: Self) -> Self {
        Self(self.0.mul_add(by.0, plus.0))
    }

    fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::from_fn(|i| f(self.lane(i)))
    }
}

/// An operation between numbers lane by lane, and with a constant.
macro_rules! operation {
    ($trait:ident, $name:ident) => {
        impl<V: Simd> $trait for Lanes<V> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0.$name(other.0))
            }
        }

        impl<V: Simd> $trait<f64> for Lanes<V> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                Self(self.0.$name(V::splat(other)))
            }
        }
    };
}

operation!(Add, add);
operation!(Sub, sub);
operation!(Mul, mul);
operation!(Div, div);

impl<V: Simd> Neg for Lanes<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<V: Simd> Real for Lanes<V> {
    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self(V::splat(x))
    }

    /// The number that all lanes have.
    ///
    /// # Panics
    /// Where they differ, because a branch would be decided for one of them. A model with
    /// [parameters](crate::Alike::parameters) must not ask for it in a mode that has them.
    fn value(self) -> f64 {
        let first = self.lane(0);
        let same = (1..V::N).all(|i| self.lane(i).to_bits() == first.to_bits());
        assert!(
            same,
            "a branch on the numbers of several runs, {:?}: give no parameters of this mode",
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

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    fn min(self, other: Self) -> Self {
        Self::from_fn(|i| Real::min(self.lane(i), other.lane(i)))
    }

    fn max(self, other: Self) -> Self {
        Self::from_fn(|i| Real::max(self.lane(i), other.lane(i)))
    }
}

impl<V: Simd> Shortcuts for Lanes<V> {}

impl<V: Simd> Ordered for Lanes<V> {
    /// A bit for each lane.
    type Mask = u32;

    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        Self(self.0.lesser(other.0))
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self(self.0.larger(other.0))
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> u32 {
        self.0.is_above(other.0)
    }
}

/// A number in each lane is also a constant of each run.
impl<V: Simd> Over<Self> for Lanes<V> {
    #[inline(always)]
    fn of(constant: Self) -> Self {
        constant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_lane_is_compared_as_it_is_alone() {
        each_lane_is_compared::<f64x8>(0);
        (0..LANES - 1).for_each(each_lane_is_compared::<f64x2>);
    }

    /// Lanes from the `from`th on.
    fn each_lane_is_compared<V: Simd>(from: usize) {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        let (a, b) = (
            [1.0, -2.0, nan, 3.0, nan, -inf, 0.0, 5.0],
            [2.0, -3.0, 1.0, nan, nan, inf, -0.0, 5.0],
        );
        let (a, b) = (&a[from..], &b[from..]);
        let (x, y) = (Lanes::<V>::from_fn(|i| a[i]), Lanes::<V>::from_fn(|i| b[i]));
        for i in 0..V::N {
            let same = |found: f64, alone: f64| found == alone || found.is_nan() && alone.is_nan();
            if !a[i].is_nan() && !b[i].is_nan() {
                assert_eq!(x.larger(y).lane(i), a[i].max(b[i]), "{i}");
                assert_eq!(x.lesser(y).lane(i), a[i].min(b[i]), "{i}");
            }
            assert_eq!((-x).lane(i).to_bits(), (-a[i]).to_bits(), "{i}");
            assert!(same(x.abs().lane(i), a[i].abs()), "{i}");
            assert_eq!(x.is_above(y) & (1 << i) != 0, a[i] > b[i], "{i}");
        }
        assert_eq!(Lanes::<V>::cst(1.0).is_above(Lanes::cst(0.0)), (1 << V::N) - 1);
    }

    #[test]
    fn the_number_that_all_lanes_have_is_their_value() {
        assert_eq!(Lanes::<f64x8>::cst(2.5).value(), 2.5);
    }

    #[test]
    #[should_panic(expected = "a branch on the numbers of several runs")]
    fn a_branch_on_different_numbers_is_refused() {
        Lanes::<f64x2>::from_fn(|i| i as f64).value();
    }
}
