//! The Taylor series of a solution, computed order by order.

use std::cell::Cell;

use super::coefficient::Coefficient;
use super::rows::{Rows, Table};
use super::series::Series;
use super::trace::Trace;
use super::unrolled::OfOrder;
use crate::erk::InMode;
use crate::system::{System, Vector};

/// Order to which guards are expanded first. In most steps it suffices to show that they are far from zero.
pub(super) const FIRST_LOOK: usize = 5;

/// A right-hand side with guards that can be evaluated with series.
pub(crate) trait SeriesField<P: System, B: Coefficient> {
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

    /// Writes both in one run and returns true, or returns false without an operation where each is to have a run of its
    /// own. The operations must begin with those of [`slope`](Self::slope), in the same order.
    fn slope_with_guards<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        dydt: &mut P::State<Series<'s, B>>,
        g: &mut P::Guards<Series<'s, B>>,
    ) -> bool;

    /// Whether its operations are [noted](super::trace) once a step, not made anew for every order. That takes one system
    /// in one mode.
    const IS_TRACED: bool = false;

    /// The system in its mode, where the runs of the field are one.
    fn in_mode(&self) -> Option<&InMode<'_, P>> {
        None
    }
}

impl<P: System, B: Coefficient> SeriesField<P, B> for InMode<'_, P> {
    const IS_TRACED: bool = P::IS_TRACED || B::IS_TRACED;

    fn in_mode(&self) -> Option<&InMode<'_, P>> {
        Some(self)
    }

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

    #[inline(always)]
    fn slope_with_guards<'s>(
        &self,
        t: Series<'s, B>,
        y: &P::State<Series<'s, B>>,
        dydt: &mut P::State<Series<'s, B>>,
        g: &mut P::Guards<Series<'s, B>>,
    ) -> bool {
        self.problem.rhs_with_guards(self.mode.clone(), t, y, dydt, g)
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
    /// Number of rows that the present expansion uses, unless it is traced.
    n_rows: usize,
    /// The rows of guards that have runs of their own.
    guard_rows: Rows<B>,
    /// Number of those; none where slope and guards have runs together.
    n_guard_rows: Option<usize>,
    trace: Trace<B>,
}

impl<B: Coefficient> Default for Expansion<B> {
    fn default() -> Self {
        Self {
            rows: Rows::new(),
            n_rows: 0,
            guard_rows: Rows::none(),
            n_guard_rows: None,
            trace: Trace::default(),
        }
    }
}

impl<B: Coefficient> Expansion<B> {
    /// Begins an expansion about `(t0, y0)`. The slope and the guards there are written to `slope` and `guards`; they
    /// have the same bits as those of the system.
    pub(crate) fn begin<P: System, F: SeriesField<P, B>>(
        &mut self,
        field: &F,
        t0: B,
        y0: &P::State<B>,
        slope: &mut P::State<B>,
        guards: &mut P::Guards<B::Rounded>,
    ) {
        if const { F::IS_TRACED } {
            if let Some(field) = field.in_mode() {
                self.trace.begin(field, (t0, y0), slope, guards);
            }
            return;
        }
        let both = self.rows.until_enough(|rows| {
            let (run, next, g) = (Run { rows, t0, field }, &mut *slope, &mut *guards);
            RhsWithGuardsRun::<P, B, _> { run, y: y0, next, g }.unrolled(0)
        });
        if let Some(n) = both {
            (self.n_rows, self.n_guard_rows) = (n, None);
            return;
        }
        let alone = self.rows.until_enough(|rows| {
            let (run, next) = (Run { rows, t0, field }, &mut *slope);
            Some(RhsRun::<P, B, _> { run, y: y0, next }.unrolled(0))
        });
        self.n_rows = alone.unwrap_or(0);
        self.n_guard_rows = self.guard_rows.until_enough(|rows| {
            let (run, g) = (Run { rows, t0, field }, &mut *guards);
            Some(GuardsRun::<P, B, _> { run, y: y0, g }.unrolled(0))
        });
    }

