//! The columns of `runs.csv`: what a run tells at its end, by name, and which of them the runs of a plan have.

use std::collections::HashSet;
use std::fmt;
use std::ops::Range;

use deltazero_solvers::{Outcome, Stats};
use deltazero_study::Part;
use deltazero_study::brief::{Brief, BriefShape, SiteBrief};
use deltazero_study::energy_balance::Balance;
use deltazero_study::errors::contact_summary::ContactSummary;
use deltazero_study::horizon::{Estimate, Horizon};
use serde_json::Value;

use super::plan::{Plan, Values};
use crate::config::Varied;
use crate::mechanisms::text::column_of;

/// What a row has in a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// A number; what is not finite is left empty.
    Number(Option<f64>),
    /// A count.
    Count(u64),
    /// A word.
    Text(String),
}

/// What all cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellKind {
    /// Numbers.
    Number,
    /// Whole numbers.
    Count,
    /// True or false.
    Truth,
    /// Words.
    Text,
}

impl CellKind {
    /// That of the column of a key which takes these values.
    fn of(values: &Values) -> Self {
        let all = match values {
            Values::Linear { whole, .. } | Values::Log { whole, .. } => {
                return if *whole { Self::Count } else { Self::Number };
            }
            Values::List(all) => all,
        };
        if all.iter().all(Value::is_i64) {
            Self::Count
        } else if all.iter().all(Value::is_number) {
            Self::Number
        } else if all.iter().all(Value::is_boolean) {
            Self::Truth
        } else {
            Self::Text
        }
    }
}

impl fmt::Display for CellKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Number => "number",
            Self::Count => "whole number",
            Self::Truth => "true or false",
            Self::Text => "word",
        })
    }
}

/// The name of a column with the unit of its numbers, empty for none, and what its cells are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Head {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) kind: CellKind,
}

impl Head {
    fn new(name: impl Into<String>, unit: impl Into<String>, kind: CellKind) -> Self {
        Self { name: name.into(), unit: unit.into(), kind }
    }

    fn number(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self::new(name, unit, CellKind::Number)
    }

    fn count(name: impl Into<String>) -> Self {
        Self::new(name, "", CellKind::Count)
    }

    pub(super) fn text(name: impl Into<String>) -> Self {
        Self::new(name, "", CellKind::Text)
    }
}

/// The heads of all columns of the runs of a plan: number, keys, status, and what a run tells. A parameter of a model with the
/// name of another column has its long name.
pub(super) fn heads_of_rows(plan: &Plan, varied: &[Varied], told: &[Head]) -> Vec<Head> {
    let (run, status) = (Head::count("run"), Head::text("status"));
    let is_taken = |key: &str| [&run, &status].into_iter().chain(told).any(|head| head.name == key);
    let own = |key: &str| column_of(key, is_taken(key));
    let axes = plan.axes.iter().map(|axis| (&axis.key, CellKind::of(&axis.values)));
    let drawn = plan.random.iter().flat_map(|random| &random.keys);
    let drawn = drawn.map(|draw| (&draw.key, CellKind::Number));
    let keys = axes.chain(drawn).zip(varied);
    let keys: Vec<Head> =
        keys.map(|((key, kind), varied)| Head::new(own(key), &varied.unit, kind)).collect();
    [run].into_iter().chain(keys).chain([status]).chain(told.iter().cloned()).collect()
}

/// How the cell of a column is taken from a value of type `T`.
enum Of<T> {
    Number(fn(&T) -> Option<f64>),
    Count(fn(&T) -> u64),
}

/// A column with its name and unit.
struct Column<T> {
    name: &'static str,
    unit: &'static str,
    of: Of<T>,
}

/// The columns of the contacts of a site, or of all.
const CONTACTS: [Column<ContactSummary>; 5] = [
    Column { name: "n_contacts", unit: "", of: Of::Count(|contacts| contacts.n as u64) },
    Column { name: "peak_force_n", unit: "N", of: Of::Number(|contacts| contacts.peak_force_n) },
    Column { name: "deepest_m", unit: "m", of: Of::Number(|contacts| contacts.deepest_m) },
    Column {
        name: "largest_impact_speed_m_s",
        unit: "m/s",
        of: Of::Number(|contacts| contacts.largest_impact_speed_m_s),
    },
    Column {
        name: "impulse_n_s",
        unit: "N s",
        of: Of::Number(|contacts| Some(contacts.impulse_n_s)),
    },
];

/// The columns of energy.
const ENERGY: [Column<Balance>; 3] = [
    Column { name: "work_j", unit: "J", of: Of::Number(|balance| Some(balance.work)) },
    Column { name: "dissipated_j", unit: "J", of: Of::Number(|balance| Some(balance.dissipated)) },
    Column {
        name: "energy_residual_j",
        unit: "J",
        of: Of::Number(|balance| Some(balance.residual)),
    },
];

