//! `study`: its table, its files, and going on after an interruption.

use std::fs;

use deltazero::figures::OF_STUDIES;
use serde_json::{Value, json};

use crate::{Scratch, Table, number};

const COLUMNS: [&str; 19] = [
    "reading",
    "method",
    "events",
    "rtol",
    "step",
    "status",
    "e",
    "event_time_error_s",
    "n_events",
    "missed",
    "spurious",
    "horizon_s",
    "n_rhs",
    "n_accepted",
    "n_rejected",
    "n_jac",
    "n_lin_solves",
    "wall_s_min",
    "wall_s_median",
];
const SHORT: [&str; 5] = [
    "run.t_end=0.12",
    "study.methods=[\"rk45\", \"rk4\", \"bdf\"]",
    "study.rtol=[1e-4, 1e-7]",
    "study.steps=[1e-4]",
    "study.repeats=1",
];

/// The rows without what differs from one measurement to the next.
fn without_times(table: &Table) -> Vec<Vec<(&String, &String)>> {
    let timeless = |(column, _): &(&String, &String)| {
        !column.starts_with("wall_") && !column.starts_with("cpu_")
    };
    let rows = table.rows.iter();
    rows.map(|row| row.iter().filter(timeless).collect()).collect()
}

#[test]
fn without_a_command_the_study_is_done_and_every_run_is_a_row() {
    let scratch = Scratch::new();
    let sets: Vec<&str> = SHORT.iter().flat_map(|set| ["--set", set]).collect();
    let ran = scratch.succeed(&sets);
    assert!(ran.stderr.contains("10 runs: 10 ok, 0 failed"), "{}", ran.stderr);
    let table = scratch.table("deltazero-out/study.csv");
    assert_eq!(table.header[..19], COLUMNS);
    assert!(table.header.iter().any(|column| column == "error"));
    assert_eq!(table.rows.len(), 10);
    for row in &table.rows {
        assert_eq!((row["reading"].as_str(), row["status"].as_str()), ("pin", "ok"));
        assert_eq!(row["method"] == "rk4", row["rtol"].is_empty(), "{row:?}");
        assert_ne!(row["step"].is_empty(), row["rtol"].is_empty(), "{row:?}");
        assert!(number(row, "e") < 0.1, "{row:?}");
        assert!(number(row, "wall_s_min") <= number(row, "wall_s_median"));
        let tight = row["events"] == "located" && row["rtol"] == "1e-7";
        assert!(!tight || number(row, "missed") + number(row, "spurious") == 0.0, "{row:?}");
    }
    let study = scratch.json("deltazero-out/study.json");
    assert_eq!(study["rows"].as_array().unwrap().len(), 10);
    assert!(study["reference"].is_object());
    assert_eq!(study["config"]["run"]["t_end"], 0.12);
    assert_eq!(study["finished"], true);
    for (row, line) in study["rows"].as_array().unwrap().iter().zip(&table.rows) {
        assert_eq!(row["e"].as_f64().unwrap(), number(line, "e"));
        assert_eq!(row["n_rhs"].as_f64().unwrap(), number(line, "n_rhs"));
    }
    let files = scratch.files("deltazero-out");
    assert!(files.iter().any(|name| name == "study.md"));
    for svg in files.iter().filter(|name| name.ends_with(".svg")) {
        assert!(files.contains(&svg.replace(".svg", ".png")), "{files:?}");
        assert!(!scratch.text(&format!("deltazero-out/{svg}")).contains("no data"), "{svg}");
        // What is in no list is left there by the next study.
        let is_of_it = |name: &&str| *svg == format!("figures/{name}.svg");
        assert!(OF_STUDIES.iter().any(is_of_it), "{svg}");
    }
    for name in ["steps", "step_histogram", "stays", "restarts", "restart_costs", "rk4_stability"] {
        let table = scratch.table(&format!("deltazero-out/{name}.csv"));
        assert!(!table.rows.is_empty(), "{name}");
    }
    assert!(!files.iter().any(|name| name.ends_with(".partial")), "{files:?}");
}

