//! The numbers of the README are those of a study that the program wrote.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero::report;
use deltazero::study::work_precision::WorkPrecision;

fn file(name: &str) -> String {
    std::fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_answer_in_the_readme_is_that_of_the_committed_study() {
    let table: WorkPrecision = serde_json::from_str(&file("docs/table1/study.json")).unwrap();
    assert!(file("README.md").contains(&report::answer(&table)));
}

#[test]
fn the_readme_names_every_method() {
    let readme = file("README.md");
    for method in deltazero_solvers::METHODS {
        assert!(readme.contains(&format!("`{}`", method.name)), "{}", method.name);
    }
}
