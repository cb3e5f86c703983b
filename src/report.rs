//! Tables to text: Markdown, CSV and the HTML page.

mod about;
pub mod audit;
mod files;
pub mod html;
pub mod laws;
pub mod recommend;
pub mod regimes;
pub mod run_lines;
pub mod run_record;
mod runs;
pub mod simulation;
pub mod steps;
pub mod sweep;

pub use about::About;
pub use files::{File, study_files};
pub use runs::study_csv;

use std::fmt::Write as _;

use deltazero_study::work_precision::{
    ACCURACIES, Row, WorkPrecision, cheapest, cheapest_right, doubt,
};

use crate::figures::Drawing;

fn count(n: Option<usize>) -> String {
    n.map_or_else(String::new, |n| n.to_string())
}

/// A number to `digits` significant digits; a dash for none, and for one that is not defined.
fn rounded(x: Option<f64>, digits: usize) -> String {
    x.filter(|x| !x.is_nan()).map_or_else(|| "–".to_owned(), |x| format!("{x:.0$e}", digits - 1))
}

/// Columns of the answer.
const ANSWER: [&str; 7] = [
    "error e at most",
    "cheapest",
    "setting",
    "its e",
    "events missed, spurious",
    "time [ms]",
    "n_rhs",
];

/// The cheapest run at each accuracy, in the columns of [`ANSWER`]; where it has events wrong, the cheapest that has them
/// right, too.
fn answer_rows(table: &WorkPrecision) -> Vec<[String; 7]> {
    let rows = |e: f64| {
        let label = format!("{e:e}");
        if !table.can_decide(e) {
            let mut row: [String; 7] = Default::default();
            row[..3].clone_from_slice(&[
                label,
                "not decidable".into(),
                table.reference.undecided(),
            ]);
            return vec![row];
        }
        let best = cheapest(&table.rows, e);
        let mut rows = vec![answer_row(label.clone(), best, &doubt(&table.rows, e))];
        if best.is_some_and(|best| !best.events_are_right()) {
            let label = format!("{label}, events right");
            rows.push(answer_row(label, cheapest_right(&table.rows, e), ""));
        }
        rows
    };
    ACCURACIES.into_iter().flat_map(rows).collect()
}

/// A run that is cheapest, if any is, with who else may be.
fn answer_row(label: String, best: Option<&Row>, doubt: &str) -> [String; 7] {
    let mut row: [String; 7] = Default::default();
    row[0] = label;
    row[1] = "none reached it".into();
    if let Some(best) = best {
        row[1] = format!("{} {}{doubt}", best.method, best.events);
        row[2] = best.setting();
        row[3] = rounded(best.e, 2);
        row[4] = format!("{}, {}", count(best.missed), count(best.spurious));
        row[5] = format!("{:.2}", 1e3 * best.time_s().unwrap_or(f64::NAN));
        row[6] = best.n_rhs.to_string();
    }
    row
}

/// The answer in one table: the cheapest run at each accuracy.
pub fn answer(table: &WorkPrecision) -> String {
    let mut text = format!("| {} |\n{}|\n", ANSWER.join(" | "), "|---".repeat(ANSWER.len()));
    for row in answer_rows(table) {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// What a user wrote, in Markdown: it begins no tag.
fn words(text: &str) -> String {
    text.replace('<', "\\<")
}

/// `study.md`: the answer, the figures, every run.
pub fn study_markdown(about: &About, table: &WorkPrecision, drawings: &[Drawing]) -> String {
    let reference = &table.reference;
    let mut text = format!(
        "# {}\n\n{}.\n\n{}\n\
         e is the worst sample's {}, up to the horizon of {} s.\n\
         Reference: {}; a second run ({}) differs by e = {}{}, which is its error.\n",
        about.question(),
        words(&about.subject),
        answer(table),
        reference.measure(),
        reference.horizons(),
        reference.method,
        reference.check,
        reference.own_error(),
        reference
            .event_time_agreement_s
            .map_or_else(String::new, |t| format!(" and {t:.1e} s in event times")),
    );
    for limit in table.limits().iter().chain(&about.warnings) {
        let _ = writeln!(text, "\n- {limit}");
    }
    if !about.facts.is_empty() {
        let _ = write!(text, "\n## {}\n\n", about.heading());
    }
    for (name, what) in &about.facts {
        let _ = writeln!(text, "- {name}: {}.", words(what));
    }
    for drawing in drawings {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            drawing.figure.title, drawing.name, drawing.caption
        );
    }
    let rows = &table.rows;
    let _ = write!(text, "\n## All runs\n\n{}", runs::runs(rows));
    let _ = write!(text, "\n## Further errors\n\n{}", runs::errors(rows));
    let _ = write!(text, "\n## Where the work goes\n\n{}", runs::work(rows));
    let _ = write!(text, "\n## Columns of study.csv\n\n{}", runs::columns(about, rows));
    text
}