#[test]
fn threads_change_no_number_but_times() {
    let scratch = Scratch::new();
    scratch.study("one", &SHORT, &["--threads", "1"]);
    let sets = [&SHORT[..], &["regimes.threads=3"]].concat();
    let ran = scratch.study("two", &sets, &["--threads", "2", "--json", "--quiet"]);
    assert_eq!(ran.stderr, "");
    let printed: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(printed["rows"].as_array().unwrap().len(), 10);
    let [one, two] = ["one", "two"].map(|dir| scratch.table(&format!("{dir}/study.csv")));
    assert_eq!(without_times(&one), without_times(&two));
    let timeless = |name: &&String| {
        let is_table = name.ends_with(".csv") && *name != "study.csv";
        is_table || (name.ends_with(".svg") && !name.ends_with("work_precision_time.svg"))
    };
    for name in scratch.files("one").iter().filter(timeless) {
        let same = scratch.text(&format!("one/{name}")) == scratch.text(&format!("two/{name}"));
        assert!(same, "{name}");
    }
    let [one, two] = ["one", "two"].map(|dir| scratch.json(&format!("{dir}/study.json")));
    assert_eq!(one["hash"], two["hash"], "threads are no part of what results are of");
}

#[test]
fn an_interrupted_study_takes_what_was_finished_and_does_the_rest() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let whole = scratch.table("out/study.csv");
    // As an interruption leaves it; the times of the finished runs tell that they are not redone.
    let mut study = scratch.json("out/study.json");
    study["finished"] = json!(false);
    let rows = study["rows"].as_array_mut().unwrap();
    for row in rows.iter_mut() {
        (row["walls_s"], row["wall_s_min"]) = (json!([1234.5]), json!(1234.5));
    }
    // Those that were compared, not timed; the latter by a version that kept no times.
    rows[4]["walls_s"] = json!([]);
    rows[5].as_object_mut().unwrap().remove("walls_s");
    for row in &mut rows[6..] {
        row["status"] = json!("interrupted");
        row["e"] = Value::Null;
        row["walls_s"] = json!([]);
    }
    fs::write(scratch.path("out/study.json"), study.to_string()).unwrap();
    scratch.study("out", &SHORT, &["--threads", "2"]);
    let resumed = scratch.table("out/study.csv");
    assert_eq!(without_times(&whole), without_times(&resumed));
    for (i, row) in resumed.rows.iter().enumerate() {
        assert_eq!(number(row, "wall_s_min") == 1234.5, i < 4, "{row:?}");
    }
}

#[test]
fn times_of_another_machine_are_not_taken_into_a_study_that_goes_on() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let mut study = scratch.json("out/study.json");
    study["finished"] = json!(false);
    study["machine"]["cpu"] = json!("another one");
    for row in study["rows"].as_array_mut().unwrap() {
        (row["walls_s"], row["wall_s_min"]) = (json!([1234.5]), json!(1234.5));
    }
    fs::write(scratch.path("out/study.json"), study.to_string()).unwrap();
    let ran = scratch.study("out", &SHORT, &[]);
    let said = "study.json: was begun on another machine or by another build";
    assert!(ran.stderr.contains(said), "{}", ran.stderr);
    for row in scratch.table("out/study.csv").rows {
        assert!(number(&row, "wall_s_min") != 1234.5, "{row:?}");
    }
}

#[test]
fn a_study_interrupted_before_its_figures_redoes_no_run_and_a_finished_one_all() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    for finished in [false, true] {
        let mut study = scratch.json("out/study.json");
        study["finished"] = json!(finished);
        for row in study["rows"].as_array_mut().unwrap() {
            (row["walls_s"], row["wall_s_min"]) = (json!([1234.5]), json!(1234.5));
        }
        fs::write(scratch.path("out/study.json"), study.to_string()).unwrap();
        fs::remove_file(scratch.path("out/study.md")).unwrap();
        scratch.study("out", &SHORT, &[]);
        assert!(scratch.path("out/study.md").exists());
        for row in scratch.table("out/study.csv").rows {
            assert_eq!(number(&row, "wall_s_min") == 1234.5, !finished, "{row:?}");
        }
    }
}

#[test]
fn a_run_beyond_the_limit_of_work_is_cut_and_the_summary_counts_it() {
    let scratch = Scratch::new();
    let sets = [
        "run.t_end=0.01",
        "study.methods=[\"rk45\", \"rk4\"]",
        "study.events=[\"located\"]",
        "study.rtol=[1e-6]",
        "study.steps=[1e-8]",
        "study.max_rhs=100_000",
    ];
    let ran = scratch.study("out", &sets, &[]);
    assert!(ran.stderr.contains("1 ok, 0 failed, 1 cut"), "{}", ran.stderr);
    let table = scratch.table("out/study.csv");
    let cut = table.rows.iter().find(|row| row["method"] == "rk4").unwrap();
    assert_eq!((cut["status"].as_str(), cut["e"].as_str()), ("cut", ""));
    assert_eq!(cut["error"], "more than study.max_rhs = 100000 right-hand sides");
}

