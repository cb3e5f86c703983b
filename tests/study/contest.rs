//! Who wins, and what it is that is said of it.

use std::sync::atomic::AtomicBool;

use deltazero::study::plan::benchmark;
use deltazero::study::regimes::map_plan;
use deltazero_solvers::{Grid, Method};
use deltazero_study::map::{CellStatus, Contested, contested};
use deltazero_study::run::{Accuracy, Limits, Price, Setting};
use deltazero_study::selection::{
    Benchmark, CUT, Candidate, Contest, Entry, FailureKind, MARGIN, RightEvents, Rules, Standings,
    Start, Trial, TrialEnd, TrialLimit,
};
use deltazero_study::setting::Events;
use deltazero_study::warning::{Code, Warning};
use deltazero_study::work_precision::{Row, WorkPrecision, cheapest, doubt, within_noise};

use super::common::config;

/// The benchmark of Table 1 with `sets`.
fn benchmark_of(sets: &[&str]) -> Benchmark {
    benchmark(&config(sets), &AtomicBool::new(false)).unwrap()
}

/// The same up to the event after the first `most`.
fn benchmark_of_first(most: usize, sets: &[&str]) -> Benchmark {
    let (config, stop) = (config(sets), AtomicBool::new(false));
    let (subject, times) = (config.mechanism.subject(&config), map_plan(&config).times);
    Benchmark::of_first(subject, config.run.t_end, times, Limits::none(&stop), most).unwrap()
}

/// The contest of `methods` on the first 0.3 s of Table 1, flights included, and on what.
fn contest(methods: &[&str], accuracy: f64) -> (Benchmark, Standings) {
    let stop = AtomicBool::new(false);
    let benchmark = benchmark_of(&["run.t_end=0.3"]);
    let methods: Vec<String> = methods.iter().map(|name| (*name).to_owned()).collect();
    let candidates = Candidate::all(&methods, Events::ALL);
    let right_events = RightEvents::FromTight;
    let rules = Rules { candidates, repeats: 1, right_events, ..Rules::default() };
    let contest = Contest { benchmark: &benchmark, accuracy, rules: &rules, stop: &stop };
    let standings = contest.run(&|_| {});
    (benchmark, standings)
}

#[test]
fn a_setting_that_a_contest_finds_holds_beside_itself_and_a_decade_looser_does_not() {
    let accuracy = 1e-6;
    let (benchmark, standings) = contest(&["rk4", "rk45", "dop853", "radau5"], accuracy);
    assert!(standings.entries.len() >= 6, "{standings:#?}");
    for entry in &standings.entries {
        let run = |looser: f64| {
            let accuracy = match (entry.rtol, entry.step) {
                (Some(rtol), _) => Accuracy::Rtol(looser * rtol, None),
                (None, step) => Accuracy::Step(looser.powf(0.25) * step.unwrap()),
            };
            let method = Method::named(&entry.method).unwrap();
            let setting = Setting { method, events: entry.events, accuracy };
            Trial::new(
                &benchmark,
                &setting,
                Start::Exact,
                TrialLimit::NONE,
                &AtomicBool::new(false),
            )
        };
        let [own, tighter, looser] = [1.0, 0.56, 10.0].map(run);
        let is_right = |trial: &Trial| RightEvents::FromTight.accept(accuracy, entry.events, trial);
        assert_eq!(own.e, entry.e, "{entry:?}");
        for trial in [&own, &tighter] {
            assert!(trial.e <= accuracy && is_right(trial), "{entry:?}");
        }
        // What a blind run reaches there is luck.
        let reaches = looser.e <= MARGIN * accuracy && is_right(&looser);
        let may_reach = !entry.timed || entry.events == Events::Blind;
        assert!(!reaches || may_reach, "{entry:?} {looser:?}");
    }
}

