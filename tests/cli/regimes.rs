//! `regimes`: one row a cell, whatever the threads, and going on after an interruption.

use std::fs;
#[cfg(unix)]
use std::time::Duration;

use serde_json::{Value, json};

#[cfg(unix)]
use crate::interrupt::Running;
use crate::{Scratch, Table, number, with_sets};

pub(crate) const SMALL: [&str; 6] = [
    "run.t_end=0.06",
    "regimes.stiffness=[1e6, 1e7]",
    "regimes.damping_ratio=[0.01, 1.0]",
    "regimes.accuracy=[1e-3, 1e-5]",
    "contest.methods=[\"rk45\", \"radau5\"]",
    "contest.repeats=1",
];

fn regimes(scratch: &Scratch, dir: &str, more: &[&str]) {
    let args = with_sets(&["regimes", "--out", dir], &SMALL);
    scratch.succeed(&[&args[..], more].concat());
}

/// What does not depend on times: the settings found, method by method.
fn settings(scratch: &Scratch, dir: &str) -> Vec<String> {
    let map = scratch.json(&format!("{dir}/regimes.json"));
    let mut settings = Vec::new();
    for cell in map["cells"].as_array().unwrap() {
        let place = format!("{} {} {}", cell["stiffness"], cell["damping_ratio"], cell["accuracy"]);
        for entry in cell["standings"]["entries"].as_array().unwrap() {
            let keys = ["method", "events", "rtol", "e", "e_spread", "n_rhs", "work"];
            settings.push(format!("{place} {:?}", keys.map(|key| &entry[key])));
        }
    }
    settings.sort();
    settings
}

fn cells(table: &Table) -> Vec<(f64, f64, f64)> {
    let of = |column| move |row| number(row, column);
    let rows = table.rows.iter();
    rows.map(|row| (of("accuracy")(row), of("stiffness")(row), of("damping_ratio")(row))).collect()
}

