//! The page of a sweep: what was swept, what the runs say, what it depends on, figures, how to redo it.

use deltazero_study::columns::Value;
use deltazero_study::digits::{count_of, rounded_to};

use super::study::machine;
use super::{Heading, Page, Part, Section, Table};
use crate::figures::Picture;
use crate::report::sweep::{Findings, checked, explained, follows, reasons, runs, shares, varied};
use crate::run::setting;
use crate::sweep::origin::Origin;
use crate::sweep::results::Results;
use crate::sweep::sobol::Sobol;
use crate::sweep::summary::{PARTS, Said};

/// What the configuration of the sweep is called where it is folded in.
const CONFIG: &str = "config.toml";

/// The page of a sweep with its figures; `report` is the command that makes it anew, without the directory.
pub fn page(
    results: &Results,
    origin: &Origin,
    findings: &Findings,
    pictures: Vec<Picture>,
    report: &str,
) -> Page {
    let section = |title: &str, parts| Section { title: title.into(), parts };
    let depends = match &findings.sobol {
        Some(sobol) => indices(results, sobol),
        None => ranks(results, findings),
    };
    let mut sections = vec![
        section("At a glance", vec![Part::Facts(glance(results, origin, findings))]),
        section("What the runs say", said(results, findings)),
        section("What it depends on", depends),
        section("Figures", pictures.into_iter().map(Part::Figure).collect()),
        section("Redo it", redo(results, origin, report)),
    ];
    sections.retain(|section| !section.parts.is_empty());
    let title = "What do the runs say, and what does it depend on?".into();
    Page { title, lead: lead(results, origin), sections }
}

fn fact(name: &str, what: impl Into<String>) -> (String, String) {
    (name.into(), what.into())
}

fn lead(results: &Results, origin: &Origin) -> String {
    let n = results.plan.n_runs().unwrap_or_default();
    let keys = results.key_columns().join(", ");
    let runs = count_of(n, "run");
    format!("{} {runs} with other values of {keys}.", origin.config.mechanism.lead())
}

/// What was swept, by what, and how many runs came to their end.
fn glance(results: &Results, origin: &Origin, findings: &Findings) -> Vec<(String, String)> {
    let config = &origin.config;
    let about = format!("{}, {}", config.mechanism.title(config), config.mechanism.entry.about);
    let Findings { ok, failed, .. } = findings;
    let but_reading = but_for(results, |key| key == "reading" || key == "bays");
    let mut facts = vec![fact("Subject", about + &but_reading)];
    facts.extend(varied(results));
    facts.push(fact("Runs", runs(&results.plan)));
    facts.push(fact("Came to their end", format!("{ok} ok, {failed} failed")));
    facts.extend(reasons(&findings.reasons).into_iter().map(|why| fact("Failed", why)));
    let method = setting(config).map_or_else(String::new, |setting| setting.to_string());
    let but_solver = but_for(results, |key| key.starts_with("solver."));
    facts.push(fact("Method", format!("{method}{but_solver}")));
    let but_end = but_for(results, |key| key == "run.t_end");
    facts.push(fact("To", format!("{} s{but_end}", config.run.t_end)));
    facts.extend(machine(&origin.provenance));
    let shards = match origin.shards {
        0 => String::new(),
        1 => ", one shard and the merge together".to_owned(),
        n => format!(", {n} shards and the merge together"),
    };
    facts.push(fact("Took", format!("{:.1} s{shards}", origin.wall_s)));
    facts
}

/// Which of these keys the runs vary, as told above.
fn but_for(results: &Results, is_of: impl Fn(&str) -> bool) -> String {
    let varied: Vec<&str> =
        results.key_columns().iter().map(String::as_str).filter(|key| is_of(key)).collect();
    if varied.is_empty() { String::new() } else { format!(", but for {} above", varied.join(", ")) }
}

fn heading(name: &str, about: &str) -> Heading {
    Heading { name: name.into(), about: about.into() }
}

/// What the runs say, column by column.
fn said(results: &Results, findings: &Findings) -> Vec<Part> {
    let (mut rows, mut words) = (Vec::new(), Vec::new());
    for (column, said) in &findings.summary.columns {
        match said {
            Said::Words(counts) => words.push(fact(column, shares(counts))),
            Said::Numbers(n, parts) => {
                let unit = results.unit(column).to_owned();
                let words = [column.clone(), unit].map(Value::Text);
                let row = words.into_iter().chain([Value::Count(Some(*n))]);
                let parts = (0..PARTS.len()).map(|i| Value::Number(parts.map(|all| short(all[i]))));
                rows.push(row.chain(parts).collect());
            }
        }
    }
    let mut parts = Vec::new();
    if !rows.is_empty() {
        parts.push(Part::Table(Table {
            caption: format!("Of {} that came to the end", count_of(findings.ok, "run")),
            columns: HEADS.map(|(name, about)| heading(name, about)).into(),
            rows,
        }));
    }
    if !words.is_empty() {
        parts.push(Part::Facts(words));
    }
    parts.extend(findings.summary.checked.as_ref().map(|own| Part::Text(checked(own))));
    parts
}

const HEADS: [(&str, &str); 8] = [
    ("result", "column of runs.csv"),
    ("unit", ""),
    ("runs", "runs that have it"),
    ("least", ""),
    ("5 %", "5 % of the runs are below"),
    ("median", ""),
    ("95 %", "95 % of the runs are below"),
    ("largest", ""),
];

