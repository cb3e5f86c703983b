//! Runs of one order, or of one of four, with that known to the compiler.
//!
//! Loops over lower orders are then straight lines of code: up to order five the place of each
//! coefficient in the table is a constant too, beyond it sums are of one number of vectors in four orders each.

use super::rows::MAX_ORDER;

/// Something that is done for one order of a series.
pub(super) trait OfOrder: Sized {
    /// What it gives.
    type Output;

    /// Orders above this one are not worth code of their own.
    const HIGHEST: usize;

    /// Does it for order `k`; inlined, for the sake of what is known of `k`.
    fn of_order(self, k: usize) -> Self::Output;

    /// [`of_order`](Self::of_order), by the code for just these orders where there is one.
    #[inline]
    fn unrolled(self, k: usize) -> Self::Output {
        // Up to the last of the short sums, then by the number of vectors in a long one, ⌊(k + 2)/4⌋.
        match k {
            0 => among::<Self, 0, 1>(self, k),
            1 => among::<Self, 1, 1>(self, k),
            2 => among::<Self, 2, 1>(self, k),
            3 => among::<Self, 3, 1>(self, k),
            4 => among::<Self, 4, 1>(self, k),
            5 => among::<Self, 5, 1>(self, k),
            6..=9 => among::<Self, 6, 4>(self, k),
            10..=13 => among::<Self, 10, 4>(self, k),
            14..=17 => among::<Self, 14, 4>(self, k),
            18..=21 => among::<Self, 18, 4>(self, k),
            22..=MAX_ORDER => among::<Self, 22, 4>(self, k),
            _ => rolled(self, k),
        }
    }
}

/// Does it for `k`, one of `N` orders from `LEAST` on: written so that this range is in the number itself and
/// no compiler has to see it from where it is called.
#[inline(never)]
fn among<R: OfOrder, const LEAST: usize, const N: usize>(run: R, k: usize) -> R::Output {
    debug_assert!((LEAST..LEAST + N).contains(&k), "order {k} is not among {N} from {LEAST} on");
    if const { LEAST <= R::HIGHEST } {
        run.of_order(LEAST + (k - LEAST) % N)
    } else {
        rolled(run, k)
    }
}

#[inline(never)]
fn rolled<R: OfOrder>(run: R, k: usize) -> R::Output {
    run.of_order(k)
}
