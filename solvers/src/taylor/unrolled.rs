//! Code that is specialised to one order of a series, or to one of four.
//!
//! Loops over lower orders then become straight-line code. In code for one order the address of each coefficient in
//! the table is a constant too. In code for four orders each sum has a fixed number of vectors.

use super::rows::MAX_ORDER;

/// A computation for one order of a series.
pub(super) trait OfOrder: Sized {
    /// The result.
    type Output: Default;

    /// The highest order that it is done for. No code is compiled for orders above.
    const MOST: usize = MAX_ORDER;

    /// Highest order for which specialised code is worthwhile.
    const HIGHEST: usize;

    /// Highest order with code of its own; orders above share code.
    const HIGHEST_APIECE: usize;

    /// Does the computation for order `k`. It must be inlined, so that the compiler can use what it knows of `k`.
    fn of_order(self, k: usize) -> Self::Output;

    /// Calls [`of_order`](Self::of_order) in the code that is specialised to `k`, where there is such code.
    ///
    /// # Panics
    /// Where `k` is above the [highest order](Self::MOST).
    #[inline]
    fn unrolled(self, k: usize) -> Self::Output {
        assert!(k <= Self::MOST, "order {k} is above {}", Self::MOST);
        macro_rules! among {
            ($($order:literal)*, $($own:literal)*) => {
                match k {
                    $($order => among::<Self, $order, 1>(self, k),)*
                    $($own if const { $own <= Self::HIGHEST_APIECE } => {
                        among::<Self, $own, 1>(self, k)
                    })*
                    // Grouped by the number of vectors in a sum, ⌊(k + 2)/4⌋.
                    6..=9 => among::<Self, 6, 4>(self, k),
                    10..=13 => among::<Self, 10, 4>(self, k),
                    14..=17 => among::<Self, 14, 4>(self, k),
                    18..=21 => among::<Self, 18, 4>(self, k),
                    _ => among::<Self, 22, 4>(self, k),
                }
            };
        }
        // Orders up to the last of the short sums have code of their own each, and orders beyond where that is
        // worthwhile.
        among!(0 1 2 3 4 5, 6 7 8 9 10 11 12 13)
    }
}

/// Does the computation for `k`, one of the `N` orders from `LEAST` on. The order is written so that its range is
/// evident from the expression itself, and the compiler need not derive it from the call.
#[inline(never)]
fn among<R: OfOrder, const LEAST: usize, const N: usize>(run: R, k: usize) -> R::Output {
    debug_assert!((LEAST..LEAST + N).contains(&k), "order {k} is not among {N} from {LEAST} on");
    if const { LEAST > R::MOST } {
        R::Output::default()
    } else if const { LEAST <= R::HIGHEST } {
        run.of_order(LEAST + (k - LEAST) % N)
    } else {
        rolled(run, k)
    }
}

#[inline(never)]
fn rolled<R: OfOrder>(run: R, k: usize) -> R::Output {
    run.of_order(k)
}
