//! The shape of a guard between the ends of a step, from values and rates at both ends.

use crate::real::Ordered;
use crate::root::{Bracket, find_root};

/// A minimum of the cubic is examined further unless it lies above zero by more than this many of its depths. For a
/// sine that touches zero in the middle of a step of s radians the cubic is off by 4 tan(s/4)/s − 1 of its depth, and
/// by no more where the sine touches zero elsewhere (by a scan). Here s = 3π/2, three quarters of a period.
const NEAR: f64 = 1.05;
/// The depth is taken to be at least this fraction of the [`bend`], which is its value for a minimum in the middle.
/// Next to a steep fall of a strongly damped sine the cubic's own depth is smaller.
const DEPTH: f64 = 1.0 / 8.0;
/// Number of intervals between the nodes at which the polynomial of degree six is evaluated.
pub(super) const N_NODES: usize = 16;

/// Whether a guard with these values and rates at both ends of a step of size `h` is so far above zero that the cubic
/// through them is clear of it. The cubic differs from the chord by at most 4/27 of its bend, and its depth is at
/// most that and the rise of the chord together.
#[inline]
pub(crate) fn is_far<T: Ordered>(from: [T; 2], to: [T; 2], h: T) -> T::Mask {
    let rise = (to[0] - from[0]).abs();
    let near = bend(from, to, h) * ((1.0 + NEAR) * 4.0 / 27.0) + rise * NEAR;
    from[0].lesser(to[0]).is_above(near)
}

/// Zero or more where a guard with these values and rates at both ends of a step of size `h`, on which it
/// [is far](is_far), does not turn below `limit` there: it does not fall at the start, or does not rise at the end, or is
/// not below `limit`.
#[inline]
pub(crate) fn no_turn<T: Ordered>(from: [T; 2], to: [T; 2], h: T, limit: T) -> T {
    let slopes = (from[1] * h).larger(-(to[1] * h));
    slopes.larger(from[0].lesser(to[0]) - limit)
}

/// Sum of the absolute differences of both end slopes from the slope of the chord, over the step.
#[inline]
fn bend<T: Ordered>([g0, rate0]: [T; 2], [g1, rate1]: [T; 2], h: T) -> T {
    let rise = g1 - g0;
    (rate0 * h - rise).abs() + (rate1 * h - rise).abs()
}

/// Whether the cubic through the values and rates at both ends of a step of size `h` has no minimum inside that may
/// stand for a guard below zero. Values and rates must be finite, the values above zero.
pub(super) fn has_no_dip(from: [f64; 2], to: [f64; 2], h: f64) -> bool {
    match cubic_minimum([from[0], to[0]], [from[1] * h, to[1] * h]) {
        Some((theta, least)) if theta < 1.0 => {
            least > NEAR * (from[0].max(to[0]) - least).max(DEPTH * bend(from, to, h))
        }
        _ => true,
    }
}

/// `c₂` and `c₃` of the cubic `g₀ + s₀ θ + c₂ θ² + c₃ θ³` with these values and slopes at 0 and 1.
fn bent([g0, g1]: [f64; 2], [s0, s1]: [f64; 2]) -> [f64; 2] {
    let rise = g1 - g0;
    [3.0 * rise - 2.0 * s0 - s1, s0 + s1 - 2.0 * rise]
}

/// The cubic with these values and slopes at 0 and 1, at `theta`.
pub(super) fn cubic_at(theta: f64, values: [f64; 2], slopes: [f64; 2]) -> f64 {
    let [c2, c3] = bent(values, slopes);
    values[0] + theta * (slopes[0] + theta * (c2 + theta * c3))
}

/// The slope of that cubic at `theta`.
pub(super) fn cubic_slope(theta: f64, values: [f64; 2], slopes: [f64; 2]) -> f64 {
    let [c2, c3] = bent(values, slopes);
    slopes[0] + theta * (2.0 * c2 + theta * 3.0 * c3)
}

/// Where the cubic with these values and slopes at 0 and 1 falls between them; `None` where it does not. One that rises from
/// zero falls beyond that root.
pub(crate) fn cubic_root(values: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
    let [at_0, at_1] = values;
    if at_0 == 0.0 && slopes[0] > 0.0 && at_1 < 0.0 {
        // The root of s₀ + c₂ θ + c₃ θ²: to its own rounding, however small it is, where the other one is far.
        let [c2, c3] = bent(values, slopes);
        let root = (c2 * c2 - 4.0 * c3 * slopes[0]).max(0.0).sqrt();
        let theta = if c2 < 0.0 { 2.0 * slopes[0] / (root - c2) } else { -0.5 * (c2 + root) / c3 };
        return Some(theta.min(1.0));
    }
    let bracket = Bracket { above: 0.0, below: 1.0 };
    let falls = at_0 > 0.0 && at_1 < 0.0;
    falls.then(|| find_root(|theta| cubic_at(theta, values, slopes), bracket, f64::EPSILON))
}

/// The place and the value of the minimum in (0, 1] of the cubic with these values and slopes at 0 and 1; `None` where it
/// has no minimum there.
pub(super) fn cubic_minimum([g0, g1]: [f64; 2], [s0, s1]: [f64; 2]) -> Option<(f64, f64)> {
    let [c2, c3] = bent([g0, g1], [s0, s1]);
    let discriminant = c2 * c2 - 3.0 * c3 * s0;
    if discriminant <= 0.0 {
        return None;
    }
    // The root of g' = 0 with g'' = 2 (c2 + 3 c3 θ) = 2 √discriminant above zero.
    let root = discriminant.sqrt();
    let theta = if c2 > 0.0 { -s0 / (c2 + root) } else { (root - c2) / (3.0 * c3) };
    let inside = theta > 0.0 && theta <= 1.0;
    inside.then_some((theta, g0 + theta * (s0 + theta * (c2 + theta * c3))))
}

