//! The sums over lower orders.

use super::super::coefficient::Coefficient;
use super::super::recurrence::{inner, inner_ahead, inner_of_power, reciprocal};
use super::super::unrolled::OfOrder;
use super::notes::{Extent, Notes, Sum};

/// The sums of one order.
pub(super) struct Sums<'a, B: Copy> {
    pub(super) notes: &'a mut Notes<B>,
    pub(super) extent: Extent,
}

impl<B: Coefficient> OfOrder for Sums<'_, B> {
    type Output = ();

    const HIGHEST: usize = B::HIGHEST_UNROLLED;

    // The most that there is: this code is compiled once for all systems.
    const HIGHEST_APIECE: usize = 13;

    #[inline(always)]
    fn of_order(self, k: usize) {
        let Self { notes, extent } = self;
        let rows = &notes.rows[..];
        let to = &mut notes.sums_of_order[..];
        let zero = B::cst(0.0);
        let both = |sum: &Sum<B>| sum.rows.map(|row| &rows[row as usize]);
        for sum in &notes.sums[..extent.sums] {
            let [a, b] = both(sum);
            to[sum.to as usize] = inner(k, a, b).map_or(zero, |of| of * sum.weight);
        }
        let share = reciprocal::<B>(k);
        for sum in &notes.of_integrals[..extent.of_integrals] {
            let [d, b] = both(sum);
            to[sum.to as usize] = inner(k, d, b).map_or(zero, |of| of * share * sum.weight);
        }
        for sum in &notes.ahead[..extent.ahead] {
            let [a, b] = both(sum);
            let weight = sum.weight * (k + 1) as f64;
            to[sum.to as usize] = inner_ahead(k, a, b).map_or(zero, |of| of * weight);
        }
        for (sum, p) in &notes.of_powers[..extent.of_powers] {
            let [c, a] = both(sum);
            let of = if k > 1 { inner_of_power(k, *p, c, a) * share * sum.weight } else { zero };
            to[sum.to as usize] = of;
        }
    }
}
