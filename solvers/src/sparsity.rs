//! Jacobians of many states by few evaluations: columns without a common row are differentiated together.
//!
//! One evaluation of the right-hand side with numbers that know which states they depend on gives the pattern of the
//! Jacobian. It is that of the branches taken at this state, so it is found anew for each Jacobian, and never stale.
//! The columns are then put in groups whose members have no common row. One evaluation with dual numbers along eight
//! directions differentiates by all states of eight groups. The entries have the bits of an evaluation for each state.
//!
//! A. R. Curtis, M. J. D. Powell, J. K. Reid, "On the estimation of sparse Jacobian matrices", J. Inst. Math. Appl.
//! 13(1), 117–119 (1974). They take differences; the choice of the groups is theirs.

mod duals;

use std::ops::{Add, Div, Mul, Neg, Sub};

use duals::{DIRECTIONS, Duals};

use crate::real::{Real, Shortcuts};
use crate::system::{System, Vector};

/// Number of states whose influence one evaluation finds.
const WIDTH: usize = u64::BITS as usize;

/// A number, and the set of those of some [`WIDTH`] states that it depends on.
#[derive(Clone, Copy, Debug)]
struct Influenced {
    value: f64,
    by: u64,
}

impl Influenced {
    fn map(self, f: impl FnOnce(f64) -> f64) -> Self {
        Self { value: f(self.value), by: self.by }
    }

    fn join(self, other: Self, f: impl FnOnce(f64, f64) -> f64) -> Self {
        Self { value: f(self.value, other.value), by: self.by | other.by }
    }
}

impl Neg for Influenced {
    type Output = Self;

    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

/// An operation with another number, and with a constant.
macro_rules! operators {
    ($($Trait:ident::$name:ident),*) => {$(
        impl $Trait for Influenced {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                self.join(other, $Trait::$name)
            }
        }

        impl $Trait<f64> for Influenced {
            type Output = Self;

            fn $name(self, constant: f64) -> Self {
                self.map(|x| x.$name(constant))
            }
        }
    )*};
}

operators!(Add::add, Sub::sub, Mul::mul, Div::div);

impl Real for Influenced {
    // A root that is found from values alone depends on nothing; one iteration tells what it depends on.
    const NEWTON_STEPS: usize = 1;

    fn cst(x: f64) -> Self {
        Self { value: x, by: 0 }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn sqrt(self) -> Self {
        self.map(Real::sqrt)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.value);
        (self.map(|_| sin), self.map(|_| cos))
    }

    fn exp(self) -> Self {
        self.map(Real::exp)
    }

    fn ln(self) -> Self {
        self.map(Real::ln)
    }

    fn powf(self, a: f64) -> Self {
        self.map(|x| Real::powf(x, a))
    }
}

impl Shortcuts for Influenced {}

/// The rows of each column in which the Jacobian can be nonzero, as sets of [`WIDTH`] rows in a number.
struct Pattern {
    rows: Vec<u64>,
    /// Numbers in the set of a column.
    length: usize,
}

impl Pattern {
    /// The pattern of the Jacobian of `problem` in `mode` at `(t, y)`.
    fn new<P: System>(problem: &P, mode: &P::Mode, t: f64, y: &[f64]) -> Self {
        // A system without states is refused where it is run.
        let (n, length) = (y.len(), y.len().div_ceil(WIDTH).max(1));
        let mut rows = vec![0; n * length];
        let mut dydt = P::State::from_fn(n, |_| Influenced::cst(0.0));
        for first in (0..n).step_by(WIDTH) {
            let states = first..n.min(first + WIDTH);
            let by = |i| if states.contains(&i) { 1 << (i - first) } else { 0 };
            let y = P::State::from_fn(n, |i| Influenced { value: y[i], by: by(i) });
            problem.rhs(mode.clone(), Influenced::cst(t), &y, &mut dydt);
            for (i, slope) in dydt.as_ref().iter().enumerate() {
                for j in bits(slope.by) {
                    rows[(first + j) * length + i / WIDTH] |= 1 << (i % WIDTH);
                }
            }
        }
        Self { rows, length }
    }

    fn columns(&self) -> impl Iterator<Item = &[u64]> {
        self.rows.chunks_exact(self.length)
    }

    /// The group of each column, and the number of groups. A column joins the first group that has none of its rows;
    /// one without rows is in no group.
    fn groups(&self) -> (Vec<Option<usize>>, usize) {
        let mut taken: Vec<u64> = Vec::new();
        let mut n_groups = 0;
        let group_of = |column: &[u64]| {
            if column.iter().all(|rows| *rows == 0) {
                return None;
            }
            let is_free = |taken: &[u64]| taken.iter().zip(column).all(|(a, b)| a & b == 0);
            let found = taken.chunks_exact(self.length).position(is_free);
            let group = found.unwrap_or(n_groups);
            if group == n_groups {
                taken.extend(column);
                n_groups += 1;
            } else {
                let of_group = &mut taken[group * self.length..][..self.length];
                of_group.iter_mut().zip(column).for_each(|(taken, rows)| *taken |= rows);
            }
            Some(group)
        };
        let groups = self.columns().map(group_of).collect();
        (groups, n_groups)
    }
}

/// The positions of the bits of a set.
fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = (set != 0).then(|| set.trailing_zeros() as usize);
        set &= set.wrapping_sub(1);
        position
    })
}