#[test]
fn every_cell_is_a_row_with_its_winner_and_threads_change_nothing_but_times() {
    let scratch = Scratch::new();
    let unused = ["--set", "contact.restitution=0.4"];
    let args = with_sets(&["regimes", "--out", "one", "--threads", "1"], &SMALL);
    let ran = scratch.succeed(&[&args[..], &unused[..]].concat());
    assert!(ran.stderr.contains("contact.law = power does not have it"), "{}", ran.stderr);
    regimes(&scratch, "two", &[&["--threads", "2", "--quiet"], &unused[..]].concat());
    let table = scratch.table("one/regimes.csv");
    let grid: Vec<(f64, f64, f64)> = [1e-3, 1e-5]
        .into_iter()
        .flat_map(|e| [1e6, 1e7].into_iter().flat_map(move |k| [0.01, 1.0].map(|z| (e, k, z))))
        .collect();
    assert_eq!(cells(&table), grid);
    for row in &table.rows {
        assert_eq!((row["reading"].as_str(), row["status"].as_str()), ("pin", "ok"), "{row:?}");
        assert!(number(row, "e_most") <= number(row, "accuracy"), "{row:?}");
        assert!(number(row, "cpu_s") <= number(row, "second_cpu_s"), "{row:?}");
    }
    assert_eq!(settings(&scratch, "one"), settings(&scratch, "two"));
    let [one, two] = ["one", "two"].map(|dir| scratch.json(&format!("{dir}/regimes.json")));
    assert_eq!(one["hash"], two["hash"]);
    let text = scratch.text("one/regimes.md");
    for part in
        ["- Implicit wins", "- Locating events", "- `auto`", "out of reach", "figures/cost.png"]
    {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    for name in ["winners", "margin", "cost"] {
        assert!(scratch.path(&format!("one/figures/{name}.png")).exists(), "{name}");
        assert!(scratch.path(&format!("one/figures/{name}.svg")).exists(), "{name}");
    }
}

#[test]
fn cells_of_a_map_that_are_in_no_chunk_are_taken_up_on_the_machine_that_made_them() {
    let scratch = Scratch::new();
    regimes(&scratch, "out", &["--quiet"]);
    let whole = settings(&scratch, "out");
    for is_here in [true, false] {
        // As an interruption left it; the errors of the finished cells tell that they are not redone.
        let mut map = scratch.json("out/regimes.json");
        if !is_here {
            map["machine"]["cpu"] = json!("another one");
        }
        let cells = map["cells"].as_array_mut().unwrap();
        cells.retain(|cell| cell["stiffness"] == 1e7);
        for cell in cells.iter_mut() {
            cell["error"] = json!("kept");
        }
        fs::write(scratch.path("out/regimes.json"), map.to_string()).unwrap();
        regimes(&scratch, "out", &["--quiet"]);
        assert_eq!(settings(&scratch, "out"), whole);
        for cell in scratch.json("out/regimes.json")["cells"].as_array().unwrap() {
            let is_kept = is_here && cell["stiffness"] == 1e7;
            assert_eq!(cell["error"] != Value::Null, is_kept, "{cell}");
        }
    }
}

/// Kills a map of so many sites once the chunk `first` is there, alters that one if asked, and lets the same command go on,
/// which runs what is missing and no more.
#[cfg(unix)]
fn killed_and_gone_on(scratch: &Scratch, args: &[&str], n_sites: usize, first: &str, alter: bool) {
    let run = Running::start(scratch, args);
    let first = scratch.path("out/chunks").join(first);
    run.until(&first, Duration::ZERO);
    run.kill();
    let other = scratch.run(&[args, &["--set", "regimes.max_events=99"]].concat());
    assert_eq!(other.code, Some(2), "{}", other.stderr);
    assert!(other.stderr.contains("results of another configuration"), "{}", other.stderr);
    let kept = scratch.files("out/chunks");
    let mut missing = n_sites - kept.iter().filter(|name| name.ends_with(".rows")).count();
    if alter {
        let text = fs::read_to_string(&first).unwrap();
        fs::write(&first, text.replacen("0.001", "0.002", 1)).unwrap();
        missing += 1;
    }
    let said = scratch.succeed(args).stderr;
    let line = format!("{missing} sites in ");
    assert!(said.lines().any(|own| own.starts_with(&line)), "{missing} missing of {said}");
    let left = scratch.files("out");
    let is_left = |name: &String| name.starts_with("chunks") || name.ends_with(".partial");
    assert!(!left.iter().any(is_left), "{left:?}");
}

#[cfg(unix)]
#[test]
fn a_killed_map_keeps_its_finished_sites_and_makes_altered_ones_again() {
    let sets = ["regimes.stiffness=[1e5, 1e6, 1e7]", "regimes.threads=1", "run.t_end=0.1"];
    let sets = with_sets(&["regimes"], &[&sets[..], &SMALL[4..]].concat());
    let scratch = Scratch::new();
    scratch.succeed(&[&sets[..], &["--quiet", "--out", "whole"]].concat());
    let whole = settings(&scratch, "whole");
    for alter in [false, true] {
        // The stiffest comes first.
        let args = [&sets[..], &["--out", "out"]].concat();
        killed_and_gone_on(&scratch, &args, 15, "0000010.rows", alter);
        assert_eq!(settings(&scratch, "out"), whole);
        fs::remove_dir_all(scratch.path("out")).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn a_killed_map_over_any_axes_goes_on() {
    let axes =
        ["--axis", "contact.stiffness=1e5:1e7:10", "--axis", "friction.coefficient=0.05,0.1,0.2"];
    let sets = with_sets(&["regimes"], &[&["regimes.threads=1"], &SMALL[4..]].concat());
    let sets = [&sets[..], &axes, &["--set", "run.t_end=0.1"]].concat();
    let scratch = Scratch::new();
    let on_two = ["--quiet", "--out", "whole", "--set", "regimes.threads=2"];
    scratch.succeed(&[&sets[..], &on_two].concat());
    let settings = |dir: &str| -> Vec<Vec<String>> {
        let rows = scratch.table(&format!("{dir}/map.csv")).rows;
        let keys = [
            "contact.stiffness",
            "friction.coefficient",
            "accuracy",
            "status",
            "horizon_s",
            "n_events",
        ];
        rows.iter().map(|row| keys.map(|key| row[key].clone()).to_vec()).collect()
    };
    let args = [&sets[..], &["--out", "out"]].concat();
    killed_and_gone_on(&scratch, &args, 30, "0000000.rows", false);
    assert_eq!(settings("out"), settings("whole"));
    assert_eq!(settings("out").len(), 60);
    let [own, whole] = ["out", "whole"].map(|dir| scratch.json(&format!("{dir}/map.json")));
    assert_eq!(own["hash"], whole["hash"], "threads are no part of what results are of");
}

#[test]
fn chains_have_a_map_without_blind_runs() {
    let scratch = Scratch::new();
    let args = with_sets(&["regimes", "--out", "out", "--quiet", "--set", "bays=2"], &SMALL);
    scratch.succeed(&[&args[..], &["--set", "regimes.accuracy=[1e-3]"]].concat());
    let table = scratch.table("out/regimes.csv");
    assert_eq!(table.rows.len(), 4);
    for row in &table.rows {
        assert_eq!((row["status"].as_str(), row["events"].as_str()), ("ok", "located"), "{row:?}");
    }
    assert!(scratch.text("out/regimes.md").contains("- No run is blind."));
}

#[test]
fn an_axis_of_another_mechanism_is_refused() {
    let scratch = Scratch::new();
    for (mechanism, axis, why) in [
        ("slider-crank", "strut.length", "mechanism = slider-crank does not use it"),
        ("cam-follower", "joint2.contact.stiffness", "mechanism = cam-follower has one joint"),
    ] {
        let (set, axis_1) = (format!("mechanism={mechanism}"), format!("{axis}=1e8,1e9"));
        let axes = ["--axis", &axis_1, "--axis", "contact.damping=1,2"];
        let ran = scratch.run(&[&["regimes", "--set", &set], &axes[..]].concat());
        let told = format!("error: --axis {axis}: {why}; ");
        assert!(ran.code == Some(2) && ran.stderr.starts_with(&told), "{}", ran.stderr);
    }
}

#[test]
fn a_cell_of_which_nothing_can_be_made_is_named() {
    let scratch = Scratch::new();
    let axes = ["--axis", "contact.stiffness=1e6,1e7", "--axis", "friction.coefficient=0.1,0"];
    let ran = scratch.run(&[&["regimes", "--set", "friction.law=lugre"], &axes[..]].concat());
    let told = "error: cell contact.stiffness = 1e6, friction.coefficient = 0: ";
    assert!(ran.code == Some(2) && ran.stderr.starts_with(told), "{}", ran.stderr);
    assert!(ran.stderr.contains("does not go with friction.law = lugre"), "{}", ran.stderr);
}

#[test]
fn a_map_over_stiffness_and_damping_is_of_contacts_that_have_both() {
    let scratch = Scratch::new();
    for (set, told) in [
        ("contact.law=hunt_crossley", "contact.law = hunt_crossley does not have both"),
        ("joint.clearance=0", "there is no contact to make a map of"),
        ("joint2.contact.damping=3", "differs from joint to joint"),
    ] {
        let ran = scratch.run(&["regimes", "--set", set]);
        assert!(ran.code == Some(2) && ran.stderr.contains(told), "{set}: {}", ran.stderr);
    }
}