    /// Completes the expansion that was begun last, about the state `y[0]` at `t0` with the slope `y[1]`. Writes the
    /// coefficients from `y[2]` on, and those of the guards from `g[1]` on to the end of `g`.
    ///
    /// # Panics
    /// Without a trace, where the right-hand side or the guards make other operations at one order than at another, or both together
    /// make fewer than the right-hand side alone. They may branch only on their mode and on the
    /// [`value`](crate::Real::value) of their arguments.
    pub(crate) fn complete<P: System, F: SeriesField<P, B>>(
        &mut self,
        field: &F,
        t0: B,
        y: &mut [P::State<B>],
        g: &mut [P::Guards<B::Rounded>],
    ) {
        if const { F::IS_TRACED } {
            for k in 1..y.len() - 1 {
                let (below, above) = y.split_at_mut(k + 1);
                let mut g = g.get_mut(k);
                self.trace.advance(k, below[k].as_ref(), g.is_some());
                self.trace.write_next(k, above[0].as_mut());
                if let Some(g) = &mut g {
                    self.trace.write_guards(g.as_mut());
                }
            }
            return;
        }
        let mut n_beyond = self.n_guard_rows.map(|_| self.n_rows);
        for k in 1..y.len() - 1 {
            let (below, above) = y.split_at_mut(k + 1);
            let (run, y, next) = (Run { rows: &self.rows, t0, field }, &below[k], &mut above[0]);
            let is_same = match g.get_mut(k) {
                Some(g) if self.n_guard_rows.is_none() => {
                    let n = RhsWithGuardsRun::<P, B, _> { run, y, next, g }.unrolled(k);
                    n == Some(self.n_rows)
                }
                g => {
                    let n = RhsRun::<P, B, _> { run, y, next }.unrolled(k);
                    let n_guards = g.map(|g| {
                        let run = Run { rows: &self.guard_rows, t0, field };
                        GuardsRun::<P, B, _> { run, y, g }.unrolled(k)
                    });
                    n == *n_beyond.get_or_insert(n)
                        && n <= self.n_rows
                        && (n_guards.is_none() || n_guards == self.n_guard_rows)
                }
            };
            assert!(is_same, "operations of order {k} differ from those of lower orders");
        }
    }
}

/// Counts the operations of right-hand sides.
#[derive(Default)]
pub(crate) struct Operations {
    expansion: Expansion<f64>,
}

impl Operations {
    /// Number of operations of a right-hand side and its guards at `(t, y)` in `mode`, time and states counted too. Where
    /// they are traced, multiples and shifts are none.
    pub(crate) fn count<P: System>(
        &mut self,
        problem: &P,
        mode: &P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> usize {
        let mut guards = P::Guards::<f64>::from_fn(problem.n_guards(), |_| 0.0);
        let field = InMode { problem, mode };
        self.expansion.begin::<P, _>(&field, t, y, &mut y.clone(), &mut guards);
        if const { P::IS_TRACED } {
            self.expansion.trace.n_results()
        } else {
            let Expansion { n_rows, n_guard_rows, .. } = self.expansion;
            // Time and states begin both tables.
            n_rows + n_guard_rows.map_or(0, |n| n - 1 - y.as_ref().len())
        }
    }
}

/// Whether [`System::rhs_with_guards`] keeps its contract at `(t, y)` in `mode`: it returns false, or writes what `rhs`
/// and `guards` write, to the bit, by operations that begin with those of `rhs`.
pub(crate) fn begins_with_rhs<P: System>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> bool {
    let field = InMode { problem, mode };
    let [mut slope, mut slope_alone] = [(); 2].map(|()| y.clone());
    let [mut g, mut g_alone] =
        [(); 2].map(|()| P::Guards::<f64>::from_fn(problem.n_guards(), |_| 0.0));
    problem.guards(mode.clone(), t, y, &mut g_alone);
    let [mut both, mut alone] = [Rows::new(), Rows::new()];
    let n_both = both.until_enough(|rows| {
        let run = Run { rows, t0: t, field: &field };
        RhsWithGuardsRun::<P, f64, _> { run, y, next: &mut slope, g: &mut g }.unrolled(0)
    });
    let n_alone = alone.until_enough(|rows| {
        let run = Run { rows, t0: t, field: &field };
        Some(RhsRun::<P, f64, _> { run, y, next: &mut slope_alone }.unrolled(0))
    });
    let (Some(n_both), Some(n_alone)) = (n_both, n_alone) else { return true };
    let n = n_alone.min(n_both);
    let bits = |x: &[f64]| -> Vec<u64> { x.iter().map(|x| x.to_bits()).collect() };
    n_alone <= n_both
        && bits(slope.as_ref()) == bits(slope_alone.as_ref())
        && bits(g.as_ref()) == bits(g_alone.as_ref())
        && bits(&both.values(n)) == bits(&alone.values(n))
}

/// The inputs of one run of a system with series.
pub(super) struct Run<'a, F, B: Copy> {
    /// The table of coefficients of this order and the lower ones.
    pub(super) rows: &'a Rows<B>,
    /// Time about which the solution is expanded.
    pub(super) t0: B,
    /// The system in its mode.
    pub(super) field: &'a F,
}

