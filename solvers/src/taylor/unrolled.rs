//! Runs of one order, with the order known to the compiler.
//!
//! Its loops over lower orders are then straight lines of code, and the place of each
//! coefficient in the table is a constant: two to three times less work than with rolled loops.

/// Something that is done for one order of a series.
pub(super) trait OfOrder: Sized {
    /// What it gives.
    type Output;

    /// Orders above this one are not worth code of their own; at most eight.
    const HIGHEST: usize;

    /// Does it for order `k`; inlined, for the sake of a `k` that is a constant.
    fn of_order(self, k: usize) -> Self::Output;

    /// [`of_order`](Self::of_order), by the code for just that order where there is one.
    #[inline]
    fn unrolled(self, k: usize) -> Self::Output {
        macro_rules! by_order {
            ($($order:literal)*) => {
                match k {
                    $($order => at::<Self, $order>(self),)*
                    _ => rolled(self, k),
                }
            };
        }
        by_order!(0 1 2 3 4 5 6 7 8)
    }
}

#[inline(never)]
fn at<R: OfOrder, const K: usize>(run: R) -> R::Output {
    if const { K <= R::HIGHEST } { run.of_order(K) } else { rolled(run, K) }
}

#[inline(never)]
fn rolled<R: OfOrder>(run: R, k: usize) -> R::Output {
    run.of_order(k)
}