/// Values at the nodes from 0 to 1 of the polynomial of degree six with these values and slopes at 0 and 1 and these
/// values at the quarters between.
///
/// ```text
/// g(θ) = c(θ) + 16 θ² (1 − θ)² q(θ),   c the cubic of both ends, q the parabola through the quarters
/// ```
pub(super) fn sextic(
    [g0, g1]: [f64; 2],
    [s0, s1]: [f64; 2],
    quarters: [f64; 3],
) -> [f64; N_NODES + 1] {
    let cubic = |theta: f64| cubic_at(theta, [g0, g1], [s0, s1]);
    let bubble = |theta: f64| 16.0 * (theta * (1.0 - theta)) * (theta * (1.0 - theta));
    let q: [f64; 3] = std::array::from_fn(|k| {
        let theta = 0.25 * (k + 1) as f64;
        (quarters[k] - cubic(theta)) / bubble(theta)
    });
    std::array::from_fn(|k| {
        let theta = k as f64 / N_NODES as f64;
        let u = 4.0 * theta - 2.0;
        let parabola = q[1] + 0.5 * u * (q[2] - q[0] + u * (q[0] - 2.0 * q[1] + q[2]));
        cubic(theta) + bubble(theta) * parabola
    })
}

/// Whether the cubic with the values `g` at `x` is above zero at all nodes from 0 to 1.
pub(super) fn stays_above_zero(x: [f64; 4], g: [f64; 4]) -> bool {
    // Newton's divided differences.
    let mut c = g;
    for order in 1..4 {
        for i in (order..4).rev() {
            c[i] = (c[i] - c[i - 1]) / (x[i] - x[i - order]);
        }
    }
    (0..=N_NODES).all(|k| {
        let theta = k as f64 / N_NODES as f64;
        c[0] + (theta - x[0]) * (c[1] + (theta - x[1]) * (c[2] + (theta - x[2]) * c[3])) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_through_four_values_is_followed() {
        let x = [0.0, 0.2, 0.6, 1.0];
        // Least at 0.3535.
        let g = |floor: f64| x.map(|x: f64| 4.0 * x.powi(3) - 1.5 * x + floor);
        assert!(stays_above_zero(x, g(0.36)));
        assert!(!stays_above_zero(x, g(0.34)));
    }

    #[test]
    fn a_cubic_falls_at_its_root_and_one_that_rises_from_zero_at_the_next() {
        // (θ + 1)(θ − ¼)(θ − 2)
        let root = cubic_root([0.5, -1.5], [-1.75, -1.25]);
        assert!(root.is_some_and(|root| (root - 0.25).abs() < 1e-15), "{root:?}");
        for size in [1.0, 1e-12] {
            // θ (θ − ¼)(θ − 2)
            let root = cubic_root([0.0, -0.75 * size], [0.5 * size, -size]);
            assert!(root.is_some_and(|root| (root - 0.25).abs() < 1e-15), "{root:?}");
        }
        for theta in [1e-3, 1e-14] {
            // θ (θ − θ₀)(θ − 2)
            let root = cubic_root([0.0, theta - 1.0], [2.0 * theta, -1.0]).unwrap();
            assert!((root / theta - 1.0).abs() < 1e-15, "{root:e}");
        }
        // θ (1 + θ − 8 θ²)
        let root = cubic_root([0.0, -6.0], [1.0, -21.0]).unwrap();
        assert!((root - (1.0 + 33.0_f64.sqrt()) / 16.0).abs() < 1e-15, "{root}");
        // Rounding hides that its two roots are one, at the end.
        let root = cubic_root([0.0, -2.92e-17], [0.973_202_900_384_493_5, -1.377e-17]);
        assert!(root.is_some_and(|root| (root - 1.0).abs() < 1e-7), "{root:?}");
        assert_eq!(cubic_root([0.0, -1.0], [-1.0, -1.0]), None);
        assert_eq!(cubic_root([1.0, 1.0], [-1.0, 1.0]), None);
    }

    #[test]
    fn the_minimum_of_a_cubic_is_found_where_it_is_inside() {
        // (θ − ¼)² and (θ − ¼)²(θ + 2) + 1, then a cubic that only rises, and one with a maximum only.
        let cases = [
            ([1.0 / 16.0, 9.0 / 16.0], [-0.5, 1.5], Some(0.0)),
            ([18.0 / 16.0, 43.0 / 16.0], [-15.0 / 16.0, 81.0 / 16.0], Some(1.0)),
            ([0.0, 1.0], [1.0, 1.0], None),
            ([0.0, 0.0], [1.0, -1.0], None),
        ];
        for (values, slopes, expected) in cases {
            match (cubic_minimum(values, slopes), expected) {
                (None, None) => {}
                (Some((_, least)), Some(value)) => assert!((least - value).abs() < 1e-14),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_polynomial_of_degree_six_is_followed_to_rounding() {
        let g = |x: f64| 1.0 - 2.0 * x + x.powi(3) - 4.0 * x.powi(5) + 3.0 * x.powi(6);
        let slope = |x: f64| -2.0 + 3.0 * x * x - 20.0 * x.powi(4) + 18.0 * x.powi(5);
        let nodes = sextic([g(0.0), g(1.0)], [slope(0.0), slope(1.0)], [0.25, 0.5, 0.75].map(g));
        for (k, node) in nodes.iter().enumerate() {
            assert!((node - g(k as f64 / N_NODES as f64)).abs() < 1e-14, "{k}: {node}");
        }
    }
}
