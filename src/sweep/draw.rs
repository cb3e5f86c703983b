//! Random draws, each a function of the seed and the number of its run alone: no state goes from one to the next.

use serde::{Deserialize, Serialize};

use super::normal::quantile;

/// How the draws at a grid point are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// Each draw for itself.
    Random,
    /// Of the draws of a key one in each of as many equal slices of probability.
    LatinHypercube,
    /// Points of a Sobol sequence, scrambled.
    Sobol,
    /// The design of [`saltelli`](super::saltelli) over such points, for Sobol indices.
    Saltelli,
}

impl Sampling {
    /// The words for it.
    pub const WORDS: [(&'static str, Self); 4] = [
        ("random", Self::Random),
        ("latin_hypercube", Self::LatinHypercube),
        ("sobol", Self::Sobol),
        ("saltelli", Self::Saltelli),
    ];
}

/// Most points of a Sobol sequence at a grid point, as the table of its crate has them.
pub const MOST_SOBOL: u64 = 1 << 16;

/// Most keys that it is drawn for.
pub const MOST_SOBOL_KEYS: usize = 256;

/// 2⁻²⁵.
const HALF_A_STEP: f64 = 1.0 / 33_554_432.0;

/// A distribution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Even from a to b.
    Uniform([f64; 2]),
    /// The logarithm is even from ln a to ln b.
    LogUniform([f64; 2]),
    /// Normal, with this mean and standard deviation.
    Normal([f64; 2]),
}

impl Law {
    /// The value below which a part `u` of it lies, 0 < u < 1.
    pub fn at(self, u: f64) -> f64 {
        match self {
            Self::Uniform([a, b]) => (a + u * (b - a)).clamp(a, b),
            Self::LogUniform([a, b]) => {
                let (low, high) = (libm::log(a), libm::log(b));
                libm::exp(low + u * (high - low)).clamp(a, b)
            }
            Self::Normal([mean, deviation]) => mean + deviation * quantile(u),
        }
    }
}

/// Where a draw stands in its plan.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The seed.
    pub seed: u64,
    /// Number of the grid point.
    pub grid: u64,
    /// Number of the draw at it, of `samples`.
    pub sample: u64,
    /// Draws at each grid point.
    pub samples: u64,
    /// Number of the key that is drawn.
    pub key: usize,
}

impl Place {
    /// The draw there, a number between 0 and 1.
    pub fn unit(self, sampling: Sampling) -> f64 {
        let Self { seed, grid, sample, samples, key } = self;
        // One stream for each key; of it the number of the run.
        let stream = mixed(seed, key as u64);
        let own = between(mixed(stream, grid.wrapping_mul(samples).wrapping_add(sample)));
        match sampling {
            Sampling::Random => own,
            Sampling::LatinHypercube => {
                let slice = shuffled(sample, samples, mixed(!stream, grid));
                (slice as f64 + own) / samples as f64
            }
            Sampling::Sobol | Sampling::Saltelli => {
                let scramble = mixed(!seed, grid) as u32;
                let point = sobol_burley::sample(sample as u32, key as u32, scramble);
                // Its numbers are multiples of 2⁻²⁴: the middle of what each stands for.
                f64::from(point) + HALF_A_STEP
            }
        }
    }
}

/// A number between 0 and 1 drawn for a run, from a stream that no key has.
pub(super) fn unit_of_run(seed: u64, run: u64) -> f64 {
    between(mixed(mixed(seed, u64::MAX), run))
}

/// The output number `i` of the generator SplitMix64 that starts at `seed`.
///
/// G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014, figure 17; its state
/// goes up by the same odd number at each output, so that every one of them is computed from its number.
pub(crate) fn mixed(seed: u64, i: u64) -> u64 {
    let z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(i.wrapping_add(1)));
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The middle of one of 2⁵² equal parts of the interval from 0 to 1, so neither of its ends.
fn between(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) * f64::EPSILON
}

