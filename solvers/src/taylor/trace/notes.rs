//! What a trace notes, and how it is noted.

use super::super::coefficient::Coefficient;
use super::super::rows::Row;

/// The place of a result among all. The first place is that of constants, whose coefficients are zero.
pub(super) type Place = u32;
pub(super) const CONSTANT: Place = 0;
/// Place of time.
pub(super) const TIME: Place = 1;
/// Place of the first state.
pub(super) const STATES: Place = 2;
/// Marks a result without a row.
pub(super) const NO_ROW: u32 = u32::MAX;

/// `c_k = α a_k + β b_k + s_k`, where `c` is the result at `to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operation<B> {
    pub(super) to: Place,
    pub(super) of: [Place; 2],
    pub(super) factors: [B; 2],
    pub(super) sum: u32,
}

/// A multiple of the result at a place: an operand of an operation.
pub(super) type Term<B> = (Place, B);

/// Sum number `to` over the products of two rows, times a weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<B> {
    pub(super) to: u32,
    pub(super) rows: [u32; 2],
    pub(super) weight: B,
}

/// The result at `of` is the derivative of that at `to`: `c_k = a_(k−1)/k`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivative {
    pub(super) to: Place,
    pub(super) of: Place,
}

/// How coefficients are written to a row.
#[derive(Clone, Copy, Debug)]
pub(super) enum Written {
    Plainly,
    /// Times `k`.
    Weighed,
    /// Before the sums, which is possible for a result with a derivative.
    Early,
}

/// The coefficients at `from` are written to `row`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    pub(super) from: Place,
    pub(super) row: u32,
}

/// What was noted.
#[derive(Debug)]
pub(super) struct Notes<B: Copy> {
    pub(super) operations: Vec<Operation<B>>,
    /// `w Σ p_j q_(k−j)` over `j = 1 … k − 1`.
    pub(super) sums: Vec<Sum<B>>,
    /// The same over `k`: of integrals.
    pub(super) of_integrals: Vec<Sum<B>>,
    /// `w (k + 1) Σ p_j q_(k+1−j)` over `j = 1 … k`, of rows that are written early.
    pub(super) ahead: Vec<Sum<B>>,
    /// `w Σ (n (k − j) − j) p_j q_(k−j)/k` over `j = 1 … k − 1`, with n: of powers.
    pub(super) of_powers: Vec<(Sum<B>, f64)>,
    pub(super) derivatives: Vec<Derivative>,
    /// What is written to rows, by [`Written`].
    pub(super) kept: [Vec<Kept>; 3],
    /// The rows of each result, by [`Written`].
    pub(super) rows_of: Vec<[u32; 3]>,
    pub(super) n_rows: usize,
    /// Number of sums, of which the first is that of an operation without a sum, zero.
    pub(super) n_sums: u32,
    /// Curves that turn, begun and not ended.
    pub(super) open_curves: usize,

    /// The coefficients of the present order; the values where none is computed yet.
    pub(super) coefficients: Vec<B>,
    pub(super) sums_of_order: Vec<B>,
    pub(super) rows: Vec<Row<B>>,
    pub(super) slopes: Vec<Term<B>>,
    pub(super) guards: Vec<Term<B>>,
    /// What the slopes need; the rest is for the guards.
    pub(super) of_slopes: Extent,
}

/// Numbers of operations and sums, counted from the first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent {
    pub(super) operations: usize,
    pub(super) sums: usize,
    pub(super) of_integrals: usize,
    pub(super) ahead: usize,
    pub(super) of_powers: usize,
}

impl<B: Coefficient> Default for Notes<B> {
    fn default() -> Self {
        Self {
            operations: Vec::new(),
            sums: Vec::new(),
            of_integrals: Vec::new(),
            ahead: Vec::new(),
            of_powers: Vec::new(),
            derivatives: Vec::new(),
            kept: [(); 3].map(|()| Vec::new()),
            rows_of: Vec::new(),
            n_rows: 0,
            n_sums: 1,
            open_curves: 0,
            coefficients: Vec::new(),
            sums_of_order: Vec::new(),
            rows: Vec::new(),
            slopes: Vec::new(),
            guards: Vec::new(),
            of_slopes: Extent::default(),
        }
    }
}

