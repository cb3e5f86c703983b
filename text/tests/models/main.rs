//! Every model that comes with the crate, against a truth of its own: a closed form, a conserved quantity, a published
//! value, or the same problem in Rust.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod arcs;
mod bouncing;
mod carts;
mod contacts;
mod friction;
mod hunt_crossley;
mod impacts;
mod joint;
mod oscillator;
mod rocking;
mod runs;
mod switching;

use deltazero_text::models::MODELS;
use runs::{balanced, file, parts};

#[test]
fn every_file_is_a_model_that_says_what_it_is_and_where_it_is_from() {
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/models")).unwrap();
    let mut found: Vec<String> = folder
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .map(|name| name.trim_end_matches(".toml").to_owned())
        .collect();
    found.sort();
    let names: Vec<&str> = MODELS.iter().map(|model| model.name).collect();
    assert_eq!(found, names);
    for name in MODELS.iter().map(|model| model.name) {
        let file = file(name);
        let words = [file.name(), file.about(), file.source()];
        assert!(words.iter().all(|words| !words.is_empty()), "{name}");
        let parts = file.models(&[]).unwrap().len();
        assert_eq!(parts, if name == "paper_joint" { 2 } else { 1 }, "{name}");
        for parameter in file.parameters() {
            assert!(!parameter.about.is_empty(), "{name}: {}", parameter.name);
        }
    }
}

#[test]
fn no_model_needs_a_warning() {
    for name in MODELS.iter().map(|model| model.name) {
        let file = file(name);
        let all = file.warnings().into_iter().chain(file.leftovers());
        let warnings: Vec<String> = all.map(|warning| warning.to_string()).collect();
        assert!(warnings.is_empty(), "{name}: {}", warnings.join("\n"));
    }
}

#[test]
fn no_run_is_wrong_by_its_own_account() {
    let rtol = 1e-10;
    for name in MODELS.iter().map(|model| model.name) {
        for part in parts(name, &[]) {
            let record = balanced(&part, "vern98", rtol, file(name).t_end().unwrap()).0;
            let warnings = record.check.warnings(Some(rtol));
            assert!(warnings.is_empty(), "{name} {}: {warnings:?}", part.part());
        }
    }
}
