//! Every mechanism of the list, by the same commands.

use deltazero::mechanisms::MECHANISMS;
use deltazero_study::columns::{COLUMNS, Given};
use serde_json::json;

use super::{Scratch, number};

/// What shortens the runs of a mechanism to a few events.
fn short(name: &str) -> &'static str {
    match name {
        "strut" => "run.t_end=0.2",
        "slider-crank" => "run.t_end=0.006",
        "four-bar" => "run.t_end=0.2",
        "cam-follower" => "run.t_end=0.03",
        _ => "run.t_end=3",
    }
}

#[test]
fn every_mechanism_is_simulated_and_its_energy_balances() {
    for entry in MECHANISMS {
        let (scratch, choice) = (Scratch::new(), format!("mechanism={}", entry.name));
        let ran = scratch.simulate("out", &[&choice, "solver.rtol=1e-9", short(entry.name)]);
        let run = scratch.json("out/run.json");
        assert_eq!(run["outcome"], json!("finished"), "{}: {}", entry.name, ran.stderr);
        assert!(run["counts"]["n_events"].as_u64().unwrap() > 2, "{}: {}", entry.name, ran.stdout);
        let energy = |part: &str| run["energy"][part].as_f64().unwrap();
        let moved = energy("work").abs().max(energy("kinetic")).max(energy("dissipated").abs());
        let residual = (energy("residual") / moved).abs();
        assert!(residual < 1e-6, "{}: {residual:e}", entry.name);
        let trajectory = scratch.table("out/trajectory.csv");
        let last = trajectory.rows.last().unwrap();
        assert!(number(last, "t_s") > 0.0 && last.contains_key("mode"), "{last:?}");
        assert!(scratch.table("out/events.csv").rows.len() > 2, "{}", entry.name);
    }
}

#[test]
fn every_mechanism_has_a_study_and_a_recommendation() {
    for entry in MECHANISMS {
        let (scratch, choice) = (Scratch::new(), format!("mechanism={}", entry.name));
        let contest = "contest.methods=[\"rk45\", \"dop853\"]";
        let sets = [
            &choice,
            short(entry.name),
            "study.methods=[\"rk45\", \"radau5\"]",
            "study.events=[\"located\"]",
            "study.rtol=[1e-7]",
            "study.repeats=1",
        ];
        scratch.study("out", &sets, &["--quiet"]);
        let table = scratch.table("out/study.csv");
        assert_eq!(table.rows.len(), 2, "{}", entry.name);
        let always = COLUMNS.iter().filter(|column| column.given == Given::Always);
        let always: Vec<&str> = always.map(|column| column.name).collect();
        for column in table.rows[0].keys().filter(|name| !always.contains(&name.as_str())) {
            let is_known = table.rows.iter().any(|row| !row[column].is_empty());
            assert!(is_known, "{}: no run has {column}", entry.name);
        }
        for row in &table.rows {
            let forces = ["peak_force_n", "impulse_n_s"].map(|name| row.get(name));
            let are_known =
                forces.iter().flatten().all(|cell| cell.parse().is_ok_and(|x: f64| x > 0.0));
            assert!(are_known, "{}: {forces:?}", entry.name);
            let right = ["status", "missed", "spurious"].map(|column| row[column].as_str());
            assert_eq!(right, ["ok", "0", "0"], "{}: {row:?}", entry.name);
            // Measured: at most 2.3e-3, of the cam, a sample of which is amid an impact.
            assert!(number(row, "e") < 1e-2, "{}: {row:?}", entry.name);
        }
        let text = scratch.text("out/study.md");
        assert!(!text.contains("joint") || entry.uses.contains(&"joint"), "{}", entry.name);
        let sets = ["--set", &choice, "--set", short(entry.name), "--set", contest];
        let args = [&["recommend", "--json", "--accuracy", "1e-5"][..], &sets].concat();
        let answer: serde_json::Value =
            serde_json::from_str(&scratch.succeed(&args).stdout).unwrap();
        assert!(answer["method"].is_string(), "{}: {answer}", entry.name);
    }
}

#[test]
fn a_block_that_overturns_ends_there() {
    let scratch = Scratch::new();
    let sets = [
        "mechanism=rocking-block",
        "rocking_block.base_amplitude=3",
        "rocking_block.start_angle=0",
    ];
    let ran = scratch.simulate("out", &sets);
    let run = scratch.json("out/run.json");
    assert_eq!(run["outcome"], json!("overturned"), "{}", ran.stdout);
    // The time of docs/rocking_block.md.
    let end = &run["overturned_s"][0];
    assert!((end["t_s"].as_f64().unwrap() - 4.55635).abs() < 1e-4, "{end}");
    assert!(ran.stdout.contains("overturned at 4.556"), "{}", ran.stdout);
}

#[test]
fn lengths_that_do_not_turn_are_refused() {
    let scratch = Scratch::new();
    let args = ["simulate", "--set", "mechanism=four-bar", "--set", "four_bar.crank_length=2.9"];
    let ran = scratch.run(&args);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert!(ran.stderr.contains("no crank-rocker: |coupler_length"), "{}", ran.stderr);
}