/// [`System::jacobian`] by its default for many states: the entries of the pattern at `(t, y)`. They go to a
/// trait object, so that this is compiled once for a system and not for each caller.
pub(crate) fn jacobian<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &[f64],
    entry: &mut dyn FnMut(usize, usize, f64),
) {
    let pattern = Pattern::new(problem, mode, t, y);
    let (groups, n_groups) = pattern.groups();
    let mut seeded = P::State::from_fn(y.len(), |i| Duals::cst(y[i]));
    let mut dydt = seeded.clone();
    for first in (0..n_groups).step_by(DIRECTIONS) {
        let direction = |of: &Option<usize>| of.and_then(|group| group.checked_sub(first));
        for (seeded, of) in seeded.as_mut().iter_mut().zip(&groups) {
            seeded.eps = unit(direction(of));
        }
        problem.rhs(mode.clone(), Duals::cst(t), &seeded, &mut dydt);
        for (j, (column, of)) in pattern.columns().zip(&groups).enumerate() {
            let Some(k) = direction(of).filter(|k| *k < DIRECTIONS) else { continue };
            for (word, rows) in column.iter().enumerate() {
                bits(*rows).for_each(|i| {
                    let i = word * WIDTH + i;
                    entry(i, j, dydt.as_ref()[i].eps[k]);
                });
            }
        }
    }
}

/// The unit vector of direction `k`; zeros where `k` is not among the [`DIRECTIONS`] of an evaluation.
fn unit(k: Option<usize>) -> [f64; DIRECTIONS] {
    let mut eps = [0.0; DIRECTIONS];
    if let Some(of_k) = k.and_then(|k| eps.get_mut(k)) {
        *of_k = 1.0;
    }
    eps
}

#[cfg(test)]
mod tests {
    use num_dual::Dual64;

    use super::*;
    use crate::system::Next;

    /// A ring: `ẏ_i = sin(y_(i−1)) y_i + √y_(i+1)`, with a last state that reads every seventh one and is read by none,
    /// and one that reads time and the root of state 0. Above one, state 0 does not read state 1.
    struct Ring {
        n: usize,
    }

    /// The root of `r³ + r = x`, by Newton's iteration from its value.
    fn root<S: Real>(x: S) -> S {
        let mut value: f64 = 0.0;
        for _ in 0..50 {
            value -= (value.powi(3) + value - x.value()) / (3.0 * value.powi(2) + 1.0);
        }
        let mut r = S::cst(value);
        for _ in 0..S::NEWTON_STEPS {
            r = r - (r * r * r + r - x) / (r * r * 3.0 + 1.0);
        }
        r
    }

    impl System for Ring {
        type Mode = ();
        type State<S: Real> = Vec<S>;
        type Guards<S: Real> = [S; 0];

        fn dim(&self) -> usize {
            self.n
        }

        fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

        fn rhs<S: Real>(&self, (): (), t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
            let m = self.n - 2;
            for i in 0..m {
                dydt[i] = y[(i + m - 1) % m].sin() * y[i] + y[(i + 1) % m].sqrt();
            }
            if y[0].value() > 1.0 {
                dydt[0] = y[0] * 2.0 - 1.0;
            }
            dydt[m] = t.exp() * root(y[0]);
            let sum = (0..m).step_by(7).fold(S::cst(0.0), |sum, i| sum + y[i].powf(1.5) / y[0]);
            dydt[m + 1] = sum.ln();
        }

        fn guards<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut Vec<S>) -> Next<()> {
            Next::Stop
        }
    }

    /// The Jacobian by one evaluation for each column.
    fn by_columns(ring: &Ring, y: &[f64]) -> Vec<f64> {
        let n = ring.n;
        let mut all = vec![0.0; n * n];
        for j in 0..n {
            let seed = |i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 });
            let mut dydt = vec![Dual64::from_re(0.0); n];
            ring.rhs((), Dual64::from_re(0.3), &(0..n).map(seed).collect(), &mut dydt);
            (0..n).for_each(|i| all[i * n + j] = dydt[i].eps);
        }
        all
    }

    #[test]
    fn groups_give_the_bits_of_an_evaluation_for_each_column() {
        for (n, first) in [(12, 0.4), (12, 1.4), (40, 0.4), (300, 1.4)] {
            let ring = Ring { n };
            let y: Vec<f64> =
                (0..n).map(|i| if i == 0 { first } else { 0.5 + 0.01 * i as f64 }).collect();
            let (mut found, mut n_entries) = (vec![0.0; n * n], 0);
            ring.jacobian((), 0.3, &y, |i, j, entry| {
                (found[i * n + j], n_entries) = (entry, n_entries + 1);
            });
            assert_eq!(found, by_columns(&ring, &y));
            // Three a row of the ring, one where it is cut, one of the root, and those of the last row.
            let m = n - 2;
            let cut = if first > 1.0 { 2 } else { 0 };
            assert_eq!(n_entries, 3 * m - cut + 1 + m.div_ceil(7));
        }
    }

    #[test]
    fn there_are_as_many_groups_as_the_fullest_row_has_entries() {
        let groups = |n| Pattern::new(&Ring { n }, &(), 0.0, &vec![0.5; n]).groups().1;
        // The last row reads every seventh state of the ring; three make up each other row.
        assert_eq!([groups(30), groups(300)], [4, 43]);
    }
}
