//! Taylor coefficients of solutions, of their derivatives and of guards, for all states of a box at once.

use std::cell::Cell;

use super::interval::{Interval, points};
use crate::real::Real;
use crate::sensitivity::Tangent;
use crate::system::{System, Vector};
use crate::taylor::rows::{Rows, Table};
use crate::taylor::series::Series;

/// Coefficients of a solution and of the guards along it, `[order][component]`.
pub(super) struct Jet {
    pub(super) y: Vec<Vec<Interval>>,
    pub(super) g: Vec<Vec<Interval>>,
}

/// A system in one mode, expanded about a time.
pub(super) struct Field<'p, P: System> {
    pub(super) problem: &'p P,
    pub(super) mode: P::Mode,
}

/// The coefficients of order `k` of time, expanded about `t`.
fn time(t: Interval, k: usize) -> Interval {
    match k {
        0 => t,
        1 => Interval::from(1.0),
        _ => Interval::ZERO,
    }
}

impl<P: System> Field<'_, P> {
    /// The coefficients to order `order` of the solution and of the guards, for every start `(t, y)` in the box.
    pub(super) fn jet(&self, t: Interval, y: &[Interval], order: usize) -> Jet {
        let mut rows = Rows::<Interval>::new();
        let start = || Jet { y: vec![y.to_vec()], g: Vec::new() };
        let mut jet = start();
        loop {
            let k = jet.g.len();
            let n = Cell::new(0);
            let [slope, g] = self.coefficients(rows.table(&n, k), t, &jet.y[k]);
            if rows.grow(n.get()) {
                jet = start();
                continue;
            }
            jet.g.push(g);
            if k == order {
                return jet;
            }
            jet.y.push(shares(k, slope));
        }
    }

    /// The coefficients of the slope and of the guards, of the order of the table.
    fn coefficients(
        &self,
        table: Table<'_, Interval>,
        t: Interval,
        y: &[Interval],
    ) -> [Vec<Interval>; 2] {
        let zero = Series::constant(Interval::ZERO);
        let at = P::State::from_fn(y.len(), |i| Series::new(table, y[i]));
        let t = Series::new(table, time(t, table.k));
        let mut slope = P::State::from_fn(y.len(), |_| zero);
        let mut g = P::Guards::from_fn(self.problem.n_guards(), |_| zero);
        self.problem.rhs(self.mode.clone(), t, &at, &mut slope);
        self.problem.guards(self.mode.clone(), t, &at, &mut g);
        let of = |each: &[Series<'_, Interval>]| -> Vec<_> {
            each.iter().map(|x| x.coefficient(table.k)).collect()
        };
        [of(slope.as_ref()), of(g.as_ref())]
    }

    /// The coefficients to order `order` of the derivative of the solution by its start along `direction`, for every
    /// start in the box.
    pub(super) fn derivative(
        &self,
        t: Interval,
        y: &[Interval],
        direction: &[f64],
        order: usize,
    ) -> Vec<Vec<Interval>> {
        let mut rows = Rows::<Interval>::new();
        let start = || (y.to_vec(), vec![points(direction)]);
        let (mut state, mut derivatives) = start();
        while derivatives.len() <= order {
            let k = derivatives.len() - 1;
            let n = Cell::new(0);
            let table = rows.table(&n, k);
            let [slope, along] = self.tangents(table, t, [&state, &derivatives[k]]);
            if rows.grow(n.get()) {
                (state, derivatives) = start();
                continue;
            }
            state = shares(k, slope);
            derivatives.push(shares(k, along));
        }
        derivatives
    }

    /// The coefficients of the slope and of its derivative, of the order of the table, by those of the state and of
    /// its derivative.
    fn tangents(
        &self,
        table: Table<'_, Interval>,
        t: Interval,
        [y, dy]: [&[Interval]; 2],
    ) -> [Vec<Interval>; 2] {
        let series = |x| Series::new(table, x);
        let at = P::State::from_fn(y.len(), |i| Tangent::new(series(y[i]), series(dy[i])));
        let t = Tangent::constant(series(time(t, table.k)));
        let mut slope = P::State::from_fn(y.len(), |_| Tangent::cst(0.0));
        self.problem.rhs(self.mode.clone(), t, &at, &mut slope);
        let slope = slope.as_ref();
        [
            slope.iter().map(|f| f.re.coefficient(table.k)).collect(),
            slope.iter().map(|f| f.eps.coefficient(table.k)).collect(),
        ]
    }

    /// The slope of every state of the box.
    pub(super) fn slope(&self, t: Interval, y: &[Interval]) -> Vec<Interval> {
        let at = P::State::from_fn(y.len(), |i| y[i]);
        let mut slope = P::State::from_fn(y.len(), |_| Interval::ZERO);
        self.problem.rhs(self.mode.clone(), t, &at, &mut slope);
        slope.as_ref().to_vec()
    }

    /// A guard of every state of the box, and its derivative along `(dt, dy)`.
    pub(super) fn guard_along(
        &self,
        guard: usize,
        (t, dt): (Interval, f64),
        y: &[Interval],
        dy: &[Interval],
    ) -> [Interval; 2] {
        let at = P::State::from_fn(y.len(), |i| Tangent::new(y[i], dy[i]));
        let mut g = P::Guards::from_fn(self.problem.n_guards(), |_| Tangent::cst(0.0));
        let t = Tangent::new(t, Interval::from(dt));
        self.problem.guards(self.mode.clone(), t, &at, &mut g);
        let Tangent { re, eps } = g.as_ref()[guard];
        [re, eps]
    }
}

/// The coefficients of order `k + 1` of the integral of a series, from those of order `k`.
fn shares(k: usize, slope: Vec<Interval>) -> Vec<Interval> {
    slope.into_iter().map(|f| f / (k + 1) as f64).collect()
}

/// The value at `x` of the polynomial with the coefficients `[order][component]`.
pub(super) fn horner(coefficients: &[Vec<Interval>], x: Interval) -> Vec<Interval> {
    let n = coefficients.first().map_or(0, Vec::len);
    coefficients.iter().rev().fold(vec![Interval::ZERO; n], |sum, c| {
        sum.iter().zip(c).map(|(sum, c)| *sum * x + *c).collect()
    })
}
