//! Operations of series in lanes with a constant in each lane.

use std::ops::{Add, Mul, Sub};

use super::coefficient::Coefficient;
use super::series::Series;
use crate::lanes::{Lanes, Simd};
use crate::real::Over;

macro_rules! with_constant {
    ($trait:ident, $name:ident, |$x:ident, $c:ident| $result:expr) => {
        impl<V: Simd> $trait<Lanes<V>> for Series<'_, Lanes<V>>
        where
            Lanes<V>: Coefficient,
        {
            type Output = Self;

            #[inline(always)]
            fn $name(self, $c: Lanes<V>) -> Self {
                let $x = self;
                $result
            }
        }
    };
}

with_constant!(Add, add, |x, c| x.plus(c));
with_constant!(Sub, sub, |x, c| x.plus(-c));
with_constant!(Mul, mul, |x, c| x.linear(x.coefficient * c));

impl<V: Simd> Over<Lanes<V>> for Series<'_, Lanes<V>>
where
    Lanes<V>: Coefficient,
{
    #[inline(always)]
    fn of(constant: Lanes<V>) -> Self {
        Self::constant(constant)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use wide::f64x2;

    use super::super::rows::MAX_ORDER;
    use super::super::series::tests::{enough_rows, operations};
    use super::*;

    /// Operations with constants of each run, and each of a [`Real`].
    fn with_constants<S: Over<C>, C: Copy>(x: S, [c, d]: [C; 2]) -> [S; 13] {
        let [a, b, e, f, g, h, i, j, k, l, m] = operations(x);
        [a, b, e, f, g, h, i, j, k, l, m, (x * c + d) * x - c, <S as Over<C>>::of(d) / x]
    }

    #[test]
    fn series_of_two_runs_have_the_bits_of_each() {
        let (x, c, d) = ([0.7, 0.8], [1.5, -0.3], [0.1, 7.0]);
        let (both, each) = (enough_rows(), [enough_rows(), enough_rows()]);
        for k in 0..=MAX_ORDER {
            let start = |x: f64| [x, 1.0, 0.0][k.min(2)];
            let n = Cell::new(0);
            let of_both = Series::new(both.table(&n, k), Lanes::<f64x2>::from_fn(|i| start(x[i])));
            let constants = [c, d].map(|c| Lanes::from_fn(|i| c[i]));
            let of_both = with_constants(of_both, constants).map(|series| series.coefficient(k));
            for (i, rows) in each.iter().enumerate() {
                n.set(0);
                let alone = Series::new(rows.table(&n, k), start(x[i]));
                let alone = with_constants(alone, [c[i], d[i]]).map(|series| series.coefficient(k));
                let bits = of_both.map(|both| both.lane(i).to_bits());
                assert_eq!(bits, alone.map(f64::to_bits), "order {k}, run {i}");
            }
        }
    }
}