/// The columns of work.
const WORK: [Column<Stats>; 3] = [
    Column { name: "n_rhs", unit: "", of: Of::Count(|stats| stats.work.n_rhs) },
    Column { name: "n_accepted", unit: "", of: Of::Count(|stats| stats.n_accepted) },
    Column { name: "n_rejected", unit: "", of: Of::Count(|stats| stats.n_rejected) },
];

/// The heads of columns, each name after `prefix`.
fn headed<T>(prefix: &str, columns: &[Column<T>]) -> impl Iterator<Item = Head> {
    columns.iter().map(move |column| {
        let kind = match column.of {
            Of::Number(_) => CellKind::Number,
            Of::Count(_) => CellKind::Count,
        };
        Head::new(format!("{prefix}{}", column.name), column.unit, kind)
    })
}

/// What columns have of `told`.
fn told<T>(columns: &[Column<T>], told: &T) -> impl Iterator<Item = Cell> {
    columns.iter().map(move |column| match column.of {
        Of::Number(of) => Cell::Number(of(told)),
        Of::Count(of) => Cell::Count(of(told)),
    })
}

/// A subject with what its runs tell of.
struct Shape {
    parts: Vec<(Vec<String>, BriefShape)>,
}

impl Shape {
    /// What the runs of these parts of a subject tell of, with their contacts and energy or without.
    fn of<'a>(parts: impl Iterator<Item = &'a Part>, audit: bool) -> Self {
        let part = |part: &Part| (prefixes(part), part.brief_shape(audit));
        Self { parts: parts.map(part).collect() }
    }

    fn n_sites(&self) -> usize {
        self.parts.iter().map(|(prefixes, _)| prefixes.len()).sum()
    }

    /// The heads of the columns, in the order of [`cells`].
    fn heads(&self) -> Vec<Head> {
        let mut heads = vec![Head::text("outcome")];
        let mut of_model = Vec::new();
        for (prefixes, shape) in &self.parts {
            for (prefix, columns) in prefixes.iter().zip(&shape.columns) {
                heads.push(Head::number(format!("{prefix}t_s"), "s"));
                heads.push(Head::text(format!("{prefix}mode")));
                of_model.push(heads.len()..heads.len() + columns.len());
                heads.extend(columns.iter().map(|own| {
                    Head::number(format!("{prefix}{}", own.header()), own.unit.as_ref())
                }));
            }
        }
        if self.n_sites() > 1 {
            for (prefixes, shape) in &self.parts {
                for prefix in prefixes {
                    heads.push(Head::count(format!("{prefix}n_events")));
                    heads.extend(headed(prefix, &CONTACTS).filter(|_| shape.has_contacts));
                }
            }
        }
        let has_contacts = self.parts.iter().any(|(_, shape)| shape.has_contacts);
        let has_energy = self.parts.iter().any(|(_, shape)| shape.has_energy);
        heads.push(Head::count("n_events"));
        heads.extend(headed("", &CONTACTS).filter(|_| has_contacts));
        heads.extend(headed("", &ENERGY).filter(|_| has_energy));
        heads.extend(headed("", &WORK));
        heads.push(Head::text("warnings"));
        distinct(&mut heads, &of_model);
        heads
    }
}

/// What stands before the columns of each site: `bay2_joint1_`.
fn prefixes(part: &Part) -> Vec<String> {
    let prefix = |labels: &Vec<(&str, usize)>| {
        labels.iter().map(|(name, value)| format!("{name}{value}_")).collect()
    };
    part.labels.iter().map(prefix).collect()
}

/// Adds a number to a name that another column has already: of parts that nothing tells apart, and of a state or an observable
/// that has the name of a result, which keeps it.
fn distinct(heads: &mut [Head], of_model: &[Range<usize>]) {
    let is_of_model = |at: usize| of_model.iter().any(|range| range.contains(&at));
    let estimate = heads_of_estimate().map(|head| head.name);
    let mut taken: HashSet<String> = estimate.into_iter().collect();
    for is_turn in [false, true] {
        for (_, head) in heads.iter_mut().enumerate().filter(|(at, _)| is_of_model(*at) == is_turn)
        {
            let name = head.name.clone();
            let mut n = 1;
            while !taken.insert(head.name.clone()) {
                n += 1;
                head.name = format!("{name}_{n}");
            }
        }
    }
}

