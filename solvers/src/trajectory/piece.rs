//! The solution on one step as values at Chebyshev points, whatever the method.
//!
//! The dense output of a step is a polynomial, of a degree that its method knows. Its values at the points
//!
//! ```text
//! θ_k = (1 − cos(k π/n))/2,   k = 0 … n
//! ```
//!
//! determine it if n is at least that degree. Here n is doubled, which keeps all points, until the polynomial predicts
//! the values at the new ones to rounding. It is then evaluated by the barycentric formula, which is stable:
//!
//! ```text
//! y(θ) = Σ_k w_k y_k/(θ − θ_k) / Σ_k w_k/(θ − θ_k),   w_k = (−1)ᵏ, half of that at both ends
//! ```
//!
//! J.-P. Berrut, L. N. Trefethen, "Barycentric Lagrange interpolation", SIAM Rev. 46(3), 501–517 (2004), (5.4).

use std::f64::consts::PI;

use crate::step::Step;
use crate::system::Vector;

/// Smallest and largest number of intervals between the points. The largest one is above the highest degree, 25.
const FEWEST: usize = 4;
const MOST: usize = 32;
/// Rounding of an interpolated value as a fraction of the largest value.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A step of a run: its mode, and the solution on it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Piece<Y, M> {
    pub(super) t0: f64,
    pub(super) t1: f64,
    pub(super) mode: M,
    /// States at the points.
    nodes: Vec<Y>,
}

impl<Y: Vector<f64>, M> Piece<Y, M> {
    /// The solution on `step`, whose dense output must be valid.
    pub(super) fn of(step: &dyn Step<Y>, mode: M) -> Self {
        let (t0, t1) = (step.t0(), step.t1());
        let at = |theta: f64| {
            let mut y = step.y1().clone();
            step.interpolate(t0 + theta * (t1 - t0), &mut y);
            y
        };
        let mut nodes: Vec<Y> = (0..=FEWEST).map(|k| at(point(k, FEWEST))).collect();
        nodes[0].clone_from(step.y0());
        nodes[FEWEST].clone_from(step.y1());
        while nodes.len() <= MOST {
            let n = nodes.len() - 1;
            let between = (0..n).map(|k| point(2 * k + 1, 2 * n));
            let found: Vec<Y> = between.clone().map(at).collect();
            let predicted: Vec<Y> = between.map(|theta| interpolate(&nodes, theta)).collect();
            if are_equal(&nodes, &found, &predicted) {
                break;
            }
            let mut found = found.into_iter();
            nodes = nodes.into_iter().flat_map(|y| [Some(y), found.next()]).flatten().collect();
        }
        Self { t0, t1, mode, nodes }
    }

    /// The solution at `t`.
    pub(super) fn at(&self, t: f64) -> Y {
        interpolate(&self.nodes, (t - self.t0) / (self.t1 - self.t0))
    }
}

/// The point with number `k` of `n + 1`.
fn point(k: usize, n: usize) -> f64 {
    0.5 * (1.0 - libm::cos(PI * k as f64 / n as f64))
}

/// The polynomial through `nodes` at `theta`.
fn interpolate<Y: Vector<f64>>(nodes: &[Y], theta: f64) -> Y {
    let n = nodes.len() - 1;
    let mut total = 0.0;
    let mut y = Y::from_fn(nodes[0].as_ref().len(), |_| 0.0);
    for (k, node) in nodes.iter().enumerate() {
        let distance = theta - point(k, n);
        if distance == 0.0 {
            return node.clone();
        }
        let share = if k == 0 || k == n { 0.5 } else { 1.0 };
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let weight = sign * share / distance;
        total += weight;
        for (y, node) in y.as_mut().iter_mut().zip(node.as_ref()) {
            *y += weight * node;
        }
    }
    y.as_mut().iter_mut().for_each(|y| *y /= total);
    y
}

/// Whether values are those predicted, to the rounding of the largest of the `nodes`.
fn are_equal<Y: Vector<f64>>(nodes: &[Y], found: &[Y], predicted: &[Y]) -> bool {
    (0..nodes[0].as_ref().len()).all(|i| {
        let size = nodes.iter().fold(0.0_f64, |size, y| size.max(y.as_ref()[i].abs()));
        let mut pairs = found.iter().zip(predicted);
        pairs.all(|(a, b)| (a.as_ref()[i] - b.as_ref()[i]).abs() <= ROUNDING * size)
    })
}
