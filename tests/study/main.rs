//! The study as a library: its table says what single runs say.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

#[path = "../common/mod.rs"]
mod common;
mod contest;

use common::config;
use deltazero::config::Config;
use deltazero::figures::{Drawing, Picture};
use deltazero::report::About;
use deltazero::report::html::{Heading, Page, Part, Section, Table};
use deltazero::study::plan::{plan, reference, work_precision};
use deltazero::study::stability::stability;
use deltazero::{figures, report};
use deltazero_solvers::{METHODS, Method};
use deltazero_study::columns::{Column, Value};
use deltazero_study::horizon::{Horizon, Span, tight_runs};
use deltazero_study::motion::Motion;
use deltazero_study::run::Limits;
use deltazero_study::setting::{Accuracy, Events, Setting};
use deltazero_study::steps::StepTables;
use deltazero_study::steps::proportionality::proportionality;
use deltazero_study::work_precision::{Progress, Row, Status, WorkPrecision, cheapest};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

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
fn joints_of_different_clearances_are_measured_by_their_own() {
    let measure = |sets: &[&str]| {
        let sets = [&["study.methods=[\"rk45\"]", "run.t_end=0.05"], sets].concat();
        study(&sets).reference.measure()
    };
    let same = measure(&[]);
    assert!(same.starts_with("larger of |Δ pin|/1e-4 m and |Δ θ|/"), "{same}");
    let different = measure(&["joint2.joint.clearance=5e-4"]);
    let expected = "largest of |Δ pin of joint 1|/1e-4 m, |Δ θ|/";
    assert!(different.starts_with(expected), "{different}");
    assert!(different.ends_with(" and |Δ pin of joint 2|/5e-4 m"), "{different}");
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
    // Long, and three times as slow as another of no larger error with the events right where it has: timed once.
    let n_timed = |table: &WorkPrecision| -> Vec<usize> {
        let first = |row: &Row| row.cpus_s[0];
        let is_beaten = |row: &Row| {
            table.rows.iter().any(|other| {
                let is_as_right = other.events_are_right() || !row.events_are_right();
                3.0 * first(other) < first(row) && other.e <= row.e && is_as_right
            })
        };
        let is_once = |row: &Row| first(row) > 5e-3 && is_beaten(row);
        table.rows.iter().map(|row| if is_once(row) { 1 } else { 2 }).collect()
    };
    let n_walls = |table: &WorkPrecision| -> Vec<usize> {
        table.rows.iter().map(|row| row.walls_s.len()).collect()
    };
    assert!(whole.rows.iter().all(|row| row.warnings.is_empty()));
    assert_eq!(n_walls(&whole), n_timed(&whole));
    assert_eq!((n_ahead, done.len()), (3 * n, 3 * n));
    let turns: Vec<&[String]> = done.chunks(n).collect();
    // Errors are measured on all cores, in any order.
    let mut measured = turns[0].to_vec();
    let mut timed = turns[1].to_vec();
    assert_eq!(turns[2], timed);
    measured.sort();
    timed.sort();
    assert_eq!(measured, timed);

    let (stopped, _) = study(&[], n + 2);
    assert!(stopped.rows.iter().all(|row| row.status == Status::Ok));
    assert_eq!(n_walls(&stopped), [&[1, 1][..], &vec![0; n - 2]].concat());
    assert_eq!(stopped.rows[2].wall_s_min, None);
    let (resumed, (n_ahead, done)) = study(&stopped.rows, usize::MAX);
    assert_eq!((n_ahead, done.len()), (3 * n, 3 * n));
    assert_eq!(n_walls(&resumed), n_timed(&resumed));
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
fn every_figure_of_a_study_of_all_methods_can_be_drawn() {
    let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
    let sets = [
        "run.t_end=0.02",
        "study.repeats=1",
        "study.rtol=[1e-4, 1e-8]",
        "study.steps=[1e-4]",
        &format!("study.methods={names:?}"),
    ];
    let (config, stop) = (config(&sets), AtomicBool::new(false));
    let table = work_precision(&config, &[], &stop, &|_| {}).unwrap();
    let subject = config.mechanism.subject(&config);
    let steps = StepTables::new(&subject, &plan(&config), &table, Limits::none(&stop));
    for drawing in figures::of_study(&table, &steps, None, &[1e-4; 2], None) {
        drawing.figure.svg().unwrap_or_else(|error| panic!("{}: {error}", drawing.name));
    }
}

/// The figures of one run of a mechanism by rk45.
fn drawings(mechanism: &str, t_end: &str) -> Vec<Drawing> {
    let (mechanism, t_end) = (format!("mechanism={mechanism}"), format!("run.t_end={t_end}"));
    let sets = [&mechanism, &t_end, "study.repeats=1", "study.rtol=[1e-6]"];
    let config = config(&[&sets[..], &["study.methods=[\"rk45\"]"]].concat());
    let stop = AtomicBool::new(false);
    let table = work_precision(&config, &[], &stop, &|_| {}).unwrap();
    let (subject, limits) = (config.mechanism.subject(&config), Limits::none(&stop));
    let steps = StepTables::new(&subject, &plan(&config), &table, limits);
    let motion = Motion::new(&subject, config.run.t_end, limits).unwrap();
    figures::of_study(&table, &steps, Some(&motion), &[], None)
}

fn caption<'a>(drawings: &'a [Drawing], name: &str) -> &'a str {
    &drawings.iter().find(|drawing| drawing.name == name).unwrap().caption
}