#[test]
fn a_contest_ranks_by_time_and_cuts_what_needs_ten_times_the_least_work() {
    let (_, standings) = contest(&["rk4", "dop853", "tr_bdf2"], 1e-7);
    let timed: Vec<_> = standings.entries.iter().filter(|entry| entry.timed).collect();
    assert!(timed.is_sorted_by(|a, b| a.time_s() <= b.time_s()), "{timed:#?}");
    // Which of them is the fastest is the machine's to say; which needs the least work is not.
    let least = standings.entries.iter().min_by(|a, b| a.work.total_cmp(&b.work)).unwrap();
    assert_eq!(least.method, "dop853");
    assert!(standings.entries.iter().all(|entry| entry.work <= CUT * least.work), "{standings:#?}");
    let cut = standings.failures.iter().filter(|failure| failure.kind == FailureKind::Cut);
    assert!(cut.clone().any(|failure| failure.method == "tr_bdf2"), "{standings:#?}");
}

#[test]
fn series_that_auto_takes_count_as_those_of_taylor() {
    let (_, standings) = contest(&["taylor", "dop853", "auto"], 1e-6);
    let located = |name: &str| {
        let own = |entry: &&Entry| entry.method == name && entry.events == Events::Located;
        standings.entries.iter().find(own).unwrap_or_else(|| panic!("{name}: {standings:#?}"))
    };
    let [taylor, dop853, auto] = ["taylor", "dop853", "auto"].map(located);
    // They find settings a few places apart; a series that counted as one evaluation would make it twenty times less.
    assert!(auto.work > 0.5 * taylor.work && auto.work < 2.0 * taylor.work, "{standings:#?}");
    assert!(dop853.work < CUT * auto.work, "{standings:#?}");
}

