//! Sobol indices: which part of the variance of a quantity each drawn key explains.
//!
//! ```text
//! main    S_i = V(E(Y | X_i)) / V(Y)        what fixing key i takes of the variance
//! total   T_i = 1 − V(E(Y | X_~i)) / V(Y)   what is left when all others are fixed: S_i and all that i interacts in
//! ```
//!
//! From N samples of [`saltelli`], a = Y(A_j), b = Y(B_j), m = Y(A_j with key i of B_j), with V of all a and b:
//!
//! ```text
//! S_i ≈ Σ (b − ȳ)(m − a) / (N V)     A. Saltelli et al., Comput. Phys. Commun. 181, 259–270 (2010), table 2 (b)
//! T_i ≈ Σ (a − m)² / (2 N V)         M. J. W. Jansen, Comput. Phys. Commun. 117, 35–43 (1999); there table 2 (f)
//! ```
//!
//! ȳ is the mean of all a and b: Σ (m − a) has the mean 0, so it changes nothing but the scatter, which without it grows
//! with ȳ²/V. The interval of each index lies between the 2.5 and the 97.5 % quantile of [`RESAMPLES`] bootstrap estimates: of as
//! many samples drawn from the N with replacement, by a fixed seed. It takes the samples as independent, so for points of a
//! Sobol sequence it is too wide rather than too narrow.

use deltazero_study::quantile::quantile;
use serde::Serialize;

use super::draw::mixed;
use super::saltelli::{self, A, B, MIXED};
use super::summary::are_alike;

/// Bootstrap estimates behind an interval.
pub const RESAMPLES: u64 = 500;
/// Their quantiles.
const ENDS: [f64; 2] = [0.025, 0.975];
/// Seed of what they draw.
const SEED: u64 = 1;
/// Samples that an estimate takes at least.
pub const LEAST_SAMPLES: usize = 8;

/// An index with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Index {
    /// The estimate.
    pub value: f64,
    /// Ends of its 95 % interval.
    pub interval: [f64; 2],
}

/// The indices of one key.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Indices {
    /// Main, or first-order.
    pub main: Index,
    /// Total.
    pub total: Index,
}

/// The indices of each key from the values of a quantity, sample by sample as [`saltelli`] orders them; none where there are
/// fewer than [`LEAST_SAMPLES`] samples or the quantity does not vary but by rounding.
///
/// # Panics
/// If the values are not of whole samples.
pub fn indices(values: &[f64], n_keys: usize) -> Option<Vec<Indices>> {
    let runs = saltelli::runs(n_keys) as usize;
    assert!(values.len().is_multiple_of(runs), "{} values in samples of {runs}", values.len());
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if are_alike(least, largest) {
        return None;
    }
    // Without what all have in common, of which the rounding would add up to a variance.
    let common = values.first().copied().unwrap_or_default();
    let values: Vec<f64> = values.iter().map(|value| value - common).collect();
    let samples: Vec<&[f64]> = values.chunks_exact(runs).collect();
    let n = samples.len();
    if n < LEAST_SAMPLES {
        return None;
    }
    let estimates = estimate(&samples, n_keys, |j| j)?;
    let mut resampled = vec![[Vec::new(), Vec::new()]; n_keys];
    for resample in 0..RESAMPLES {
        let stream = mixed(SEED, resample);
        let drawn = |j: usize| below(mixed(stream, j as u64), n);
        // One whose samples are all alike has no indices.
        let own = estimate(&samples, n_keys, drawn).unwrap_or_default();
        for (of_key, own) in resampled.iter_mut().zip(own) {
            of_key.iter_mut().zip(own).for_each(|(all, value)| all.push(value));
        }
    }
    let index = |value: f64, all: &mut Vec<f64>| {
        let interval = ENDS.map(|end| quantile(all, end).unwrap_or(value));
        Index { value, interval }
    };
    let of_key = |([main, total], [mains, totals]): ([f64; 2], &mut [Vec<f64>; 2])| Indices {
        main: index(main, mains),
        total: index(total, totals),
    };
    Some(estimates.into_iter().zip(&mut resampled).map(of_key).collect())
}

/// Main and total index of each key from the samples `drawn(0)`, `drawn(1)`, …, as many as there are.
fn estimate(
    samples: &[&[f64]],
    n_keys: usize,
    drawn: impl Fn(usize) -> usize,
) -> Option<Vec<[f64; 2]>> {
    let n = samples.len() as f64;
    let all = || (0..samples.len()).map(|j| samples[drawn(j)]);
    let mean = all().map(|sample| sample[A] + sample[B]).sum::<f64>() / (2.0 * n);
    let square = |x: f64| (x - mean) * (x - mean);
    let variance =
        all().map(|sample| square(sample[A]) + square(sample[B])).sum::<f64>() / (2.0 * n);
    let mut sums = vec![[0.0; 2]; n_keys];
    for sample in all() {
        let (a, b) = (sample[A], sample[B]);
        for ([main, total], m) in sums.iter_mut().zip(&sample[MIXED..]) {
            *main += (b - mean) * (m - a);
            *total += 0.5 * (a - m) * (a - m);
        }
    }
    let varies = variance > 0.0 && variance.is_finite();
    varies.then(|| sums.into_iter().map(|sum| sum.map(|sum| sum / (n * variance))).collect())
}