#[test]
fn impacts_of_no_duration_have_no_force_to_draw() {
    let force = |mechanism, t_end| {
        let drawings = drawings(mechanism, t_end);
        let n_panels =
            drawings.iter().find(|own| own.name == "gap_and_force").unwrap().figure.panels.len();
        (n_panels, caption(&drawings, "gap_and_force").contains("force"))
    };
    assert_eq!(force("impact-oscillator", "1.5"), (2, false));
    assert_eq!(force("strut", "0.05"), (4, true));
}

#[test]
fn steps_of_several_sites_are_told_as_theirs() {
    let drawings = drawings("rocking-block", "1.0");
    let caption = caption(&drawings, "step_size");
    assert!(caption.starts_with("Accepted steps of 2 sites together, "), "{caption}");
}

#[test]
fn both_figures_of_one_flight_show_the_same_one() {
    // The contacts of an impact oscillator take no time: from one impact to the next is a flight.
    for (t_end, told) in [("1.5", "the first flight"), ("0.1", "for there is no flight")] {
        let drawings = drawings("impact-oscillator", t_end);
        let both = ["step_size_zoom", "gap_and_force"].map(|name| caption(&drawings, name));
        assert!(both[0].contains(told), "{both:?}");
        let is_at_start = both.map(|caption| caption.contains("the start, for there is no flight"));
        assert_eq!(is_at_start[0], is_at_start[1], "{both:?}");
    }
}

#[test]
fn figures_without_data_are_left_out_of_a_study() {
    let table = study(&["study.max_rhs=600000", "study.steps=[1e-7]", "study.methods=[\"rk4\"]"]);
    assert!(table.rows.iter().all(|row| row.e.is_none()));
    // Nothing is left to draw.
    let drawings = figures::of_study(&table, &StepTables::default(), None, &[1e-4; 2], None);
    assert_eq!(drawings.iter().map(|drawing| drawing.name).collect::<Vec<_>>(), [""; 0]);
    // What was asked for is drawn all the same.
    figures::chosen_axes(&table, "n_rhs", "e").unwrap().figure.png().unwrap();
}

/// The figure of error against tolerance.
fn tolerance(table: &WorkPrecision) -> Drawing {
    let steps = StepTables { proportionality: proportionality(table), ..StepTables::default() };
    let mut drawings = figures::of_study(table, &steps, None, &[], None).into_iter();
    drawings.find(|drawing| drawing.name == "tolerance").unwrap()
}

#[test]
fn a_method_that_is_drawn_blind_alone_is_in_the_legend() {
    let mut table = study(&["study.methods=[\"rk45\", \"bs32\"]"]);
    let named =
        |table: &WorkPrecision| tolerance(table).figure.svg().unwrap().matches("bs32").count();
    let n = named(&table);
    for row in table.rows.iter_mut().filter(|row| row.method == "bs32") {
        row.e = row.e.filter(|_| row.events == Events::Blind);
    }
    assert_eq!((n, named(&table)), (1, 1));
}

#[test]
fn runs_without_an_error_are_told_where_they_have_no_place() {
    let mut table = study(&["study.methods=[\"rk4\", \"rk45\", \"bs32\"]"]);
    let exact = |row: &&mut Row| row.method != "bs32" && row.events == Events::Located;
    table.rows.iter_mut().filter(exact).for_each(|row| row.e = Some(0.0));
    let caption = tolerance(&table).caption;
    for part in ["rk45 located: exact at every tolerance;", " Not drawn, having e = 0: 2 runs."] {
        assert!(caption.contains(part), "no {part:?} in: {caption}");
    }
    let drawings = figures::of_study(&table, &StepTables::default(), None, &[], None);
    let order = drawings.iter().find(|drawing| drawing.name == "rk4_order").unwrap();
    assert!(order.caption.ends_with(" Not drawn, having e = 0: 1 run."), "{}", order.caption);
}

