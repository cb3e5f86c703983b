//! Sums, products and quotients that are noted.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::super::coefficient::Coefficient;
use super::Noted;

impl<B: Coefficient> Neg for Noted<'_, B> {
    type Output = Self;

    fn neg(self) -> Self {
        self.scaled(-self.number(), B::cst(-1.0))
    }
}

impl<B: Coefficient> Add for Noted<'_, B> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, self.number() + other.number(), B::cst(1.0))
    }
}

impl<B: Coefficient> Sub for Noted<'_, B> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.with(other, self.number() - other.number(), B::cst(-1.0))
    }
}

impl<B: Coefficient> Mul for Noted<'_, B> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.product(other, self.number() * other.number())
    }
}

impl<B: Coefficient> Div for Noted<'_, B> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.quotient(other, self.number() / other.number(), B::cst(1.0) / other.number())
    }
}

impl<B: Coefficient> Add<f64> for Noted<'_, B> {
    type Output = Self;

    fn add(self, x: f64) -> Self {
        self.shifted(self.number() + x)
    }
}

impl<B: Coefficient> Sub<f64> for Noted<'_, B> {
    type Output = Self;

    fn sub(self, x: f64) -> Self {
        self.shifted(self.number() - x)
    }
}

impl<B: Coefficient> Mul<f64> for Noted<'_, B> {
    type Output = Self;

    fn mul(self, x: f64) -> Self {
        self.scaled(self.number() * x, B::cst(x))
    }
}

impl<B: Coefficient> Div<f64> for Noted<'_, B> {
    type Output = Self;

    fn div(self, x: f64) -> Self {
        self.scaled(self.number() / x, B::cst(1.0) / x)
    }
}
