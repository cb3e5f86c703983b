//! A run that cannot reach its end: exit 1, and what was computed is on disk.

use crate::{Scratch, number, with_sets};

/// The explicit method far beyond its stability in contact.
const DIVERGING: [&str; 3] = ["solver.method=rk4", "solver.step=0.01", "run.t_end=0.3"];

#[test]
fn a_run_that_fails_says_where_and_what_to_try_and_writes_what_it_has() {
    let scratch = Scratch::new();
    let ran = scratch.run(&with_sets(&["simulate", "--out", "out"], &DIVERGING));
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let run = scratch.json("out/run.json");
    assert_eq!(run["outcome"], "failed");
    let error = &run["error"];
    let (t, mode) = (error["t"].as_f64().unwrap(), error["mode"].as_str().unwrap());
    assert_eq!(error["bay"], 1);
    let joint = error["joint"].as_u64().unwrap() as usize;
    for part in [&format!("joint {joint}"), mode, "t = ", "smaller step"] {
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    assert!(ran.stderr.contains(error["message"].as_str().unwrap()));
    let trajectory = scratch.table("out/trajectory.csv");
    let rows = trajectory.of_joint(joint);
    assert!(!rows.is_empty());
    assert!(rows.iter().all(|row| number(row, "t_s") <= t));
    for row in &trajectory.rows {
        let (states, forces) = trajectory.header[2..].split_at(8);
        assert!(states.iter().all(|column| number(row, column).is_finite()));
        let is_sound = |column: &String| row[column].is_empty() || number(row, column).is_finite();
        assert!(forces.iter().all(is_sound));
    }
    let events = scratch.table("out/events.csv");
    assert!(events.of_joint(joint).iter().all(|row| number(row, "t_s") <= t));
    assert_eq!(scratch.files("out"), ["events.csv", "run.json", "trajectory.csv"]);
}

#[test]
fn a_failed_method_is_a_row_of_the_study_and_of_its_summary() {
    let scratch = Scratch::new();
    let sets = [
        "run.t_end=0.3",
        "study.methods=[\"rk45\", \"rk4\"]",
        "study.events=[\"located\"]",
        "study.rtol=[1e-6]",
        "study.steps=[0.01]",
        "study.repeats=1",
    ];
    let ran = scratch.study("out", &sets, &[]);
    assert!(ran.stderr.contains("1 ok, 1 failed"), "{}", ran.stderr);
    let table = scratch.table("out/study.csv");
    let failed = table.rows.iter().find(|row| row["status"] == "failed").unwrap();
    assert!(failed["error"].contains("smaller step"), "{failed:?}");
    assert!(ran.stderr.contains(&failed["error"]), "{}", ran.stderr);
    for column in ["e", "missed", "spurious", "wall_s_min"] {
        assert_eq!(failed[column], "", "{column}");
    }
}

#[test]
fn a_study_in_which_no_run_reaches_its_end_fails() {
    let scratch = Scratch::new();
    let sets = [
        "run.t_end=0.3",
        "study.methods=[\"rk4\"]",
        "study.events=[\"located\"]",
        "study.steps=[0.01]",
    ];
    let ran = scratch.run(&with_sets(&["study", "--out", "out"], &sets));
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("no run reached its end"), "{}", ran.stderr);
    assert_eq!(scratch.table("out/study.csv").rows.len(), 1);
}

#[test]
fn a_contact_pressed_beyond_the_range_of_its_law_says_so_before_or_during_the_run() {
    let scratch = Scratch::new();
    let failure = |modulus: &str, out: &str| {
        let sets = ["contact.law=johnson", modulus, "run.t_end=0.5"];
        let ran = scratch.run(&with_sets(&["simulate", "--out", out], &sets));
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        ran.stderr
    };
    // The drive alone presses with M1/l = 0.4 N.
    let before = failure("contact.young_modulus=1e5", "soft");
    assert!(before.contains("no run can begin: ") && before.contains("at most 1."), "{before}");
    let during = failure("contact.young_modulus=3e5", "firm");
    assert!(during.contains("penetration δ = ") && during.contains("slip"), "{during}");
    assert!(scratch.json("firm/run.json")["error"]["t"].as_f64() > Some(0.0));
}

#[test]
fn a_guard_of_a_text_model_that_fails_is_shown_where_it_is_written() {
    let scratch = Scratch::new();
    let model = r#"
mode = "falling_on_a_floor_of_an_uneven_hall"
t_end = 1
[states]
x = { start = 1 }
[rates]
x = "-3"
[modes.falling_on_a_floor_of_an_uneven_hall]
events = [{ when = "x + log(x - 0.5) > 9", to = "falling_on_a_floor_of_an_uneven_hall" }]
"#;
    std::fs::write(scratch.path("model.toml"), model).unwrap();
    let ran = scratch.run(&["simulate", "--model", "model.toml", "--out", "out"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let error = ran.stderr.split_once("error: guard 0 is not finite").map(|(_, error)| error);
    let error = error.unwrap_or_else(|| panic!("{}", ran.stderr));
    let parts = ["in mode falling_on_a_floor_of_an_uneven_hall,", "model.toml:9:21", "^"];
    for part in parts {
        assert!(error.contains(part), "no {part:?} in: {error}");
    }
}