impl<B: Coefficient> Notes<B> {
    pub(super) fn clear(&mut self) {
        self.operations.clear();
        self.sums.clear();
        self.of_integrals.clear();
        self.ahead.clear();
        self.of_powers.clear();
        self.derivatives.clear();
        self.kept.iter_mut().for_each(Vec::clear);
        self.rows_of.clear();
        self.n_rows = 0;
        self.n_sums = 1;
        self.open_curves = 0;
        self.coefficients.clear();
        self.slopes.clear();
        self.guards.clear();
    }

    /// A new place for a result of this value.
    pub(super) fn place(&mut self, value: B) -> Place {
        self.coefficients.push(value);
        self.rows_of.push([NO_ROW; 3]);
        (self.coefficients.len() - 1) as Place
    }

    /// Notes that the result at `to` is the sum of these terms and of sum number `sum`.
    pub(super) fn operation(&mut self, to: Place, sum: u32, [a, b]: [Term<B>; 2]) {
        // The later one is the last to be known: one operation follows it.
        let [a, b] = if a.0 <= b.0 { [a, b] } else { [b, a] };
        self.operations.push(Operation { to, of: [a.0, b.0], factors: [a.1, b.1], sum });
    }

    /// A new sum over the products of two rows.
    pub(super) fn sum(&mut self, rows: [u32; 2], weight: B) -> Sum<B> {
        self.n_sums += 1;
        Sum { to: self.n_sums - 1, rows, weight }
    }

    /// The row to which the coefficients at `from` are written so.
    pub(super) fn row(&mut self, from: Place, written: Written) -> u32 {
        let row = self.rows_of[from as usize][written as usize];
        if row != NO_ROW {
            return row;
        }
        if self.n_rows == self.rows.len() {
            self.rows.push(Row::new());
        }
        let row = self.n_rows as u32;
        self.n_rows += 1;
        self.rows_of[from as usize][written as usize] = row;
        self.kept[written as usize].push(Kept { from, row });
        row
    }

    /// Writes the coefficients of order `k` that are written so.
    pub(super) fn write(&self, k: usize, written: Written) {
        for Kept { from, row } in &self.kept[written as usize] {
            let coefficient = self.coefficients[*from as usize];
            let weighed = matches!(written, Written::Weighed);
            let coefficient = if weighed { coefficient * k as f64 } else { coefficient };
            self.rows[*row as usize].set(k, coefficient);
        }
    }

    pub(super) fn all(&self) -> Extent {
        Extent {
            operations: self.operations.len(),
            sums: self.sums.len(),
            of_integrals: self.of_integrals.len(),
            ahead: self.ahead.len(),
            of_powers: self.of_powers.len(),
        }
    }

    /// The last place that the slopes need, by the order in which places were given. Sine and cosine sum over each other,
    /// and what has a derivative needs it; all else needs earlier places alone.
    pub(super) fn last_of_slopes(&self) -> Place {
        let mut last = self.slopes.iter().map(|(place, _)| *place).max().unwrap_or(CONSTANT);
        loop {
            let needed = self.derivatives.iter().filter(|derivative| derivative.to <= last);
            let more = needed.map(|derivative| derivative.of).max().unwrap_or(CONSTANT);
            if more <= last {
                // The cosine follows its sine.
                return last + 1;
            }
            last = more;
        }
    }

    /// What gives the results up to the place `last`.
    pub(super) fn extent_to(&self, last: Place) -> Extent {
        let operations = self.operations.partition_point(|operation| operation.to <= last);
        let with_sums = self.operations[..operations].iter().rev();
        let last = with_sums.map(|operation| operation.sum).find(|sum| *sum > 0).unwrap_or(0);
        let sums = |all: &[Sum<B>]| all.partition_point(|sum| sum.to <= last);
        Extent {
            operations,
            sums: sums(&self.sums),
            of_integrals: sums(&self.of_integrals),
            ahead: sums(&self.ahead),
            of_powers: self.of_powers.partition_point(|(sum, _)| sum.to <= last),
        }
    }
}
