//! Gauss–Legendre quadrature: integrals over a step.

/// Nodes and weights on [0, 1], exact to degree thirteen: steps of high order are long.
pub const GAUSS: [(f64, f64); 7] = [
    (0.025_446_043_828_620_74, 0.064_742_483_084_434_85),
    (0.129_234_407_200_302_78, 0.139_852_695_744_638_33),
    (0.297_077_424_311_301_4, 0.190_915_025_252_559_47),
    (0.5, 256.0 / 1225.0),
    (0.702_922_575_688_698_6, 0.190_915_025_252_559_47),
    (0.870_765_592_799_697_2, 0.139_852_695_744_638_33),
    (0.974_553_956_171_379_3, 0.064_742_483_084_434_85),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_to_the_thirteenth_are_integrated_to_rounding() {
        for k in 0..14 {
            let sum: f64 = GAUSS.iter().map(|(x, w)| w * x.powi(k)).sum();
            assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-15, "{k}: {sum}");
        }
    }
}
