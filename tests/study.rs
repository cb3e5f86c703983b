//! The study as a library: its table says what single runs say.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use std::sync::atomic::AtomicBool;

use common::config;
use deltazero::study::work_precision::{Status, WorkPrecision, cheapest, work_precision};
use deltazero::{figures, report};
use deltazero_solvers::METHODS;

fn study(sets: &[&str]) -> WorkPrecision {
    let short =
        ["run.t_end=0.15", "study.repeats=1", "study.rtol=[1e-4, 1e-8]", "study.steps=[1e-4]"];
    let config = config(&[&short[..], sets].concat());
    work_precision(&config, &[], &AtomicBool::new(false), &|_| {}).unwrap()
}

#[test]
fn a_study_has_one_row_for_each_method_treatment_and_setting() {
    let table = study(&[]);
    // Located and blind: rk4 at one step, rk45, dop853, vern98, radau5 and bdf at two tolerances.
    assert_eq!(table.rows.len(), 2 * (1 + 5 * 2));
    assert!(table.rows.iter().all(|row| row.status == Status::Ok), "{:?}", table.rows);
    let tight = table.rows.iter().find(|row| row.method == "rk45" && row.rtol == Some(1e-8));
    assert!(tight.is_some_and(|row| row.events_are_right() && row.e < Some(1e-7)));
}

#[test]
fn the_reference_is_confirmed_by_its_second_method() {
    let reference = study(&["study.methods=[\"rk45\"]"]).reference;
    // Measured: e = 3.4e-13, event times to 1.1e-12 s.
    assert!(reference.agreement < 3e-12, "{:e}", reference.agreement);
    assert!(reference.event_time_agreement_s.is_some_and(|t| t < 1e-11));
}

#[test]
fn an_accuracy_beyond_the_reference_is_not_decided() {
    // Without damping the motion is chaotic: the reference loses its digits within the run.
    let table = study(&["run.t_end=2", "contact.damping=0", "study.methods=[\"rk45\"]"]);
    let reference = &table.reference;
    assert!(reference.agreement > 1e-9, "{:e}", reference.agreement);
    assert!(!table.can_decide(1e-9));
    assert!(report::answer(&table).contains("| 1e-9 | not decidable |"));
    assert!(reference.horizon_s.iter().any(|t| *t < 2.0), "{:?}", reference.horizon_s);
}

#[test]
fn a_run_beyond_the_limit_of_work_is_cut() {
    let table = study(&["study.max_rhs=600000", "study.steps=[1e-7]", "study.methods=[\"rk4\"]"]);
    assert!(table.rows.iter().all(|row| row.status == Status::Cut && row.e.is_none()));
    assert!(cheapest(&table.rows, 1.0).is_none());
}

#[test]
fn rows_do_not_depend_on_the_number_of_threads() {
    let strip = |mut table: WorkPrecision| {
        for row in &mut table.rows {
            (row.wall_s_min, row.wall_s_median) = (None, None);
        }
        table
    };
    assert_eq!(strip(study(&[])), strip(study(&["study.threads=2"])));
}

#[test]
fn every_figure_of_a_study_without_a_finished_run_can_be_drawn() {
    let table = study(&["study.max_rhs=600000", "study.steps=[1e-7]", "study.methods=[\"rk4\"]"]);
    for drawing in figures::of_study(&table, &[], None) {
        drawing.figure.svg().unwrap();
        drawing.figure.png().unwrap();
    }
}

#[test]
fn the_configuration_knows_the_methods_of_the_solvers() {
    let names: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
    assert_eq!(names, deltazero::config::METHODS);
}