#[test]
fn a_run_beyond_the_limit_of_time_is_cut_and_says_so() {
    let scratch = Scratch::new();
    // Minutes of steps; the reference takes milliseconds.
    let sets = [
        "run.t_end=0.002",
        "study.methods=[\"rk4\"]",
        "study.events=[\"located\"]",
        "study.steps=[1e-5, 1e-12]",
        "study.max_rhs=1_000_000_000_000",
        "study.max_seconds=3",
    ];
    let ran = scratch.study("out", &sets, &[]);
    assert!(ran.stderr.contains("1 ok, 0 failed, 1 cut"), "{}", ran.stderr);
    assert!(ran.stderr.contains("rk4 located, h 1e-12 s: more than study.max_seconds = 3 s"));
    let table = scratch.table("out/study.csv");
    assert_eq!(table.rows[1]["status"], "cut");
    assert_eq!(table.rows[1]["error"], "more than study.max_seconds = 3 s");
}

#[test]
fn an_infinite_error_survives_a_report_and_a_resumed_study() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let mut study = scratch.json("out/study.json");
    for (row, e) in [(1, "inf"), (2, "nan")] {
        (study["rows"][row]["e"], study["rows"][row]["missed"]) = (json!(e), json!(7));
    }
    let text_of = |study: &Value| {
        fs::write(scratch.path("out/study.json"), study.to_string()).unwrap();
        scratch.succeed(&["report", "out", "--quiet"]);
        let rows = scratch.table("out/study.csv").rows;
        assert_eq!((rows[1]["e"].as_str(), rows[2]["e"].as_str()), ("inf", ""));
        scratch.text("out/study.md")
    };
    let told = text_of(&study);
    // The same study, resumed before its figures: nothing is left to run.
    study["finished"] = json!(false);
    fs::write(scratch.path("out/study.json"), study.to_string()).unwrap();
    scratch.study("out", &SHORT, &["--quiet"]);
    let resumed = scratch.json("out/study.json");
    assert_eq!(
        (&resumed["rows"][1]["e"], &resumed["rows"][2]["e"]),
        (&json!("inf"), &json!("nan"))
    );
    assert!(scratch.text("out/study.md") == told && text_of(&resumed) == told);
}

#[test]
fn a_repeated_study_takes_the_reference_that_is_there() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    // The mark tells that it was not made anew.
    let marked = |mark: f64| {
        let mut kept = scratch.json("out/reference.json");
        kept["reference"]["summary"]["scales"][1]["scale"] = json!(mark);
        fs::write(scratch.path("out/reference.json"), kept.to_string()).unwrap();
    };
    let mark =
        || scratch.json("out/study.json")["reference"]["scales"][1]["scale"].as_f64().unwrap();
    let exact = mark();
    marked(1234.5);
    let other_methods = [&SHORT[..], &["study.methods=[\"rk45\"]"]].concat();
    scratch.study("out", &other_methods, &["--force"]);
    assert_eq!(mark(), 1234.5);
    // Another run has another reference.
    scratch.study("out", &[&SHORT[..], &["drive.m1=2"]].concat(), &["--force"]);
    assert_ne!(mark(), exact);
    scratch.study("out", &SHORT, &["--force"]);
    assert_eq!(mark(), exact);
}

#[test]
fn a_study_in_the_place_of_another_leaves_nothing_of_it() {
    let scratch = Scratch::new();
    let axes = ["study.x=e_l2", "study.y=wall_s_min"];
    scratch.study("out", &[&SHORT[..], &axes].concat(), &["--quiet"]);
    let of_struts = scratch.files("out");
    for name in ["figures/chosen_axes.png", "figures/orbit.png", "rk4_stability.csv"] {
        assert!(of_struts.iter().any(|own| own == name), "{name}: {of_struts:?}");
    }
    fs::write(scratch.path("out/figures/mine.svg"), "mine").unwrap();
    let other = [&SHORT[..], &["mechanism=impact-oscillator"]].concat();
    scratch.study("out", &other, &["--force", "--quiet"]);
    scratch.study("alone", &other, &["--quiet"]);
    fs::write(scratch.path("alone/figures/mine.svg"), "mine").unwrap();
    assert_eq!(scratch.files("out"), scratch.files("alone"));
}