/// One of the numbers below `n`, each as likely as the others.
fn below(bits: u64, n: usize) -> usize {
    ((u128::from(bits) * n as u128) >> u64::BITS) as usize
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::draw::{Law, Place, Sampling};
    use super::*;

    /// Values of `f` on the design, each coordinate drawn from `law`.
    fn values(n: u64, n_keys: usize, law: Law, f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        let run = |run| {
            let x = (0..n_keys).map(|key| {
                let (sample, key) = saltelli::place(run, key, n_keys);
                let place = Place { seed: 7, grid: 0, sample, samples: n, key };
                law.at(place.unit(Sampling::Saltelli))
            });
            f(&x.collect::<Vec<_>>())
        };
        (0..n * saltelli::runs(n_keys)).map(run).collect()
    }

    /// Asserts that indices are those of a closed form up to `bound`, and that nine in ten intervals hold them.
    fn assert_near(found: &[Indices], main: &[f64], total: &[f64], bound: f64) {
        let closed = main.iter().zip(total).flat_map(|(main, total)| [*main, *total]);
        let found = found.iter().flat_map(|indices| [indices.main, indices.total]);
        let (mut outside, mut n, mut worst) = (0, 0, 0.0_f64);
        for (index, closed) in found.zip(closed) {
            worst = worst.max((index.value - closed).abs());
            let [low, high] = index.interval;
            assert!(high - low < 0.2, "{index:?}");
            outside += usize::from(!(low - 1e-12..=high + 1e-12).contains(&closed));
            n += 1;
        }
        assert!(worst < bound, "off by {worst:e}");
        assert!(outside * 10 <= n, "{outside} of {n} outside their intervals");
    }

    #[test]
    fn indices_of_ishigamis_function_are_its_closed_form() {
        // T. Ishigami, T. Homma (1990): Y = sin x₁ + a sin² x₂ + b x₃⁴ sin x₁, each x even from −π to π.
        let (a, b) = (7.0, 0.1);
        let f = |x: &[f64]| {
            let sin = x[1].sin();
            x[0].sin() + a * sin * sin + b * x[2].powi(4) * x[0].sin()
        };
        let v1 = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let (v2, v13) = (a * a / 8.0, b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0));
        let v = v1 + v2 + v13;
        let found = indices(&values(4096, 3, Law::Uniform([-PI, PI]), f), 3).unwrap();
        let total = [(v1 + v13) / v, v2 / v, v13 / v];
        assert_near(&found, &[v1 / v, v2 / v, 0.0], &total, ISHIGAMI);
    }

    #[test]
    fn indices_of_the_g_function_are_its_closed_form() {
        // A. Saltelli, I. M. Sobol' (1995): Y = Π (|4 x_i − 2| + a_i) / (1 + a_i), each x even from 0 to 1.
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0];
        let f = |x: &[f64]| {
            let factors = x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a));
            factors.product::<f64>()
        };
        let own = a.map(|a: f64| 1.0 / 3.0 / (1.0 + a).powi(2));
        let all = own.iter().map(|v| 1.0 + v).product::<f64>();
        let main = own.map(|v| v / (all - 1.0));
        let total = own.map(|v| v * all / (1.0 + v) / (all - 1.0));
        let found = indices(&values(4096, 6, Law::Uniform([0.0, 1.0]), f), 6).unwrap();
        assert_near(&found, &main, &total, G_FUNCTION);
    }

    #[test]
    fn a_large_mean_does_not_drown_the_indices() {
        let f = |offset: f64| move |x: &[f64]| offset + x[0] + 2.0 * x[1];
        let law = Law::Uniform([0.0, 1.0]);
        let [small, large] =
            [0.0, 1e6].map(|mean| indices(&values(256, 2, law, f(mean)), 2).unwrap());
        for (small, large) in small.iter().zip(&large) {
            assert!((small.main.value - large.main.value).abs() < 1e-6, "{small:?} {large:?}");
        }
        assert!((small[1].total.value - 0.8).abs() < 0.02, "{small:?}");
    }

    #[test]
    fn what_does_not_vary_or_is_too_little_has_no_indices() {
        let law = Law::Uniform([0.0, 1.0]);
        for n in [64, 4096] {
            assert_eq!(indices(&values(n, 2, law, |_| 0.1), 2), None);
            let rounding = |x: &[f64]| x[0].sin().powi(2) + x[0].cos().powi(2) + x[1] * 1e-15;
            assert_eq!(indices(&values(n, 2, law, rounding), 2), None);
        }
        assert_eq!(indices(&values(7, 2, law, |x| x[0]), 2), None);
    }

    /// Largest errors allowed; measured 3.3e-3 and 7.7e-4.
    const ISHIGAMI: f64 = 1e-2;
    const G_FUNCTION: f64 = 3e-3;
}
