//! The first place where a polynomial falls below zero, isolated by its Bernstein coefficients.

use super::rows::MAX_ORDER;
use crate::root::{Bracket, find_root};

/// Number of halvings after which two roots are not separated. They are then taken for a touch, which is no crossing.
const DEPTH: u32 = 40;

/// `1/C(n, k)`.
static PER_BINOMIAL: [[f64; MAX_ORDER + 1]; MAX_ORDER + 1] = {
    let mut table = [[0.0; MAX_ORDER + 1]; MAX_ORDER + 1];
    let mut n = 0;
    while n <= MAX_ORDER {
        let (mut k, mut binomial) = (0, 1);
        while k <= n {
            table[n][k] = 1.0 / binomial as f64;
            binomial = binomial * (n - k) / (k + 1);
            k += 1;
        }
        n += 1;
    }
    table
};

/// A polynomial on [0, 1], given by its coefficients of 1, s, s², …
///
/// ```
/// use deltazero_solvers::taylor::polynomial::Polynomial;
///
/// // (s − 1/4) (s − 3/4) falls at the first root alone.
/// let p = Polynomial::new([3.0 / 16.0, -1.0, 1.0].into_iter());
/// assert_eq!((p.at(0.5), p.derivative().at(0.5)), (-1.0 / 16.0, 0.0));
/// assert!(p.first_fall(0.0, 1e-12).is_some_and(|s| (s - 0.25).abs() < 1e-12));
/// assert_eq!(p.first_fall(0.5, 1e-12), None);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Polynomial {
    c: [f64; MAX_ORDER + 1],
    degree: usize,
}

impl Polynomial {
    /// The polynomial with these coefficients.
    ///
    /// # Panics
    /// Here, or where it is first used, for more than [`MAX_ORDER`]` + 1` coefficients, or none.
    #[inline(always)]
    pub fn new(coefficients: impl ExactSizeIterator<Item = f64>) -> Self {
        let mut polynomial = Self { c: [0.0; MAX_ORDER + 1], degree: coefficients.len() - 1 };
        for (c, coefficient) in polynomial.c.iter_mut().zip(coefficients) {
            *c = coefficient;
        }
        polynomial
    }

    /// Its coefficients.
    pub fn coefficients(&self) -> &[f64] {
        &self.c[..=self.degree]
    }

    /// Its value at `s`.
    #[inline]
    pub fn at(&self, s: f64) -> f64 {
        self.coefficients().iter().rev().fold(0.0, |sum, c| sum * s + c)
    }

    /// Its value and its first and second derivative at `s`.
    #[inline]
    fn with_derivatives(&self, s: f64) -> [f64; 3] {
        let terms = self.coefficients().iter().rev();
        let [value, slope, bend] = terms.fold([0.0; 3], |[value, slope, bend], c| {
            [value * s + c, slope * s + value, bend * s + slope]
        });
        [value, slope, 2.0 * bend]
    }

    /// Its derivative at several places.
    fn slopes<const N: usize>(&self, s: [f64; N]) -> [f64; N] {
        let (mut values, mut slopes) = ([0.0; N], [0.0; N]);
        for c in self.coefficients().iter().rev() {
            for ((value, slope), s) in values.iter_mut().zip(&mut slopes).zip(s) {
                *slope = *slope * s + *value;
                *value = *value * s + c;
            }
        }
        slopes
    }

    /// Tells `found` of a minimum in each of `N` equal parts of (0, 1] on which it falls at the start and not at the end:
    /// about where it is, and the value there, which is below `low` or little above.
    pub fn minima<const N: usize>(&self, low: f64, mut found: impl FnMut(f64, f64)) {
        let at = |k: usize| k as f64 / N as f64;
        let mut slope = self.c[1];
        let ends = std::array::from_fn::<f64, N, _>(|k| at(k + 1));
        for (k, to) in self.slopes(ends).into_iter().enumerate() {
            let from = std::mem::replace(&mut slope, to);
            if !(from < 0.0 && slope >= 0.0) {
                continue;
            }
            // A secant of the slope, then vertices of parabolas.
            let [a, b] = [at(k), at(k + 1)];
            let mut turn = a + (b - a) * (from / (from - slope));
            let mut least = f64::INFINITY;
            for _ in 0..2 {
                let [value, slope, bend] = self.with_derivatives(turn);
                let to_vertex = if bend > 0.0 { -slope / bend } else { 0.0 };
                turn = (turn + to_vertex).clamp(a, b);
                least = value + 0.5 * slope * to_vertex;
                if least > 2.0 * low {
                    break;
                }
            }
            found(turn, least);
        }
    }

