//! The table of Taylor coefficients, with a row for each operation of a right-hand side.

use std::cell::Cell;

use crate::real::Real;

/// The highest order of a series.
pub const MAX_ORDER: usize = 25;

/// Number of rows of a new table.
pub(super) const N_ROWS: usize = 64;

/// The Taylor coefficients of one intermediate result, as far as later orders read them.
#[derive(Debug)]
pub struct Row<B: Copy> {
    /// The coefficients to the highest order, and one more, because some are known one order ahead.
    coefficients: [Cell<B>; MAX_ORDER + 2],
    /// A number that an operation keeps for higher orders, such as the reciprocal of a divisor.
    pub(super) kept: Cell<B>,
}

impl<B: Real> Row<B> {
    pub(super) fn new() -> Self {
        let zero = || Cell::new(B::cst(0.0));
        Self { coefficients: std::array::from_fn(|_| zero()), kept: zero() }
    }

    /// The coefficient of order `k`.
    #[inline(always)]
    pub fn at(&self, k: usize) -> B {
        self.coefficients[k].get()
    }

    /// The coefficients from order `first` on.
    #[inline(always)]
    pub(super) fn tail(&self, first: usize) -> Tail<'_, B> {
        Tail { row: self, first }
    }

    #[inline(always)]
    pub(super) fn set(&self, k: usize, coefficient: B) {
        self.coefficients[k].set(coefficient);
    }
}

/// The coefficients of a row from some order on, indexed from there.
#[derive(Clone, Copy, Debug)]
pub struct Tail<'a, B: Copy> {
    row: &'a Row<B>,
    first: usize,
}

impl<B: Real> Tail<'_, B> {
    /// The coefficient of order `first + k`.
    #[inline(always)]
    pub fn at(self, k: usize) -> B {
        self.row.at(self.first + k)
    }
}

/// A row for each operation, in the order in which a run makes them.
///
/// Each order is one run of the right-hand side, and each run begins at the first row. So an operation finds its row
/// by counting, provided that every run makes the same operations.
#[derive(Debug)]
pub struct Rows<B: Copy> {
    rows: Vec<Row<B>>,
}

impl<B: Real> Default for Rows<B> {
    fn default() -> Self {
        Self::new()
    }
}

impl<B: Real> Rows<B> {
    /// A table with enough rows for most systems, which grows where needed.
    pub fn new() -> Self {
        Self { rows: (0..N_ROWS).map(|_| Row::new()).collect() }
    }

    /// A table without rows, which has some after [`until_enough`](Self::until_enough).
    pub(super) const fn none() -> Self {
        Self { rows: Vec::new() }
    }

    /// Makes `run`, which returns the number of rows that it takes, until there are enough for it. Returns that number, or
    /// none where the run has none.
    #[inline(always)]
    pub(super) fn until_enough(
        &mut self,
        mut run: impl FnMut(&Self) -> Option<usize>,
    ) -> Option<usize> {
        self.grow(N_ROWS);
        loop {
            let n = run(self)?;
            if !self.grow(n) {
                return Some(n);
            }
        }
    }

    /// The coefficients of order zero in the first `n` rows.
    pub(super) fn values(&self, n: usize) -> Vec<B> {
        self.rows[..n].iter().map(|row| row.at(0)).collect()
    }

    /// Makes room for a run that takes `n` rows. Returns whether there were too few rows, so that the run is invalid
    /// and must be repeated.
    #[inline]
    pub(crate) fn grow(&mut self, n: usize) -> bool {
        let is_short = self.rows.len() < n;
        if is_short {
            self.rows.resize_with(n.next_power_of_two(), Row::new);
        }
        is_short
    }

    /// The table for a run of order `k`, which counts its rows in `n`.
    ///
    /// The counter is a local variable of the caller and not a field here, because the compiler can keep a local
    /// variable in a register where all operations are inlined.
    #[inline(always)]
    pub(crate) fn table<'a>(&'a self, n: &'a Cell<usize>, k: usize) -> Table<'a, B> {
        let rows = &self.rows[..];
        // Always true; it lets the compiler omit the bounds checks of rows with constant indices.
        assert!(rows.len() >= N_ROWS, "a table of rows never shrinks");
        Table { rows, n, k }
    }
}

/// The table, borrowed by one run.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a, B: Copy> {
    rows: &'a [Row<B>],
    n: &'a Cell<usize>,
    /// Order of the run.
    pub(crate) k: usize,
}

impl<'a, B: Real> Table<'a, B> {
    /// The next row. Beyond the last row it is an arbitrary one; the run is then [repeated](Rows::grow).
    #[inline(always)]
    pub(super) fn next(self) -> &'a Row<B> {
        let n = self.n.get();
        self.n.set(n + 1);
        self.row(n)
    }

    #[inline(always)]
    fn row(self, n: usize) -> &'a Row<B> {
        if n < self.rows.len() { &self.rows[n] } else { &self.rows[0] }
    }

    /// The result of `call`, which is given a row counter of its own, and the last row that it took. With the same
    /// counter, a function that is not inlined would force the counter into memory.
    #[inline(always)]
    pub(super) fn outlined(self, call: impl FnOnce(Table<'_, B>) -> B) -> (&'a Row<B>, B) {
        let n = Cell::new(self.n.get());
        let coefficient = call(Table { rows: self.rows, n: &n, k: self.k });
        self.n.set(n.get());
        (self.row(n.get() - 1), coefficient)
    }

    /// The same for several coefficients, which are in the last rows that `call` took.
    #[inline(always)]
    pub(super) fn all_outlined<const M: usize>(
        self,
        call: impl FnOnce(Table<'_, B>) -> [B; M],
    ) -> ([&'a Row<B>; M], [B; M]) {
        let n = Cell::new(self.n.get());
        let coefficients = call(Table { rows: self.rows, n: &n, k: self.k });
        self.n.set(n.get());
        let first = n.get() - M;
        (std::array::from_fn(|i| self.row(first + i)), coefficients)
    }
}
