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

/// Nodes and weights on [0, 1].
pub type Nodes = &'static [(f64, f64)];

/// Exact to degree seven.
const GAUSS_4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// The nodes for steps of a method of this order: a dense output of order up to five has degree four at most, and the
/// eighth degree of a power is beyond its error.
pub fn nodes_of_order(order: usize) -> Nodes {
    if order <= 5 { &GAUSS_4 } else { &GAUSS }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_below_twice_the_nodes_are_integrated_to_rounding() {
        for nodes in [nodes_of_order(5), nodes_of_order(6)] {
            for k in 0..2 * nodes.len() as i32 {
                let sum: f64 = nodes.iter().map(|(x, w)| w * x.powi(k)).sum();
                assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-15, "{k}: {sum}");
            }
        }
    }
}