    /// A lower bound of its values.
    #[inline]
    pub fn lower_bound(&self) -> f64 {
        self.c[1..=self.degree].iter().fold(self.c[0], |least, c| least + c.min(0.0))
    }

    /// Extends it by a term of the next order, if there is room for one, to the value `end` at 1.
    #[inline]
    pub fn extend_to(&mut self, end: f64) {
        if self.degree < MAX_ORDER {
            let lacking = end - self.at(1.0);
            self.degree += 1;
            self.c[self.degree] = lacking;
        }
    }

    /// This polynomial plus the constant `level`.
    pub fn raised(mut self, level: f64) -> Self {
        self.c[0] += level;
        self
    }

    /// Its derivative.
    pub fn derivative(mut self) -> Self {
        for k in 1..=self.degree {
            self.c[k - 1] = k as f64 * self.c[k];
        }
        self.c[self.degree] = 0.0;
        self.degree = self.degree.saturating_sub(1);
        self
    }

    /// The polynomial with the opposite sign.
    pub fn negated(mut self) -> Self {
        for c in &mut self.c {
            *c = -*c;
        }
        self
    }

    /// Its root in (0, 1), to within `precision`, where it falls there and has no other; `None` where the signs of its Bernstein
    /// coefficients do not show that.
    pub fn only_fall(&self, precision: f64) -> Option<f64> {
        let ([first, last], is_simple) = Bernstein::on(self, 0.0).signs();
        let falls = is_simple && first > 0.0 && last < 0.0;
        falls.then(|| find_root(|s| self.at(s), Bracket { above: 0.0, below: 1.0 }, precision))
    }

    /// The first root in `[from, 1]` at which the polynomial falls from above zero, to within `precision`; `None`
    /// where there is none.
    pub fn first_fall(&self, from: f64, precision: f64) -> Option<f64> {
        let bracket = Bernstein::on(self, from).first_fall(from, 1.0, DEPTH)?;
        if bracket.above == bracket.below {
            return Some(bracket.below);
        }
        Some(find_root(|s| self.at(s), bracket, precision))
    }
}

/// A polynomial on some interval, given by its Bernstein coefficients:
///
/// ```text
/// p = Σ b_j C(n, j) uʲ (1 − u)ⁿ⁻ʲ,   u from 0 to 1
/// ```
///
/// By Descartes' rule of signs the number of roots inside the interval is the number of sign changes in `b_0 … b_n`,
/// or less by an even number. No change or one change determines the number of roots; with more changes the interval
/// is halved. So no crossing of the polynomial is missed, however many there are.
///
/// F. Rouillier, P. Zimmermann, "Efficient isolation of polynomial's real roots", J. Comput. Appl. Math.
/// 162(1), 33–50 (2004).
#[derive(Clone, Copy)]
struct Bernstein {
    b: [f64; MAX_ORDER + 1],
    degree: usize,
}

impl Bernstein {
    /// `p` on [`from`, 1].
    fn on(p: &Polynomial, from: f64) -> Self {
        let n = p.degree;
        let mut b = p.c;
        // Substitution of s = from + (1 − from) u: Horner's shift, then a scaling.
        let width = 1.0 - from;
        if from != 0.0 {
            for i in 0..n {
                for j in (i..n).rev() {
                    b[j] += from * b[j + 1];
                }
            }
            let mut scale = 1.0;
            for b in &mut b[..=n] {
                *b *= scale;
                scale *= width;
            }
        }
        // b_j = Σ_k C(j, k)/C(n, k) c_k, computed as repeated sums.
        for (b, per_binomial) in b.iter_mut().zip(&PER_BINOMIAL[n][..=n]) {
            *b *= per_binomial;
        }
        for i in 0..n {
            for j in (i + 1..=n).rev() {
                b[j] += b[j - 1];
            }
        }
        Self { b, degree: n }
    }

    fn coefficients(&self) -> &[f64] {
        &self.b[..=self.degree]
    }

    /// Signs of the first and the last nonzero coefficient, which are the signs of the polynomial just inside both
    /// ends, and whether the sign changes at most once.
    fn signs(&self) -> ([f64; 2], bool) {
        let mut signs = self.coefficients().iter().filter(|b| **b != 0.0).map(|b| b.signum());
        let first = signs.next().unwrap_or(0.0);
        let (mut last, mut changes) = (first, 0);
        for sign in signs {
            changes += u32::from(sign != last);
            last = sign;
        }
        ([first, last], changes <= 1)
    }

