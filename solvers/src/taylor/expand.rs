//! Taylor series of a solution, order by order.

use std::cell::Cell;

use super::guards::FIRST_LOOK;
use super::rows::{MAX_ORDER, Rows, Table};
use super::series::Series;
use super::unrolled::OfOrder;
use crate::system::{System, Vector};

/// The Taylor coefficients of a solution about the start of a step, and of the guards along it.
///
/// ```text
/// y(t₀ + s) = Σ y_k sᵏ,   y_(k+1) = f_k/(k + 1),   f(t₀ + s, y(t₀ + s)) = Σ f_k sᵏ
/// ```
#[derive(Debug)]
pub struct Expansion<Y> {
    rows: Rows,
    /// Those that the present expansion takes.
    n_rows: usize,
    /// Coefficients of the solution, a state an order.
    y: Vec<Y>,
}

impl<Y: Vector<f64>> Expansion<Y> {
    /// Memory for an expansion of `n` states to `order`.
    pub fn new(n: usize, order: usize) -> Self {
        let zero = || Y::from_fn(n, |_| 0.0);
        let y = (0..=order.min(MAX_ORDER)).map(|_| zero()).collect();
        Self { rows: Rows::new(), n_rows: 0, y }
    }

    /// The highest order.
    pub fn order(&self) -> usize {
        self.y.len() - 1
    }

    /// The coefficients of the solution, by order.
    pub fn coefficients(&self) -> &[Y] {
        &self.y
    }

    /// Begins an expansion about `(t0, y0)`, whose slope there goes to `slope`: the value of the
    /// right-hand side to the bit.
    pub fn begin<P>(&mut self, problem: &P, mode: P::Mode, t0: f64, y0: &Y, slope: &mut Y)
    where
        P: System<State<f64> = Y>,
    {
        loop {
            let run = Run { rows: &self.rows, t0, problem, mode };
            self.n_rows = RhsRun { run, y: y0, next: slope }.unrolled(0);
            if !self.rows.grow(self.n_rows) {
                return;
            }
        }
    }

    /// Completes the expansion that was last begun, about `(t0, y0)` with `slope`.
    ///
    /// # Panics
    /// Where the right-hand side makes other operations at another order: it may branch on its mode
    /// and on the [`value`](crate::Real::value) of its arguments only.
    pub fn complete<P>(&mut self, problem: &P, mode: P::Mode, t0: f64, y0: &Y, slope: &Y)
    where
        P: System<State<f64> = Y>,
    {
        self.y[0].clone_from(y0);
        self.y[1].clone_from(slope);
        for k in 1..self.order() {
            let (below, above) = self.y.split_at_mut(k + 1);
            let next = &mut above[0];
            let run = Run { rows: &self.rows, t0, problem, mode };
            let n = RhsRun { run, y: &below[k], next }.unrolled(k);
            assert!(n == self.n_rows, "operations of order {k} differ from those of order 0");
        }
    }
}

/// One run of a system over series.
pub(super) struct Run<'a, P: System> {
    /// The table, for this order and those below.
    pub(super) rows: &'a Rows,
    /// Time about which is expanded.
    pub(super) t0: f64,
    /// The system.
    pub(super) problem: &'a P,
    /// The mode.
    pub(super) mode: P::Mode,
}

/// Time and state, of which `y` is the coefficient of the order of `table`.
#[inline(always)]
fn start<'a, Y: Vector<Series<'a>>>(table: Table<'a>, t0: f64, y: &[f64]) -> (Series<'a>, Y) {
    let t = match table.k {
        0 => t0,
        1 => 1.0,
        _ => 0.0,
    };
    let t = Series::new(table, t);
    (t, Y::from_fn(y.len(), |i| Series::new(table, y[i])))
}

/// The coefficients of the state of the next order, `y_(k+1) = f_k/(k + 1)`; gives the rows it took.
struct RhsRun<'a, P: System> {
    run: Run<'a, P>,
    y: &'a P::State<f64>,
    next: &'a mut P::State<f64>,
}

impl<P: System> OfOrder for RhsRun<'_, P> {
    type Output = usize;

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, problem, mode } = self.run;
        let n = Cell::new(0);
        let (t, y): (_, P::State<Series<'_>>) = start(rows.table(&n, k), t0, self.y.as_ref());
        let next = self.next.as_mut();
        let mut f = P::State::<Series<'_>>::from_fn(next.len(), |_| Series::constant(0.0));
        problem.rhs(mode, t, &y, &mut f);
        let (f, share) = (f.as_ref(), 1.0 / (k + 1) as f64);
        each(next.len().min(f.len()), |i| next[i] = f[i].coefficient(k) * share);
        n.get()
    }
}

/// The coefficients of the guards to `g`, the same.
pub(super) struct GuardsRun<'a, P: System> {
    pub(super) run: Run<'a, P>,
    pub(super) y: &'a P::State<f64>,
    pub(super) g: &'a mut P::Guards<f64>,
}

impl<P: System> OfOrder for GuardsRun<'_, P> {
    type Output = usize;

    const HIGHEST: usize = FIRST_LOOK;

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, problem, mode } = self.run;
        let n = Cell::new(0);
        let (t, y): (_, P::State<Series<'_>>) = start(rows.table(&n, k), t0, self.y.as_ref());
        let g = self.g.as_mut();
        let mut series = P::Guards::<Series<'_>>::from_fn(g.len(), |_| Series::constant(0.0));
        problem.guards(mode, t, &y, &mut series);
        let series = series.as_ref();
        each(g.len().min(series.len()), |i| g[i] = series[i].coefficient(k));
        n.get()
    }
}

/// Calls `of` for 0 … n − 1, the first eight without a loop: an array with an index that varies is
/// memory, and so is then all that its entries point to.
#[inline(always)]
fn each(n: usize, mut of: impl FnMut(usize)) {
    let mut at = |i: usize| {
        if i < n {
            of(i);
        }
    };
    at(0);
    at(1);
    at(2);
    at(3);
    at(4);
    at(5);
    at(6);
    at(7);
    for i in 8..n {
        of(i);
    }
}
