//! The scalar that expands a right-hand side: one Taylor coefficient at a time.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::base::Base;
use super::recurrence;
use super::rows::{Row, Table};
use crate::real::{Function, Functions, Length, Real, length_of_values};

/// The largest integer power that is taken by products.
const LARGEST_PRODUCT: f64 = 64.0;

/// A function of time, of which the present run computes one Taylor coefficient; those
/// of lower orders are in a table.
///
/// A right-hand side is run once per order. Each of its operations finds its row in the table and
/// computes one coefficient by its [`recurrence`], so `N` runs expand to order `N`
/// whatever the right-hand side is made of. Constants have no row, and cost no more than numbers.
/// A coefficient is written to its row by what reads the row at higher orders: a recurrence *keeps* each
/// operand that it sums over, and its own result where it sums over that.
///
/// The coefficient of order zero is computed by the very operations of an `f64`, and is
/// [`value`](Real::value) at every order: decisions taken on it are the same in every run, as the
/// table needs them to be.
#[derive(Clone, Copy)]
pub struct Series<'a, B: Copy> {
    place: Option<Place<'a, B>>,
    /// The coefficient of the present order; of a constant its value, at every order.
    pub(super) coefficient: B,
}

/// Where the coefficients of a series are.
#[derive(Clone, Copy)]
struct Place<'a, B: Copy> {
    table: Table<'a, B>,
    row: &'a Row<B>,
}

impl<'a, B: Base> Series<'a, B> {
    /// A constant.
    #[inline(always)]
    pub(super) fn constant(x: B) -> Self {
        Self { place: None, coefficient: x }
    }

    /// A new row for this coefficient, which is written to it at order zero, and else once it is
    /// [kept](Self::kept).
    #[inline(always)]
    pub(super) fn new(table: Table<'a, B>, coefficient: B) -> Self {
        let row = table.next();
        if table.k == 0 {
            row.set(0, coefficient);
        }
        Self { place: Some(Place { table, row }), coefficient }
    }

    /// The same, its coefficient written to its row, for what sums over lower orders: what is only added up, or
    /// multiplied by constants, is never asked for it.
    #[inline(always)]
    fn kept(self) -> Self {
        if let Some(Place { table, row }) = self.place {
            row.set(table.k, self.coefficient);
        }
        self
    }

    /// The coefficient of the present order in `row`.
    #[inline(always)]
    fn at(table: Table<'a, B>, row: &'a Row<B>, coefficient: B) -> Self {
        row.set(table.k, coefficient);
        Self { place: Some(Place { table, row }), coefficient }
    }

    /// The coefficient of order `k`, which is the run's.
    #[inline(always)]
    pub(super) fn coefficient(self, k: usize) -> B {
        if self.place.is_some() || k == 0 { self.coefficient } else { B::cst(0.0) }
    }

    /// A linear function of this series, with this coefficient; of a constant, its value.
    #[inline(always)]
    pub(super) fn linear(self, coefficient: B) -> Self {
        match self.place {
            None => Self::constant(coefficient),
            Some(Place { table, .. }) => Self::new(table, coefficient),
        }
    }

    /// The series with `x` added to its coefficient of order zero.
    #[inline(always)]
    pub(super) fn plus(self, x: B) -> Self {
        let is_value = self.place.is_none_or(|place| place.table.k == 0);
        self.linear(if is_value { self.coefficient + x } else { self.coefficient })
    }

    /// The series over the constant `x`.
    #[inline(always)]
    fn over(self, x: B) -> Self {
        let is_value = self.place.is_none_or(|place| place.table.k == 0);
        // Higher orders need not be those of an f64 to the bit, and a division is slow.
        self.linear(if is_value {
            self.coefficient / x
        } else {
            self.coefficient * (B::cst(1.0) / x)
        })
    }

    #[inline(always)]
    fn is_same_row(self, other: Self) -> bool {
        match (self.place, other.place) {
            (Some(a), Some(b)) => std::ptr::eq(a.row, b.row),
            _ => false,
        }
    }

    /// The coefficient of `aᵖ`, in the row taken last.
    // Inlined, its loops keep the count of rows of all operations around them in memory.
    #[inline(never)]
    fn power(table: Table<'_, B>, (row, a_k): (&Row<B>, B), p: f64) -> B {
        let k = table.k;
        if (2.0..=LARGEST_PRODUCT).contains(&p) && p.fract() == 0.0 {
            let base = Series { place: Some(Place { table, row }), coefficient: a_k };
            let product = base.product(p as u32);
            // The value is that of an f64 to the bit.
            let c_k = if k == 0 { Real::powf(a_k, p) } else { product.coefficient };
            return Series::new(table, c_k).coefficient;
        }
        let c = table.next();
        let c_k = if k == 0 {
            c.kept.set(B::cst(1.0) / a_k);
            Real::powf(a_k, p)
        } else {
            recurrence::power(k, (row, a_k), p, c)
        };
        c.set(k, c_k);
        c_k
    }

