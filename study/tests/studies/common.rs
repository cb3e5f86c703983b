//! What several test files share.

use std::sync::atomic::AtomicBool;

use deltazero_study::plan::settings;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::{WorkPrecision, work_precision};
use deltazero_study::{Plan, Subject};

/// Runs of these methods, each once.
pub(crate) fn plan(
    methods: &[&str],
    events: &[Events],
    rtol: &[f64],
    steps: &[f64],
    t_end: f64,
) -> Plan {
    let methods: Vec<String> = methods.iter().map(|name| (*name).to_owned()).collect();
    let settings = settings(&methods, events, rtol, steps, None);
    Plan { settings, repeats: 1, ..Plan::new(t_end) }
}

/// The study of `subject` by `plan`.
pub(crate) fn study(subject: &Subject, plan: &Plan) -> WorkPrecision {
    work_precision(subject, plan, &[], &AtomicBool::new(false), &|_| {}).unwrap()
}
