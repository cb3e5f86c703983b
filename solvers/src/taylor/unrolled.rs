//! Runs of one order, or of one of four, with that known to the compiler.
//!
//! Loops over lower orders are then straight lines of code. In a run of one order the place of each coefficient in
//! the table is a constant too; in one of four orders sums are of one number of vectors.

use super::rows::MAX_ORDER;

/// Something that is done for one order of a series.
pub(super) trait OfOrder: Sized {
    /// What it gives.
    type Output;

    /// Orders above this one are not worth code of their own.
    const HIGHEST: usize;

    /// Orders above this one share their code with others.
    const HIGHEST_APIECE: usize;

    /// Does it for order `k`; inlined, for the sake of what is known of `k`.
    fn of_order(self, k: usize) -> Self::Output;

    /// [`of_order`](Self::of_order), by the code for just these orders where there is one.
    #[inline]
    fn unrolled(self, k: usize) -> Self::Output {
        macro_rules! among {
            ($($order:literal)*, $($own:literal)*) => {
                match k {
                    $($order => among::<Self, $order, 1>(self, k),)*
                    $($own if const { $own <= Self::HIGHEST_APIECE } => {
                        among::<Self, $own, 1>(self, k)
                    })*
                    // By the number of vectors in a sum, ⌊(k + 2)/4⌋.
                    6..=9 => among::<Self, 6, 4>(self, k),
                    10..=13 => among::<Self, 10, 4>(self, k),
                    14..=17 => among::<Self, 14, 4>(self, k),
                    18..=21 => among::<Self, 18, 4>(self, k),
                    22..=MAX_ORDER => among::<Self, 22, 4>(self, k),
                    _ => rolled(self, k),
                }
            };
        }
        // Up to the last of the short sums, and where that is worth it beyond, each order by itself.
        among!(0 1 2 3 4 5, 6 7 8 9 10 11 12 13)
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
