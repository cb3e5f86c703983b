//! The table of coefficients that the operations of a right-hand side share.

use std::cell::Cell;

use super::coefficient::Coefficient;

/// The highest order of a series.
pub const MAX_ORDER: usize = 25;

/// Rows of a new table.
pub(super) const N_ROWS: usize = 64;

/// The Taylor coefficients of one intermediate result, as far as they are kept.
#[derive(Debug)]
pub struct Row<B: Copy> {
    /// To the highest order, and one that is known before it is asked for.
    coefficients: [Cell<B>; MAX_ORDER + 2],
    /// What an operation keeps for the orders to come, such as the reciprocal of a divisor.
    pub(super) kept: Cell<B>,
}

impl<B: Coefficient> Row<B> {
    fn new() -> Self {
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

/// The coefficients of a row from some order on, counted from there.
#[derive(Clone, Copy, Debug)]
pub struct Tail<'a, B: Copy> {
    row: &'a Row<B>,
    first: usize,
}

impl<B: Coefficient> Tail<'_, B> {
    /// That of order `first + k`.
    #[inline(always)]
    pub fn at(self, k: usize) -> B {
        self.row.at(self.first + k)
    }
}

/// A row for each operation, in the order in which a run comes by them.
///
/// Each order is one run of the right-hand side, and each run begins at the first row. So an
/// operation finds its row by counting, as long as every run makes the same operations.
#[derive(Debug)]
pub struct Rows<B: Copy> {
    rows: Vec<Row<B>>,
}

impl<B: Coefficient> Default for Rows<B> {
    fn default() -> Self {
        Self::new()
    }
}

impl<B: Coefficient> Rows<B> {
    /// A table that is enough for most, and grows with its use.
    pub fn new() -> Self {
        Self { rows: (0..N_ROWS).map(|_| Row::new()).collect() }
    }

    /// The coefficients of order zero in the first `n` rows.
    pub(super) fn values(&self, n: usize) -> Vec<B> {
        self.rows[..n].iter().map(|row| row.at(0)).collect()
    }

    /// Makes room for a run that took `n` rows; whether it had too little, and is worth nothing.
    #[inline]
    pub(super) fn grow(&mut self, n: usize) -> bool {
        let is_short = self.rows.len() < n;
        if is_short {
            self.rows.resize_with(n.next_power_of_two(), Row::new);
        }
        is_short
    }

    /// The table as a run of order `k` sees it, which counts its rows in `n`.
    ///
    /// The count is not kept here: a local one is no memory where all is inlined.
    #[inline(always)]
    pub(super) fn table<'a>(&'a self, n: &'a Cell<usize>, k: usize) -> Table<'a, B> {
        let rows = &self.rows[..];
        // Never false; it spares the checks of constant rows.
        assert!(rows.len() >= N_ROWS, "a table of rows never shrinks");
        Table { rows, n, k }
    }
}

/// The table in the hands of one run.
#[derive(Clone, Copy)]
pub(super) struct Table<'a, B: Copy> {
    rows: &'a [Row<B>],
    n: &'a Cell<usize>,
    /// Order of the run.
    pub(super) k: usize,
}

impl<'a, B: Coefficient> Table<'a, B> {
    /// The next row; any one where there is none, in a run that [begins anew](Rows::grow).
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

    /// What `call` gives with a count of its own, and the row that it took last. A function that is
    /// not inlined would force the count into memory.
    #[inline(always)]
    pub(super) fn outlined(self, call: impl FnOnce(Table<'_, B>) -> B) -> (&'a Row<B>, B) {
        let n = Cell::new(self.n.get());
        let coefficient = call(Table { rows: self.rows, n: &n, k: self.k });
        self.n.set(n.get());
        (self.row(n.get() - 1), coefficient)
    }

    /// The same of several coefficients, whose rows it took last.
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
