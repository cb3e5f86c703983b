//! The set of states that a solution is known to be in: a parallelepiped whose axes move with the flow.

use super::interval::{Interval, points};
use crate::linear::DenseLu;

/// The states `c + Σ_j a_j r_j` with the numbers `r_j` anywhere in their intervals.
///
/// A box along the coordinates would grow at each step, by all that turns and shears. So the axes are the images of the
/// axes before (a parallelepiped), as long as they are well apart. Where they are not, they are made orthogonal in
/// units of the scale, the longest edge first (Lohner's method). Every `r_j` contains zero, so the center is one of the
/// states.
///
/// R. J. Lohner, *Einschließung der Lösung gewöhnlicher Anfangs- und Randwertaufgaben und Anwendungen*, thesis,
/// Universität Karlsruhe (1988).
#[derive(Clone, Debug)]
pub(super) struct Set {
    pub(super) center: Vec<f64>,
    /// The axes `a_j`, in units of the states.
    pub(super) axes: Vec<Vec<f64>>,
    pub(super) r: Vec<Interval>,
    scale: Vec<f64>,
}

impl Set {
    /// The one state `y`; `scale` are sizes of the states that are comparable. They are rounded to powers of two, by
    /// which products are exact, and which no product with an entry of an axis makes subnormal.
    pub(super) fn point(y: &[f64], scale: &[f64]) -> Self {
        let power = |s: &f64| libm::log2(*s).round().clamp(-FARTHEST_SCALE, FARTHEST_SCALE);
        let scale: Vec<f64> = scale.iter().map(|s| libm::ldexp(1.0, power(s) as i32)).collect();
        let axis = |j| (0..y.len()).map(|i| if i == j { scale[i] } else { 0.0 }).collect();
        Self {
            center: y.to_vec(),
            axes: (0..y.len()).map(axis).collect(),
            r: vec![Interval::ZERO; y.len()],
            scale,
        }
    }

    /// The smallest box along the coordinates that contains it.
    pub(super) fn hull(&self) -> Vec<Interval> {
        let axes: Vec<_> = self.axes.iter().map(|axis| points(axis)).collect();
        along(&points(&self.center), &axes, &self.r)
    }

    /// The center, as intervals.
    pub(super) fn center(&self) -> Vec<Interval> {
        points(&self.center)
    }

    /// The image `center + Σ_j columns_j r_j`, for every center and every column of their intervals. `None` where its
    /// bounds are not finite.
    pub(super) fn image(&self, center: &[Interval], columns: &[Vec<Interval>]) -> Option<Self> {
        let middle: Vec<f64> = center.iter().map(|c| c.mid()).collect();
        let rest = center.iter().zip(&middle).map(|(c, m)| *c - *m);
        let rest: Vec<_> = rest.zip(&self.scale).map(|(x, scale)| x / *scale).collect();
        let scaled = |column: &Vec<Interval>| -> Vec<_> {
            column.iter().zip(&self.scale).map(|(x, scale)| *x / *scale).collect()
        };
        let columns: Vec<_> = columns.iter().map(scaled).collect();
        let frame = Frame::along(&columns, &self.r)?;
        // The inverse times the columns first: their product with r is not wrapped by the coordinates between.
        let turned: Vec<_> = columns.iter().map(|column| frame.coordinates(column)).collect();
        let r = along(&frame.coordinates(&rest), &turned, &self.r);
        let axes =
            frame.axes.iter().map(|a| a.iter().zip(&self.scale).map(|(a, s)| a * s).collect());
        let axes: Vec<Vec<f64>> = axes.collect();
        let is_finite = middle.iter().chain(axes.iter().flatten()).all(|x| x.is_finite())
            && r.iter().all(|r| r.mag().is_finite());
        is_finite.then(|| Self { center: middle, axes, r, scale: self.scale.clone() })
    }
}

/// `x + Σ_j columns_j r_j`.
pub(super) fn along(x: &[Interval], columns: &[Vec<Interval>], r: &[Interval]) -> Vec<Interval> {
    let of = |i: usize| columns.iter().zip(r).fold(x[i], |sum, (column, r)| sum + column[i] * *r);
    (0..x.len()).map(of).collect()
}

/// Entries of axes below this are zero, so that no product with a scale underflows.
const NO_ENTRY: f64 = 1e-60;
/// Largest power of two of a scale, and of its reciprocal.
const FARTHEST_SCALE: f64 = 800.0;
/// Share of a column that must be left after the axes before it are taken off, for an axis along it.
const LEAST_REST: f64 = 1e-8;
/// Largest norm of the inverse of axes of length one that are kept.
const FARTHEST: f64 = 1e4;
/// Largest `|I − P A|` for which `A⁻¹` is bounded.
const NO_INVERSE: f64 = 1e-6;