/// The committed study of Table 1, its times as processor and wall have them in `times` for the runs named there.
fn timed(times: &[(&str, Events, f64, [f64; 3], f64)]) -> Vec<Row> {
    let file = format!("{}/docs/table1/study.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).unwrap();
    let mut rows = serde_json::from_str::<WorkPrecision>(&text).unwrap().rows;
    for row in &mut rows {
        (row.wall_s_min, row.cpu_s_min) = (Some(1.0), Some(1.0));
        (row.wall_s_median, row.cpu_s_median) = (Some(1.0), Some(1.0));
        let own = |of: &&(&str, Events, f64, [f64; 3], f64)| {
            (of.0, of.1, Some(of.2)) == (row.method.as_str(), row.events, row.rtol)
        };
        if let Some((_, _, _, [least, median, most], wall)) = times.iter().find(own) {
            (row.cpu_s_min, row.cpu_s_median) = (Some(*least), Some(*median));
            (row.wall_s_min, row.wall_s_median, row.wall_s_max) =
                (Some(*wall), Some(*wall), Some(*most));
        }
    }
    rows
}

#[test]
fn what_disturbs_the_machine_names_no_winner_and_what_the_times_leave_open_is_told() {
    let taylor = |times, wall| ("taylor", Events::Located, 1e-10, times, wall);
    let vern98 = ("vern98", Events::Located, 1e-10, [3.5e-3; 3], 3.5e-3);
    // Three repeats that waited for the processor: 7 ms on the wall, 3 ms of work.
    let rows = timed(&[taylor([3e-3; 3], 7e-3), vern98]);
    assert_eq!(cheapest(&rows, 1e-9).unwrap().method, "taylor");
    assert!(within_noise(&rows, 1e-9).is_empty());
    assert_eq!(doubt(&rows, 1e-9), "");
    // Half of the repeats took as long as the other method: which is faster is open.
    let rows = timed(&[taylor([3e-3, 4e-3, 4e-3], 3e-3), vern98]);
    assert_eq!(cheapest(&rows, 1e-9).unwrap().method, "taylor");
    assert_eq!(doubt(&rows, 1e-9), " (within the noise: also vern98 located)");
    // A run that warns of itself never wins, whatever its e and its time.
    let mut rows = timed(&[taylor([3e-3; 3], 7e-3), vern98]);
    for row in rows.iter_mut().filter(|row| row.method == "taylor") {
        row.warnings.push(Warning { code: Code::Energy, message: String::new() });
    }
    assert_eq!(cheapest(&rows, 1e-9).unwrap().method, "vern98");
    // The noise of a slower one, too, may have hidden that it is the faster one.
    let rows = timed(&[taylor([3.6e-3, 4e-3, 5e-3], 3e-3), vern98]);
    assert_eq!(cheapest(&rows, 1e-9).unwrap().method, "vern98");
    assert_eq!(doubt(&rows, 1e-9), " (within the noise: also taylor located)");
    // Without times of the processor, as an earlier version kept them, those on the wall rank.
    let mut rows = timed(&[taylor([3e-3; 3], 7e-3), vern98]);
    rows.iter_mut().for_each(|row| row.cpu_s_min = None);
    assert_eq!(cheapest(&rows, 1e-9).unwrap().method, "vern98");
}

#[test]
fn a_run_with_far_more_events_than_the_reference_is_broken_off_where_they_must_be_right() {
    let benchmark = benchmark_of(&["run.t_end=0.3", "contact.stiffness=1e12"]);
    for events in Events::ALL {
        let setting = Setting {
            method: Method::named("bs32").unwrap(),
            events: *events,
            accuracy: Accuracy::Rtol(1e-3, None),
        };
        let run = |chatter| {
            let limit = TrialLimit { chatter, ..TrialLimit::NONE };
            Trial::new(&benchmark, &setting, Start::Exact, limit, &AtomicBool::new(false))
        };
        let [whole, short] = [false, true].map(run);
        assert_eq!((whole.end, short.end), (TrialEnd::Reached, TrialEnd::Chatters), "{events}");
        assert!(whole.spurious > 10 * benchmark.n_events && short.work < 0.5 * whole.work);
    }
}

#[test]
fn what_reaches_a_smaller_error_reaches_a_larger_one() {
    // Critically damped: of the settings of `auto` few have every event right.
    let config = config(&["contact.stiffness=1e8", "contact.damping=49501.5"]);
    let mut plan = map_plan(&config);
    let methods = ["auto".to_owned(), "bdf".to_owned()];
    plan.rules.candidates = Candidate::all(&methods, &[Events::Located]);
    let all = contested(config.mechanism.subject(&config), &plan, &AtomicBool::new(false));
    let who = |contest: &Contested| {
        let mut who: Vec<_> =
            contest.standings.entries.iter().map(|entry| entry.method.clone()).collect();
        who.sort();
        who
    };
    assert_eq!(all.iter().map(|own| own.accuracy).collect::<Vec<_>>(), [1e-3, 1e-6]);
    assert_eq!(all.iter().map(who).collect::<Vec<_>>(), [methods.clone(), methods]);
}

#[test]
fn the_finals_tell_who_is_within_the_noise() {
    let (_, standings) = contest(&["rk45", "dop853"], 1e-5);
    let first = &standings.entries[0];
    assert!(standings.entries.iter().all(|entry| entry.noise.is_some() == entry.timed));
    assert!(first.cpu_s.is_some_and(|cpu| cpu > 0.0) && first.noise >= Some(1.0), "{first:?}");
    let with = |time: f64, noise: f64| Entry {
        cpu_s: Some(time),
        noise: Some(noise),
        timed: true,
        ..first.clone()
    };
    let best = with(3e-3, 1.0);
    assert!(!with(3.5e-3, 1.0).is_within_noise_of(&best));
    assert!(with(3.5e-3, 1.2).is_within_noise_of(&best));
    assert!(with(3.5e-3, 1.0).is_within_noise_of(&with(3e-3, 1.2)));
    let untimed = Entry { timed: false, ..with(3.5e-3, 1.2) };
    assert!(!untimed.is_within_noise_of(&best));
}

#[test]
fn located_events_must_be_right_from_1e_minus_6_on_and_blind_ones_need_not() {
    // Of the blind ones vern98 arrives with events wrong.
    let (_, standings) = contest(&["dop853", "rk45", "vern98"], 1e-6);
    let wrong = |of: Events| {
        let own = standings.entries.iter().filter(move |entry| entry.events == of);
        own.map(|entry| entry.missed + entry.spurious).max().unwrap()
    };
    assert_eq!(wrong(Events::Located), 0);
    assert!(wrong(Events::Blind) > 0);
    let (_, loose) = contest(&["dop853", "rk45", "bs32"], 1e-2);
    assert!(
        loose.entries.iter().any(|e| e.events == Events::Located && e.missed > 0),
        "{loose:#?}"
    );
}

#[test]
fn auto_wins_a_cell_where_it_alone_arrives() {
    let with = |methods: &[&str]| Contested {
        accuracy: 1e-4,
        status: CellStatus::Ok,
        error: None,
        t_end_s: Some(0.3),
        horizon_s: None,
        n_events: None,
        standings: contest(methods, 1e-4).1,
    };
    let alone = with(&["auto"]);
    assert!(alone.winner().is_some_and(Entry::is_auto));
    assert_eq!(alone.second(), None);
    let beside = with(&["auto", "rk4"]);
    assert_eq!(beside.winner().map(|entry| entry.method.as_str()), Some("rk4"));
}

#[test]
fn the_part_of_a_benchmark_with_its_first_events_is_a_benchmark() {
    let whole = benchmark_of(&["run.t_end=0.3"]);
    let n = whole.n_events / 2;
    let part = benchmark_of_first(n, &["run.t_end=0.3"]);
    assert!((n..whole.n_events).contains(&part.n_events) && part.t_end < whole.t_end);
    let shorter = benchmark_of(&[&format!("run.t_end={}", part.t_end)]);
    assert_eq!(part.n_events, shorter.n_events);
    for (own, other) in part.reference.parts.iter().zip(&shorter.reference.parts) {
        assert_eq!(own.times, other.times);
        for (own, other) in own.scale.groups.iter().zip(&other.scale.groups) {
            assert!((own.scale / other.scale - 1.0).abs() < 1e-14);
        }
        for (a, b) in own.samples.iter().zip(&other.samples) {
            assert!(own.scale.error(a, b) < 1e-12);
        }
    }
    assert_eq!(benchmark_of_first(whole.n_events, &["run.t_end=0.3"]).t_end, whole.t_end);
}

#[test]
fn the_horizon_ends_the_first_events_as_it_ends_all() {
    // Without damping the last bit of the start is seen long before the end.
    let sets = ["contact.damping=0"];
    let whole = benchmark_of(&sets);
    assert!(whole.horizon.is_some_and(|t| t < 2.0), "{:?}", whole.horizon);
    let same = benchmark_of_first(whole.n_events, &sets);
    assert_eq!(
        (same.horizon, same.t_end, same.n_events),
        (whole.horizon, whole.t_end, whole.n_events)
    );
    let fewer = benchmark_of_first(whole.n_events / 2, &sets);
    assert!(fewer.t_end < whole.t_end && fewer.n_events < whole.n_events);
}

#[test]
fn a_horizon_that_no_sample_lies_before_is_looked_for_with_samples_of_its_own() {
    let fine = benchmark_of(&["contact.damping=0"]);
    let coarse = benchmark_of(&["contact.damping=0", "run.sample=2"]);
    assert!(coarse.times.len() > 10 && coarse.times.iter().all(|t| *t <= coarse.t_end));
    // Each is known to a sample, of 0.01 s and a two hundredth of 2 s.
    let [fine, coarse] = [fine, coarse].map(|own| own.horizon.unwrap());
    assert!((fine - coarse).abs() <= 0.01, "{fine} {coarse}");
}

#[test]
fn a_run_that_ends_early_has_an_infinite_error_and_one_a_sample_short_has_not() {
    let benchmark = benchmark_of(&["run.t_end=0.1"]);
    let setting = deltazero::run::setting(&config(&[])).unwrap();
    let grid = Grid::Times(benchmark.times.clone());
    let stop = AtomicBool::new(false);
    let mut watch = Limits::none(&stop).watch(Price::PLAIN);
    let part = &benchmark.subject.parts[0];
    let (_, mut own) = part.run(&setting, Start::Exact, benchmark.t_end, &grid, &mut watch);
    let reference = &benchmark.reference.parts[0];
    assert!(reference.error(&own) < 1e-6);
    own.states.pop();
    assert!(reference.error(&own) < 1e-6);
    own.states.pop();
    assert_eq!(reference.error(&own), f64::INFINITY);
}
