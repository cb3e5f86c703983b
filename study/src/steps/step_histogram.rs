//! Which step sizes does each method take in flight, in slip, in stick?

use serde::{Deserialize, Serialize};

use super::step_size::{ModeKind, StepHistory};

/// Bins a decade; one is centred on each power of ten.
const BINS_PER_DECADE: f64 = 10.0;

/// The steps of one method, in one kind of mode, of about one size; all parts together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BinRow {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// What the site does.
    pub kind: ModeKind,
    /// Smallest and largest step size of the bin [s].
    pub h_s: (f64, f64),
    /// Accepted steps.
    pub n_steps: u64,
}

/// Counts the steps of each method by mode and size, in bins of a tenth of a decade; empty bins
/// have no row.
pub fn step_histogram(histories: &[StepHistory]) -> Vec<BinRow> {
    let mut counts: Vec<((&str, &str), ModeKind, i32, u64)> = Vec::new();
    for history in histories {
        let method = (history.method.as_str(), history.setting.as_str());
        for step in &history.steps {
            let (kind, bin) = (step.kind(), bin(step.h_s));
            let place = counts
                .iter_mut()
                .find(|known| known.0 == method && known.1 == kind && known.2 == bin);
            match place {
                Some(known) => known.3 += 1,
                None => counts.push((method, kind, bin, 1)),
            }
        }
    }
    // Methods stay in the order of the histories.
    let mut methods: Vec<(&str, &str)> = counts.iter().map(|count| count.0).collect();
    methods.dedup();
    let rank = |method| methods.iter().position(|known| *known == method);
    counts.sort_by_key(|&(method, kind, bin, _)| (rank(method), kind, bin));
    let row = |((method, setting), kind, bin, n_steps): ((&str, &str), ModeKind, i32, u64)| {
        let edge = |half: f64| libm::exp10((f64::from(bin) + half) / BINS_PER_DECADE);
        let h_s = (edge(-0.5), edge(0.5));
        BinRow { method: method.to_owned(), setting: setting.to_owned(), kind, h_s, n_steps }
    };
    counts.into_iter().map(row).collect()
}

/// The number of a size's bin.
fn bin(h: f64) -> i32 {
    (BINS_PER_DECADE * libm::log10(h)).round() as i32
}