#[test]
fn a_reference_that_cannot_be_read_is_made_anew_with_a_message() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    let whole = scratch.text("out/reference.json");
    fs::write(scratch.path("out/reference.json"), &whole[..whole.len() / 2]).unwrap();
    let ran = scratch.study("out", &SHORT, &[]);
    let message = "out/reference.json: EOF while parsing";
    assert!(ran.stderr.contains(message) && ran.stderr.contains("anew"), "{}", ran.stderr);
    assert!(scratch.text("out/reference.json") == whole);
}

#[test]
fn other_axes_are_no_other_study_and_a_wrong_one_is_told_the_right_ones() {
    let scratch = Scratch::new();
    scratch.study("out", &SHORT, &[]);
    scratch.study("out", &[&SHORT[..], &["study.x=e_l2", "study.y=impulse_error"]].concat(), &[]);
    let svg = scratch.text("out/figures/chosen_axes.svg");
    assert!(svg.contains("impulse_error against e_l2"));
    let ran = scratch.run(&["study", "--out", "out", "--set", "study.x=speed"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("study.x") && ran.stderr.contains("n_accepted"), "{}", ran.stderr);
}

#[test]
fn a_slider_crank_is_studied_with_figures_of_its_own() {
    let scratch = Scratch::new();
    let sets = [
        "mechanism=slider-crank",
        "run.t_end=0.003",
        "study.methods=[\"rk45\", \"rk4\", \"radau5\"]",
        "study.rtol=[1e-5]",
        "study.steps=[2e-6]",
        "study.repeats=1",
    ];
    scratch.study("out", &sets, &["--quiet"]);
    let table = scratch.table("out/study.csv");
    // No blind runs: its contact law remembers the speed of each impact.
    assert_eq!(table.rows.len(), 3);
    for row in &table.rows {
        assert_eq!((row["status"].as_str(), row["missed"].as_str()), ("ok", "0"), "{row:?}");
        assert!(number(row, "e") < 1e-2, "{row:?}");
    }
    let (page, text) = (scratch.text("out/report.html"), scratch.text("out/study.md"));
    assert!(page.contains("slider-crank: crank 0.05 m at 523.5987755982989 rad/s"));
    assert!(text.contains("Mechanism `slider-crank`."));
    for name in ["against_ideal", "orbit"] {
        assert!(text.contains(&format!("figures/{name}.png")), "{name}");
    }
    // A mechanism has these figures, and no other.
    let mut figures: Vec<String> = scratch.files("out/figures");
    figures.retain(|name| name.ends_with(".svg"));
    let expected = [
        "against_ideal",
        "chosen_axes",
        "gap_and_force",
        "orbit",
        "restarts",
        "rk4_order",
        "rk4_stability",
        "step_histogram",
        "step_size",
        "step_size_zoom",
        "steps_per_contact",
        "tolerance",
        "work_precision_rhs",
        "work_precision_time",
    ];
    assert_eq!(figures, expected.map(|name| format!("{name}.svg")));
    let motion = scratch.table("out/motion.csv");
    assert_eq!(motion.rows.len(), 4000 + 1001);
}

#[test]
fn chains_and_bristles_have_a_study() {
    let scratch = Scratch::new();
    let sets = [
        "bays=2",
        "joint2.friction.law=lugre",
        "run.t_end=0.1",
        "study.methods=[\"rk45\", \"rk4\", \"radau5\"]",
        "study.rtol=[1e-7]",
        "study.steps=[5e-5]",
        "study.repeats=1",
    ];
    scratch.study("out", &sets, &["--quiet"]);
    let table = scratch.table("out/study.csv");
    // No blind runs.
    assert_eq!(table.rows.len(), 3);
    for row in &table.rows {
        let right = ["status", "missed", "spurious"].map(|column| row[column].as_str());
        assert_eq!(right, ["ok", "0", "0"], "{row:?}");
        // Measured: at most 1.4e-7, 2.7e-7, 8.8e-8 and 2.5e-6.
        let bounds =
            [("e", 1e-6), ("e_max", 2e-6), ("e_l2", 8e-7), ("contact_impulse_error", 2e-5)];
        for (error, bound) in bounds {
            assert!(number(row, error) < bound, "{error}: {row:?}");
        }
    }
    let study = scratch.json("out/study.json");
    let sites = |part: usize| study["reference"]["parts"][part]["sites"].as_array().unwrap();
    let names: Vec<_> =
        (0..2).flat_map(|part| sites(part).iter().map(|site| &site["name"])).collect();
    assert_eq!(names, ["bay 1, joint 1", "bay 2, joint 1", "joint 2"]);
}
