//! What a configuration asks of the study.

use std::sync::atomic::AtomicBool;

use deltazero_study::Plan;
use deltazero_study::plan::{self, settings};
use deltazero_study::recommend::{self, Recommendation};
use deltazero_study::reference::{Reference, ReferenceError};
use deltazero_study::run::Limits;
use deltazero_study::selection::{Benchmark, Candidate, RightEvents, Rules};
use deltazero_study::work_precision::{Progress, Row, WorkPrecision};

use crate::config::Config;

/// The runs that a configuration's `[study]` asks for and its laws permit.
pub fn plan(config: &Config) -> Plan {
    let (study, permitted) = (&config.study, config.permitted(&config.study.events));
    let atol = config.solver.atol.clone().map(Into::into);
    Plan {
        t_end: config.run.t_end,
        times: sample_times(config),
        settings: settings(&study.methods, &permitted, &study.rtol, &study.steps, atol.as_ref()),
        repeats: study.repeats as usize,
        threads: study.threads,
        digits: study.reference,
        max_rhs: study.max_rhs,
        max_seconds: study.max_seconds,
    }
}

/// The times at which a study compares states.
pub fn sample_times(config: &Config) -> Vec<f64> {
    let has_samples = config.run.n_samples().is_some_and(|n| n > 0);
    plan::sample_times(has_samples.then_some(config.run.sample), config.run.t_end)
}

/// The limits of each run of a study.
pub fn limits<'a>(config: &Config, stop: &'a AtomicBool) -> Limits<'a> {
    Limits { max_rhs: config.study.max_rhs, max_seconds: config.study.max_seconds, stop }
}

/// What `[contest]` asks for.
pub fn rules(config: &Config) -> Rules {
    let contest = &config.contest;
    Rules {
        candidates: Candidate::all(&contest.methods, &config.permitted(&contest.events)),
        atol: config.solver.atol.clone().map(Into::into),
        repeats: contest.repeats,
        max_work: contest.max_work,
        right_events: if contest.right_events {
            RightEvents::Always
        } else {
            RightEvents::FromTight
        },
    }
}

/// Where the contests of a configuration take place.
///
/// # Errors
/// [`ReferenceError`] where there is no reference.
pub fn benchmark(config: &Config, stop: &AtomicBool) -> Result<Benchmark, ReferenceError> {
    let subject = config.mechanism.subject(config);
    Benchmark::new(subject, config.run.t_end, sample_times(config), limits(config, stop))
}

/// The contest on the problem of `config` at `accuracy`.
pub fn recommend(
    config: &Config,
    accuracy: f64,
    stop: &AtomicBool,
    progress: &dyn Fn(Progress),
) -> Recommendation {
    recommend::recommend(
        config.mechanism.subject(config),
        (config.run.t_end, sample_times(config)),
        accuracy,
        &rules(config),
        limits(config, stop),
        config.warnings(),
        progress,
    )
}

/// The study that a configuration asks for; see [`deltazero_study::work_precision()`].
///
/// # Errors
/// [`ReferenceError`] where the reference cannot be made.
pub fn work_precision(
    config: &Config,
    known: &[Row],
    stop: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<WorkPrecision, ReferenceError> {
    let subject = config.mechanism.subject(config);
    deltazero_study::work_precision(&subject, &plan(config), known, stop, progress)
}

/// The reference of the study that a configuration asks for.
///
/// # Errors
/// [`ReferenceError`].
pub fn reference(config: &Config, stop: &AtomicBool) -> Result<Reference, ReferenceError> {
    let subject = config.mechanism.subject(config);
    deltazero_study::work_precision::reference(&subject, &plan(config), stop)
}
