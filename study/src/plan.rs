//! What a study runs.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Grid, METHODS, Method};

use crate::run::{Accuracy, Events, Limits, Setting};
use crate::setting::{Atol, Digits};

/// Sample times of a study that asks for none.
const DEFAULT_SAMPLES: u32 = 200;
/// Tolerances of a study that asks for none: 1e-3 to 1e-12.
const DECADES: std::ops::RangeInclusive<i32> = 3..=12;
/// Fixed steps of a study that asks for none, for each run: from a thousandth of it on, four times as many each.
const STEPS: [f64; 5] = [1e3, 4e3, 1.6e4, 6.4e4, 2.56e5];

/// The runs of a study, and how much each may take.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The end of the runs [s].
    pub t_end: f64,
    /// When states are compared [s].
    pub times: Vec<f64>,
    /// One run each.
    pub settings: Vec<Setting>,
    /// How often a run is timed that may be the cheapest at some error; a long one that cannot is timed once.
    pub repeats: usize,
    /// Runs that are timed at the same time; more than one disturbs the times. Errors are measured on all cores.
    pub threads: usize,
    /// The numbers that the reference is computed in.
    pub digits: Digits,
    /// Right-hand sides beyond which a run is cut.
    pub max_rhs: u64,
    /// Time beyond which a run is cut [s].
    pub max_seconds: f64,
}

impl Plan {
    /// Every method, its events located, at tolerances from 1e-3 to 1e-12 or at fixed steps, to `t_end` [s].
    pub fn new(t_end: f64) -> Self {
        let rtol: Vec<f64> = DECADES.map(|k| libm::exp10(f64::from(-k))).collect();
        let steps: Vec<f64> = STEPS.iter().map(|n| t_end / n).collect();
        let names: Vec<String> = METHODS.iter().map(|method| method.name.to_owned()).collect();
        Self {
            t_end,
            times: sample_times(None, t_end),
            settings: settings(&names, &[Events::Located], &rtol, &steps, None),
            repeats: 3,
            threads: 1,
            digits: Digits::Double,
            max_rhs: 10_000_000,
            max_seconds: 60.0,
        }
    }

    /// The limits of each of its runs.
    pub fn limits<'a>(&self, stop: &'a AtomicBool) -> Limits<'a> {
        Limits { max_rhs: self.max_rhs, max_seconds: self.max_seconds, stop }
    }
}

/// Each of `methods`, by name, with each of `events` and at each tolerance, or step where it has fixed ones; an unknown
/// method none.
pub fn settings(
    methods: &[String],
    events: &[Events],
    rtol: &[f64],
    steps: &[f64],
    atol: Option<&Atol>,
) -> Vec<Setting> {
    let mut settings = Vec::new();
    for method in methods.iter().filter_map(|name| Method::named(name)) {
        let accuracies: Vec<Accuracy> = if method.is_fixed_step() {
            steps.iter().map(|step| Accuracy::Step(*step)).collect()
        } else {
            rtol.iter().map(|rtol| Accuracy::Rtol(*rtol, atol.cloned())).collect()
        };
        for &events in events {
            let setting =
                |accuracy: &Accuracy| Setting { method, events, accuracy: accuracy.clone() };
            settings.extend(accuracies.iter().map(setting));
        }
    }
    settings
}

/// The times at which a study to `t_end` [s] compares states, so far apart [s]; two hundred where that is not said.
pub fn sample_times(spacing: Option<f64>, t_end: f64) -> Vec<f64> {
    match Grid::uniform(spacing.unwrap_or(t_end / f64::from(DEFAULT_SAMPLES)), t_end) {
        Grid::Times(times) => times,
        Grid::Steps => Vec::new(),
    }
}