    /// The coefficient of `f` of the series in `row`, in the row taken last.
    #[inline(never)]
    fn function<F: Function>(table: Table<'_, B>, (row, a_k): (&Row<B>, B), f: &F) -> B {
        let value = f.of(Series { place: Some(Place { table, row }), coefficient: a_k });
        Series::new(table, value.coefficient(table.k)).coefficient
    }

    /// The coefficients of `f` of the series in these rows or, without one, constant; in the rows taken last.
    #[inline(never)]
    fn functions<F: Functions<N, M>, const N: usize, const M: usize>(
        table: Table<'_, B>,
        x: [(Option<&Row<B>>, B); N],
        f: &F,
    ) -> [B; M] {
        let x = x.map(|(row, coefficient)| Series {
            place: row.map(|row| Place { table, row }),
            coefficient,
        });
        f.of(x).map(|y| Series::new(table, y.coefficient(table.k)).coefficient)
    }

    /// `selfⁿ` by squaring, `n ≥ 1`: it has no singular point where the base is zero.
    fn product(self, mut n: u32) -> Self {
        let (mut square, mut product) = (self, None);
        loop {
            if n % 2 == 1 {
                product = Some(product.map_or(square, |product: Self| product * square));
            }
            n /= 2;
            match product {
                Some(product) if n == 0 => return product,
                _ => square = square * square,
            }
        }
    }
}

impl<B: Base> fmt::Debug for Series<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            None => write!(f, "{:?}", self.coefficient),
            Some(Place { table, .. }) => write!(f, "{:?} at order {}", self.coefficient, table.k),
        }
    }
}

impl<B: Base> Neg for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.linear(-self.coefficient)
    }
}

impl<B: Base> Add for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        match (self.place, other.place) {
            (Some(Place { table, .. }), Some(_)) => {
                Self::new(table, self.coefficient + other.coefficient)
            }
            (None, Some(_)) => other.plus(self.coefficient),
            (_, None) => self.plus(other.coefficient),
        }
    }
}

impl<B: Base> Sub for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        match (self.place, other.place) {
            (Some(Place { table, .. }), Some(_)) => {
                Self::new(table, self.coefficient - other.coefficient)
            }
            (None, Some(Place { table, .. })) => {
                let own = self.coefficient(table.k);
                Self::new(table, own - other.coefficient)
            }
            (_, None) => self.plus(-other.coefficient),
        }
    }
}

impl<B: Base> Mul for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a_k, b_k) = (self.coefficient, other.coefficient);
        match (self.place, other.place) {
            (Some(a), Some(b)) => {
                self.kept();
                other.kept();
                let k = a.table.k;
                let coefficient = if k == 0 {
                    a_k * b_k
                } else if self.is_same_row(other) {
                    recurrence::square(k, (a.row, a_k))
                } else {
                    recurrence::product(k, (a.row, a_k), (b.row, b_k))
                };
                Self::new(a.table, coefficient)
            }
            (None, Some(_)) => other.linear(a_k * b_k),
            (_, None) => self.linear(a_k * b_k),
        }
    }
}

impl<B: Base> Div for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let Some(Place { table, row: b }) = other.kept().place else {
            return self.over(other.coefficient);
        };
        let (k, b_k) = (table.k, other.coefficient);
        let a_k = self.coefficient(k);
        let c = table.next();
        if k == 0 {
            c.kept.set(B::cst(1.0) / b_k);
            return Self::at(table, c, a_k / b_k);
        }
        Self::at(table, c, recurrence::quotient(k, a_k, (b, b_k), c))
    }
}

impl<B: Base> Add<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn add(self, x: f64) -> Self {
        self.plus(B::cst(x))
    }
}

impl<B: Base> Sub<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        self.plus(B::cst(-x))
    }
}

impl<B: Base> Mul<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        self.linear(self.coefficient * x)
    }
}

impl<B: Base> Div<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn div(self, x: f64) -> Self {
        self.over(B::cst(x))
    }
}

