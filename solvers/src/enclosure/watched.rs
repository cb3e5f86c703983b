//! Intervals that know when a decision is taken on them.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::interval::Interval;
use crate::real::{Real, Shortcuts};

/// What a decision may be taken on, and whether one was taken on something else.
#[derive(Debug)]
pub(super) struct Watch {
    allowed: Allowed,
    is_undecided: Cell<bool>,
}

/// What a decision may be taken on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Allowed {
    /// On single numbers alone.
    Points,
    /// On intervals without zero too, by their lower bound: so for decisions by the sign.
    SignsLow,
    /// The same by their upper bound.
    SignsHigh,
}

impl Watch {
    pub(super) fn new(allowed: Allowed) -> Self {
        Self { allowed, is_undecided: Cell::new(false) }
    }

    /// Whether a decision was taken on an interval on which it must not be.
    pub(super) fn is_undecided(&self) -> bool {
        self.is_undecided.get()
    }
}

/// An interval under watch; a constant is under none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched<'w> {
    pub(super) x: Interval,
    watch: Option<&'w Watch>,
}

impl<'w> Watched<'w> {
    pub(super) fn new(x: Interval, watch: &'w Watch) -> Self {
        Self { x, watch: Some(watch) }
    }

    fn of(self, x: Interval) -> Self {
        Self { x, ..self }
    }

    /// The result of a function that no interval is known of: what uses it is not decided.
    fn unknown(self) -> Self {
        if let Some(watch) = self.watch {
            watch.is_undecided.set(true);
        }
        self.of(Interval::WHOLE)
    }
}

impl Neg for Watched<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self.of(-self.x)
    }
}

macro_rules! operators {
    ($($Operator:ident::$operator:ident)*) => {$(
        impl $Operator for Watched<'_> {
            type Output = Self;

            fn $operator(self, by: Self) -> Self {
                Self { x: self.x.$operator(by.x), watch: self.watch.or(by.watch) }
            }
        }

        impl $Operator<f64> for Watched<'_> {
            type Output = Self;

            fn $operator(self, by: f64) -> Self {
                self.of(self.x.$operator(by))
            }
        }
    )*};
}

operators!(Add::add Sub::sub Mul::mul Div::div);

impl Real for Watched<'_> {
    const NEWTON_STEPS: usize = 0;

    fn cst(x: f64) -> Self {
        Self { x: Interval::from(x), watch: None }
    }

    fn value(self) -> f64 {
        let allowed = self.watch.map(|watch| watch.allowed);
        match allowed {
            _ if self.x.is_point() => self.x.lo(),
            Some(Allowed::SignsLow) if !self.x.contains(0.0) => self.x.lo(),
            Some(Allowed::SignsHigh) if !self.x.contains(0.0) => self.x.hi(),
            Some(_) => {
                self.watch.inspect(|watch| watch.is_undecided.set(true));
                f64::NAN
            }
            None => self.x.value(),
        }
    }

    fn sqrt(self) -> Self {
        self.of(self.x.sqrt())
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.x.sin_cos();
        (self.of(sin), self.of(cos))
    }

    fn exp(self) -> Self {
        self.of(self.x.exp())
    }

    fn ln(self) -> Self {
        self.of(self.x.ln())
    }

    fn powf(self, a: f64) -> Self {
        self.of(self.x.powf(a))
    }

    fn sinh(self) -> Self {
        self.unknown()
    }

    fn cosh(self) -> Self {
        self.unknown()
    }

    fn tanh(self) -> Self {
        self.unknown()
    }

    fn atan2(self, x: Self) -> Self {
        x.unknown();
        self.unknown()
    }
}

impl Shortcuts for Watched<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_without_an_interval_and_undecided_choices_are_seen() {
        let low = |x: Interval, f: &dyn Fn(Watched<'_>) -> Watched<'_>| {
            let watch = Watch::new(Allowed::SignsLow);
            let found = f(Watched::new(x, &watch)).x;
            (found, watch.is_undecided())
        };
        let x = Interval::new(1.0, 1.5);
        assert!(low(x, &|x| x.tanh()).1 && low(x, &|x| x.atan()).1 && low(x, &|x| x.asin()).1);
        assert_eq!(low(-x, &|x| x.abs()), (x, false));
        assert!(low(Interval::new(-1.0, 1.0), &|x| x.abs()).1);
        let wide = Interval::new(-0.1, 0.1);
        assert_eq!(low(x, &|x| x.max(Watched { x: wide, ..x })), (x, false));
        assert_eq!(low(x, &|x| x.max(Real::cst(2.0))), (Interval::from(2.0), false));
        assert_eq!(low(x, &|x| x.min(Real::cst(2.0))), (x, false));
        assert!(low(x, &|x| x.max(Real::cst(1.2))).1 && low(x, &|x| x.min(Real::cst(1.2))).1);
    }

    /// Whether the sign of a number of this interval is decided.
    fn is_decided(allowed: Allowed, x: Interval) -> bool {
        let watch = Watch::new(allowed);
        let _ = (Watched::new(x, &watch) * 2.0 + 0.0).value();
        !watch.is_undecided()
    }

    #[test]
    fn decisions_on_what_straddles_zero_are_seen() {
        let (straddling, above) = (Interval::within(1e-300), Interval::new(0.1, 0.2));
        for allowed in [Allowed::SignsLow, Allowed::SignsHigh] {
            assert!(!is_decided(allowed, straddling) && is_decided(allowed, above));
            assert!(!is_decided(allowed, Interval::new(0.0, 1.0)));
        }
        assert!(!is_decided(Allowed::Points, above));
        assert!(is_decided(Allowed::Points, Interval::ZERO));
    }
}