/// Axes `A` with about their inverse `P`.
struct Frame {
    axes: Vec<Vec<f64>>,
    /// The rows of `P`.
    inverse: Vec<Vec<f64>>,
    /// A bound of the entries of `(P A)⁻¹ − I`.
    skew: Interval,
}

impl Frame {
    /// Axes along the middle of the columns, or orthogonal ones near them. `None` where columns are not finite.
    fn along(columns: &[Vec<Interval>], r: &[Interval]) -> Option<Self> {
        let middle: Vec<Vec<f64>> =
            columns.iter().map(|c| c.iter().map(|x| x.mid()).collect()).collect();
        let axes = middle.iter().map(|c| rest(c, &[])).collect::<Option<Vec<_>>>();
        let images = axes.and_then(Self::of);
        images.or_else(|| Self::of(orthogonal(&middle, r)?))
    }

    /// These axes, where their inverse is bounded and not too large.
    ///
    /// With `E = I − P A`, `(P A)⁻¹ = I + E + E² + …`: its entries differ from those of I by ε/(1 − ε) at most, ε the
    /// largest sum over a row of |E|.
    fn of(axes: Vec<Vec<f64>>) -> Option<Self> {
        let n = axes.len();
        let mut lu = DenseLu::new(n);
        lu.factorise(&axes.concat(), 0.0, -1.0);
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let mut column = unit(n, i);
                lu.solve(&mut column);
                column
            })
            .collect();
        let inverse: Vec<Vec<f64>> =
            (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
        let size = inverse.iter().map(|row| dot(row, row)).sum::<f64>().sqrt();
        let error = |i: usize, j: usize| {
            let product = product(&inverse[i], &points(&axes[j]));
            Interval::from((product - if i == j { 1.0 } else { 0.0 }).mag())
        };
        let row = |i| (0..n).fold(Interval::ZERO, |sum, j| sum + error(i, j)).hi();
        let epsilon = (0..n).map(row).fold(0.0, f64::max);
        let skew = (Interval::from(epsilon) / (Interval::from(1.0) - epsilon)).hi();
        let holds = size < FARTHEST && epsilon < NO_INVERSE;
        holds.then(|| Self { axes, inverse, skew: Interval::within(skew) })
    }

    /// `A⁻¹ x = (P A)⁻¹ P x`.
    fn coordinates(&self, x: &[Interval]) -> Vec<Interval> {
        let by_inverse: Vec<_> = self.inverse.iter().map(|row| product(row, x)).collect();
        let sizes = by_inverse.iter().fold(Interval::ZERO, |sum, x| sum + Interval::from(x.mag()));
        let skew = self.skew * sizes;
        by_inverse.into_iter().map(|x| x + skew).collect()
    }
}

/// Axes by Gram and Schmidt, of the column with the longest edge first; `None` where columns are not finite.
fn orthogonal(columns: &[Vec<f64>], r: &[Interval]) -> Option<Vec<Vec<f64>>> {
    let n = columns.len();
    let edge = |j: usize| dot(&columns[j], &columns[j]).sqrt() * r[j].width();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|i, j| edge(*j).total_cmp(&edge(*i)));
    let mut axes: Vec<Vec<f64>> = Vec::new();
    for j in order {
        let any = |i: usize| rest(&unit(n, i), &axes);
        // A column that is a sum of those before it: any other direction.
        let axis = rest(&columns[j], &axes).or_else(|| (0..n).find_map(any));
        axes.push(axis?);
    }
    Some(axes)
}

/// The unit vector along coordinate `i` of `n`.
fn unit(n: usize, i: usize) -> Vec<f64> {
    (0..n).map(|k| if i == k { 1.0 } else { 0.0 }).collect()
}