/// The series of time and state in a run, where `y` is the coefficient of the state for the order of `table`.
#[inline(always)]
fn start<'a, B: Coefficient, Y: Vector<Series<'a, B>>>(
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

/// Highest order for which specialised code is compiled. For states of unknown length it is zero: in a loop over many
/// states the addresses of the coefficients are not constants, so specialised code would gain nothing.
const fn highest_unrolled<P: System, B: Coefficient>() -> usize {
    if <P::State<B> as Vector<B>>::IS_SHORT { B::HIGHEST_UNROLLED } else { 0 }
}

/// A run of the right-hand side, which writes the coefficients of the state of the next order, `y_(k+1) = f_k/(k +
/// 1)`, to `next`. It returns the number of rows that it took.
struct RhsRun<'a, P: System, B: Coefficient, F> {
    run: Run<'a, F, B>,
    y: &'a P::State<B>,
    next: &'a mut P::State<B>,
}

impl<P: System, B: Coefficient, F: SeriesField<P, B>> OfOrder for RhsRun<'_, P, B, F> {
    type Output = usize;

    const HIGHEST: usize = highest_unrolled::<P, B>();

    const HIGHEST_APIECE: usize = B::HIGHEST_APIECE;

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, field } = self.run;
        let n = Cell::new(0);
        let (t, y) = start(rows.table(&n, k), t0, self.y.as_ref());
        let mut f = zeros::<B, P::State<_>>(self.next.as_ref().len());
        field.slope(t, &y, &mut f);
        write_next(k, f.as_ref(), self.next.as_mut());
        n.get()
    }
}

/// The same run with the guards, whose coefficients it writes to `g`, rounded; none where they share no terms.
struct RhsWithGuardsRun<'a, P: System, B: Coefficient, F> {
    run: Run<'a, F, B>,
    y: &'a P::State<B>,
    next: &'a mut P::State<B>,
    g: &'a mut P::Guards<B::Rounded>,
}

impl<P: System, B: Coefficient, F: SeriesField<P, B>> OfOrder for RhsWithGuardsRun<'_, P, B, F> {
    type Output = Option<usize>;

    // Beyond the first look the guards are expanded alone.
    const MOST: usize = FIRST_LOOK;

    const HIGHEST: usize = highest_look::<P, B>();

    const HIGHEST_APIECE: usize = FIRST_LOOK;

    #[inline(always)]
    fn of_order(self, k: usize) -> Option<usize> {
        let Run { rows, t0, field } = self.run;
        let n = Cell::new(0);
        let (t, y) = start(rows.table(&n, k), t0, self.y.as_ref());
        let mut f = zeros::<B, P::State<_>>(self.next.as_ref().len());
        let mut g = zeros::<B, P::Guards<_>>(self.g.as_ref().len());
        if !field.slope_with_guards(t, &y, &mut f, &mut g) {
            debug_assert_eq!(n.get(), 1 + self.y.as_ref().len(), "operations without a result");
            return None;
        }
        write_next(k, f.as_ref(), self.next.as_mut());
        write_rounded(k, g.as_ref(), self.g.as_mut());
        Some(n.get())
    }
}

