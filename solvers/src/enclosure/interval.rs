//! Numbers known to lie between two bounds, rounded outward.

use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Length, Real, Shortcuts};
use crate::taylor::coefficient::Coefficient;

/// A closed interval of real numbers.
///
/// The result of an operation contains the exact result for every choice of numbers in the operands. Sums, products,
/// quotients and roots of `f64` are the exact results rounded to nearest (IEEE 754), so the next number below and
/// above bounds them. Sine and cosine are computed from their series. The other functions, and operations that are
/// not defined for all numbers of their operands, give [`WHOLE`](Self::WHOLE): a model that uses them is not enclosed.
///
/// An infinite bound means that there is none on that side.
///
/// R. E. Moore, *Interval Analysis*, Prentice-Hall (1966).
///
/// ```
/// use deltazero_solvers::Real;
/// use deltazero_solvers::enclosure::Interval;
///
/// // 0.1 is not a tenth, but a tenth of ten is near one.
/// let x = Interval::from(1.0) / 10.0 * 10.0;
/// assert!(x.contains(1.0) && x.width() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// All real numbers.
    pub const WHOLE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// Zero.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// The numbers from `lo` to `hi`; all numbers where these are not in order.
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            Self { lo, hi }
        } else {
            Self::WHOLE
        }
    }

    /// The numbers of at most this size.
    pub fn within(size: f64) -> Self {
        Self::new(-size, size)
    }

    /// The lower bound.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// The upper bound.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// The distance of the bounds, rounded up.
    pub fn width(self) -> f64 {
        (Self::from(self.hi) - Self::from(self.lo)).hi
    }

    /// A number about the middle.
    pub fn mid(self) -> f64 {
        (0.5 * self.lo + 0.5 * self.hi).clamp(self.lo, self.hi)
    }

    /// The largest size of its numbers.
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Whether it is one number.
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Whether `x` is in it.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Whether all of it is in `other`.
    pub fn is_in(self, other: Self) -> bool {
        other.lo <= self.lo && self.hi <= other.hi
    }

    /// The distance of `x` from it; zero inside.
    pub fn distance(self, x: f64) -> f64 {
        (self.lo - x).max(x - self.hi).max(0.0)
    }

    /// The sizes of its numbers.
    fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Self::new(0.0, self.mag())
        }
    }

    /// The smallest interval that contains both.
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// What is in both, of two intervals that hold the same number.
    pub(super) fn meet(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }

    /// Both bounds to the next number outward.
    fn outward(lo: f64, hi: f64) -> Self {
        Self::new(lo.next_down(), hi.next_up())
    }

    /// The hull of four results of an operation that is monotone in each operand.
    fn hull_of([a, b, c, d]: [f64; 4]) -> Self {
        if [a, b, c, d].iter().any(|x| x.is_nan()) {
            return Self::WHOLE;
        }
        Self::outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }
}

impl From<f64> for Interval {
    /// The number itself.
    fn from(x: f64) -> Self {
        Self::new(x, x)
    }
}

/// Single numbers, as intervals.
pub(super) fn points(x: &[f64]) -> Vec<Interval> {
    x.iter().map(|x| Interval::from(*x)).collect()
}

