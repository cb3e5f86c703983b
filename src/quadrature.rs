//! Gauss–Legendre quadrature: integrals over a step.

/// Nodes and weights on [0, 1], exact to degree nine: steps of high order are long.
pub(crate) const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 64.0 / 225.0),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_to_the_ninth_are_integrated_to_rounding() {
        for k in 0..10 {
            let sum: f64 = GAUSS.iter().map(|(x, w)| w * x.powi(k)).sum();
            assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-15, "{k}: {sum}");
        }
    }
}
