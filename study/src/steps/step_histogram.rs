//! Which step sizes does each method take in flight, in contact, in stick, or in each mode that has a name?

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
    /// The mode: by its name, where modes have names, else by what the site does.
    pub mode: String,
    /// Smallest and largest step size of the bin [s].
    pub h_s: (f64, f64),
    /// Accepted steps.
    pub n_steps: u64,
}

/// What is counted together: method and setting, number of the mode where it has a name, what the site does, bin.
type Key<'a> = ((&'a str, &'a str), u16, ModeKind, i32);

/// Counts the steps of each method by mode and size, in bins of a tenth of a decade; empty bins
/// have no row.
pub fn step_histogram(histories: &[StepHistory]) -> Vec<BinRow> {
    let mut counts: Vec<(Key<'_>, &str, u64)> = Vec::new();
    for history in histories {
        let method = (history.method.as_str(), history.setting.as_str());
        for step in &history.steps {
            let number = if history.modes.is_empty() { 0 } else { step.mode_number };
            let key = (method, number, step.kind(), bin(step.h_s));
            match counts.iter_mut().find(|known| known.0 == key) {
                Some(known) => known.2 += 1,
                None => counts.push((key, history.mode_name(step), 1)),
            }
        }
    }
    // Methods stay in the order of the histories.
    let mut methods: Vec<(&str, &str)> = counts.iter().map(|count| count.0.0).collect();
    methods.dedup();
    let rank = |method| methods.iter().position(|known| *known == method);
    counts.sort_by_key(|&((method, number, kind, bin), ..)| (rank(method), number, kind, bin));
    let row = |((method, _, kind, bin), mode, n_steps): (Key<'_>, &str, u64)| {
        let edge = |half: f64| libm::exp10((f64::from(bin) + half) / BINS_PER_DECADE);
        BinRow {
            method: method.0.to_owned(),
            setting: method.1.to_owned(),
            kind,
            mode: mode.to_owned(),
            h_s: (edge(-0.5), edge(0.5)),
            n_steps,
        }
    };
    counts.into_iter().map(row).collect()
}

/// The number of a size's bin.
fn bin(h: f64) -> i32 {
    (BINS_PER_DECADE * libm::log10(h)).round() as i32
}
