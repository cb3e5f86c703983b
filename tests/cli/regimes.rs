//! `regimes`: one row a cell, whatever the threads, and going on after an interruption.

use std::fs;

use serde_json::{Value, json};

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
    regimes(&scratch, "one", &["--threads", "1"]);
    regimes(&scratch, "two", &["--threads", "2", "--quiet"]);
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
fn an_interrupted_map_takes_what_was_finished_and_does_the_rest() {
    let scratch = Scratch::new();
    regimes(&scratch, "out", &["--quiet"]);
    let whole = settings(&scratch, "out");
    // As an interruption leaves it; the errors of the finished cells tell that they are not redone.
    let mut map = scratch.json("out/regimes.json");
    let cells = map["cells"].as_array_mut().unwrap();
    cells.retain(|cell| cell["stiffness"] == 1e7);
    for cell in cells.iter_mut() {
        cell["error"] = json!("kept");
    }
    fs::write(scratch.path("out/regimes.json"), map.to_string()).unwrap();
    regimes(&scratch, "out", &["--quiet"]);
    assert_eq!(settings(&scratch, "out"), whole);
    for cell in scratch.json("out/regimes.json")["cells"].as_array().unwrap() {
        assert_eq!(cell["error"] != Value::Null, cell["stiffness"] == 1e7, "{cell}");
    }
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
