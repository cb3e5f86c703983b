//! The scalar that expands a right-hand side: one Taylor coefficient at a time.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::base::Base;
use super::recurrence;
use super::rows::{Row, Table};
use crate::real::{
    Divisor, Function, Functions, Length, Real, Turning, length_of_values, less_turning_of_values,
    turning_of_values,
};

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

    /// What `row` holds of the present order already.
    #[inline(always)]
    fn known(table: Table<'a, B>, row: &'a Row<B>) -> Self {
        Self { place: Some(Place { table, row }), coefficient: row.at(table.k) }
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
    fn over_constant(self, x: B) -> Self {
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

    /// Waits for one operation where the second factor is known last, for two where the first is.
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
            return self.over_constant(other.coefficient);
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
        self.over_constant(B::cst(x))
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
    fn divisor(self) -> Divisor<Self> {
        let reciprocal = match self.place {
            Some(place) if place.table.k > 0 => B::cst(0.0),
            _ => B::cst(1.0) / self.coefficient,
        };
        Divisor { value: self, reciprocal: Self::constant(reciprocal) }
    }

    #[inline(always)]
    fn over(self, by: &Divisor<Self>) -> Self {
        let Some(Place { table, row: b }) = by.value.kept().place else {
            return self * by.reciprocal;
        };
        let (k, a_k, c) = (table.k, self.coefficient(table.k), table.next());
        if k == 0 {
            c.kept.set(by.reciprocal.coefficient);
            return Self::at(table, c, a_k * by.reciprocal.coefficient);
        }
        Self::at(table, c, recurrence::quotient(k, a_k, (b, by.value.coefficient), c))
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
        let rate_k = if k == 0 {
            let d = [x.coefficient, y.coefficient];
            let length = length_of_values(d, [v_x.coefficient, v_y.coefficient]);
            rate.kept.set(length.rho.reciprocal);
            rho.set(0, length.rho.value);
            length.rate
        } else {
            let product = |a: Place<'_, B>, a_k, b: Place<'_, B>, b_k| {
                recurrence::product(k, (a.row, a_k), (b.row, b_k))
            };
            let along_x = product(at_x, x.coefficient, at_v_x, v_x.coefficient);
            let along_y = product(at_y, y.coefficient, at_v_y, v_y.coefficient);
            recurrence::quotient(k, along_x + along_y, (rho, rho.at(k)), rate)
        };
        rho.set(k + 1, rate_k * recurrence::reciprocal::<B>(k + 1));
        let value = Self::known(table, rho);
        let reciprocal = Self::constant(rate.kept.get());
        Length { rho: Divisor { value, reciprocal }, rate: Self::at(table, rate, rate_k) }
    }

    #[inline(always)]
    fn turning(arms: [Self; 2], turn: [Self; 2]) -> Turning<Self> {
        let ([theta, omega], [p, q]) = (turn, arms);
        let (Some(Place { table, .. }), Some(_), None, None) =
            (theta.place, omega.kept().place, p.place, q.place)
        else {
            return turning_of_values(arms, turn);
        };
        let (k, sin, cos) = (table.k, table.next(), table.next());
        let (sin_rate, cos_rate) = (table.next(), table.next());
        if k == 0 {
            let (sin_0, cos_0) = Real::sin_cos(theta.coefficient);
            sin.set(0, sin_0);
            cos.set(0, cos_0);
            sin_rate.set(0, cos_0 * omega.coefficient);
            cos_rate.set(0, -(sin_0 * omega.coefficient));
        }
        debug_assert!(
            k == 0 || sin_rate.kept.get().value() == k as f64,
            "a curve that turns was not ended at the order before {k}"
        );
        // Those of the rates are known from the order before, and tell sine and cosine one order ahead.
        let share = recurrence::reciprocal::<B>(k + 1);
        sin.set(k + 1, sin_rate.at(k) * share);
        cos.set(k + 1, cos_rate.at(k) * share);
        let here = |row| Self::known(table, row);
        let (sin, cos) = (here(sin), here(cos));
        let rates = [here(sin_rate), here(cos_rate)];
        Turning { sin, cos, along: [cos * p, -(sin * q)], rates, arms, omega }
    }

    #[inline(always)]
    fn less_turning(a: [Self; 2], turning: Turning<Self>, theta_dd: Self) -> [Self; 2] {
        let Turning { sin, cos, along, rates, arms, omega } = turning;
        let (Some(sin), Some(cos), [Some(sin_rate), Some(cos_rate)], Some(w), [None, None]) = (
            sin.place,
            cos.place,
            [rates[0].place, rates[1].place],
            omega.place,
            [arms[0].place, arms[1].place],
        ) else {
            return less_turning_of_values(a, [along, rates, arms], omega, theta_dd);
        };
        let (table, k, w) = (w.table, w.table.k, w.row);
        let (a_x, a_y, alpha) = (a[0].coefficient(k), a[1].coefficient(k), theta_dd.coefficient(k));
        let next_w = alpha * recurrence::reciprocal::<B>(k + 1);
        w.set(k + 1, next_w);
        let ahead = |row: &Row<B>| recurrence::product_ahead(k, (row, row.at(k + 1)), (w, next_w));
        let (next_sin_rate, next_cos_rate) = (ahead(cos.row), -ahead(sin.row));
        sin_rate.row.set(k + 1, next_sin_rate);
        cos_rate.row.set(k + 1, next_cos_rate);
        if cfg!(debug_assertions) {
            sin_rate.row.kept.set(B::cst((k + 1) as f64));
        }
        let arms = [arms[0].coefficient, arms[1].coefficient];
        let [x, y] = if k == 0 {
            let along = [along[0].coefficient, along[1].coefficient];
            let rates = [rates[0].coefficient, rates[1].coefficient];
            less_turning_of_values([a_x, a_y], [along, rates, arms], omega.coefficient, alpha)
        } else {
            // r̈ of this order is k + 1 times ṙ of the next.
            let n = (k + 1) as f64;
            [B::fma(next_sin_rate, -(arms[0] * n), a_x), B::fma(next_cos_rate, -(arms[1] * n), a_y)]
        };
        [Self::new(table, x), Self::new(table, y)]
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
    pub(crate) fn operations<S: Real>(x: S) -> [S; 11] {
        let (sin, cos) = x.sin_cos();
        let length = S::length([x * x, sin], [x * 2.0, cos]);
        let beside = S::length([x, S::cst(0.4)], [S::cst(1.0), S::cst(0.0)]);
        [
            length.rho.value * length.rate + x.over(&length.rho) + beside.rho.value * beside.rate,
            x * x / (x + 1.0) - S::cst(2.0) / x,
            (x * x + 1.0).sqrt() * -x,
            sin * cos * 2.0 - cos,
            (x * -0.5).exp() * x,
            (x / 3.0 + 1.0).ln() + sin,
            (x + 0.5).powf(1.5) + x.powf(-0.7),
            (x - 0.7).powf(3.0) + (x - 0.7).powf(2.0),
            S::cst(1.5) - x.powf(1.0) * S::cst(2.0).sqrt(),
            S::cst(2.0).over(&(x + 1.0).divisor()) + (x - 0.2).over(&S::cst(3.0).divisor()),
            curves(x),
        ]
    }

    /// Second derivatives of curves that turn by sin x, by x², and evenly.
    fn curves<S: Real>(x: S) -> S {
        let (sin, cos) = x.sin_cos();
        let arms = [S::cst(0.3), S::cst(-1.2)];
        let by_sine = S::turning(arms, [sin, cos]);
        let of_curve = by_sine.sin * by_sine.along[0] + by_sine.cos * by_sine.along[1];
        let of_rates = by_sine.rates[0] * by_sine.rates[1];
        let [a, b] = S::less_turning([x, cos], by_sine, -sin);
        let by_square = S::turning(arms, [x * x, x * 2.0]);
        let [c, d] = S::less_turning([S::cst(0.0), S::cst(0.5)], by_square, S::cst(2.0));
        let evenly = S::turning(arms, [x * 2.0, S::cst(2.0)]);
        let [e, f] = S::less_turning([x, S::cst(0.5)], evenly, S::cst(0.0));
        of_curve + of_rates + a * b + c * d + e * f
    }

    /// Coefficients of order `k` of the operations about `x`, those below being in `rows`.
    fn coefficients(rows: &Rows<f64>, x: f64, k: usize) -> [f64; 11] {
        let n = Cell::new(0);
        let x = Series::new(rows.table(&n, k), [x, 1.0, 0.0][k.min(2)]);
        let all = operations(x).map(|series| series.coefficient(k));
        assert!(n.get() <= 2 * N_ROWS, "{} rows", n.get());
        all
    }

    /// Rows for [`operations`] and some.
    pub(crate) fn enough_rows<B: Base>() -> Rows<B> {
        let mut rows = Rows::new();
        rows.grow(2 * N_ROWS);
        rows
    }

    /// Rows in which a coefficient that is read before it is written shows.
    fn poisoned() -> Rows<f64> {
        let (rows, n) = (enough_rows(), Cell::new(0));
        for _ in 0..2 * N_ROWS {
            let row = rows.table(&n, 0).next();
            (0..=MAX_ORDER + 1).for_each(|k| row.set(k, f64::NAN));
        }
        rows
    }

    #[test]
    fn series_sum_to_what_they_expand() {
        let (x, s) = (0.7, 0.07);
        let rows = poisoned();
        let mut sums = [0.0; 11];
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

    #[test]
    fn curves_one_order_ahead_are_those_of_their_definition() {
        let rows = poisoned();
        for k in 0..=MAX_ORDER {
            let n = Cell::new(0);
            let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k.min(2)]);
            let (a, arms) = ([x, x.sin_cos().1], [0.3, -1.2].map(Series::cst));
            let omega = x * 2.0;
            let of_values = turning_of_values(arms, [x * x, omega]);
            let Turning { along, rates, .. } = of_values;
            let [x_1, y_1] =
                less_turning_of_values(a, [along, rates, arms], omega, Series::cst(2.0));
            let [x_2, y_2] =
                Series::less_turning(a, Series::turning(arms, [x * x, omega]), Series::cst(2.0));
            for (own, other) in [(x_1, x_2), (y_1, y_2)] {
                let (own, other) = (own.coefficient(k), other.coefficient(k));
                assert!((own / other - 1.0).abs() < 1e-12, "order {k}: {own:e} for {other:e}");
            }
        }
    }

    #[test]
    #[should_panic(expected = "was not ended at the order before 2")]
    #[cfg(debug_assertions)]
    fn a_curve_that_is_not_ended_is_refused() {
        let rows = enough_rows::<f64>();
        for k in 0..3 {
            let n = Cell::new(0);
            let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k]);
            let curve = Series::turning([0.3, -1.2].map(Series::cst), [x * x, x * 2.0]);
            if k == 0 {
                let _ = Series::less_turning([x, x], curve, Series::cst(2.0));
            }
        }
    }

    /// Those of two numbers, of which one may be constant.
    struct Both;

    impl Functions<2, 3> for Both {
        fn of<S: Real>(&self, [x, c]: [S; 2]) -> [S; 3] {
            let curve = S::turning([S::cst(1.0), S::cst(1.0)], [x * x, x * 2.0]);
            let [a, _] = S::less_turning([c, c], curve, S::cst(2.0));
            [x.sin_cos().0 * c + a, x, c]
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