/// `a + b` rounded, and the sign of what rounding left out: M. Møller's and D. E. Knuth's sum of two, exact where
/// nothing overflows. Where it overflows the second number is NaN.
fn sum_of_two(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

fn sum_below(a: f64, b: f64) -> f64 {
    let (sum, rest) = sum_of_two(a, b);
    if rest >= 0.0 { sum } else { sum.next_down() }
}

fn sum_above(a: f64, b: f64) -> f64 {
    let (sum, rest) = sum_of_two(a, b);
    if rest <= 0.0 { sum } else { sum.next_up() }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

// A model makes thousands of these operations, each of twenty to sixty instructions: in place they would be most of its code.
impl Add for Interval {
    type Output = Self;

    #[inline(never)]
    fn add(self, by: Self) -> Self {
        Self::new(sum_below(self.lo, by.lo), sum_above(self.hi, by.hi))
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline]
    fn sub(self, by: Self) -> Self {
        self + -by
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline(never)]
    fn mul(self, by: Self) -> Self {
        if self == Self::ZERO || by == Self::ZERO {
            return Self::ZERO;
        }
        Self::hull_of([self.lo * by.lo, self.lo * by.hi, self.hi * by.lo, self.hi * by.hi])
    }
}

impl Div for Interval {
    type Output = Self;

    #[inline(never)]
    fn div(self, by: Self) -> Self {
        if by.contains(0.0) {
            return Self::WHOLE;
        }
        if self == Self::ZERO {
            return Self::ZERO;
        }
        Self::hull_of([self.lo / by.lo, self.lo / by.hi, self.hi / by.lo, self.hi / by.hi])
    }
}

/// Operators with a number, which is an interval of its own.
macro_rules! with_number {
    ($($Operator:ident::$operator:ident)*) => {$(
        impl $Operator<f64> for Interval {
            type Output = Self;

            #[inline]
            fn $operator(self, by: f64) -> Self {
                self.$operator(Self::from(by))
            }
        }
    )*};
}

with_number!(Add::add Sub::sub Mul::mul Div::div);

/// π/2, between two neighbouring numbers.
fn quarter_turn() -> Interval {
    Interval::new(FRAC_PI_2, FRAC_PI_2.next_up())
}

/// Quarter turns beyond which sine and cosine are only bounded by one.
const MOST_QUARTERS: f64 = 1e6;
/// Terms of their series about a point of size at most one.
const TERMS: u32 = 12;
/// A bound of what the other terms add, relative to the first one: `1/24! = 1.6e-24` for the cosine, less for the sine.
const REST: f64 = 2e-24;

/// Sine and cosine of a number of size at most one. The terms of both series alternate and fall in size, so the
/// first one left out bounds all that are.
fn sin_cos_of_point(x: f64) -> (Interval, Interval) {
    let square = Interval::from(x) * x;
    let mut sums = [Interval::from(1.0); 2];
    for n in (1..TERMS).rev() {
        let n = 2.0 * f64::from(n);
        sums[0] = Interval::from(1.0) - square * sums[0] / (n * (n + 1.0));
        sums[1] = Interval::from(1.0) - square * sums[1] / (n * (n - 1.0));
    }
    let [sin, cos] = sums.map(|sum| if x == 0.0 { sum } else { sum + Interval::within(REST) });
    (sin * x, cos)
}

impl Real for Interval {
    const NEWTON_STEPS: usize = 0;

    fn cst(x: f64) -> Self {
        Self::from(x)
    }

    /// The number itself; one of its numbers where they are all of one sign, by which a constant such as a third is decided on
    /// (what differs among states is watched); NaN where neither is so.
    fn value(self) -> f64 {
        if self.is_point() || !self.contains(0.0) { self.mid() } else { f64::NAN }
    }

    /// The root of a number; all numbers where the interval reaches below zero.
    fn sqrt(self) -> Self {
        if self.lo < 0.0 {
            return Self::WHOLE;
        }
        // The root of zero is exact.
        let [lo, hi] = [self.lo, self.hi].map(f64::sqrt);
        Self::new(
            if lo == 0.0 { lo } else { lo.next_down() },
            if hi == 0.0 { hi } else { hi.next_up() },
        )
    }

    /// By the series about the middle `m` of the distance from the nearest quarter turn, and the mean value theorem:
    /// `sin x ∈ sin m + cos(x) (x − m)`, `cos x ∈ cos m − sin(x) (x − m)`.
    fn sin_cos(self) -> (Self, Self) {
        let any = (Self::new(-1.0, 1.0), Self::new(-1.0, 1.0));
        let quarters = (self.mid() / FRAC_PI_2).round();
        if quarters.is_nan() || quarters.abs() > MOST_QUARTERS {
            return any;
        }
        let x = if quarters == 0.0 { self } else { self - quarter_turn() * quarters };
        let m = x.mid();
        let away = x - m;
        if m.is_nan() || m.abs() > 1.0 || away.mag() > 1.0 {
            return any;
        }
        let (sin_m, cos_m) = sin_cos_of_point(m);
        let unit = Self::new(-1.0, 1.0);
        let sin = sin_m + (cos_m + unit * away) * away;
        let cos = cos_m - (sin_m + unit * away) * away;
        match quarters.rem_euclid(4.0) {
            1.0 => (cos, -sin),
            2.0 => (-sin, -cos),
            3.0 => (-cos, sin),
            _ => (sin, cos),
        }
    }

    /// All numbers.
    fn exp(self) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn ln(self) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn powf(self, _a: f64) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn sinh(self) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn cosh(self) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn tanh(self) -> Self {
        Self::WHOLE
    }

    /// All numbers.
    fn atan2(self, _x: Self) -> Self {
        Self::WHOLE
    }

    fn abs(self) -> Self {
        Self::abs(self)
    }

    fn sign(self) -> Self {
        let sign = |x: f64| f64::from(i8::from(x > 0.0) - i8::from(x < 0.0));
        Self::new(sign(self.lo), sign(self.hi))
    }

    fn min(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.min(other.hi))
    }

    fn max(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.max(other.hi))
    }
}

