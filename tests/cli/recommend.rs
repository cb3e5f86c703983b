//! `recommend`: an answer that `simulate` takes, and what it says where there is none.

use serde_json::{Value, json};

use crate::{Scratch, Table, number, with_sets};

const SHORT: [&str; 3] =
    ["run.t_end=0.1", "contest.repeats=1", "contest.methods=[\"rk45\", \"rk4\"]"];

fn recommend(scratch: &Scratch, accuracy: &str, sets: &[&str]) -> Value {
    let args = with_sets(&["recommend", "--json", "--quiet", "--accuracy", accuracy], sets);
    let ran = scratch.succeed(&args);
    assert_eq!(ran.stderr, "");
    serde_json::from_str(&ran.stdout).unwrap()
}

/// Largest distance of the pins over the clearance.
fn pin_error(one: &Table, two: &Table) -> f64 {
    assert_eq!(one.rows.len(), two.rows.len());
    let pairs = one.rows.iter().zip(&two.rows);
    let error = pairs.map(|(a, b)| {
        let apart = |column| number(a, column) - number(b, column);
        // Displacements of joint 1 come first, of joint 2 too.
        apart("d1_m").hypot(apart("d2_m")) / 1e-4
    });
    error.fold(0.0, f64::max)
}

#[test]
fn what_is_recommended_goes_into_simulate_and_reaches_the_accuracy() {
    let scratch = Scratch::new();
    let answer = recommend(&scratch, "1e-5", &SHORT);
    let keys: Vec<&String> = answer.as_object().unwrap().keys().collect();
    let asked = [
        "accuracy",
        "events",
        "expected_cpu_s",
        "expected_e",
        "expected_e_spread",
        "expected_wall_s",
        "method",
        "reason",
        "rtol",
        "runners_up",
        "step",
        "warnings",
    ];
    assert_eq!(keys, asked);
    let e = answer["expected_e"].as_f64().unwrap();
    let spread = answer["expected_e_spread"].as_array().unwrap();
    assert!(spread[0].as_f64().unwrap() <= e && e <= spread[1].as_f64().unwrap());
    assert!(spread[1].as_f64().unwrap() <= 1e-5);
    for entry in answer["runners_up"].as_array().unwrap() {
        assert!(entry["expected_e"].as_f64().unwrap() <= 1e-5, "{entry}");
        assert!(entry["reason"].as_str().unwrap().contains("times the time"), "{entry}");
    }
    let key = |name: &str| match &answer[name] {
        Value::Null => None,
        value => Some(format!("solver.{name}={value}")),
    };
    let solver: Vec<String> =
        ["method", "events", "rtol", "step"].into_iter().filter_map(key).collect();
    assert_eq!(solver.len(), 3, "{solver:?}");
    let sets: Vec<&str> = solver.iter().map(String::as_str).chain(["run.t_end=0.1"]).collect();
    scratch.simulate("own", &sets);
    scratch.simulate("tight", &["run.t_end=0.1", "solver.method=vern98", "solver.rtol=1e-12"]);
    let error =
        pin_error(&scratch.table("own/trajectory.csv"), &scratch.table("tight/trajectory.csv"));
    assert!(error <= 1e-5 && error > 0.01 * e, "{error:e} beside {e:e}");
}

