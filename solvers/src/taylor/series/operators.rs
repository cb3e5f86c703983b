//! Sums, products and quotients of series.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::super::coefficient::Coefficient;
use super::super::recurrence;
use super::{Place, Series};

impl<B: Coefficient> Neg for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.linear(-self.coefficient)
    }
}

impl<B: Coefficient> Add for Series<'_, B> {
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

impl<B: Coefficient> Sub for Series<'_, B> {
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

impl<B: Coefficient> Mul for Series<'_, B> {
    type Output = Self;

    /// If the second factor is known last, one operation follows it; if the first is, two.
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

impl<B: Coefficient> Div for Series<'_, B> {
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

impl<B: Coefficient> Add<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn add(self, x: f64) -> Self {
        self.plus(B::cst(x))
    }
}

impl<B: Coefficient> Sub<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, x: f64) -> Self {
        self.plus(B::cst(-x))
    }
}

impl<B: Coefficient> Mul<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        self.linear(self.coefficient * x)
    }
}

impl<B: Coefficient> Div<f64> for Series<'_, B> {
    type Output = Self;

    #[inline(always)]
    fn div(self, x: f64) -> Self {
        self.over_constant(B::cst(x))
    }
}
