//! DOPRI5 and DOP853 written by hand for this one model: what generality is measured against.
//!
//! Fixed arrays, stages unrolled without their zero coefficients, the joint's equations inlined, two
//! guards. Steps are controlled and events located by the same rules as ours: dense output predicts,
//! steps retaken from the same start close on the root, the last lands just past the surface.

mod dop853;
mod dopri5;
mod drive;
mod joint;

pub(crate) use dop853::Dop853;
pub(crate) use dopri5::Dopri5;
pub(crate) use drive::run;
pub(crate) use joint::Joint;

/// `y + h Σ w_j k_j` over the stages `j` that have a weight.
macro_rules! combine {
    ($y:expr, $h:expr, $k:expr, $w:expr; $j0:literal $($j:literal)*) => {{
        let (y, h, k, w) = (&$y, $h, &$k, &$w);
        std::array::from_fn(|i| y[i] + h * (w[$j0] * k[$j0][i] $(+ w[$j] * k[$j][i])*))
    }};
}
pub(crate) use combine;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry::atol;
    use crate::problem::{Problem, Track};

    type Solve = fn(&Joint, [f64; 6], &[f64], f64, &[f64; 6]) -> Result<Track, String>;

    #[test]
    fn both_find_every_event_and_reproduce_the_golden_run() {
        let problem = Problem::new().unwrap();
        let by_hand = |solve: Solve| {
            let run = problem.both(|block| {
                let (start, atol) = (block.initial_state(), atol(block, 1e-10));
                Ok(solve(&Joint::new(block), start, &problem.times, 1e-10, &atol)?)
            });
            problem.judge(&run.unwrap()).unwrap()
        };
        // Measured: e = 5.8e-11 and 1.6e-10.
        for (verdict, e) in [(by_hand(run::<Dopri5>), 5e-10), (by_hand(run::<Dop853>), 1e-9)] {
            assert!(verdict.e < e, "{:e}", verdict.e);
            assert_eq!((verdict.delta.paired, verdict.slip.paired), (52, 8));
            assert_eq!((verdict.delta.spurious, verdict.slip.spurious), (0, 0));
        }
    }
}
