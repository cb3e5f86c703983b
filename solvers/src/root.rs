//! Bracketing root finders and a minimiser for scalar functions. They are independent of differential equations.

/// An interval over which a function falls from above zero to zero or below.
///
/// ```
/// use deltazero_solvers::root::Bracket;
///
/// // Bisection of 2 − x².
/// let mut bracket = Bracket { above: 0.0, below: 2.0 };
/// while !bracket.is_closed() {
///     let x = bracket.middle();
///     bracket.narrow(x, 2.0 - x * x);
/// }
/// assert!((bracket.below - 2.0_f64.sqrt()).abs() <= f64::EPSILON);
/// assert_eq!(Bracket { above: 0.0, below: 2.0 }.inside(3.0), 1.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Where the function is above zero.
    pub above: f64,
    /// Where it is at or below zero.
    pub below: f64,
}

impl Bracket {
    /// Narrows the bracket by the function's value at `x`.
    pub fn narrow(&mut self, x: f64, f: f64) {
        if f > 0.0 {
            self.above = x;
        } else {
            self.below = x;
        }
    }

    /// `x` if it lies strictly inside, else the middle.
    pub fn inside(&self, x: f64) -> f64 {
        let Self { above, below } = *self;
        if above < x && x < below || below < x && x < above { x } else { self.middle() }
    }

    /// The middle.
    pub fn middle(&self) -> f64 {
        self.above + 0.5 * (self.below - self.above)
    }

    /// Whether no number lies strictly inside.
    pub fn is_closed(&self) -> bool {
        let middle = self.middle();
        middle == self.above || middle == self.below
    }
}

/// A root of `f` in `bracket`, to within `tolerance` or the spacing of `f64`. The number returned is one where `f ≤
/// 0`.
///
/// It takes a step of inverse quadratic interpolation where that is safe, and a bisection elsewhere and in every
/// fourth evaluation, so it never needs more than four times the evaluations of bisection. Where `f` is not above
/// zero at `above`, it returns a number next to `above`; where it is above zero at `below`, too, and is found nowhere else,
/// `below`; where `f` is NaN, the last `below` at which `f` was a number.
///
/// T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a
/// nonlinear function without using derivatives", Adv. Eng. Softw. 28(3), 145–149 (1997).
///
/// ```
/// use deltazero_solvers::root::{Bracket, find_root};
///
/// let f = |x| 2.0 - x * x;
/// let root = find_root(f, Bracket { above: 0.0, below: 2.0 }, 1e-12);
/// assert!((root - 2.0_f64.sqrt()).abs() <= 1e-12 && f(root) <= 0.0);
/// ```
pub fn find_root(mut f: impl FnMut(f64) -> f64, bracket: Bracket, tolerance: f64) -> f64 {
    let values = [f(bracket.above), f(bracket.below)];
    close(f, bracket, values, tolerance)
}

/// A root of `f` near a guess in `bracket`, where the slope of `f` is about `slope`, to within `tolerance` or the spacing of `f64`.
/// The number returned is one where `f ≤ 0`.
///
/// Twice the step of Newton's iteration is to pass the root, or eight times that, and so on; what they enclose is searched. `None`
/// where the guess or they leave the bracket, and where `f` is not a number: what `f` is at the ends of the bracket is not asked.
pub(crate) fn root_near(
    (guess, slope): (f64, f64),
    mut f: impl FnMut(f64) -> f64,
    mut bracket: Bracket,
    tolerance: f64,
) -> Option<f64> {
    if bracket.inside(guess) != guess {
        return None;
    }
    let (mut x, mut fx) = (guess, f(guess));
    let least = tolerance.max(f64::EPSILON * guess.abs());
    let mut stride = (2.0 * fx / slope).abs().max(least);
    while !fx.is_nan() {
        if fx == 0.0 {
            return Some(x);
        }
        let (before, is_above) = (fx, fx > 0.0);
        bracket.narrow(x, fx);
        let towards = if is_above { bracket.below } else { bracket.above };
        x += stride.copysign(towards - x);
        if bracket.inside(x) != x {
            return None;
        }
        fx = f(x);
        let has_crossed = if is_above { fx < 0.0 } else { fx > 0.0 };
        if has_crossed {
            bracket.narrow(x, fx);
            let values = if is_above { [before, fx] } else { [fx, before] };
            return Some(close(f, bracket, values, tolerance));
        }
        stride *= 8.0;
    }
    None
}

