//! The study as a library: its table says what single runs say.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use common::config;
use deltazero::config::Config;
use deltazero::figures::Picture;
use deltazero::report::html::{Heading, Page, Part, Section, Table};
use deltazero::study::plan::{benchmark, plan, reference, work_precision};
use deltazero::study::stability::stability;
use deltazero::{figures, report};
use deltazero_solvers::{Grid, METHODS, Method};
use deltazero_study::columns::{Column, Value};
use deltazero_study::horizon::{Horizon, Span, tight_runs};
use deltazero_study::map::{CellStatus, Contested};
use deltazero_study::run::{Accuracy, Limits, Price, Setting};
use deltazero_study::selection::{
    Benchmark, CUT, Candidate, Contest, Entry, FailureKind, MARGIN, RightEvents, Standings, Start,
    Trial,
};
use deltazero_study::setting::Events;
use deltazero_study::steps::StepTables;
use deltazero_study::warning::{Code, Warning};
use deltazero_study::work_precision::{
    Progress, Row, Status, WorkPrecision, cheapest, doubt, within_noise,
};

fn study(sets: &[&str]) -> WorkPrecision {
    let short =
        ["run.t_end=0.15", "study.repeats=1", "study.rtol=[1e-4, 1e-8]", "study.steps=[1e-4]"];
    let config = config(&[&short[..], sets].concat());
    work_precision(&config, &[], &AtomicBool::new(false), &|_| {}).unwrap()
}

#[test]
fn a_study_has_one_row_for_each_method_treatment_and_setting() {
    let table = study(&[]);
    // Located and blind: rk4 at one step, rk45, dop853, vern98, taylor, radau5 and bdf at two tolerances.
    assert_eq!(table.rows.len(), 2 * (1 + 6 * 2));
    assert!(table.rows.iter().all(|row| row.status == Status::Ok), "{:?}", table.rows);
    let tight = table.rows.iter().find(|row| row.method == "rk45" && row.rtol == Some(1e-8));
    assert!(tight.is_some_and(|row| row.events_are_right() && row.e < Some(1e-7)));
}

#[test]
fn the_reference_is_confirmed_by_its_second_method() {
    let reference = study(&["study.methods=[\"rk45\"]"]).reference;
    assert!(reference.method.starts_with("taylor"), "{}", reference.method);
    // Measured: e = 2.2e-15, event times to 1.9e-13 s.
    assert!(reference.agreement < 2e-14, "{:e}", reference.agreement);
    assert!(reference.event_time_agreement_s.is_some_and(|t| t < 1.9e-12), "{reference:?}");
    assert_eq!(reference.limits(), Vec::<String>::new());
}

#[test]
fn where_series_cost_too_much_the_reference_is_implicit_and_says_so() {
    // K = 1e10 N/m, ζ = 3; the right-hand sides are worth 8000 series.
    let sets = [
        "contact.stiffness=1e10",
        "contact.damping=1.5e6",
        "run.t_end=0.05",
        "study.max_rhs=1500000",
        "study.methods=[\"radau5\"]",
    ];
    let reference = study(&sets).reference;
    // The run of joint 2 takes more.
    assert!(reference.method.contains("joint 2: radau5 located, rtol 1e-14"), "{reference:?}");
    assert!(reference.agreement < 1e-9, "{reference:?}");
}

#[test]
fn an_accuracy_beyond_the_reference_is_not_decided() {
    // Without damping the motion is chaotic: the reference loses its digits within the run.
    let table = study(&["run.t_end=2", "contact.damping=0", "study.methods=[\"rk45\"]"]);
    let reference = &table.reference;
    // Measured: 1.8e-9.
    assert!(reference.agreement > 2e-10, "{:e}", reference.agreement);
    assert!(!table.can_decide(1e-9));
    assert!(report::answer(&table).contains("| 1e-9 | not decidable |"));
    assert!(reference.parts.iter().any(|part| part.horizon_s < 2.0), "{:?}", reference.parts);
    let limits = reference.limits();
    assert!(limits.iter().any(|limit| limit.contains("predictable up to")), "{limits:?}");
    // What is compared over the whole run is there, the state at its end is not.
    let errors = table.rows[0].errors;
    assert!(errors.impulse_error.is_some() && errors.dissipation_error.is_some());
    assert_eq!(errors.e_final, None);
}

