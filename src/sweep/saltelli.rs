//! The design for Sobol indices: which values the runs of a sample have.
//!
//! ```text
//! sample j of k keys   run  0   A_j         the draws of the sample
//!                      run  1   B_j         others
//!                      run 2+i  A_j but key i from B_j,   i = 0 … k − 1
//! ```
//!
//! A and B are the two halves of one point with 2k coordinates, so both are spread as its sequence spreads.
//!
//! A. Saltelli et al., "Variance based sensitivity analysis of model output. Design and estimator for the total
//! sensitivity index", Comput. Phys. Commun. 181, 259–270 (2010), section 3.

/// The run of a sample that has all values of A, and the one that has all of B.
pub const A: usize = 0;
/// See [`A`].
pub const B: usize = 1;
/// The run that has the value of B of the first key.
pub const MIXED: usize = 2;

/// Runs of a sample of `n_keys` keys.
pub fn runs(n_keys: usize) -> u64 {
    (MIXED + n_keys) as u64
}

/// The sample of the run number `run` at its grid point, and the coordinate of it that the key number `key` takes.
pub(super) fn place(run: u64, key: usize, n_keys: usize) -> (u64, usize) {
    let (sample, own) = (run / runs(n_keys), (run % runs(n_keys)) as usize);
    let is_of_b = own == B || own == MIXED + key;
    (sample, if is_of_b { n_keys + key } else { key })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_both_halves_of_a_point_and_each_key_exchanged_once() {
        let coordinates = |run| [0, 1].map(|key| place(run, key, 2).1);
        assert_eq!((0..4).map(coordinates).collect::<Vec<_>>(), [[0, 1], [2, 3], [2, 1], [0, 3]]);
        assert_eq!([3, 4].map(|run| place(run, 0, 2).0), [0, 1]);
    }
}