/// Where a shuffle of `0 … n − 1` puts `i`, computed for `i` alone.
///
/// Four rounds of a Feistel network permute the numbers of 2k bits, 4ᵏ ≥ n; what lands beyond n − 1 is sent on until
/// it does not, which leaves a permutation of the numbers below n (J. Black, P. Rogaway, "Ciphers with arbitrary
/// finite domains", CT-RSA 2002, method 2).
fn shuffled(i: u64, n: u64, seed: u64) -> u64 {
    let bits = (u64::BITS - n.saturating_sub(1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1_u64 << bits) - 1;
    let round =
        |(left, right): (u64, u64), r: u64| (right, left ^ (mixed(mixed(seed, r), right) & mask));
    let mut at = i;
    loop {
        let (left, right) = (0..4).fold((at >> bits, at & mask), round);
        at = left << bits | right;
        if at < n {
            return at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Sampling; 3] = [Sampling::Random, Sampling::LatinHypercube, Sampling::Sobol];

    fn units(sampling: Sampling, grid: u64, samples: u64, key: usize) -> Vec<f64> {
        let place = |sample| Place { seed: 7, grid, sample, samples, key };
        (0..samples).map(|sample| place(sample).unit(sampling)).collect()
    }

    fn mean(all: impl ExactSizeIterator<Item = f64>) -> f64 {
        let n = all.len() as f64;
        all.sum::<f64>() / n
    }

    #[test]
    fn draws_have_the_moments_of_their_law() {
        let n = 40_000;
        // Even: mean 1/2, variance 1/12. Measured at most, in the order of the bounds: 3.1e-3, 6.7e-4; 7.7e-8, 2.7e-8;
        // 2.1e-6, 6.3e-7. The mean of n independent draws has a standard deviation of 1.4e-3.
        let bounds = [[1e-2, 5e-3], [5e-7, 2e-7], [2e-5, 6e-6]];
        for (sampling, [of_mean, of_variance]) in ALL.into_iter().zip(bounds) {
            for key in 0..6 {
                let units = units(sampling, 3, n, key);
                assert!(units.iter().all(|u| 0.0 < *u && *u < 1.0));
                let m = mean(units.iter().copied());
                let variance = mean(units.iter().map(|u| (u - m) * (u - m)));
                assert!((m - 0.5).abs() < of_mean, "{sampling:?} {key}: mean {m}");
                assert!(
                    (variance - 1.0 / 12.0).abs() < of_variance,
                    "{sampling:?} {key}: {variance}"
                );
            }
        }
        let units = units(Sampling::LatinHypercube, 0, n, 0);
        let normal: Vec<f64> = units.iter().map(|u| Law::Normal([3.0, 0.5]).at(*u)).collect();
        let m = mean(normal.iter().copied());
        let deviation = mean(normal.iter().map(|x| (x - m) * (x - m))).sqrt();
        // Measured: 1.1e-5, 2.7e-5.
        assert!((m - 3.0).abs() < 1e-4 && (deviation - 0.5).abs() < 2e-4, "{m} {deviation}");
    }

    #[test]
    fn draws_of_two_keys_and_of_neighbouring_runs_are_not_correlated() {
        let n = 40_000;
        let correlation = |a: &[f64], b: &[f64]| {
            let products = a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5));
            12.0 * mean(products)
        };
        for sampling in ALL {
            let [a, b] = [0, 1].map(|key| units(sampling, 0, n, key));
            let other = units(sampling, 1, n, 0);
            // The correlation of independent ones has a standard deviation of 0.005.
            for (what, other) in [("key", &b), ("grid point", &other)] {
                let c = correlation(&a, other);
                assert!(c.abs() < 0.02, "{sampling:?} next {what}: {c}");
            }
        }
        let a = units(Sampling::Random, 0, n, 0);
        let c = correlation(&a[1..], &a[..a.len() - 1]);
        assert!(c.abs() < 0.02, "{c}");
    }

    #[test]
    fn a_latin_hypercube_has_one_draw_in_each_slice() {
        for n in [1, 2, 3, 10, 100, 1000] {
            for key in 0..3 {
                let mut slices: Vec<u64> = units(Sampling::LatinHypercube, 5, n, key)
                    .into_iter()
                    .map(|u| (u * n as f64) as u64)
                    .collect();
                slices.sort_unstable();
                assert!(slices.into_iter().eq(0..n), "{n} {key}");
            }
        }
    }

    #[test]
    fn the_generator_is_that_of_its_authors() {
        // The first outputs from the state 1234567, as the reference implementation prints them.
        let first = [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973];
        assert_eq!([mixed(1_234_567, 0), mixed(1_234_567, 1)], first);
    }

    #[test]
    fn laws_stay_between_their_ends() {
        let small = 0.5 * f64::EPSILON;
        for law in [Law::Uniform([0.05, 0.2]), Law::LogUniform([0.05, 0.2])] {
            assert!(
                (law.at(small) - 0.05).abs() < 1e-15 && (law.at(1.0 - small) - 0.2).abs() < 1e-15
            );
        }
        assert!((Law::LogUniform([1e5, 1e9]).at(0.5) / 1e7 - 1.0).abs() < 1e-14);
        assert_eq!(Law::Normal([0.1, 0.02]).at(0.5), 0.1);
    }
}
