//! The tables of all runs: as CSV, and in the report.

use std::fmt::Write as _;

use deltazero_study::columns::{Column, Value, shown};
use deltazero_study::work_precision::{Row, WorkPrecision};

use super::{About, count, rounded};
use crate::csv::{self, exact, field};

/// `study.csv`.
pub fn study_csv(about: &About, table: &WorkPrecision) -> String {
    let columns = shown(&table.rows);
    let leading = about.leading.iter().map(|(name, ..)| *name);
    let names: Vec<&str> = leading.chain(columns.iter().map(|column| column.name)).collect();
    let mut csv = names.join(",") + "\n";
    for row in &table.rows {
        let own = columns.iter().map(|column| match (column.value)(row) {
            Value::Text(text) => field(&text),
            Value::Number(x) => exact(x.filter(|x| !x.is_nan())),
            Value::Count(n) => n.map_or_else(String::new, |n| n.to_string()),
        });
        let leading = about.leading.iter().map(|(.., value)| field(value));
        csv += &(leading.chain(own).collect::<Vec<_>>().join(",") + "\n");
    }
    csv
}

/// Columns of the report's table of all runs.
const RUNS: [csv::Column<Row>; 18] = [
    ("method", |row| row.method.clone()),
    ("events", |row| row.events.to_string()),
    ("setting", Row::setting),
    ("status", |row| match &row.error {
        None => row.status.name().to_owned(),
        Some(error) => format!("{}: {error}", row.status.name()),
    }),
    ("e", |row| rounded(row.e, 2)),
    ("event time error [s]", |row| rounded(row.event_time_error_s, 2)),
    ("missed", |row| count(row.missed)),
    ("spurious", |row| count(row.spurious)),
    ("n_rhs", |row| row.n_rhs.to_string()),
    ("steps", |row| row.n_accepted.to_string()),
    ("rejected", |row| row.n_rejected.to_string()),
    ("retaken", |row| row.n_retaken.to_string()),
    ("Jacobians", |row| row.n_jac.to_string()),
    ("factorisations", |row| row.n_factorisations.to_string()),
    ("linear solves", |row| row.n_lin_solves.to_string()),
    ("time min [ms]", |row| milliseconds(row.times_s()[0])),
    ("median [ms]", |row| milliseconds(row.times_s()[1])),
    ("max [ms]", |row| milliseconds(row.times_s()[2])),
];

/// All runs: errors, events, work, time.
pub(super) fn runs(rows: &[Row]) -> String {
    let names = RUNS.map(|(name, _)| name).join(" | ");
    let mut text = format!("| {names} |\n|{}\n", "---|".repeat(RUNS.len()));
    for row in rows {
        let _ = writeln!(text, "| {} |", RUNS.map(|(_, of)| of(row)).join(" | "));
    }
    text
}

fn milliseconds(time_s: Option<f64>) -> String {
    time_s.map_or_else(|| "–".to_owned(), |time| format!("{:.2}", 1e3 * time))
}

/// What tells a run from the others, before its columns.
const RUN: [&str; 3] = ["method", "events", "setting"];

/// Columns of the report's table of further errors.
const ERRORS: [&str; 9] = [
    "e_max",
    "e_l2",
    "e_final",
    "peak_force_error",
    "contact_impulse_error",
    "impact_speed_error",
    "impulse_error",
    "dissipation_error",
    "energy_residual",
];

/// Columns of the report's table of work.
const WORK: [&str; 9] = [
    "n_rhs_flight",
    "n_rhs_contact",
    "n_rhs_stick",
    "n_rhs_restart",
    "n_rhs_location",
    "n_rhs_per_event",
    "n_accepted_flight",
    "n_accepted_contact",
    "n_accepted_stick",
];

/// The further errors of all runs.
pub(super) fn errors(rows: &[Row]) -> String {
    of_columns(rows, &ERRORS)
}

/// Where the work of all runs went.
pub(super) fn work(rows: &[Row]) -> String {
    of_columns(rows, &WORK)
}

fn of_columns(rows: &[Row], names: &[&str]) -> String {
    let is_asked = |column: &&&Column| names.contains(&column.name);
    let shown = shown(rows);
    let columns = || shown.iter().filter(is_asked);
    let header: Vec<&str> = columns().map(|column| column.name).collect();
    let mut text = format!("| {} |\n", [&RUN[..], &header].concat().join(" | "));
    text += &("|---".repeat(RUN.len() + header.len()) + "|\n");
    for row in rows {
        let values = columns().map(|column| match (column.value)(row) {
            Value::Text(text) => text,
            Value::Number(x) => rounded(x, 2),
            Value::Count(n) => n.map_or_else(String::new, |n| n.to_string()),
        });
        let run = [row.method.clone(), row.events.to_string(), row.setting()].into_iter();
        let _ = writeln!(text, "| {} |", run.chain(values).collect::<Vec<_>>().join(" | "));
    }
    text
}

/// What each column of `study.csv` is.
pub(super) fn columns(about: &About, rows: &[Row]) -> String {
    let mut text = String::from("| column | unit | what it is |\n|---|---|---|\n");
    for (name, what, _) in &about.leading {
        let _ = writeln!(text, "| `{name}` |  | {what} |");
    }
    for Column { name, unit, about, .. } in shown(rows) {
        let _ = writeln!(text, "| `{name}` | {unit} | {about} |");
    }
    text
}
