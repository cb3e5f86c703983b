//! What a report of a sweep is made from, read once, and its findings in words.

use deltazero_study::digits::{count_of, rounded_to};

use crate::figures::Drawing;
use crate::figures::sweep::{self, PlotError, chosen, drawing_of};
use crate::sweep::plan::{Plan, Random, Values};
use crate::sweep::plan_toml::shortest;
use crate::sweep::ranks::Correlation;
use crate::sweep::results::{Column, Reason, Results};
use crate::sweep::sobol::{Sobol, design};
use crate::sweep::summary::{Checked, Follows, Said, Summary};
use crate::sweep::{draw::Law, saltelli};

/// Values of an axis that are listed; of more the first.
const MOST_VALUES: usize = 12;
/// Words of a column that are told; of more the commonest.
const MOST_WORDS: usize = 8;

/// What a report is made from.
pub struct Findings {
    /// The columns that it is of.
    pub columns: Vec<String>,
    /// What the runs say in them.
    pub summary: Summary,
    /// Their Sobol indices, where the plan is designed for them and has few enough grid points.
    pub sobol: Option<Vec<Sobol>>,
    /// Runs that came to their end.
    pub ok: u64,
    /// Runs that did not.
    pub failed: u64,
    /// Why they did not, the commonest reason first.
    pub reasons: Vec<Reason>,
    /// The figures with the names of their files.
    pub drawings: Vec<(String, Drawing)>,
}

impl Findings {
    /// Those of `columns`. The rows are read once, once more for Sobol indices.
    ///
    /// # Errors
    /// A column that is not there or is a key, rows that cannot be read.
    pub fn of(results: &Results, columns: &[&str]) -> Result<Self, PlotError> {
        let table = results.table(&Summary::needs(results, columns)?)?;
        let summary = Summary::of(results, &table, columns);
        let has_words = |column: &str| matches!(table.column(column), Some(Column::Words { .. }));
        let of_numbers: Vec<&str> =
            columns.iter().copied().filter(|column| !has_words(column)).collect();
        let sobol = has_indices(&results.plan).then(|| Sobol::of_each(results, &of_numbers));
        let sobol = sobol.transpose()?;
        let mut drawings = Vec::new();
        // What is the same in all runs is told without a figure.
        for column in columns.iter().filter(|column| summary.varies(column)) {
            let own = sobol.iter().flatten().find(|own| own.column == *column);
            if let Some(own) = own.filter(|own| !own.points.is_empty()) {
                drawings.push((sweep::sobol::file_name(column), sweep::sobol::drawing(own)?));
                continue;
            }
            let strongest = summary.strongest(column).map(|own| own.key.as_str());
            for asked in chosen(results, column, has_words(column), strongest) {
                match drawing_of(results, &table, asked) {
                    Err(PlotError::Nothing { .. }) => {}
                    drawing => drawings.push((asked.file_name(), drawing?)),
                }
            }
        }
        Ok(Self {
            columns: columns.iter().map(|column| (*column).to_owned()).collect(),
            ok: table.n_rows() as u64,
            failed: table.failed,
            reasons: table.reasons,
            summary,
            sobol,
            drawings,
        })
    }
}

/// Whether a plan is designed for Sobol indices, at so few grid points that a figure shows them.
fn has_indices(plan: &Plan) -> bool {
    let is_shown = plan.n_points().is_some_and(|n| n <= sweep::sobol::MOST as u64);
    design(plan).is_some() && is_shown
}