#[test]
fn a_run_beyond_the_limit_of_work_is_cut() {
    let table = study(&["study.max_rhs=600000", "study.steps=[1e-7]", "study.methods=[\"rk4\"]"]);
    assert!(table.rows.iter().all(|row| row.status == Status::Cut && row.e.is_none()));
    assert!(cheapest(&table.rows, 1.0).is_none());
}

#[test]
fn rejected_series_count_as_work() {
    // Blind on a contact that sticks, series after series is rejected: 36 for each that is taken.
    let most = 3_000_000.0;
    let table = study(&[
        "reading=full",
        "run.t_end=0.9",
        "study.methods=[\"taylor\"]",
        "study.events=[\"blind\"]",
        "study.rtol=[1e-10]",
        "study.max_rhs=3000000",
    ]);
    let [row] = table.rows.as_slice() else { panic!("{:?}", table.rows) };
    assert_eq!(row.status, Status::Cut, "{row:?}");
    let of_taken = 2.0 * 20.0 * row.n_rhs as f64;
    assert!(of_taken < 0.5 * most && row.n_rejected > 10 * row.n_rhs, "{row:?}");
    assert_eq!(row.error.as_deref(), Some("more than study.max_rhs = 3000000 right-hand sides"));
}

#[test]
fn rows_do_not_depend_on_the_number_of_threads() {
    let strip = |mut table: WorkPrecision| {
        for row in &mut table.rows {
            (row.wall_s_min, row.wall_s_median, row.wall_s_max) = (None, None, None);
            (row.cpu_s_min, row.cpu_s_median) = (None, None);
            row.walls_s.clear();
            row.cpus_s.clear();
        }
        table
    };
    assert_eq!(strip(study(&[])), strip(study(&["study.threads=2"])));
}

#[test]
fn repeats_go_in_turns_round_all_runs_and_an_interrupted_turn_is_gone_on_with() {
    let sets = ["run.t_end=0.02", "study.repeats=2", "study.rtol=[1e-4]", "study.steps=[1e-4]"];
    let config = config(&sets);
    // Of all runs and repeats, those that were announced and done until `stop_after`.
    let study = |known: &[Row], stop_after: usize| {
        let (stop, done) = (AtomicBool::new(false), Mutex::new((0, Vec::new())));
        let table = work_precision(&config, known, &stop, &|progress| {
            let mut done = done.lock().unwrap();
            match progress {
                Progress::Runs(n) => done.0 = n,
                Progress::Done(what) => done.1.push(what),
                Progress::Row(_) | Progress::Left(_) => {}
            }
            stop.store(done.1.len() >= stop_after, Ordering::Relaxed);
        });
        (table.unwrap(), done.into_inner().unwrap())
    };
    let (whole, (n_ahead, done)) = study(&[], usize::MAX);
    let n = whole.rows.len();
    assert!(whole.rows.iter().all(|row| row.walls_s.len() == 2));
    assert_eq!((n_ahead, done.len()), (3 * n, 3 * n));
    let turns: Vec<&[String]> = done.chunks(n).collect();
    assert_eq!(turns, [turns[0]; 3]);

    let (stopped, _) = study(&[], n + 2);
    assert!(stopped.rows.iter().all(|row| row.status == Status::Ok));
    let n_walls = |table: &WorkPrecision| -> Vec<usize> {
        table.rows.iter().map(|row| row.walls_s.len()).collect()
    };
    assert_eq!(n_walls(&stopped), [&[1, 1][..], &vec![0; n - 2]].concat());
    assert_eq!(stopped.rows[2].wall_s_min, None);
    let (resumed, (n_ahead, done)) = study(&stopped.rows, usize::MAX);
    assert_eq!((n_ahead, done.len()), (3 * n, 3 * n));
    assert_eq!(n_walls(&resumed), vec![2; n]);
    for (row, before) in resumed.rows.iter().zip(&stopped.rows) {
        assert_eq!(row.walls_s[..before.walls_s.len()], before.walls_s);
        assert_eq!(row.wall_s_min, row.walls_s.iter().copied().reduce(f64::min));
    }
}