#[test]
fn the_answer_for_readers_fits_a_terminal_and_holds_the_solver_table() {
    let scratch = Scratch::new();
    let args = with_sets(&["recommend", "--accuracy", "1e-4"], &SHORT);
    let text = scratch.succeed(&args).stdout;
    for part in ["[solver]\nmethod = \"", "events = \"", "expected: e = ", "why: ", "time [ms]"] {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn where_no_method_reaches_the_accuracy_the_method_is_null_and_the_exit_code_1() {
    let scratch = Scratch::new();
    // A method of order 3 would need some 1e6 right-hand sides.
    let sets = ["run.t_end=0.1", "contest.methods=[\"bs32\"]", "contest.max_work=1e4"];
    let args = with_sets(&["recommend", "--json", "--accuracy", "1e-10"], &sets);
    let ran = scratch.run(&args);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let answer: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(answer["method"], Value::Null);
    assert_eq!(answer["runners_up"], json!([]));
    assert!(ran.stderr.contains("none for e = 1e-10: no method reaches it"), "{}", ran.stderr);
    let sets = ["run.t_end=0.1", "study.max_rhs=10"];
    let ran = scratch.run(&with_sets(&["recommend", "--quiet"], &sets));
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(
        ran.stderr.contains("none for e = 1e-6: no reference: it needs more"),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_run_beyond_its_horizon_is_warned_about() {
    let scratch = Scratch::new();
    // Without damping a last-bit change is seen within 2 s.
    let sets = ["contact.damping=0", "contest.methods=[\"dop853\"]", "contest.repeats=1"];
    let answer = recommend(&scratch, "1e-3", &sets);
    let warnings = answer["warnings"].as_array().unwrap();
    let horizon = warnings.iter().find(|warning| warning["code"] == "horizon");
    assert!(horizon.unwrap()["message"].as_str().unwrap().contains("2 s long"), "{answer}");
}

#[test]
fn a_law_that_delivers_another_restitution_is_warned_about() {
    let scratch = Scratch::new();
    let law = ["contact.law=lankarani_nikravesh", "contact.restitution=0.6", "run.t_end=0.02"];
    let contest = ["contest.methods=[\"rk45\"]", "contest.repeats=1"];
    let answer = recommend(&scratch, "1e-3", &[&law[..], &contest].concat());
    let codes: Vec<_> = answer["warnings"].as_array().unwrap().iter().map(|w| &w["code"]).collect();
    assert_eq!(codes, ["restitution"], "{answer}");
}

#[test]
fn chatter_is_warned_about() {
    let scratch = Scratch::new();
    // A pin that has no room: 650 mode changes a second of each joint.
    let contact = ["contact.stiffness=1e10", "contact.damping=500", "joint.clearance=1e-7"];
    let contest = ["run.t_end=0.02", "contest.methods=[\"rk4\"]", "contest.repeats=1"];
    let answer = recommend(&scratch, "1e-3", &[contact, contest].concat());
    let codes: Vec<_> = answer["warnings"].as_array().unwrap().iter().map(|w| &w["code"]).collect();
    assert_eq!(codes, ["chatter"], "{answer}");
}

#[test]
fn an_accuracy_that_cannot_be_asked_for_is_bad_usage() {
    let scratch = Scratch::new();
    for accuracy in ["0", "-1e-6", "1", "1e-20", "small", "nan"] {
        let ran = scratch.run(&["recommend", &format!("--accuracy={accuracy}")]);
        assert_eq!(ran.code, Some(2), "{accuracy}: {}", ran.stderr);
        assert!(ran.stderr.contains("from 1e-12 to 1e-1"), "{}", ran.stderr);
    }
}

#[test]
fn chains_and_bristles_are_recommended_for() {
    let scratch = Scratch::new();
    for own in ["bays=2", "friction.law=lugre"] {
        let methods = "contest.methods=[\"rk45\", \"radau5\"]";
        let sets = [own, "run.t_end=0.1", methods, "contest.repeats=1"];
        let answer = recommend(&scratch, "1e-4", &sets);
        // Which of them is the faster is the machine's to say.
        let is_known = ["rk45", "radau5"].iter().any(|name| answer["method"] == *name);
        assert!(is_known && answer["events"] == "located", "{own}: {answer}");
        let e = answer["expected_e"].as_f64().unwrap();
        assert!(e > 0.0 && e <= 1e-4, "{own}: {answer}");
    }
}

#[test]
fn a_method_that_needs_most_for_the_first_impacts_is_not_given_up() {
    // Before, rk4 was named, at eight times the time of radau5.
    let sets = [
        "reading=full",
        "contact.stiffness=1e12",
        "contact.damping=495014",
        "run.t_end=0.5",
        "contest.methods=[\"rk4\", \"bs32\", \"radau5\"]",
        "contest.events=[\"located\"]",
        "contest.repeats=1",
    ];
    let scratch = Scratch::new();
    for accuracy in ["1e-3", "1e-6"] {
        let answer = recommend(&scratch, accuracy, &sets);
        assert_eq!(answer["method"], "radau5", "{answer}");
    }
}