    /// The polynomial on both halves of the interval, by the algorithm of de Casteljau.
    fn halves(&self) -> [Self; 2] {
        let n = self.degree;
        let (mut left, mut right) = (*self, *self);
        for i in 1..=n {
            left.b[i - 1] = right.b[0];
            for j in 0..=n - i {
                right.b[j] = 0.5 * (right.b[j] + right.b[j + 1]);
            }
        }
        left.b[n] = right.b[0];
        [left, right]
    }

    /// A bracket of the first fall, where the interval is that from `lo` to `hi`. The bracket has no width where a
    /// root is met exactly.
    fn first_fall(&self, lo: f64, hi: f64, depth: u32) -> Option<Bracket> {
        let ([first, last], is_simple) = self.signs();
        if is_simple || depth == 0 {
            return (first > 0.0 && last < 0.0).then_some(Bracket { above: lo, below: hi });
        }
        let middle = lo + 0.5 * (hi - lo);
        let [left, right] = self.halves();
        left.first_fall(lo, middle, depth - 1).or_else(|| {
            let falls_in_the_middle = left.signs().0[1] > 0.0 && right.signs().0[0] < 0.0;
            if falls_in_the_middle {
                return Some(Bracket { above: middle, below: middle });
            }
            right.first_fall(middle, hi, depth - 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial with these roots and leading coefficient.
    fn of_roots(leading: f64, roots: &[f64]) -> Polynomial {
        let mut c = vec![leading];
        for root in roots {
            c.push(0.0);
            for k in (1..c.len()).rev() {
                c[k] = c[k - 1] - root * c[k];
            }
            c[0] *= -root;
        }
        Polynomial::new(c.into_iter())
    }

    #[test]
    fn the_first_of_many_falls_is_found() {
        let cases: [(f64, &[f64], Option<f64>); 8] = [
            (1.0, &[0.3, 0.4], Some(0.3)),
            (1.0, &[0.3, 0.300001, 0.7, 0.8], Some(0.3)),
            (-1.0, &[0.3], Some(0.3)),
            (1.0, &[0.3], None),
            // The polynomial rises at the first root.
            (-1.0, &[0.2, 0.5, 0.6, 0.9], Some(0.5)),
            (-1.0, &[0.25, 0.5], Some(0.5)),
            (1.0, &[1.5, -0.5], None),
            (1.0, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], Some(0.1)),
        ];
        for (leading, roots, expected) in cases {
            let found = of_roots(leading, roots).first_fall(0.0, 1e-12);
            match (found, expected) {
                (Some(found), Some(expected)) => {
                    assert!((found - expected).abs() < 1e-9, "{found}")
                }
                (found, expected) => assert_eq!(found, expected, "{roots:?}"),
            }
        }
    }

    #[test]
    fn a_search_from_inside_leaves_out_what_is_before() {
        let p = of_roots(1.0, &[0.1, 0.2, 0.6, 0.7]);
        let found = p.first_fall(0.3, 1e-12).unwrap_or(f64::NAN);
        assert!((found - 0.6).abs() < 1e-10, "{found}");
        assert_eq!(p.first_fall(0.75, 1e-12), None);
    }

    #[test]
    fn an_only_fall_is_the_first_one_and_others_are_not_told() {
        for (leading, roots) in [(-1.0, &[0.3][..]), (-2.0, &[0.7, 3.0, 4.0]), (3.0, &[0.999, 1.5])]
        {
            let p = of_roots(leading, roots);
            let found = p.only_fall(1e-14);
            assert!(found.is_some_and(|s| (s - roots[0]).abs() < 1e-13), "{roots:?}: {found:?}");
            assert_eq!(found, p.first_fall(0.0, 1e-14));
        }
        // It rises again, rises, is only touched, has no root, falls at zero.
        for (leading, roots) in [
            (1.0, &[0.3, 0.4][..]),
            (1.0, &[0.3]),
            (1.0, &[0.5, 0.5]),
            (1.0, &[1.5, -0.5]),
            (-1.0, &[0.0]),
        ] {
            assert_eq!(of_roots(leading, roots).only_fall(1e-14), None, "{roots:?}");
        }
    }

    #[test]
    fn a_touch_is_no_fall() {
        let p = of_roots(1.0, &[0.6, 0.6]).raised(4e-15);
        assert_eq!(p.first_fall(0.0, 1e-12), None);
        let falls = p.raised(-1e-14).first_fall(0.0, 1e-12).unwrap_or(f64::NAN);
        assert!((falls - 0.6).abs() < 1e-6, "{falls}");
    }
}