/// A short study by `methods` and its tables of steps.
fn steps(methods: &str) -> (WorkPrecision, StepTables) {
    let sets =
        ["run.t_end=0.15", "study.repeats=1", "study.steps=[1e-4]", "study.rtol=[1e-6]", methods];
    let (config, stop) = (config(&sets), AtomicBool::new(false));
    let table = work_precision(&config, &[], &stop, &|_| {}).unwrap();
    let subject = config.mechanism.subject(&config);
    let steps = StepTables::new(&subject, &plan(&config), &table, Limits::none(&stop));
    (table, steps)
}

#[test]
fn fixed_steps_are_equal_but_where_they_land_or_time_ends_and_a_restart_loses_none() {
    let (_, steps) = steps("study.methods=[\"rk4\"]");
    assert_eq!(steps.histories.len(), 2);
    for history in &steps.histories {
        let (_, whole) = history.steps.split_last().unwrap();
        for step in whole.iter().filter(|step| !step.lands) {
            // Measured: 1.1e-17 s, the resolution of time.
            assert!((step.h_s - 1e-4).abs() < 1e-16, "{step:?}");
        }
        let landings = history.steps.iter().filter(|step| step.lands).count();
        assert_eq!(landings, history.events.len());
    }
    let cost = &steps.restart_costs[0];
    assert_eq!((cost.recovery_steps, cost.lost_steps, cost.rejected), (Some(0.0), Some(0.0), 0.0));
    for row in &steps.restarts {
        assert!(row.h_over_settled.iter().all(|ratio| (ratio - 1.0).abs() < 1e-11), "{row:?}");
    }
}

#[test]
fn every_accepted_step_is_in_one_bin_and_in_one_contact_or_flight() {
    let (table, steps) = steps("study.methods=[\"rk4\", \"dop853\", \"radau5\", \"bdf\"]");
    let located = table.rows.iter().filter(|row| row.events == Events::Located);
    for row in located {
        let own = |method: &str| row.method == method;
        let bins = || steps.histogram.iter().filter(|bin| own(&bin.method));
        assert_eq!(bins().map(|bin| bin.n_steps).sum::<u64>(), row.n_accepted, "{}", row.method);
        for contact in [true, false] {
            let bins = bins().filter(|bin| bin.kind.is_contact() == contact);
            let stays =
                steps.stays.iter().filter(|stay| own(&stay.method) && stay.is_contact == contact);
            let in_stays: usize = stays.map(|stay| stay.n_steps).sum();
            assert_eq!(bins.map(|bin| bin.n_steps).sum::<u64>(), in_stays as u64);
        }
        let histories = steps.histories.iter().filter(|history| own(&history.method));
        let rows = || histories.clone().flat_map(|history| &history.steps);
        assert_eq!(rows().map(|step| step.n_rejected).sum::<u64>(), row.n_rejected);
        // From the start to the end without a gap.
        let covered: f64 = rows().map(|step| step.h_s).sum();
        // Measured: 1.6e-14 s, by rk4.
        assert!((covered - 0.3).abs() < 1e-13, "{} {covered}", row.method);
    }
}

