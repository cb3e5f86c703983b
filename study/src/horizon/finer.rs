//! Where runs at rounding do not come to the end, a run is compared with one of its own method that is somewhat more exact.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::Grid;

use super::{Bound, Judge, LEAST_WORK, SHARE, Span, TightEvents};
use crate::digits::rounded_to;
use crate::part::{Part, Start};
use crate::setting::{Accuracy, Atol, Events, Setting};

/// Its tolerance, over that of the run.
const TOLERANCE: f64 = 1e-2;
/// The tightest tolerance that it has.
const LEAST_RTOL: f64 = 1e-13;
/// A tolerance that is clearly tighter is at most this part of that of the run.
const TIGHTER: f64 = 0.5;
/// Its step, over that of the run.
const STEP: f64 = 0.25;

/// The events of a run like that at `setting`, but more exact, as far as it comes at a few times the work; none of a run that
/// locates no events, or cannot be more exact.
pub(super) fn events(
    part: &Part,
    setting: &Setting,
    span: Span,
    stop: &AtomicBool,
) -> Option<TightEvents> {
    if setting.events != Events::Located || span.reached <= 0.0 {
        return None;
    }
    let accuracy = more_exact(&setting.accuracy)?;
    let by = Judge::Finer(accuracy.to_string());
    let finer = Setting { accuracy, ..setting.clone() };
    let most = (SHARE * span.work).max(LEAST_WORK);
    let mut bound = Bound { setting: &finer, most, stop };
    let nowhere = Grid::Times(Vec::new());
    let (run, trace) = part.run(&finer, Start::Exact, span.end(), &nowhere, &mut bound);
    let changes = trace.changes;
    let stopped_at = run.stopped_at();
    Some(TightEvents { until: vec![run.t; changes.len()], changes, stopped_at, by })
}

fn more_exact(accuracy: &Accuracy) -> Option<Accuracy> {
    match accuracy {
        Accuracy::Step(h) => Some(Accuracy::Step(STEP * h)),
        Accuracy::Rtol(rtol, atol) => {
            let tighter = rounded_to((TOLERANCE * rtol).max(LEAST_RTOL), 3);
            let atol = atol.as_ref().map(|atol| scaled(atol, tighter / rtol));
            (tighter <= TIGHTER * rtol).then_some(Accuracy::Rtol(tighter, atol))
        }
    }
}

fn scaled(atol: &Atol, by: f64) -> Atol {
    match atol {
        Atol::Same(atol) => Atol::Same(atol * by),
        Atol::Each(all) => Atol::Each(all.iter().map(|atol| atol * by).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_run_is_clearly_more_exact_or_there_is_none() {
        assert_eq!(more_exact(&Accuracy::Step(4e-3)), Some(Accuracy::Step(1e-3)));
        let atol = |all: &[f64]| Some(Atol::Each(all.into()));
        let Some(Accuracy::Rtol(rtol, Some(Atol::Each(finer)))) =
            more_exact(&Accuracy::Rtol(1e-4, atol(&[1e-6, 1e-3])))
        else {
            panic!("a tolerance");
        };
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(rtol, 1e-6) && close(finer[0], 1e-8) && close(finer[1], 1e-5));
        let Some(Accuracy::Rtol(rtol, Some(Atol::Same(same)))) =
            more_exact(&Accuracy::Rtol(1e-12, Some(Atol::Same(1e-9))))
        else {
            panic!("a tolerance");
        };
        assert!(close(rtol, 1e-13) && close(same, 1e-10));
        assert_eq!(more_exact(&Accuracy::Rtol(1e-13, None)), None);
        assert_eq!(more_exact(&Accuracy::Rtol(1e-15, None)), None);
    }
}
