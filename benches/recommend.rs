//! How good are recommendations? Random configurations, each recommended a setting, run again with it, and
//! compared with an exhaustive search.
//!
//! `cargo bench --bench recommend -- 0..200 0..40` does the first 200 draws, and the exhaustive search for the
//! first 40; without ranges, `0..3 0..3`. `KEY=VALUE` sets a key of all, as `--set` does on the command line.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a bench panics to fail, and prints"
)]

#[path = "drawn/random.rs"]
mod random;

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use deltazero::config::Config;
use deltazero::study::plan::{benchmark, recommend};
use deltazero_solvers::{METHODS, Method};
use deltazero_study::recommend::Recommendation;
use deltazero_study::reference::Reference;
use deltazero_study::run::{Accuracy, Limits, Setting};
use deltazero_study::selection::{Benchmark, Start, Trial, TrialEnd, TrialLimit};
use deltazero_study::setting::Events;
use random::Random;

/// m_ref of the damping ratio [kg].
const M_REF: f64 = 6.126;
/// The same configurations at every run.
const SEED: u64 = 20_240_607;
/// Right-hand sides of a block, of which a series of order N stands for N²/2, beyond which an extended reference
/// is given up, and the one in f64 judges: some ten seconds.
const EXTENDED: u64 = 3_000_000;
/// A setting that takes more than this many times the work of the recommended one is not faster.
const EXHAUSTIVE: f64 = 2.5;

/// One draw: what is set, and the accuracy.
fn draw(random: &mut Random) -> (Vec<String>, f64) {
    let stiffness = random.log_uniform(1e5, 1e11);
    let damping = 2.0 * random.log_uniform(0.003, 3.0) * (stiffness * M_REF).sqrt();
    let sets = vec![
        format!("contact.stiffness={stiffness:e}"),
        format!("contact.damping={damping:e}"),
        format!("friction.coefficient={}", random.uniform(0.0, 0.4)),
        format!("joint.clearance={:e}", random.log_uniform(5e-5, 2e-3)),
        format!("drive.m1={}", random.log_uniform(0.2, 3.0)),
        format!("drive.m4={}", random.log_uniform(0.1, 1.0)),
    ];
    (sets, random.log_uniform(1e-8, 1e-2))
}

/// What came of one configuration.
#[derive(Default)]
struct Tally {
    none: usize,
    warned: usize,
    reached: usize,
    missed: usize,
    /// Judged by an extended reference.
    extended: usize,
    /// Time against the best of the exhaustive search.
    ratios: Vec<f64>,
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let (more, ranges): (Vec<String>, Vec<String>) =
        args.into_iter().partition(|arg| arg.contains('='));
    let ranges: Vec<Range<usize>> =
        ranges.iter().map(|arg| range(arg).expect("FROM..TO")).collect();
    let draws = ranges.first().cloned().unwrap_or(0..3);
    let searched = ranges.get(1).unwrap_or(&draws);
    let mut random = Random::new(SEED);
    let mut tally = Tally::default();
    for i in 0..draws.end {
        let (mut sets, accuracy) = draw(&mut random);
        if i < draws.start {
            continue;
        }
        sets.extend(more.iter().cloned());
        let config = Config::load(None, &sets).expect("the draws are in range");
        one(i, &config, &sets, accuracy, searched.contains(&i), &mut tally);
    }
    let Tally { none, warned, reached, missed, extended, mut ratios } = tally;
    ratios.sort_by(f64::total_cmp);
    let cheap = ratios.iter().filter(|ratio| **ratio <= 1.25).count();
    println!(
        "{} configurations: {warned} warned, {none} without an answer; of the others {reached} reach \
         again, {missed} do not, {extended} judged in extended precision; cost within 1.25 of the exhaustive search in {cheap} of {}",
        draws.len(),
        ratios.len()
    );
}

/// `FROM..TO`.
fn range(arg: &str) -> Option<Range<usize>> {
    let (from, to) = arg.split_once("..")?;
    Some(from.parse().ok()?..to.parse().ok()?)
}

