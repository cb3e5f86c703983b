//! The scalar that expands a right-hand side: a Taylor series, of which one coefficient is computed at a time.

mod operators;

use std::fmt;

use super::coefficient::Coefficient;
use super::recurrence::{self, LARGEST_PRODUCT};
use super::rows::{Row, Table};
use crate::real::{
    ArcTangent, Divisor, Function, Functions, Length, Real, Shortcuts, Turning, length_of_values,
    less_turning_of_values, turning_of_values,
};

/// A function of time as a Taylor series. The present run computes the coefficient of one order; the lower ones are
/// in a table.
///
/// A right-hand side is run once per order. Each of its operations finds its row in the table and computes one
/// coefficient by its [`recurrence`], so `N` runs expand to order `N` whatever the right-hand side consists of.
/// Constants have no row, and cost no more than numbers. A coefficient is written to its row only if a later order
/// reads it: a recurrence *keeps* each operand that it sums over, and its own result if it sums over that.
///
/// The coefficient of order zero is computed by the same operations as with `f64`. It is the [`value`](Real::value)
/// of the series in the runs of all orders, so decisions are the same in every run. The table relies on that.
#[derive(Clone, Copy)]
pub struct Series<'a, B: Copy> {
    place: Option<Place<'a, B>>,
    /// The coefficient of the present order; for a constant, its value in runs of all orders.
    pub(super) coefficient: B,
}

/// Place of the coefficients of a series: its table and row.
#[derive(Clone, Copy)]
struct Place<'a, B: Copy> {
    table: Table<'a, B>,
    row: &'a Row<B>,
}

impl<'a, B: Coefficient> Series<'a, B> {
    /// A constant.
    #[inline(always)]
    pub(crate) fn constant(x: B) -> Self {
        Self { place: None, coefficient: x }
    }

    /// A series in a new row with this coefficient. The coefficient is written to the row at order zero, and at
    /// higher orders only by [`kept`](Self::kept).
    #[inline(always)]
    pub(crate) fn new(table: Table<'a, B>, coefficient: B) -> Self {
        let row = table.next();
        if table.k == 0 {
            row.set(0, coefficient);
        }
        Self { place: Some(Place { table, row }), coefficient }
    }

    /// Writes the coefficient to its row, for recurrences that sum over lower orders. Series that are only added, or
    /// multiplied by constants, need not be written.
    #[inline(always)]
    fn kept(self) -> Self {
        if let Some(Place { table, row }) = self.place {
            row.set(table.k, self.coefficient);
        }
        self
    }

    /// A series whose coefficient of the present order is this one, which is written to `row`.
    #[inline(always)]
    fn at(table: Table<'a, B>, row: &'a Row<B>, coefficient: B) -> Self {
        row.set(table.k, coefficient);
        Self { place: Some(Place { table, row }), coefficient }
    }

    /// The coefficient of order `k`, which must be the order of the run.
    #[inline(always)]
    pub(crate) fn coefficient(self, k: usize) -> B {
        if self.place.is_some() || k == 0 { self.coefficient } else { B::cst(0.0) }
    }

    /// The series in `row`, whose coefficient of the present order is known already.
    #[inline(always)]
    fn known(table: Table<'a, B>, row: &'a Row<B>) -> Self {
        Self { place: Some(Place { table, row }), coefficient: row.at(table.k) }
    }

    /// A linear function of this series, whose coefficient is the given one; a constant where this series is
    /// constant.
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

    /// The series divided by the constant `x`.
    #[inline(always)]
    fn over_constant(self, x: B) -> Self {
        let is_value = self.place.is_none_or(|place| place.table.k == 0);
        // Only the value must agree with `f64` to the bit; at higher orders a product replaces the slow division.
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

    /// Computes the coefficient of `aᵖ`, in the last row that it takes.
    // Not inlined: its loops would keep the row counter of all surrounding operations in memory.
    #[inline(never)]
    fn power(table: Table<'_, B>, (row, a_k): (&Row<B>, B), p: f64) -> B {
        let k = table.k;
        if (2.0..=LARGEST_PRODUCT).contains(&p) && p.fract() == 0.0 {
            // Unlike the recurrence of powers, products have no singular point where the base is zero.
            let base = Series { place: Some(Place { table, row }), coefficient: a_k };
            let product = base.powi(p as u32);
            // The value must agree with `f64` to the bit.
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

    /// Computes the coefficient of `f` of the series in `row`, in the last row that it takes.
    #[inline(never)]
    fn function<F: Function>(table: Table<'_, B>, (row, a_k): (&Row<B>, B), f: &F) -> B {
        let value = f.of(Series { place: Some(Place { table, row }), coefficient: a_k });
        Series::new(table, value.coefficient(table.k)).coefficient
    }

    /// Computes the coefficients of `f` of the series in these rows (constants where there is no row), in the last
    /// rows that it takes.
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
}

impl<B: Coefficient> fmt::Debug for Series<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            None => write!(f, "{:?}", self.coefficient),
            Some(Place { table, .. }) => write!(f, "{:?} at order {}", self.coefficient, table.k),
        }
    }
}

impl<B: Coefficient> Real for Series<'_, B> {
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
        let (c, c_k) = table.outlined(|table| Self::power(table, (row, self.coefficient), p));
        Self { place: Some(Place { table, row: c }), coefficient: c_k }
    }

    /// Of constants it is that of their numbers, which may be intervals.
    fn atan2(self, x: Self) -> Self {
        if self.place.is_none() && x.place.is_none() {
            return Self::constant(Real::atan2(self.coefficient, x.coefficient));
        }
        let [angle] = Self::all_outlined([self, x], &ArcTangent);
        angle
    }
}

impl<B: Coefficient> Shortcuts for Series<'_, B> {
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
        // ρ ρ̇ = d·v and ρ_(k+1) = ρ̇_k/(k + 1), so orders above zero need neither squares nor a root.
        let rate_k = if k == 0 {
            let d = [x.coefficient, y.coefficient];
            let length = B::length(d, [v_x.coefficient, v_y.coefficient]);
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
        // The coefficients of the rates are known from the order before. They give those of sine and cosine one order
        // higher.
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
            // The coefficient of r̈ of this order is k + 1 times that of ṙ of the next order.
            let n = (k + 1) as f64;
            [B::fma(next_sin_rate, -(arms[0] * n), a_x), B::fma(next_cos_rate, -(arms[1] * n), a_y)]
        };
        [Self::new(table, x), Self::new(table, y)]
    }

    #[inline(always)]
    fn outlined<F: Function>(self, f: &F) -> Self {
        let Some(Place { table, row }) = self.kept().place else {
            return Self::constant(self.coefficient.outlined(f));
        };
        let (c, c_k) = table.outlined(|table| Self::function(table, (row, self.coefficient), f));
        Self { place: Some(Place { table, row: c }), coefficient: c_k }
    }

    #[inline(always)]
    fn all_outlined<F: Functions<N, M>, const N: usize, const M: usize>(
        x: [Self; N],
        f: &F,
    ) -> [Self; M] {
        let Some(Place { table, .. }) = x.iter().find_map(|x| x.place) else {
            return f.of(x.map(|x| x.coefficient)).map(Self::constant);
        };
        let x = x.map(Self::kept);
        let (rows, values) = table.all_outlined(|table| {
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
pub(super) mod tests;