impl<B: Base> Real for Series<'_, B> {
    #[inline(always)]
    fn cst(x: f64) -> Self {
        Self::constant(B::cst(x))
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.place.map_or(self.coefficient, |place| place.row.at(0)).value()
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let Some(Place { table, .. }) = self.place else {
            return Self::constant(Real::sqrt(self.coefficient));
        };
        let (k, a_k, c) = (table.k, self.coefficient, table.next());
        if k == 0 {
            let root = Real::sqrt(a_k);
            c.kept.set(B::cst(0.5) / root);
            return Self::at(table, c, root);
        }
        Self::at(table, c, recurrence::sqrt(k, a_k, c))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let Some(Place { table, .. }) = self.place else {
            let (sin, cos) = Real::sin_cos(self.coefficient);
            return (Self::constant(sin), Self::constant(cos));
        };
        let (k, a_k) = (table.k, self.coefficient);
        let (d, sin, cos) = (table.next(), table.next(), table.next());
        let (sin_k, cos_k) = if k == 0 {
            Real::sin_cos(a_k)
        } else {
            d.set(k, a_k * k as f64);
            (recurrence::integral(k, (d, a_k), cos), -recurrence::integral(k, (d, a_k), sin))
        };
        (Self::at(table, sin, sin_k), Self::at(table, cos, cos_k))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let Some(Place { table, .. }) = self.place else {
            return Self::constant(Real::exp(self.coefficient));
        };
        let (k, a_k) = (table.k, self.coefficient);
        let (d, c) = (table.next(), table.next());
        if k == 0 {
            return Self::at(table, c, Real::exp(a_k));
        }
        d.set(k, a_k * k as f64);
        Self::at(table, c, recurrence::integral(k, (d, a_k), c))
    }

    #[inline(always)]
    fn ln(self) -> Self {
        let Some(Place { table, row: a }) = self.kept().place else {
            return Self::constant(Real::ln(self.coefficient));
        };
        let (k, a_k) = (table.k, self.coefficient);
        let (d, c) = (table.next(), table.next());
        if k == 0 {
            d.kept.set(B::cst(1.0) / a_k);
            return Self::at(table, c, Real::ln(a_k));
        }
        let c_k = recurrence::ln(k, (a, a_k), d);
        d.set(k, c_k * k as f64);
        Self::at(table, c, c_k)
    }

    #[inline(always)]
    fn powf(self, p: f64) -> Self {
        let Some(Place { table, row }) = self.kept().place else {
            return Self::constant(Real::powf(self.coefficient, p));
        };
        if p == 0.0 || p == 1.0 {
            return if p == 0.0 { Self::constant(B::cst(1.0)) } else { self };
        }
        let (c, c_k) = table.apart(|table| Self::power(table, (row, self.coefficient), p));
        Self { place: Some(Place { table, row: c }), coefficient: c_k }
    }

    #[inline(always)]
    fn length([x, y]: [Self; 2], [v_x, v_y]: [Self; 2]) -> Length<Self> {
        let (Some(at_x), Some(at_y), Some(at_v_x), Some(at_v_y)) =
            (x.kept().place, y.kept().place, v_x.kept().place, v_y.kept().place)
        else {
            return length_of_values([x, y], [v_x, v_y]);
        };
        let table = at_x.table;
        let (k, rho, rate) = (table.k, table.next(), table.next());
        // ρ ρ̇ = d·v, and ρ_(k+1) = ρ̇_k/(k + 1): neither squares nor a root beyond order zero.
        let (rho_k, rate_k) = if k == 0 {
            let d = [x.coefficient, y.coefficient];
            let length = length_of_values(d, [v_x.coefficient, v_y.coefficient]);
            rate.kept.set(length.reciprocal);
            rho.set(0, length.value);
            (length.value, length.rate)
        } else {
            let product = |a: Place<'_, B>, a_k, b: Place<'_, B>, b_k| {
                recurrence::product(k, (a.row, a_k), (b.row, b_k))
            };
            let along_x = product(at_x, x.coefficient, at_v_x, v_x.coefficient);
            let along_y = product(at_y, y.coefficient, at_v_y, v_y.coefficient);
            let rho_k = rho.at(k);
            (rho_k, recurrence::quotient(k, along_x + along_y, (rho, rho_k), rate))
        };
        rho.set(k + 1, rate_k * recurrence::reciprocal::<B>(k + 1));
        let value = Self { place: Some(Place { table, row: rho }), coefficient: rho_k };
        let reciprocal = Self::constant(B::cst(1.0)) / value;
        Length { value, reciprocal, rate: Self::at(table, rate, rate_k) }
    }

    #[inline(always)]
    fn apart<F: Function>(self, f: &F) -> Self {
        let Some(Place { table, row }) = self.kept().place else {
            return Self::constant(self.coefficient.apart(f));
        };
        let (c, c_k) = table.apart(|table| Self::function(table, (row, self.coefficient), f));
        Self { place: Some(Place { table, row: c }), coefficient: c_k }
    }

    #[inline(always)]
    fn all_apart<F: Functions<N, M>, const N: usize, const M: usize>(
        x: [Self; N],
        f: &F,
    ) -> [Self; M] {
        let Some(Place { table, .. }) = x.iter().find_map(|x| x.place) else {
            return f.of(x.map(|x| x.coefficient)).map(Self::constant);
        };
        let x = x.map(Self::kept);
        let (rows, values) = table.all_apart(|table| {
            let rows = x.map(|x| (x.place.map(|place| place.row), x.coefficient));
            Self::functions(table, rows, f)
        });
        std::array::from_fn(|i| Self {
            place: Some(Place { table, row: rows[i] }),
            coefficient: values[i],
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::cell::Cell;

    use super::super::rows::{MAX_ORDER, N_ROWS, Rows};
    use super::*;

    /// Every operation of a [`Real`] once, of an argument near 0.7 that changes at one.
    pub(crate) fn operations<S: Real>(x: S) -> [S; 9] {
        let (sin, cos) = x.sin_cos();
        let length = S::length([x * x, sin], [x * 2.0, cos]);
        let beside = S::length([x, S::cst(0.4)], [S::cst(1.0), S::cst(0.0)]);
        [
            length.value * length.rate + length.reciprocal + beside.value * beside.rate,
            x * x / (x + 1.0) - S::cst(2.0) / x,
            (x * x + 1.0).sqrt() * -x,
            sin * cos * 2.0 - cos,
            (x * -0.5).exp() * x,
            (x / 3.0 + 1.0).ln() + sin,
            (x + 0.5).powf(1.5) + x.powf(-0.7),
            (x - 0.7).powf(3.0) + (x - 0.7).powf(2.0),
            S::cst(1.5) - x.powf(1.0) * S::cst(2.0).sqrt(),
        ]
    }

    /// Coefficients of order `k` of the operations about `x`, those below being in `rows`.
    fn coefficients(rows: &Rows<f64>, x: f64, k: usize) -> [f64; 9] {
        let n = Cell::new(0);
        let x = Series::new(rows.table(&n, k), [x, 1.0, 0.0][k.min(2)]);
        operations(x).map(|series| series.coefficient(k))
    }

    /// Rows in which a coefficient that is read before it is written shows.
    fn poisoned() -> Rows<f64> {
        let (rows, n) = (Rows::new(), Cell::new(0));
        for _ in 0..N_ROWS {
            let row = rows.table(&n, 0).next();
            (0..=MAX_ORDER + 1).for_each(|k| row.set(k, f64::NAN));
        }
        rows
    }

    #[test]
    fn series_sum_to_what_they_expand() {
        let (x, s) = (0.7, 0.07);
        let rows = poisoned();
        let mut sums = [0.0; 9];
        for k in 0..18 {
            let terms = coefficients(&rows, x, k);
            if k == 0 {
                assert_eq!(terms, operations(x), "values are those of f64 to the bit");
            }
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term * f64::powi(s, k as i32);
            }
        }
        for (sum, exact) in sums.iter().zip(operations(x + s)) {
            // Measured: 8.9e-16.
            assert!((sum - exact).abs() < 5e-15, "{sum} for {exact}");
        }
    }

    /// Those of two numbers, of which one may be constant.
    struct Both;

    impl Functions<2, 3> for Both {
        fn of<S: Real>(&self, [x, c]: [S; 2]) -> [S; 3] {
            [x.sin_cos().0 * c, x, c]
        }
    }

    #[test]
    fn functions_of_several_numbers_are_the_same_apart() {
        let rows = poisoned();
        for k in 0..12 {
            let run = |is_apart: bool| {
                let n = Cell::new(if is_apart { 0 } else { N_ROWS / 2 });
                let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k.min(2)]);
                // A linear result, which nothing has kept yet.
                let given = [x * 0.5 + 0.35, Series::constant(1.5)];
                let [y, again, c] =
                    if is_apart { Series::all_apart(given, &Both) } else { Both.of(given) };
                // Rows of their own come after it.
                [y * x, again * again, c * x, y / x].map(|series| series.coefficient(k))
            };
            assert_eq!(run(true), run(false), "order {k}");
        }
    }
}