/// What a run tells in the columns of its shape; `parts` are those of its subject, and what became of them.
pub(super) fn cells(parts: &[(Part, Brief)], cells: &mut Vec<Cell>) {
    cells.clear();
    cells.push(Cell::Text(outcome(parts).to_owned()));
    for (_, brief) in parts {
        for site in &brief.sites {
            cells.push(Cell::Number(Some(brief.run.t)));
            cells.push(Cell::Text(site.mode.clone()));
            cells.extend(site.values.iter().map(|value| Cell::Number(Some(*value))));
        }
    }
    let sites = || parts.iter().flat_map(|(_, brief)| &brief.sites);
    if sites().nth(1).is_some() {
        for SiteBrief { n_events, contacts, .. } in sites() {
            cells.push(Cell::Count(*n_events as u64));
            cells.extend(contacts.iter().flat_map(|contacts| told(&CONTACTS, contacts)));
        }
    }
    cells.push(Cell::Count(sites().map(|site| site.n_events as u64).sum()));
    let contacts = sites().filter_map(|site| site.contacts).reduce(together);
    cells.extend(contacts.iter().flat_map(|contacts| told(&CONTACTS, contacts)));
    let balances = parts.iter().filter_map(|(_, brief)| brief.balance);
    let balance = balances.reduce(|mut sum, own| {
        sum += own;
        sum
    });
    cells.extend(balance.iter().flat_map(|balance| told(&ENERGY, balance)));
    let mut stats = Stats::default();
    parts.iter().for_each(|(_, brief)| stats += brief.run.stats);
    cells.extend(told(&WORK, &stats));
    cells.push(Cell::Text(warnings(parts)));
}

/// The heads of all that a run of these parts tells under `plan`.
pub(super) fn heads_of_run<'a>(parts: impl Iterator<Item = &'a Part>, plan: &Plan) -> Vec<Head> {
    let mut heads = Shape::of(parts, plan.audit).heads();
    if plan.check > 0.0 {
        heads.extend(heads_of_estimate());
    }
    heads
}

/// The heads of what an [estimate](estimated) tells.
fn heads_of_estimate() -> [Head; 3] {
    [Head::number("horizon_s", "s"), Head::number("estimated_e", ""), Head::text("events_right")]
}

/// What tight runs tell of a run to `t_end`; all empty where there are none.
pub(super) fn estimated(estimate: Option<Estimate>, t_end: f64, cells: &mut Vec<Cell>) {
    let horizon = estimate.and_then(|own| match own.horizon {
        Horizon::WholeRun => Some(t_end),
        Horizon::LostAt(t) => Some(t),
        Horizon::NotMeasured => None,
    });
    let word = |is_right| if is_right { "yes" } else { "no" }.to_owned();
    cells.push(Cell::Number(horizon));
    cells.push(Cell::Number(estimate.and_then(|own| own.e)));
    cells.push(Cell::Text(estimate.and_then(|own| own.has_events).map_or_else(String::new, word)));
}

/// The contacts of two sites in the same few numbers.
fn together(a: ContactSummary, b: ContactSummary) -> ContactSummary {
    let of = |which: fn(f64, f64) -> f64, a: Option<f64>, b: Option<f64>| {
        a.into_iter().chain(b).reduce(which)
    };
    ContactSummary {
        n: a.n + b.n,
        peak_force_n: of(f64::max, a.peak_force_n, b.peak_force_n),
        deepest_m: of(f64::max, a.deepest_m, b.deepest_m),
        largest_impact_speed_m_s: of(
            f64::max,
            a.largest_impact_speed_m_s,
            b.largest_impact_speed_m_s,
        ),
        impulse_n_s: a.impulse_n_s + b.impulse_n_s,
        ..ContactSummary::default()
    }
}

/// The name of the end if every part came to it, `finished` if any ran to the end of its time; empty where one did
/// neither.
fn outcome(parts: &[(Part, Brief)]) -> &'static str {
    let all = |is: fn(&Outcome) -> bool| {
        parts.iter().all(|(_, brief)| brief.run.outcome.as_ref().is_ok_and(is))
    };
    if all(|outcome| *outcome == Outcome::Stopped) {
        parts.first().map_or("finished", |(part, _)| part.end_name.key)
    } else if all(|outcome| matches!(outcome, Outcome::Stopped | Outcome::Finished)) {
        "finished"
    } else {
        ""
    }
}

/// The codes of the warnings, each once.
fn warnings(parts: &[(Part, Brief)]) -> String {
    let mut codes: Vec<&str> = Vec::new();
    for code in parts.iter().flat_map(|(_, brief)| &brief.warnings) {
        if !codes.contains(&code.name()) {
            codes.push(code.name());
        }
    }
    codes.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_stand_twice_are_numbered() {
        let mut heads = ["a", "b", "a", "a"].map(Head::text);
        distinct(&mut heads, &[]);
        assert_eq!(heads.map(|head| head.name), ["a", "b", "a_2", "a_3"]);
    }

    #[test]
    fn a_result_keeps_its_name_and_the_column_of_the_model_is_numbered() {
        let mut heads = ["n_rhs", "x", "estimated_e", "n_rhs", "n_rhs_2"].map(Head::text);
        distinct(&mut heads, std::slice::from_ref(&(0..3)));
        let names = heads.map(|head| head.name);
        assert_eq!(names, ["n_rhs_3", "x", "estimated_e_2", "n_rhs", "n_rhs_2"]);
    }
}