/// Closes `bracket`, with the values of `f` above and below, on its root.
fn close(
    mut f: impl FnMut(f64) -> f64,
    mut bracket: Bracket,
    values: [f64; 2],
    tolerance: f64,
) -> f64 {
    let (mut a, mut b) = (bracket.below, bracket.above);
    let [mut fb, mut fa] = values;
    let mut fraction = 0.5;
    let mut n = 0_u32;
    // They are the bracket, but where `f` is above zero at both of its ends: then they close on one of them.
    let is_closed = |a, b| Bracket { above: a, below: b }.is_closed();
    while (b - a).abs() > tolerance && !bracket.is_closed() && !is_closed(a, b) {
        n += 1;
        let x = a + fraction * (b - a);
        let fx = f(x);
        if fx.is_nan() {
            return bracket.below;
        }
        bracket.narrow(x, fx);
        let (c, fc);
        if (fx > 0.0) == (fa > 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc) = (b, fb);
            (b, fb) = (a, fa);
        }
        (a, fa) = (x, fx);
        if fx == 0.0 {
            break;
        }
        let xi = (a - b) / (c - b);
        let phi = (fa - fb) / (fc - fb);
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        fraction = if safe && !n.is_multiple_of(4) {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        // The next point keeps at least this distance from both ends, so that the bracket closes from both sides.
        let width = (b - a).abs();
        let least = ((0.5 * tolerance).max(f64::EPSILON * a.abs()) / width).min(0.5);
        fraction = fraction.clamp(least, 1.0 - least);
    }
    bracket.below
}

/// Ratio of the golden-section search, (3 − √5)/2.
const GOLDEN: f64 = 0.381_966_011_250_105_2;

/// A minimum of `f` and its value, by golden-section search from the three points `a < m < b`, and then the vertex of
/// the parabola through the last three. If `f` has one minimum between `a` and `b`, the result is within 1e-3 of their
/// distance from it; if `f` is smooth, the value is above the least by some 1e-12 of the range. The search ends early
/// where no number lies between the points.
///
/// J. Kiefer, "Sequential minimax search for a maximum", Proc. Amer. Math. Soc. 4(3), 502–506 (1953).
///
/// ```
/// use deltazero_solvers::root::minimum;
///
/// // x − ln x is least at 1, and 1 there.
/// let (x, least) = minimum(|x: f64| x - x.ln(), [0.5, 0.8, 2.0]);
/// assert!((x - 1.0).abs() < 1e-3 && (least - 1.0).abs() < 1e-9);
/// ```
pub fn minimum(mut f: impl FnMut(f64) -> f64, points: [f64; 3]) -> (f64, f64) {
    let width = points[2] - points[0];
    let [mut a, mut m, mut b] = points.map(|x| (x, f(x)));
    while b.0 - a.0 > 1e-3 * width {
        let is_left = m.0 - a.0 > b.0 - m.0;
        let x = if is_left { m.0 - GOLDEN * (m.0 - a.0) } else { m.0 + GOLDEN * (b.0 - m.0) };
        if x <= a.0 || x >= b.0 || x == m.0 {
            return m;
        }
        let next = (x, f(x));
        let (left, right) = if x < m.0 { (next, m) } else { (m, next) };
        if left.1 < right.1 {
            (m, b) = (left, right);
        } else {
            (a, m) = (left, right);
        }
    }
    let (vertex, _) = parabola([a, m, b]);
    if vertex > a.0 && vertex < b.0 {
        let value = f(vertex);
        if value < m.1 {
            return (vertex, value);
        }
    }
    m
}

