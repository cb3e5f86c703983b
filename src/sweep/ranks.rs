//! Rank correlation after Spearman: how far two quantities rise and fall together, whatever the shape.
//!
//! ```text
//! ρ = Σ (r_i − r̄)(s_i − r̄) / √(Σ (r_i − r̄)² Σ (s_i − r̄)²)      r, s: ranks of x and y,  r̄ = (n + 1)/2
//! ```
//!
//! Equal values share the mean of their ranks. ρ is 1 where y never falls as x rises, −1 where it never rises, and near 0
//! where it does neither as a whole: a dependence that turns round is not seen.
//!
//! C. Spearman, "The proof and measurement of association between two things", Am. J. Psychol. 15, 72–101 (1904);
//! ties as M. G. Kendall, "Rank Correlation Methods" (1948), chapter 3.

/// Ends of 95 % of a standard normal distribution.
const NORMAL_95: f64 = 1.96;

/// A rank correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// Spearman's ρ.
    pub rho: f64,
    /// Pairs that it is of.
    pub n: usize,
}

impl Correlation {
    /// What |ρ| of `n` pairs that have nothing to do with each other stays below in 19 of 20 cases: the standard deviation of
    /// ρ over all orders is 1/√(n − 1), its distribution nearly normal from some ten pairs on.
    pub fn by_chance(self) -> f64 {
        NORMAL_95 / (self.n.saturating_sub(1) as f64).sqrt()
    }
}

/// The rank correlation of the pairs of which both are finite; none where one of the two does not vary.
///
/// ```
/// use deltazero::sweep::ranks::spearman;
///
/// let x = [1.0, 2.0, 3.0, 4.0];
/// assert_eq!(spearman(&x, &x.map(f64::exp)).map(|own| own.rho), Some(1.0));
/// assert_eq!(spearman(&x, &x.map(|x| -x)).map(|own| own.rho), Some(-1.0));
/// assert_eq!(spearman(&x, &[7.0; 4]), None);
/// ```
pub fn spearman(x: &[f64], y: &[f64]) -> Option<Correlation> {
    let pairs = x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite());
    let (mut x, mut y): (Vec<f64>, Vec<f64>) = pairs.unzip();
    let n = x.len();
    let mean = (n as f64 + 1.0) / 2.0;
    for values in [&mut x, &mut y] {
        rank(values);
        values.iter_mut().for_each(|rank| *rank -= mean);
    }
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let squares = [sum(&x, &x), sum(&y, &y)];
    let varies = squares.iter().all(|square| *square > 0.0);
    let rho = || sum(&x, &y) / (squares[0] * squares[1]).sqrt();
    varies.then(|| Correlation { rho: rho().clamp(-1.0, 1.0), n })
}

/// Puts its rank in the place of each value, from 1; equal ones have the mean of theirs.
fn rank(values: &mut [f64]) {
    let mut sorted: Vec<(f64, usize)> = values.iter().copied().zip(0..).collect();
    sorted.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut before = 0;
    for equal in sorted.chunk_by(|(a, _), (b, _)| a == b) {
        let mean = before as f64 + (equal.len() as f64 + 1.0) / 2.0;
        equal.iter().for_each(|(_, at)| values[*at] = mean);
        before += equal.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_share_the_mean_of_their_ranks() {
        let mut values = [3.0, 1.0, 3.0, -2.0, 3.0, 1.0];
        rank(&mut values);
        assert_eq!(values, [5.0, 2.5, 5.0, 1.0, 5.0, 2.5]);
    }

    #[test]
    fn without_ties_it_is_the_formula_of_the_differences() {
        let found = spearman(&[1.0, 2.0, 3.0, 4.0, 5.0], &[3.0, 1.0, 2.0, 60.0, 3.5]).unwrap();
        // Ranks of y: 3, 1, 2, 5, 4; d = −2, 1, 1, −1, 1; Σd² = 8; 1 − 6·8/120 = 0.6.
        assert!((found.rho - 0.6).abs() < 1e-15 && found.n == 5, "{found:?}");
    }

    #[test]
    fn ties_count_as_by_hand() {
        // Ranks of x: 1, 2.5, 2.5, 4, of y: 1.5, 1.5, 3, 4; from the mean 2.5: −1.5, 0, 0, 1.5 and −1, −1, 0.5, 1.5.
        // Σ xy = 1.5 + 2.25 = 3.75, Σ x² = 4.5, Σ y² = 4.5; ρ = 3.75/4.5 = 5/6.
        let found = spearman(&[0.1, 7.0, 7.0, 8.0], &[-1.0, -1.0, 0.0, 1e9]).unwrap();
        assert!((found.rho - 5.0 / 6.0).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn pairs_that_lack_a_number_are_left_out_and_the_rest_is_ranked_anew() {
        let x = [1.0, 5.0, 2.0, 3.0, f64::NAN];
        let y = [1.0, f64::NAN, 4.0, 9.0, -3.0];
        assert_eq!(spearman(&x, &y), Some(Correlation { rho: 1.0, n: 3 }));
        assert_eq!(spearman(&[], &[]), None);
        assert_eq!(spearman(&[1.0], &[1.0]), None);
    }

    #[test]
    fn chance_is_less_with_more_pairs() {
        let bound = |n| Correlation { rho: 0.0, n }.by_chance();
        assert!((bound(101) - 0.196).abs() < 1e-12);
        assert!(bound(2) > 1.0, "two pairs tell nothing");
    }
}