#[test]
fn rk4_finds_events_that_are_none_beyond_the_limit_of_stability() {
    let sets = [
        "run.t_end=0.15",
        "study.repeats=1",
        "study.steps=[1e-4]",
        "study.rtol=[1e-6]",
        "study.methods=[\"rk4\"]",
    ];
    let (config, stop) = (config(&sets), AtomicBool::new(false));
    let table = work_precision(&config, &[], &stop, &|_| {}).unwrap();
    let stability = stability(&config, &table, Limits::none(&stop)).unwrap();
    for row in &stability.stiffness {
        let runs = || stability.runs.iter().filter(|run| run.joint == row.joint);
        let stable = runs().filter(|run| run.h_s < 0.9 * row.limit_s);
        let unstable = runs().filter(|run| run.h_s > 1.1 * row.limit_s);
        let most = stable.map(|run| run.n_events).max();
        let least = unstable.map(|run| run.n_events).min();
        // Measured: 3 and 39 events on joint 1, 3 and 63 on joint 2.
        assert!(most.map(|n| 2 * n) < least, "joint {}: {most:?} {least:?}", row.joint);
    }
}

#[test]
fn every_figure_of_a_study_without_a_finished_run_can_be_drawn() {
    let table = study(&["study.max_rhs=600000", "study.steps=[1e-7]", "study.methods=[\"rk4\"]"]);
    for drawing in figures::of_mechanism(&[1e-4; 2], &table, &StepTables::default(), None, None) {
        drawing.figure.svg().unwrap();
        drawing.figure.png().unwrap();
    }
}

#[test]
fn the_errors_of_a_run_are_of_one_size_and_its_work_is_that_of_its_parts() {
    let table = study(&["study.methods=[\"rk4\", \"vern98\", \"radau5\", \"bdf\"]"]);
    for row in &table.rows {
        let (e, errors) = (row.e.unwrap(), row.errors);
        let [e_max, e_l2] = [errors.e_max, errors.e_l2].map(Option::unwrap);
        assert!(e <= e_max && e_l2 <= e_max && 0.0 < e_l2, "{row:?}");
        let peak = errors.peak_force_n.unwrap();
        let settled = row.events_are_right() && e < 1e-6;
        // Peak forces go with penetration: K Δδ. Measured: 0.16 to 0.94 of that.
        let relative = e * 1e-4 * 1e7 / peak;
        assert!(!settled || errors.peak_force_error.unwrap() < 9.0 * relative, "{row:?}");
        let work = row.work_by_phase;
        let phases = [work.flight, work.contact, work.stick];
        let of_phases: u64 = phases.iter().flatten().map(|phase| phase.counts.n_rhs).sum();
        assert_eq!(of_phases + work.restart.n_rhs + work.location.counts.n_rhs, row.n_rhs);
        let steps: u64 = phases.iter().flatten().map(|phase| phase.n_accepted).sum();
        assert_eq!(steps, row.n_accepted);
    }
}

#[test]
fn any_two_columns_of_numbers_are_axes_of_a_figure() {
    let table = study(&["study.methods=[\"rk45\"]"]);
    for name in deltazero::config::AXES {
        let value = Column::named(name).map(|column| (column.value)(&table.rows[0]));
        assert!(!matches!(value, None | Some(Value::Text(_))), "{name}");
    }
    let drawing = figures::chosen_axes(&table, "e_l2", "peak_force_error").unwrap();
    drawing.figure.svg().unwrap();
    assert!(drawing.caption.contains("Lowest: rk45 located, rtol 1e-8"), "{}", drawing.caption);
}

#[test]
fn a_page_escapes_what_it_is_given() {
    let mean = "<b>&\"'</script>";
    let values = vec![Value::Text(mean.into())];
    let heading = Heading { name: mean.into(), about: mean.into() };
    let picture = Picture {
        name: "figure",
        title: mean.into(),
        caption: mean.into(),
        svg: "<svg width=\"1\"></svg>".into(),
        png: Vec::new(),
    };
    let parts = vec![
        Part::Text(mean.into()),
        Part::Facts(vec![(mean.into(), mean.into())]),
        Part::Table(Table { caption: mean.into(), columns: vec![heading], rows: vec![values] }),
        Part::Figure(picture),
        Part::Folded(mean.into(), vec![Part::Code(mean.into())]),
    ];
    let section = Section { title: mean.into(), parts };
    let page = Page { title: mean.into(), lead: mean.into(), sections: vec![section] }.html();
    assert!(!page.contains("<b>"), "{page}");
    assert!(!page.contains("&\""), "{page}");
    // The one script of the page.
    assert_eq!(page.matches("</script>").count(), 1, "{page}");
    assert!(page.contains("<p>&lt;b&gt;&amp;"), "{page}");
}