#[test]
fn a_slope_through_two_runs_is_told_as_such() {
    let told = |sets: &[&str]| {
        let table = study(&[&["study.methods=[\"rk4\", \"rk45\"]"], sets].concat());
        let drawings = figures::of_study(&table, &StepTables::default(), None, &[], None);
        let order = drawings.iter().find(|drawing| drawing.name == "rk4_order").unwrap();
        [tolerance(&table).caption, order.caption.clone()]
            .map(|caption| caption.contains(" through two runs"))
    };
    assert_eq!(told(&["study.rtol=[1e-5, 1e-7]", "study.steps=[1e-4, 5e-5]"]), [true, true]);
    let three = [
        "study.rtol=[1e-5, 1e-6, 1e-7]",
        "study.steps=[1e-4, 7e-5, 5e-5]",
        "study.events=[\"located\"]",
    ];
    assert_eq!(told(&three), [false, false]);
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
    for name in deltazero::keys::AXES {
        let value = Column::named(name).map(|column| (column.value)(&table.rows[0]));
        assert!(!matches!(value, None | Some(Value::Text(_))), "{name}");
    }
    let drawing = figures::chosen_axes(&table, "e_l2", "peak_force_error").unwrap();
    drawing.figure.svg().unwrap();
    assert!(drawing.caption.contains("Lowest: rk45 located, rtol 1e-8"), "{}", drawing.caption);
    assert!(!drawing.caption.contains("Not drawn"), "{}", drawing.caption);
    // An explicit method has no Jacobians, and a scale of logarithms no place for none.
    let caption = figures::chosen_axes(&table, "e", "n_jac").unwrap().caption;
    let n = table.rows.iter().filter(|row| row.e.is_some()).count();
    let told =
        format!("Lowest: n_jac = 0, of {n} runs. Not drawn, having n_jac or e = 0: {n} runs.");
    assert!(n > 1 && caption.contains(&told), "{caption}");
}

#[test]
fn markdown_has_no_tags_of_what_it_is_given() {
    let table = study(&["study.methods=[\"rk45\"]"]);
    let mean = "a <b>block</b>";
    let facts = vec![("Source".to_owned(), mean.to_owned())];
    let about = About { facts, ..About::new(mean) };
    let text = report::study_markdown(&about, &table, &[]);
    assert!(text.contains("\na \\<b>block\\</b>.\n"), "{text}");
    assert!(text.contains("- Source: a \\<b>block\\</b>.\n"), "{text}");
}

#[test]
fn a_page_escapes_what_it_is_given() {
    let mean = "<b>&\"'</script>";
    let values = vec![Value::Text(mean.into())];
    let heading = Heading { name: mean.into(), about: mean.into() };
    let picture = Picture {
        name: "figure".into(),
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
    let picture = Picture { name: "large".into(), title, caption, svg, png: b"png".to_vec() };
    let section = Section { title: "s".into(), parts: vec![Part::Figure(picture)] };
    let page = Page { title: "t".into(), lead: String::new(), sections: vec![section] }.html();
    assert!(page.contains("<img src=\"data:image/png;base64,cG5n\" alt=\"large\">"), "{page}");
    assert!(!page.contains("<svg"));
}

static RUNNING: AtomicBool = AtomicBool::new(false);

/// The setting of the runs that are compared with tight ones.
fn asked() -> Setting {
    let accuracy = Accuracy::Rtol(1e-6, None);
    Setting { method: Method::named("rk45").unwrap(), events: Events::Located, accuracy }
}

fn horizon(config: &Config, work: f64) -> Horizon {
    let subject = config.mechanism.subject(config);
    let span = Span { t_end: config.run.t_end, reached: config.run.t_end, is_stopped: false, work };
    tight_runs(&subject, &asked(), &vec![span; subject.parts.len()], &RUNNING).horizon
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
    let spans = [Span { t_end: 1e3, reached: 1e3, is_stopped: false, work: 0.0 }; 2];
    let measured = |spans, stop| tight_runs(&subject, &asked(), spans, &stop).horizon;
    assert_eq!(measured(&spans, AtomicBool::new(true)), Horizon::NotMeasured);
    let failed_at_once = [Span { t_end: 2.0, reached: 0.0, is_stopped: false, work: 0.0 }; 2];
    assert_eq!(measured(&failed_at_once, AtomicBool::new(false)), Horizon::NotMeasured);
}