const fn highest_look<P: System, B: Coefficient>() -> usize {
    let highest = highest_unrolled::<P, B>();
    if highest < FIRST_LOOK { highest } else { FIRST_LOOK }
}

#[inline(always)]
fn zeros<'s, B: Coefficient + 's, Y: Vector<Series<'s, B>>>(n: usize) -> Y {
    Y::from_fn(n, |_| Series::constant(B::cst(0.0)))
}

#[inline(always)]
fn write_next<B: Coefficient>(k: usize, f: &[Series<'_, B>], next: &mut [B]) {
    let share = B::cst(1.0) / (k + 1) as f64;
    each(next.len().min(f.len()), |i| next[i] = f[i].coefficient(k) * share);
}

#[inline(always)]
fn write_rounded<B: Coefficient>(k: usize, series: &[Series<'_, B>], g: &mut [B::Rounded]) {
    each(g.len().min(series.len()), |i| g[i] = series[i].coefficient(k).rounded());
}

/// A run of the guards alone, which writes their coefficients to `g`, rounded. It returns the number of rows that it
/// took.
pub(super) struct GuardsRun<'a, P: System, B: Coefficient, F> {
    pub(super) run: Run<'a, F, B>,
    pub(super) y: &'a P::State<B>,
    pub(super) g: &'a mut P::Guards<B::Rounded>,
}

impl<P: System, B: Coefficient, F: SeriesField<P, B>> OfOrder for GuardsRun<'_, P, B, F> {
    type Output = usize;

    const HIGHEST: usize = highest_look::<P, B>();

    const HIGHEST_APIECE: usize = FIRST_LOOK;

    #[inline(always)]
    fn of_order(self, k: usize) -> usize {
        let Run { rows, t0, field } = self.run;
        let n = Cell::new(0);
        let (t, y) = start(rows.table(&n, k), t0, self.y.as_ref());
        let mut g = zeros::<B, P::Guards<_>>(self.g.as_ref().len());
        field.guards(t, &y, &mut g);
        write_rounded(k, g.as_ref(), self.g.as_mut());
        n.get()
    }
}

/// Calls `of` for 0 … n − 1, the first eight times without a loop. The index is then a constant; with a variable
/// index the compiler would keep the array, and all that its entries point to, in memory.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;
    use crate::system::Next;

    /// A pendulum whose guard and right-hand side share the sine.
    struct Pendulum {
        guards_first: bool,
    }

    impl System for Pendulum {
        type Mode = ();
        type State<S: Real> = [S; 2];
        type Guards<S: Real> = [S; 1];

        fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

        fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
            *dydt = [y[1], -y[0].sin_cos().0];
        }

        fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 2], g: &mut [S; 1]) {
            *g = [y[0].sin_cos().0 + y[1] * y[1]];
        }

        fn rhs_with_guards<S: Real>(
            &self,
            (): (),
            _t: S,
            y: &[S; 2],
            dydt: &mut [S; 2],
            g: &mut [S; 1],
        ) -> bool {
            let of_guard = if self.guards_first { Some(y[1] * y[1]) } else { None };
            let sin = y[0].sin_cos().0;
            *dydt = [y[1], -sin];
            *g = [sin + of_guard.unwrap_or_else(|| y[1] * y[1])];
            true
        }

        fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
            *bounds = [1e-15];
        }

        fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
            Next::Stop
        }
    }

    #[test]
    fn guards_among_the_first_operations_are_found() {
        let y = [0.3, -0.2];
        assert!(begins_with_rhs(&Pendulum { guards_first: false }, &(), 0.0, &y));
        assert!(!begins_with_rhs(&Pendulum { guards_first: true }, &(), 0.0, &y));
    }
}
