//! The range of a guard over a step, from its Taylor polynomial with a bound of the remainder.

use super::interval::Interval;

/// Halvings of a span after which a sign is left undecided.
const DEEPEST: u32 = 40;

/// A function on a span of time: its Taylor coefficients about zero, the last one for the whole span.
///
/// ```text
/// g(x) ∈ Σ_(k<n) c_k xᵏ + c_n xⁿ,   c_n ∋ g⁽ⁿ⁾(ξ)/n! for every ξ of the span
/// ```
#[derive(Clone, Debug)]
pub(super) struct Polynomial(Vec<Interval>);

impl Polynomial {
    pub(super) fn new(coefficients: Vec<Interval>) -> Self {
        Self(coefficients)
    }

    /// Whether it is the same for all states and times.
    pub(super) fn is_constant(&self) -> bool {
        self.0.iter().skip(1).all(|c| *c == Interval::ZERO)
    }

    /// The coefficient of order `k`.
    pub(super) fn coefficient(&self, k: usize) -> Interval {
        self.0[k]
    }

    /// A bound of the values at the numbers of `x`.
    pub(super) fn at(&self, x: Interval) -> Interval {
        self.0.iter().rev().fold(Interval::ZERO, |sum, c| sum * x + *c)
    }

    /// The derivative of order `n`, over `n!`. Its own Taylor expansion has the same remainder.
    pub(super) fn derived(&self, n: usize) -> Self {
        let binomial = |k: usize| {
            (1..=n).fold(Interval::from(1.0), |c, i| c * ((k - n + i) as f64) / i as f64)
        };
        Self((n..self.0.len()).map(|k| self.0[k] * binomial(k)).collect())
    }

    /// Its negative.
    pub(super) fn negated(&self) -> Self {
        Self(self.0.iter().map(|c| -*c).collect())
    }

    /// A bound of the values on a span, by the mean value theorem too.
    fn range(&self, slope: &Self, x: Interval) -> Interval {
        let middle = Interval::from(x.mid());
        let by_slope = self.at(middle) + slope.at(x) * (x - middle);
        by_slope.meet(self.at(x))
    }

    /// Where from left to right it is not shown to be above zero: the left end of the first piece that it is not shown
    /// on. `None` where it is above zero on the whole span.
    pub(super) fn first_doubt(&self, span: Interval) -> Option<f64> {
        self.doubt(&self.derived(1), span, DEEPEST)
    }

    fn doubt(&self, slope: &Self, span: Interval, deepest: u32) -> Option<f64> {
        if self.range(slope, span).lo() > 0.0 {
            return None;
        }
        let middle = span.mid();
        if deepest == 0 || middle <= span.lo() || middle >= span.hi() {
            return Some(span.lo());
        }
        let half = |lo, hi| self.doubt(slope, Interval::new(lo, hi), deepest - 1);
        half(span.lo(), middle).or_else(|| half(middle, span.hi()))
    }

    /// About where it falls below zero after `from`, to the resolution of its coefficients. `None` where it is not
    /// seen to fall before `to`.
    pub(super) fn fall_after(&self, from: f64, to: f64) -> Option<f64> {
        let value = |x: f64| self.at(Interval::from(x)).mid();
        let beyond = |halvings: u32| from + (to - from) * libm::ldexp(1.0, -(halvings as i32));
        let mut below = (0..=DEEPEST).rev().map(beyond).find(|x| value(*x) < 0.0)?;
        let mut above = from;
        for _ in 0..2 * DEEPEST {
            let middle = 0.5 * (above + below);
            if value(middle) < 0.0 {
                below = middle;
            } else {
                above = middle;
            }
        }
        Some(below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(x − 0.3)(x − 0.9)`.
    fn parabola() -> Polynomial {
        Polynomial::new([0.27, -1.2, 1.0].map(Interval::from).to_vec())
    }

    #[test]
    fn signs_are_shown_where_they_are_sure() {
        let p = parabola();
        assert_eq!(p.first_doubt(Interval::new(0.0, 0.29999)), None);
        assert_eq!(p.first_doubt(Interval::new(0.9001, 7.0)), None);
        let doubt = p.first_doubt(Interval::new(0.0, 1.0)).unwrap();
        assert!((doubt - 0.3).abs() < 1e-11, "{doubt}");
        let fall = p.fall_after(doubt, 1.0).unwrap_or(f64::NAN);
        assert!((fall - 0.3).abs() < 1e-11, "{fall}");
        assert_eq!(p.fall_after(0.0, 0.2), None);
    }

    #[test]
    fn a_remainder_that_may_change_the_sign_is_a_doubt() {
        let mut coefficients = parabola().0;
        coefficients.push(Interval::within(100.0));
        let p = Polynomial::new(coefficients);
        let doubt = p.first_doubt(Interval::new(0.0, 0.29)).unwrap();
        assert!(p.at(Interval::from(doubt)).lo() < 1e-6 && doubt < 0.2, "{doubt}");
    }

    #[test]
    fn derivatives_are_those_of_the_polynomial_over_their_factorials() {
        let p = Polynomial::new([1.0, 2.0, 3.0, 4.0, 5.0].map(Interval::from).to_vec());
        // (6 + 24 x + 60 x²)/2.
        for (found, exact) in p.derived(2).0.iter().zip([3.0, 12.0, 30.0]) {
            assert!(found.contains(exact) && found.width() < 1e-13, "{found:?}");
        }
        assert_eq!(p.derived(2).0.len(), 3);
    }
}