/// Which key each column follows, by ranks.
fn ranks(results: &Results, findings: &Findings) -> Vec<Part> {
    let sentence = |column: &String| Some((results.label(column), follows(findings, column)?));
    let mut parts = vec![
        Part::Facts(findings.columns.iter().filter_map(sentence).collect()),
        Part::Text(
            "ρ is the rank correlation after Spearman. It sees monotonic dependence alone: it is 1 where the result never falls \
             as the key rises, −1 where it never rises, and near 0 where it does neither, also where it depends on the key but \
             turns round, which only the figures show. ρ² is the part of the variance of the ranks that goes with the key."
                .into(),
        ),
    ];
    let unranked = &findings.summary.unranked;
    if !unranked.is_empty() {
        let keys = unranked.join(", ");
        parts.push(Part::Text(format!(
            "Words have no ranks, so what {keys} does is left to the figures."
        )));
    }
    let row = |own: &crate::sweep::summary::Follows| {
        let rho = own.correlation.rho;
        vec![
            Value::Text(own.column.clone()),
            Value::Text(own.key.clone()),
            rounded(rho),
            rounded(rho * rho),
            rounded(own.correlation.by_chance()),
            Value::Count(Some(own.correlation.n as u64)),
        ]
    };
    let columns = [
        ("result", "column of runs.csv"),
        ("key", "what was varied"),
        ("ρ", "rank correlation"),
        ("ρ²", "part of the variance of the ranks"),
        ("by chance", "what |ρ| stays below in 19 of 20 cases where nothing depends on anything"),
        ("runs", "runs that have the result"),
    ];
    let rows: Vec<Vec<Value>> = findings.summary.follows.iter().map(row).collect();
    if !rows.is_empty() {
        parts.push(Part::Table(Table {
            caption: "Rank correlations, the strongest first".into(),
            columns: columns.map(|(name, about)| heading(name, about)).into(),
            rows,
        }));
    }
    parts
}

/// Which key the scatter of each column comes from.
fn indices(results: &Results, all: &[Sobol]) -> Vec<Part> {
    let sentence = |sobol: &Sobol| (results.label(&sobol.column), explained(sobol));
    let mut rows = Vec::new();
    for sobol in all {
        for point in &sobol.points {
            for own in &point.keys {
                let [main, total] = [own.main, own.total]
                    .map(|index| [index.value, index.interval[0], index.interval[1]]);
                let words = [sobol.column.clone(), point.title(), own.key.clone()].map(Value::Text);
                let numbers = main.into_iter().chain(total).map(rounded);
                rows.push((own.total.value, words.into_iter().chain(numbers).collect::<Vec<_>>()));
            }
        }
    }
    rows.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let has_grid = !results.plan.axes.is_empty();
    let columns = [
        ("result", "column of runs.csv"),
        ("at", "point of the grid"),
        ("key", "what was drawn"),
        ("main", "part of the variance that the key explains alone"),
        ("from", "lower end of its 95 % interval"),
        ("to", "upper end"),
        ("total", "with all interactions that it takes part in"),
        ("from", "lower end of its 95 % interval"),
        ("to", "upper end"),
    ];
    let is_shown = |i: &usize| has_grid || *i != 1;
    let shown = |row: Vec<Value>| {
        row.into_iter().enumerate().filter(|(i, _)| is_shown(i)).map(|(_, own)| own).collect()
    };
    vec![
        Part::Facts(all.iter().map(sentence).collect()),
        Part::Text(
            "The main Sobol index of a key is the part of the variance that it explains alone, the total index that with all \
             interactions it takes part in; both with 95 % intervals."
                .into(),
        ),
        Part::Table(Table {
            caption: "Sobol indices, the largest total first".into(),
            columns: columns
                .iter()
                .enumerate()
                .filter(|(i, _)| is_shown(i))
                .map(|(_, (name, about))| heading(name, about))
                .collect(),
            rows: rows.into_iter().map(|(_, row)| shown(row)).collect(),
        }),
    ]
}

/// Rounded to what the page shows, so that it is rounded once: four digits where these are no longer than three with an
/// exponent, else three; a whole number stays.
fn short(x: f64) -> f64 {
    let four = rounded_to(x, 4);
    let fits = four.to_string().len() <= format!("{x:.2e}").len();
    if x.fract() == 0.0 {
        x
    } else if fits {
        four
    } else {
        rounded_to(x, 3)
    }
}

/// To three decimals.
fn rounded(x: f64) -> Value {
    Value::Number(Some((1e3 * x).round() / 1e3 + 0.0))
}

fn redo(results: &Results, origin: &Origin, report: &str) -> Vec<Part> {
    let code = |text: &str| Part::Code(text.to_owned());
    let folded = |name: &str, text: String| Part::Folded(name.into(), vec![Part::Code(text)]);
    let without = match &origin.following[..] {
        [] => String::new(),
        keys => format!(" Leave out {}: they follow run.t_end in each run.", keys.join(", ")),
    };
    vec![
        Part::Text(format!(
            "Save the plan below as plan.toml and the configuration as {CONFIG} beside it.{without} The rows come out the same by \
             the same build of the program:"
        )),
        code("deltazero sweep plan.toml --out redone"),
        Part::Text("This page and its figures alone, from the directory that holds sweep.json and runs.csv:".into()),
        code(report),
        folded("The plan", results.plan.to_toml(CONFIG)),
        folded("The configuration", origin.config.to_toml()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_rounded_once() {
        assert_eq!([1.04482844e-7, 12.3412, 1.0, 2e9].map(short), [1.04e-7, 12.34, 1.0, 2e9]);
    }
}