impl Shortcuts for Interval {
    /// Of a vector along an axis the length is the size of that component, without rounding: what begins on a circle,
    /// on an axis, is exactly there.
    fn length(d: [Self; 2], v: [Self; 2]) -> Length<Self> {
        let rho = match d {
            [Self::ZERO, y] => y.abs(),
            [x, Self::ZERO] => x.abs(),
            [x, y] => (x * x + y * y).sqrt(),
        };
        let rho = rho.divisor();
        Length { rho, rate: (d[0] * v[0] + d[1] * v[1]).over(&rho) }
    }
}

impl Coefficient for Interval {
    const HIGHEST_UNROLLED: usize = 0;

    type Rounded = f64;

    fn rounded(self) -> f64 {
        self.value()
    }
}

#[cfg(all(test, feature = "extended"))]
mod tests {
    use super::*;
    use crate::double_double::DoubleDouble;

    /// Numbers of all sizes and signs.
    fn numbers() -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(7);
        let size = |random: &mut fastrand::Rng| 10_f64.powi(random.i32(-12..12));
        (0..2000).map(|_| (random.f64() - 0.5) * size(&mut random)).collect()
    }

    /// Whether the exact number is inside: `x` is exact to some 1e-30 of its size.
    fn holds(found: Interval, x: DoubleDouble) -> bool {
        let above = x - DoubleDouble::from(found.lo());
        let below = DoubleDouble::from(found.hi()) - x;
        above.hi() > 0.0 && below.hi() > 0.0
            || above.hi() == 0.0 && below.hi() >= 0.0
            || below.hi() == 0.0 && above.hi() >= 0.0
    }

    #[test]
    fn operations_hold_the_exact_results_within_a_few_last_digits() {
        let numbers = numbers();
        for pair in numbers.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let [x, y] = [a, b].map(Interval::from);
            let [u, v] = [a, b].map(DoubleDouble::from);
            let root = Interval::from(a.abs()).sqrt();
            let pairs = [
                (x + y, u + v),
                (x - y, u - v),
                (x * y, u * v),
                (x / y, u / v),
                (root, DoubleDouble::from(a.abs()).sqrt()),
            ];
            for (i, (found, exact)) in pairs.into_iter().enumerate() {
                assert!(holds(found, exact), "operation {i} of {a:e} and {b:e}: {found:?}");
                assert!(found.width() <= 2.1 * f64::EPSILON * found.mag(), "{i}: {found:?}");
            }
        }
    }

    #[test]
    fn intervals_hold_the_results_of_all_their_numbers() {
        let mut random = fastrand::Rng::with_seed(3);
        for pair in numbers().windows(4) {
            let [x, y] = [[pair[0], pair[1]], [pair[2], pair[3]]]
                .map(|[a, b]| Interval::new(a.min(b), a.max(b)));
            let of = |x: Interval, share: f64| {
                (x.lo() + share * (x.hi() - x.lo())).clamp(x.lo(), x.hi())
            };
            let (a, b) = (of(x, random.f64()), of(y, random.f64()));
            for found in [(x + y, a + b), (x - y, a - b), (x * y, a * b), (x / y, a / b)] {
                assert!(found.0.contains(found.1), "{x:?}, {y:?}: {found:?}");
            }
        }
    }

    #[test]
    fn sines_and_cosines_hold_those_of_thirty_digits() {
        for x in numbers().into_iter().filter(|x| x.abs() < 1e3).chain([0.0, FRAC_PI_2, 1e-300]) {
            let (sin, cos) = Interval::from(x).sin_cos();
            let (exact_sin, exact_cos) = DoubleDouble::from(x).sin_cos();
            assert!(holds(sin, exact_sin) && holds(cos, exact_cos), "{x:e}: {sin:?}, {cos:?}");
            let most = 3e-15 * (1.0 + x.abs());
            assert!(
                sin.width() < most.min(4e-15 * x.abs()).max(1e-300) || x.abs() > 0.7,
                "{x:e}: {sin:?}"
            );
            assert!(cos.width() < most, "{x:e}: {cos:?}");
            let wide = Interval::new(x - 0.1, x + 0.1).sin_cos();
            for share in [-0.1, -0.03, 0.07, 0.1] {
                let (sin, cos) = libm::sincos(x + share);
                assert!(wide.0.contains(sin) && wide.1.contains(cos), "{x:e}");
            }
        }
    }

    #[test]
    fn what_has_no_result_is_not_bounded() {
        let [zero, one] = [0.0, 1.0].map(Interval::from);
        let about_zero = Interval::within(1e-9);
        for found in [one / about_zero, zero / zero, about_zero.sqrt(), one.exp(), one.ln()] {
            assert_eq!(found, Interval::WHOLE);
        }
        assert_eq!(Interval::new(1.0, 0.0), Interval::WHOLE);
        assert_eq!(Interval::from(f64::NAN), Interval::WHOLE);
        assert_eq!(Interval::from(f64::MAX) * 2.0, Interval::new(f64::MAX, f64::INFINITY));
        assert_eq!(Interval::WHOLE * 0.0, zero);
        assert!((Interval::WHOLE - Interval::WHOLE).contains(3.0));
        assert!(about_zero.value().is_nan() && Interval::WHOLE.value().is_nan());
        assert!(Interval::new(-2.0, -1.0).value() < 0.0 && (one / 3.0).value() > 0.0);
    }

    #[test]
    fn the_distance_of_a_number_is_zero_inside_alone() {
        let x = Interval::new(-1.0, 3.0);
        for (at, distance) in [(-3.0, 2.0), (-1.0, 0.0), (0.5, 0.0), (3.0, 0.0), (3.5, 0.5)] {
            assert_eq!(x.distance(at), distance, "{at}");
        }
    }

    #[test]
    fn signs_and_lengths_hold_those_of_their_numbers() {
        let sign = |lo, hi| {
            let sign = Interval::new(lo, hi).sign();
            (sign.lo(), sign.hi())
        };
        assert_eq!(sign(-2.0, -1.0), (-1.0, -1.0));
        assert_eq!(sign(-2.0, 1.0), (-1.0, 1.0));
        assert_eq!(sign(0.0, 1.0), (0.0, 1.0));
        let [three, four, one, two, zero] = [3.0, 4.0, 1.0, 2.0, 0.0].map(Interval::from);
        for (d, v, rho, rate) in [
            ([three, four], [one, two], 5.0, 2.2),
            ([zero, -four], [one, two], 4.0, -2.0),
            ([-three, zero], [one, two], 3.0, -1.0),
        ] {
            let length = Interval::length(d, v);
            // Measured: 4.0e-15.
            assert!(length.rho.value.contains(rho) && length.rho.value.width() < 1e-14);
            assert!(length.rate.contains(rate) && length.rate.width() < 1e-14, "{:?}", length.rate);
        }
    }
}