fn one(i: usize, config: &Config, sets: &[String], accuracy: f64, search: bool, tally: &mut Tally) {
    let stop = AtomicBool::new(false);
    let start = Instant::now();
    let answer = recommend(config, accuracy, &stop, &|_| {});
    let took = start.elapsed().as_secs_f64();
    let codes: Vec<&str> = answer.warnings.iter().map(|warning| warning.code.name()).collect();
    let head = format!("{i:3} e {accuracy:.1e} {:5.1} s {codes:?}", took);
    let Some(first) = answer.first() else {
        tally.none += 1;
        println!("{head} NONE {} | {}", answer.reason, sets.join(" "));
        return;
    };
    let mut benchmark = benchmark(config, &stop).expect("made before");
    let mut best = String::new();
    let mut ratio = 1.0;
    if search {
        (ratio, best) = exhaustive(&benchmark, &answer, accuracy, &stop);
        best = format!(", {ratio:.2} of {best}");
        tally.ratios.push(ratio);
    }
    let limits = Limits { max_rhs: EXTENDED, ..Limits::none(&stop) };
    if let Ok(own) =
        Reference::extended(&benchmark.subject, benchmark.t_end, &benchmark.times, limits)
    {
        benchmark.reference = own;
        tally.extended += 1;
    }
    let again = rerun(&benchmark, &answer, &stop);
    let holds = again.e <= accuracy && again.events_are_right();
    if !codes.is_empty() {
        tally.warned += 1;
    } else if holds {
        tally.reached += 1;
    } else {
        tally.missed += 1;
    }
    println!(
        "{head} {} {} {}: again e {:.1e} {}, {} events, {:.2} ms{best}{}",
        first.method,
        first.events,
        first.setting(),
        again.e,
        if holds { "reached" } else { "NOT REACHED" },
        answer.n_events,
        1e3 * first.time_s(),
        if !holds || ratio > 1.25 { format!(" | {}", sets.join(" ")) } else { String::new() },
    );
}

/// The run that a user makes of what was printed.
fn rerun(benchmark: &Benchmark, answer: &Recommendation, stop: &AtomicBool) -> Trial {
    let first = answer.first().expect("has an answer");
    Trial::new(
        benchmark,
        &setting(&first.method, first.events, first.rtol, first.step),
        Start::Exact,
        TrialLimit::NONE,
        stop,
    )
}

fn setting(method: &str, events: Events, rtol: Option<f64>, step: Option<f64>) -> Setting {
    let method = Method::named(method).expect("is in the list");
    let accuracy = match step {
        Some(step) => Accuracy::Step(step),
        None => Accuracy::Rtol(rtol.expect("has one or the other"), None),
    };
    Setting { method, events, accuracy }
}

/// Time of the recommended setting over that of the fastest one, on eight rungs a decade of error, that
/// reaches the accuracy, be it by luck: the shortest of five as a user runs them, in turns.
fn exhaustive(
    benchmark: &Benchmark,
    answer: &Recommendation,
    accuracy: f64,
    stop: &AtomicBool,
) -> (f64, String) {
    let first = answer.first().expect("has an answer");
    let limit = EXHAUSTIVE * first.work;
    let time = |setting: &Setting| {
        let timing = benchmark.took(setting, stop);
        timing.map_or(f64::INFINITY, |timing| timing.took.cpu.as_secs_f64())
    };
    let mut reaching = Vec::new();
    for method in METHODS {
        for events in [Events::Located, Events::Blind] {
            for rung in 0..112 {
                let value = if method.is_fixed_step() {
                    1e-2 * 10_f64.powf(-f64::from(rung) / 16.0)
                } else {
                    1e-1 * 10_f64.powf(-f64::from(rung) / 8.0)
                };
                let (rtol, step) =
                    if method.is_fixed_step() { (None, Some(value)) } else { (Some(value), None) };
                let setting = setting(method.name, events, rtol, step);
                let trial =
                    Trial::new(benchmark, &setting, Start::Exact, TrialLimit::work(limit), stop);
                if trial.end == TrialEnd::Cut && method.order > 1 && trial.stats.n_events < 1000 {
                    break;
                }
                if trial.e <= accuracy && trial.events_are_right() {
                    reaching.push((time(&setting), setting));
                    // Tighter ones cost more.
                    if trial.e < 1e-2 * accuracy {
                        break;
                    }
                }
            }
        }
    }
    reaching.sort_by(|a, b| a.0.total_cmp(&b.0));
    reaching.truncate(12);
    let own = setting(&first.method, first.events, first.rtol, first.step);
    reaching.push((f64::INFINITY, own));
    for _ in 0..5 {
        for (least, setting) in &mut reaching {
            *least = least.min(time(setting));
        }
    }
    let own = reaching.last().map_or(f64::NAN, |(least, _)| *least);
    let best = reaching.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or((f64::NAN, "none".to_owned()), |(least, setting)| {
        (own / least, setting.to_string())
    })
}
