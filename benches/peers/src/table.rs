//! `peers.md`: the fastest run of each method at four errors, and ours over others at equal error.

use std::fmt::Write;

use crate::entry::Handling;
use crate::row::{Build, Row};

/// Errors at which the fastest runs are shown.
const ERRORS: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];
/// With what ours are compared at equal error: the tool, the methods, the errors. The two that are written by
/// hand, and `diffsol`'s, which ours run and their own users call directly.
const COMPARED: [(&str, &[&str], &[f64]); 2] = [
    ("hand-written", &["rk45", "dop853"], &[1e-6, 1e-9]),
    (
        "diffsol",
        &["bdf", "tr_bdf2", "esdirk34", "tsit45"],
        &[1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9],
    ),
];

/// The fastest row with an error of at most `e`.
pub(crate) fn fastest<'r>(rows: impl IntoIterator<Item = &'r Row>, e: f64) -> Option<&'r Row> {
    let reaching = rows.into_iter().filter(|row| row.e().is_some_and(|own| own <= e));
    let timed = reaching.filter_map(|row| row.cpu_ms().map(|time| (row, time)));
    timed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The rows of one method of one tool in one build.
pub(crate) struct Group<'r> {
    /// Its rows.
    pub(crate) rows: Vec<&'r Row>,
}

/// The rows by tool, build, method and handling, in their order.
pub(crate) fn groups(rows: &[Row]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for row in rows {
        let same = |other: &Row| other.build == row.build && other.label.same_ladder(&row.label);
        match groups.iter_mut().find(|group| group.rows.first().is_some_and(|first| same(first))) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group { rows: vec![row] }),
        }
    }
    groups
}

/// The table of all methods.
pub(crate) fn methods(rows: &[Row]) -> String {
    let mut table = String::from(
        "| tool | build | method | events | e ≤ 1e-3 | e ≤ 1e-6 | e ≤ 1e-9 | e ≤ 1e-12 |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for Group { rows } in groups(rows) {
        let Some(first) = rows.first() else { continue };
        let label = &first.label;
        let _ = write!(
            table,
            "| {} {} | {} | {} | {} |",
            label.tool,
            label.version,
            first.build.name(),
            label.method,
            label.handling.name()
        );
        for e in ERRORS {
            let _ = write!(
                table,
                " {} |",
                fastest(rows.iter().copied(), e).map_or_else(|| "—".to_owned(), cell)
            );
        }
        table.push('\n');
    }
    table
}

/// `2.05 (48k; 52, 8)`: time, right-hand sides, events found, with `−missed +spurious` where not right.
fn cell(row: &Row) -> String {
    let Ok(outcome) = &row.outcome else { return "—".to_owned() };
    let verdict = &outcome.verdict;
    let n_rhs = outcome.n_rhs.map_or_else(|| "—".to_owned(), |n| format!("{}k", (n + 500) / 1000));
    let found = |found: deltazero_study::errors::EventMatch| match (found.missed, found.spurious) {
        (0, 0) => format!("{}", found.paired),
        (missed, spurious) => format!("{}−{missed}+{spurious}", found.paired + missed),
    };
    format!(
        "{} ({n_rhs}; {}, {})",
        three_digits(outcome.times.cpu_ms),
        found(verdict.delta),
        found(verdict.slip)
    )
}

/// A time with three digits.
fn three_digits(ms: f64) -> String {
    let decimals = (2.0 - ms.abs().log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{ms:.decimals$}")
}

/// Time at the error `e`, between the neighbouring runs of the front by a line in the logarithms.
fn time_at(rows: &[&Row], e: f64) -> Option<f64> {
    let mut front: Vec<(f64, f64)> =
        rows.iter().filter_map(|row| row.e().zip(row.cpu_ms())).filter(|(e, _)| *e > 0.0).collect();
    front.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut best = f64::INFINITY;
    front.retain(|(e, _)| {
        let better = *e < best;
        best = best.min(*e);
        better
    });
    let after = front.iter().position(|(own, _)| *own <= e)?;
    let (e1, t1) = front[after];
    let Some(&(e0, t0)) = after.checked_sub(1).and_then(|before| front.get(before)) else {
        return Some(t1);
    };
    let part = (e0 / e).ln() / (e0 / e1).ln();
    Some((t0.ln() + part * (t1 / t0).ln()).exp())
}

/// Ours over the same methods of others, at equal error, events located.
pub(crate) fn ratios(rows: &[Row]) -> String {
    let mut table = String::from(
        "| method | build | e | ours [ms] | theirs [ms] | ratio |\n|---|---|---|---|---|---|\n",
    );
    let located = |tool: &str, method: &str, build: Build, e: f64| {
        let own: Vec<&Row> = rows
            .iter()
            .filter(|row| row.label.tool == tool && row.label.method == method)
            .filter(|row| row.build == build && row.label.handling == Handling::Located)
            .collect();
        time_at(&own, e)
    };
    for (tool, methods, errors) in COMPARED {
        for method in methods {
            for build in [Build::Plain, Build::Native] {
                for &e in errors {
                    let time = |tool: &str| located(tool, method, build, e);
                    if let (Some(ours), Some(theirs)) = (time("deltazero"), time(tool)) {
                        let _ = writeln!(
                            table,
                            "| {method}, {tool} | {} | {e:e} | {} | {} | {:.2} |",
                            build.name(),
                            three_digits(ours),
                            three_digits(theirs),
                            ours / theirs
                        );
                    }
                }
            }
        }
    }
    table
}