/// Each varied key with the values that it takes.
pub(super) fn varied(results: &Results) -> Vec<(String, String)> {
    let Plan { axes, random, .. } = &results.plan;
    let unit = |key: &str| match results.unit(key) {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    let mut keys = results.key_columns().iter();
    let mut facts = Vec::new();
    for (axis, key) in axes.iter().zip(keys.by_ref()) {
        facts.push((key.clone(), values(&axis.values, &unit(key))));
    }
    for (draw, key) in random.iter().flat_map(|random| &random.keys).zip(keys) {
        facts.push((key.clone(), law(draw.law, &unit(key))));
    }
    facts
}

fn values(values: &Values, unit: &str) -> String {
    let even = |[first, last]: [f64; 2], points: u64, how: &str| {
        let [first, last] = [first, last].map(shortest);
        format!("{first} to {last}{unit}, {} at equal {how}", count_of(points, "value"))
    };
    match values {
        Values::Linear { ends, points, .. } => even(*ends, *points, "distances"),
        Values::Log { ends, points, .. } => even(*ends, *points, "ratios"),
        Values::List(all) => {
            let word = |value: &serde_json::Value| match value {
                serde_json::Value::String(word) => word.clone(),
                serde_json::Value::Number(x) => x.as_f64().map_or_else(|| x.to_string(), shortest),
                other => other.to_string(),
            };
            let told: Vec<String> = all.iter().take(MOST_VALUES).map(word).collect();
            let more = match all.len() {
                n if n > MOST_VALUES => format!(" and {} more", n - MOST_VALUES),
                _ => String::new(),
            };
            format!("{}{unit}{more}", told.join(", "))
        }
    }
}

fn law(law: Law, unit: &str) -> String {
    let of = |numbers: [f64; 2]| numbers.map(shortest);
    match law {
        Law::Uniform(ends) => {
            let [a, b] = of(ends);
            format!("drawn, uniform from {a} to {b}{unit}")
        }
        Law::LogUniform(ends) => {
            let [a, b] = of(ends);
            format!("drawn, log-uniform from {a} to {b}{unit}")
        }
        Law::Normal(numbers) => {
            let [mean, deviation] = of(numbers);
            format!("drawn, normal, mean {mean}{unit}, standard deviation {deviation}{unit}")
        }
    }
}

/// How many runs a plan has, and of what.
pub(super) fn runs(plan: &Plan) -> String {
    let n = plan.n_runs().unwrap_or_default();
    let points = plan.n_points().unwrap_or_default();
    let grid = if plan.axes.is_empty() { String::new() } else { count_of(points, "grid point") };
    let Some(Random { samples, seed, sampling, keys }) = &plan.random else {
        return format!("{n}: {grid}");
    };
    let each = match design(plan) {
        Some(_) => {
            format!("{} of {} runs", count_of(*samples, "sample"), saltelli::runs(keys.len()))
        }
        None => count_of(*samples, "draw"),
    };
    let at = if grid.is_empty() { String::new() } else { format!("{grid}, at each ") };
    format!("{n}: {at}{each} ({}, seed {seed})", sampling.word())
}

/// Why runs failed, the commonest reason first.
pub(super) fn reasons(reasons: &[Reason]) -> Vec<String> {
    let told = |Reason { first, n }: &Reason| match n {
        1 => format!("1 run: {first}"),
        n => format!("{n} runs, as the first of them: {first}"),
    };
    let mut told: Vec<String> = reasons.iter().take(MOST_WORDS).map(told).collect();
    if reasons.len() > MOST_WORDS {
        let rest: u64 = reasons.iter().skip(MOST_WORDS).map(|reason| reason.n).sum();
        let others = count_of(reasons.len() - MOST_WORDS, "other reason");
        told.push(format!("{} for {others}", count_of(rest, "run")));
    }
    told
}

/// The shares of words.
pub(super) fn shares(words: &[(String, u64)]) -> String {
    let all: u64 = words.iter().map(|(_, n)| n).sum();
    let share = |n: u64| format!("{} % ({n})", percent(n as f64 / all as f64));
    let name = |word: &str| if word.is_empty() { "none" } else { word }.to_owned();
    let mut told: Vec<String> = words
        .iter()
        .take(MOST_WORDS)
        .map(|(word, n)| format!("{} {}", name(word), share(*n)))
        .collect();
    if words.len() > MOST_WORDS {
        let rest: u64 = words.iter().skip(MOST_WORDS).map(|(_, n)| n).sum();
        let others = count_of(words.len() - MOST_WORDS, "other");
        told.push(format!("{others} {}", share(rest)));
    }
    if told.is_empty() { "no run".to_owned() } else { told.join(", ") }
}

/// A part in per cent, to three digits.
fn percent(part: f64) -> String {
    rounded_to(100.0 * part, 3).to_string()
}

/// What is known of the errors of runs.
pub(super) fn checked(checked: &Checked) -> String {
    let Checked { n, judged, right, worst } = checked;
    let largest = match worst {
        Some((e, run)) => format!(" The largest estimated e is {e:.1e}, of run {run}."),
        None => String::new(),
    };
    match n {
        0 => "No run has an estimate of its error.".to_owned(),
        _ => format!(
            "Errors are estimated by tight runs beside {}. Events can be judged in {judged}, and are right in {right}.{largest}",
            count_of(*n, "run")
        ),
    }
}

/// Which key a column of numbers follows most, and how much; none for words.
pub(super) fn follows(findings: &Findings, column: &str) -> Option<String> {
    let (_, said) = findings.summary.columns.iter().find(|(own, _)| own == column)?;
    match said {
        Said::Words(_) => return None,
        Said::Numbers(_, None) => return Some("No run has it.".to_owned()),
        own if !own.varies() => return Some("It is the same in all runs.".to_owned()),
        Said::Numbers(..) => {}
    }
    let mut all = findings.summary.follows.iter().filter(|own| own.column == column);
    let Some(Follows { key, correlation, .. }) = all.next() else {
        return Some("No key of numbers varies with it.".to_owned());
    };
    let Correlation { rho, n } = *correlation;
    let chance = correlation.by_chance();
    if rho.abs() <= chance {
        return Some(format!(
            "It follows no key beyond chance: |ρ| is at most {:.2}, and {chance:.2} is chance in {n} runs.",
            rho.abs()
        ));
    }
    let how = if rho > 0.0 { "rises" } else { "falls" };
    let part = percent((rho * rho * 100.0).round() / 100.0);
    let mut text = format!(
        "It {how} with {key} most: ρ = {}, {part} % of the variance of its ranks.",
        signed(rho)
    );
    if let Some(next) = all.next().filter(|next| next.correlation.rho.abs() > chance) {
        text += &format!(" Then comes {}, ρ = {}.", next.key, signed(next.correlation.rho));
    }
    Some(text)
}

/// A number between −1 and 1 to two decimals, with the sign that it is printed with.
fn signed(x: f64) -> String {
    format!("{x:.2}").replace('-', "−")
}

/// What Sobol indices of a column say, at each grid point.
pub(super) fn explained(sobol: &Sobol) -> String {
    let point = |point: &crate::sweep::sobol::Point| match point.title() {
        at if at.is_empty() => point.finding(),
        at => format!("At {at}: {}", point.finding()),
    };
    match &sobol.points[..] {
        [] => "It has no indices: it does not vary, or too few samples have it in all their runs."
            .to_owned(),
        points => {
            let mut text: Vec<String> = points.iter().map(point).collect();
            text.extend(Some(sobol.gaps()).filter(|gaps| !gaps.is_empty()));
            text.join(" ")
        }
    }
}