#[test]
fn a_figure_too_large_as_svg_stands_in_the_page_as_png() {
    let svg = format!("<svg width=\"1\">{}</svg>", " ".repeat(600_000));
    let (title, caption) = ("large".to_owned(), String::new());
    let picture = Picture { name: "large", title, caption, svg, png: b"png".to_vec() };
    let section = Section { title: "s".into(), parts: vec![Part::Figure(picture)] };
    let page = Page { title: "t".into(), lead: String::new(), sections: vec![section] }.html();
    assert!(page.contains("<img src=\"data:image/png;base64,cG5n\" alt=\"large\">"), "{page}");
    assert!(!page.contains("<svg"));
}

#[test]
fn the_configuration_knows_the_methods_of_the_solvers() {
    let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
    assert_eq!(names, deltazero::config::METHODS);
}

/// The benchmark of Table 1 with `sets`.
fn benchmark_of(sets: &[&str]) -> Benchmark {
    benchmark(&config(sets), &AtomicBool::new(false)).unwrap()
}

/// The contest of `methods` on the first 0.3 s of Table 1, flights included, and on what.
fn contest(methods: &[&str], accuracy: f64) -> (Benchmark, Standings) {
    let stop = AtomicBool::new(false);
    let benchmark = benchmark_of(&["run.t_end=0.3"]);
    let methods: Vec<String> = methods.iter().map(|name| (*name).to_owned()).collect();
    let candidates = Candidate::all(&methods, Events::ALL);
    let contest = Contest {
        benchmark: &benchmark,
        accuracy,
        atol: None,
        repeats: 1,
        max_work: 1e8,
        right_events: RightEvents::FromTight,
        stop: &stop,
    };
    let standings = contest.run(&candidates, &|_| {});
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
            Trial::new(&benchmark, &setting, Start::Exact, f64::INFINITY, &AtomicBool::new(false))
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
    let part = whole.clone().with_at_most(n);
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
    assert_eq!(whole.clone().with_at_most(whole.n_events).t_end, whole.t_end);
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

static RUNNING: AtomicBool = AtomicBool::new(false);

fn horizon(config: &Config, work: f64) -> Horizon {
    let subject = config.mechanism.subject(config);
    let span = Span { t_end: config.run.t_end, reached: config.run.t_end, work };
    tight_runs(&subject, &vec![span; subject.parts.len()], &RUNNING).horizon
}

#[test]
fn the_horizon_is_that_of_the_reference() {
    for sets in [&["contact.damping=0"][..], &["reading=full", "run.t_end=0.3"]] {
        let config = config(sets);
        let (reference, t_end) = (reference(&config, &RUNNING).unwrap(), config.run.t_end);
        match horizon(&config, 0.0) {
            // Times of the reference are 0.01 s apart, these ones 0.002 s.
            Horizon::LostAt(t) => assert!((reference.horizon() - t).abs() < 0.02, "{t}"),
            other => assert_eq!((other, reference.horizon()), (Horizon::WholeRun, t_end)),
        }
    }
}

#[test]
fn a_motion_that_costs_too_much_to_follow_is_not_measured() {
    let config = Config::table1().unwrap();
    let subject = config.mechanism.subject(&config);
    assert_eq!(horizon(&config, 0.0), Horizon::WholeRun);
    let spans = [Span { t_end: 1e3, reached: 1e3, work: 0.0 }; 2];
    let measured = |spans, stop| tight_runs(&subject, spans, &stop).horizon;
    assert_eq!(measured(&spans, AtomicBool::new(true)), Horizon::NotMeasured);
    let failed_at_once = [Span { t_end: 2.0, reached: 0.0, work: 0.0 }; 2];
    assert_eq!(measured(&failed_at_once, AtomicBool::new(false)), Horizon::NotMeasured);
}