/// The vertex `x₀` and the factor `c` of the parabola `y₀ + c (x − x₀)²` through three points `(x, y)`.
pub(crate) fn parabola([a, m, b]: [(f64, f64); 3]) -> (f64, f64) {
    let (fall, rise) = ((m.1 - a.1) / (m.0 - a.0), (b.1 - m.1) / (b.0 - m.0));
    let vertex = 0.5 * (a.0 + m.0) - 0.5 * fall * (b.0 - a.0) / (rise - fall);
    (vertex, (rise - fall) / (b.0 - a.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_above_zero_at_both_ends_ends_the_search_at_any_tolerance() {
        for (above, below) in [(1.0, 2.0), (2.0, 1.0), (0.0, 1e-300)] {
            for tolerance in [0.0, 1e-18, 1e-3] {
                let mut n = 0;
                let f = |x: f64| {
                    n += 1;
                    assert!(n < 5000, "it does not end");
                    1.0 + x
                };
                assert_eq!(find_root(f, Bracket { above, below }, tolerance), below);
            }
        }
    }

    #[test]
    fn a_root_is_found_near_a_guess_on_either_side_of_it() {
        // Falls at 0.3 with the slope −1.3.
        let f = |x: f64| (0.3 - x) * (1.0 + x);
        for bracket in [Bracket { above: 0.0, below: 1.0 }, Bracket { above: 0.0, below: 7.0 }] {
            for guess in [0.3, 0.3 - 1e-12, 0.31, 0.29, 0.2, 0.35] {
                for slope in [-1.3, -0.7, -1e3, 1.3] {
                    let mut n = 0;
                    let counted = |x| {
                        n += 1;
                        f(x)
                    };
                    let root = root_near((guess, slope), counted, bracket, 1e-9).unwrap();
                    assert!(
                        f(root) <= 0.0 && (root - 0.3).abs() <= 1e-9,
                        "{guess}, {slope}: {root}"
                    );
                    assert!(n < 20, "{guess}, {slope}: {n} evaluations");
                }
            }
        }
        // A slope of zero says nothing, nor does a stride that leaves the bracket, a guess or a root outside, or what is not a
        // number.
        let bracket = Bracket { above: 0.0, below: 1.0 };
        assert_eq!(root_near((0.2, 0.0), f, bracket, 1e-9), None);
        assert_eq!(root_near((0.2, -0.1), f, bracket, 1e-9), None);
        let never = |x: f64| -> f64 { panic!("{x} is outside") };
        assert_eq!(root_near((1.2, -1.0), never, bracket, 1e-9), None);
        assert_eq!(root_near((f64::NAN, -1.0), never, bracket, 1e-9), None);
        assert_eq!(root_near((0.4, -1.0), |x| -0.1 - x, bracket, 1e-9), None);
        assert_eq!(root_near((0.4, -1.0), |_| f64::NAN, bracket, 1e-9), None);
        // Time runs backward, and no tolerance.
        let back = Bracket { above: 0.0, below: -1.0 };
        let root = root_near((-0.29, 1.3), |x| f(-x), back, 0.0).unwrap();
        assert!((root + 0.3).abs() < 1e-15 && f(-root) <= 0.0, "{root:e}");
    }

    #[test]
    fn what_is_inside_is_known_however_narrow_the_bracket_is() {
        let tiny = f64::from_bits(3);
        for bracket in [Bracket { above: 0.0, below: tiny }, Bracket { above: tiny, below: 0.0 }] {
            assert_eq!(bracket.inside(f64::from_bits(1)), f64::from_bits(1));
            for outside in [0.0, tiny, 1.0, f64::NAN] {
                assert_eq!(bracket.inside(outside), bracket.middle());
            }
        }
    }

    #[test]
    fn a_minimum_is_found_to_a_thousandth_of_its_interval() {
        let (x, value) = minimum(|x| 1.0 + (x - 0.3) * (x - 0.3), [0.0, 0.9, 1.0]);
        assert!((x - 0.3).abs() < 1e-3 && (value - 1.0).abs() < 1e-15);
        let (x, value) = minimum(|x| (x - 0.3).abs(), [0.0, 0.9, 1.0]);
        assert!((x - 0.3).abs() < 1e-3 && value < 1e-3);
        let (_, value) = minimum(|x: f64| (3.0 * x - 1.0).exp() - 3.0 * x, [0.0, 0.5, 1.0]);
        assert!(value < 1e-12, "{value:e}");
    }

    #[test]
    fn a_minimum_between_neighbouring_numbers_ends() {
        for n in 1..5 {
            let (a, mut b) = (0.3_f64, 0.3_f64);
            for _ in 0..n {
                b = b.next_up();
            }
            let (x, _) = minimum(|x| (x - a) * (x - b), [a, a + 0.5 * (b - a), b]);
            assert!(a <= x && x <= b);
        }
    }

    #[test]
    fn roots_are_found_from_the_lower_side_in_few_evaluations() {
        type Case = (fn(f64) -> f64, f64);
        let cases: [Case; 4] = [
            (|x| 1.0 - x, 1.0),
            (|x| 2.0 - x * x, std::f64::consts::SQRT_2),
            (|x| (-x).exp() - 1e-3, 1e3_f64.ln()),
            (|x| 1e-20 * (1.0 - x.powi(9)), 1.0),
        ];
        for (f, root) in cases {
            let mut n = 0;
            let counted = |x| {
                n += 1;
                f(x)
            };
            let found = find_root(counted, Bracket { above: 0.0, below: 10.0 }, 0.0);
            assert!(f(found) <= 0.0);
            assert!((found - root).abs() <= 2.0 * f64::EPSILON * root, "{found} for {root}");
            assert!(n < 70, "{n} evaluations");
        }
    }

    #[test]
    fn an_end_without_a_sign_and_a_value_that_is_no_number_end_the_search() {
        let bracket = Bracket { above: 0.0, below: 1.0 };
        let found = find_root(|x| -x - 1e-20, bracket, f64::EPSILON);
        assert!(found > 0.0 && found <= 2.0 * f64::EPSILON, "{found:e}");
        assert_eq!(find_root(|x| if x < 1.0 { f64::NAN } else { -1.0 }, bracket, 0.0), 1.0);
    }

    #[test]
    fn a_step_function_ends_beside_its_jump() {
        let found = find_root(
            |x| if x < 0.3 { 1.0 } else { -1.0 },
            Bracket { above: 0.0, below: 1.0 },
            0.0,
        );
        assert_eq!(found, 0.3);
    }

    #[test]
    fn a_parabola_is_that_through_its_points() {
        // 2 + 3 (x − 0.7)².
        let at = |x: f64| (x, 2.0 + 3.0 * (x - 0.7) * (x - 0.7));
        for points in [[0.1, 0.4, 1.5], [-2.0, 1.0, 1.25], [1.0, 2.0, 4.0]] {
            let (vertex, factor) = parabola(points.map(at));
            // Measured: 4.4e-16 and 1.3e-15.
            assert!(
                (vertex - 0.7).abs() < 4e-15 && (factor - 3.0).abs() < 8e-15,
                "{vertex} {factor}"
            );
        }
    }
}
