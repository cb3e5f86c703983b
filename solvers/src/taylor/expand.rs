//! Taylor series of a solution, order by order.

use std::cell::Cell;

use super::base::Base;
use super::guards::FIRST_LOOK;
use super::rows::{Rows, Table};
use super::series::Series;
use super::unrolled::OfOrder;
use crate::erk::InMode;
use crate::system::{System, Vector};

/// A right-hand side and guards to expand.
pub(crate) trait SeriesField<P: System, B: Base> {
    /// Writes the slope at `(t, y)` to `dydt`.
    fn slope<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        dydt: &mut P::State<Series<'s, B>>,
    );

    /// Writes the guards there to `g`.
    fn guards<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        g: &mut P::Guards<Series<'s, B>>,
    );
}

impl<P: System, B: Base> SeriesField<P, B> for InMode<'_, P> {
    #[inline(always)]
    fn slope<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        dydt: &mut P::State<Series<'s, B>>,
    ) {
        self.problem.rhs(self.mode.clone(), t, y, dydt);
    }

    #[inline(always)]
    fn guards<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        g: &mut P::Guards<Series<'s, B>>,
    ) {
        self.problem.guards(self.mode.clone(), t, y, g);
    }
}

/// The expansion of a solution about the start of a step.
///
/// ```text
/// y(t₀ + s) = Σ y_k sᵏ,   y_(k+1) = f_k/(k + 1),   f(t₀ + s, y(t₀ + s)) = Σ f_k sᵏ
/// ```
#[derive(Debug)]
pub(crate) struct Expansion<B: Copy> {
    rows: Rows<B>,
    /// Those that the present expansion takes.
    n_rows: usize,
}

impl<B: Base> Default for Expansion<B> {
    fn default() -> Self {
        Self { rows: Rows::new(), n_rows: 0 }
    }
}

impl<B: Base> Expansion<B> {
    /// Begins an expansion about `(t0, y0)`, whose slope there goes to `slope`: the value of the
    /// right-hand side to the bit.
    pub(crate) fn begin<P: System>(
        &mut self,
        field: &impl SeriesField<P, B>,
        t0: B,
        y0: &P::State<B>,
        slope: &mut P::State<B>,
    ) {
        loop {
            let run = Run { rows: &self.rows, t0, field };
            self.n_rows = RhsRun::<P, B, _> { run, y: y0, next: slope }.unrolled(0);
            if !self.rows.grow(self.n_rows) {
                return;
            }
        }
    }

    /// Completes the expansion that was last begun, about the state `y[0]` at `t0` with the slope
    /// `y[1]`: writes the coefficients from `y[2]` on.
    ///
    /// # Panics
    /// Where the right-hand side makes other operations at another order: it may branch on its mode
    /// and on the [`value`](crate::Real::value) of its arguments only.
    pub(crate) fn complete<P: System>(
        &mut self,
        field: &impl SeriesField<P, B>,
        t0: B,
        y: &mut [P::State<B>],
    ) {
        for k in 1..y.len() - 1 {
            let (below, above) = y.split_at_mut(k + 1);
            let run = Run { rows: &self.rows, t0, field };
            let n = RhsRun::<P, B, _> { run, y: &below[k], next: &mut above[0] }.unrolled(k);
            assert!(n == self.n_rows, "operations of order {k} differ from those of order 0");
        }
    }
}

/// One run of a system over series.
pub(super) struct Run<'a, F, B: Copy> {
    /// The table, for this order and those below.
    pub(super) rows: &'a Rows<B>,
    /// Time about which is expanded.
    pub(super) t0: B,
    /// The system in its mode.
    pub(super) field: &'a F,
}

/// Time and state, of which `y` is the coefficient of the order of `table`.
#[inline(always)]
fn start<'a, B: Base, Y: Vector<Series<'a, B>>>(
    table: Table<'a, B>,
    t0: B,
    y: &[B],
) -> (Series<'a, B>, Y) {
    let t = match table.k {
        0 => t0,
        1 => B::cst(1.0),
        _ => B::cst(0.0),
    };
    let t = Series::new(table, t);
    (t, Y::from_fn(y.len(), |i| Series::new(table, y[i])))
}

/// Highest order with code of its own: in a loop over many states the places of the coefficients are no
/// constants, and there is nothing to gain.
const fn highest_unrolled<P: System, B: Base>() -> usize {
    if <P::State<B> as Vector<B>>::IS_SHORT { B::HIGHEST_UNROLLED } else { 0 }
}

/// The coefficients of the state of the next order, `y_(k+1) = f_k/(k + 1)`; gives the rows it took.
struct RhsRun<'a, P: System, B: Base, F> {
    run: Run<'a, F, B>,
    y: &'a P::State<B>,
    next: &'a mut P::State<B>,
}

impl<P: System, B: Base, F: SeriesField<P, B>> OfOrder for RhsRun<'_, P, B, F> {
    type Output = usize;

    const HIGHEST: usize = highest_unrolled::<P, B>();

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, field } = self.run;
        let n = Cell::new(0);
        let (t, y): (_, P::State<Series<'_, B>>) = start(rows.table(&n, k), t0, self.y.as_ref());
        let next = self.next.as_mut();
        let zero = |_| Series::constant(B::cst(0.0));
        let mut f = P::State::<Series<'_, B>>::from_fn(next.len(), zero);
        field.slope(t, &y, &mut f);
        let (f, share) = (f.as_ref(), B::cst(1.0) / (k + 1) as f64);
        each(next.len().min(f.len()), |i| next[i] = f[i].coefficient(k) * share);
        n.get()
    }
}

/// The coefficients of the guards to `g`, rounded; the same.
pub(super) struct GuardsRun<'a, P: System, B: Base, F> {
    pub(super) run: Run<'a, F, B>,
    pub(super) y: &'a P::State<B>,
    pub(super) g: &'a mut P::Guards<B::Rounded>,
}

impl<P: System, B: Base, F: SeriesField<P, B>> OfOrder for GuardsRun<'_, P, B, F> {
    type Output = usize;

    const HIGHEST: usize = if highest_unrolled::<P, B>() < FIRST_LOOK {
        highest_unrolled::<P, B>()
    } else {
        FIRST_LOOK
    };

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, field } = self.run;
        let n = Cell::new(0);
        let (t, y): (_, P::State<Series<'_, B>>) = start(rows.table(&n, k), t0, self.y.as_ref());
        let g = self.g.as_mut();
        let zero = |_| Series::constant(B::cst(0.0));
        let mut series = P::Guards::<Series<'_, B>>::from_fn(g.len(), zero);
        field.guards(t, &y, &mut series);
        let series = series.as_ref();
        each(g.len().min(series.len()), |i| g[i] = series[i].coefficient(k).rounded());
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
