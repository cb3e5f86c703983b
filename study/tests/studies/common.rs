//! What several test files share.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::problems::{CompliantBall, Exit};
use deltazero_study::plan::settings;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::{WorkPrecision, work_precision};
use deltazero_study::{Plan, Subject};

/// A ball that flies fast between soft walls that take a tenth of its speed.
pub(crate) const WALLS: CompliantBall = CompliantBall {
    mass: 0.1,
    stiffness: 1e4,
    damping: 2.0,
    exit: Exit::Penetration,
    gap: 0.05,
    start: [0.02, 1.0],
};

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