fn product(a: &[f64], x: &[Interval]) -> Interval {
    a.iter().zip(x).fold(Interval::ZERO, |sum, (a, x)| sum + *x * *a)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The unit vector along what is left of `x` without its parts along `axes`; `None` where too little is.
fn rest(x: &[f64], axes: &[Vec<f64>]) -> Option<Vec<f64>> {
    let size = dot(x, x).sqrt();
    let mut left: Vec<f64> = x.iter().map(|x| x / size).collect();
    // Twice, since what the first round leaves may be small and not orthogonal.
    for _ in 0..2 {
        for axis in axes {
            let part = dot(&left, axis);
            left.iter_mut().zip(axis).for_each(|(x, a)| *x -= part * a);
        }
        let size = dot(&left, &left).sqrt();
        if size.is_nan() || size <= LEAST_REST {
            return None;
        }
        left.iter_mut().for_each(|x| *x /= size);
    }
    left.iter_mut().filter(|x| x.abs() < NO_ENTRY).for_each(|x| *x = 0.0);
    Some(left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;

    #[test]
    fn a_box_that_turns_keeps_its_size() {
        let (mut set, n) = (Set::point(&[1.0, 0.0], &[1.0, 1.0]), 1000);
        set.r = vec![Interval::within(1e-6); 2];
        let turn = |x: &[Interval]| -> Vec<Interval> {
            let angle = Interval::from(0.7);
            let (sin, cos) = angle.sin_cos();
            vec![cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]]
        };
        for _ in 0..n {
            let columns: Vec<Vec<Interval>> = set
                .axes
                .iter()
                .map(|a| turn(&a.iter().map(|a| Interval::from(*a)).collect::<Vec<_>>()))
                .collect();
            set = set.image(&turn(&set.center()), &columns).unwrap();
        }
        let (sin, cos) = libm::sincos(0.7 * f64::from(n));
        for (x, exact) in set.hull().iter().zip([cos, sin]) {
            assert!(x.contains(exact) && x.width() < 6e-6, "{x:?} about {exact}");
        }
    }

    #[test]
    fn an_image_holds_the_images_of_all_its_points() {
        let mut set = Set::point(&[1.0, -2.0, 0.5], &[1.0, 300.0, 1e-4]);
        set.r = vec![Interval::new(-1e-3, 2e-3), Interval::within(1e-5), Interval::within(0.1)];
        let columns: Vec<Vec<Interval>> = [[1.0, 0.2, 0.0], [0.3, -50.0, 1e-3], [2.0, 1.0, 2e-3]]
            .iter()
            .map(|c| c.iter().map(|x| Interval::new(*x, x + 1e-3)).collect())
            .collect();
        let center = [4.0, 5.0, 6.0].map(|x| Interval::new(x, x + 1e-6));
        let image = set.image(&center, &columns).unwrap().hull();
        let mut random = fastrand::Rng::with_seed(5);
        let mut of = |x: Interval| x.lo() + random.f64() * (x.hi() - x.lo());
        for _ in 0..1000 {
            let r: Vec<f64> = set.r.iter().map(|r| of(*r)).collect();
            for i in 0..3 {
                let x = of(center[i]) + (0..3).map(|j| of(columns[j][i]) * r[j]).sum::<f64>();
                assert!(image[i].contains(x), "{x} in {:?}", image[i]);
            }
        }
        // No wider than twice what it must be in the first state.
        let least = (0..3).map(|j| columns[j][0].mag() * set.r[j].width()).sum::<f64>();
        assert!(image[0].width() < 2.0 * least, "{:?} for {least}", image[0]);
    }

    #[test]
    fn scales_near_the_smallest_numbers_lose_no_state() {
        let mut set = Set::point(&[0.0; 2], &[1e-320; 2]);
        let unit = set.scale[0];
        set.r = vec![Interval::within(1e-15 / unit); 2];
        let columns =
            [[0.6, 0.8], [-0.8, 0.6]].map(|c| c.map(|x| Interval::from(x * unit)).to_vec());
        let image = set.image(&[Interval::ZERO; 2], &columns).unwrap().hull();
        let exact = along(&[Interval::ZERO; 2], &columns, &set.r);
        for (image, exact) in image.iter().zip(exact) {
            // A corner of the box, by the same products.
            assert!(image.mag() >= exact.mag() * (1.0 - 1e-14), "{image:?} for {exact:?}");
        }
    }

    #[test]
    fn columns_that_are_no_basis_are_completed() {
        let mut set = Set::point(&[0.0, 0.0], &[1.0, 1.0]);
        set.r = vec![Interval::within(1.0), Interval::within(0.5)];
        let along_one = [1.0, 2.0].map(|x: f64| vec![Interval::from(x), Interval::ZERO]);
        let image = set.image(&[Interval::ZERO; 2], &along_one).unwrap().hull();
        assert!(image[0].contains(2.0) && image[0].width() < 4.1, "{image:?}");
        assert!(image[1].contains(0.0) && image[1].width() < 1e-12, "{image:?}");
    }
}
