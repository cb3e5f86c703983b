//! The page of a study: question, answer, figures, runs, method, reference, machine, how to redo it.

use deltazero_solvers::Method;
use deltazero_study::Plan;
use deltazero_study::columns::{Column, Value, shown};
use deltazero_study::digits::count_of;
use deltazero_study::reference::HORIZON_ERROR;
use deltazero_study::work_precision::{BEATEN, Row, SHORT_S, Status, WorkPrecision};

use super::{Heading, Page, Part, Section, Table};
use crate::figures::Picture;
use crate::report::{ANSWER, About, answer_rows};
use crate::study::record::Provenance;

/// The page of a study with its figures.
pub fn page(
    about: &About,
    plan: &Plan,
    table: &WorkPrecision,
    provenance: &Provenance,
    pictures: Vec<Picture>,
) -> Page {
    let mut sections = vec![
        section(about.heading(), told(about)),
        section("Answer", answer(table, plan)),
        section("Figures", pictures.into_iter().map(Part::Figure).collect()),
        section("All runs", runs(about, &table.rows)),
        section("Method", method(table, plan)),
        section("Reference", reference(table)),
        section("Machine", vec![Part::Facts(machine(provenance))]),
    ];
    if !about.redo.is_empty() {
        sections.push(section("Redo it", about.redo.clone()));
    }
    Page { title: about.question(), lead: about.lead.clone(), sections }
}

fn section(title: &str, parts: Vec<Part>) -> Section {
    Section { title: title.into(), parts }
}

fn fact(name: &str, what: impl Into<String>) -> (String, String) {
    (name.into(), what.into())
}

/// The subject, and what to know of it.
fn told(about: &About) -> Vec<Part> {
    let mut facts = vec![fact("Subject", about.subject.clone())];
    facts.extend(about.facts.iter().cloned());
    let warnings = about.warnings.iter().cloned().map(Part::Text);
    std::iter::once(Part::Facts(facts)).chain(warnings).collect()
}

fn answer(table: &WorkPrecision, plan: &Plan) -> Vec<Part> {
    let rows = &table.rows;
    let count = |status| rows.iter().filter(|row| row.status == status).count();
    let cells = answer_rows(table).into_iter();
    vec![
        Part::Table(Table {
            caption: "The run of the shortest processor time among those whose error e is at most so large"
                .into(),
            columns: ANSWER.iter().map(|name| heading(name, "")).collect(),
            rows: cells.map(|row| row.into_iter().map(Value::Text).collect()).collect(),
        }),
        Part::Text(format!(
            "{}: {} ok, {} failed, {} cut at {} right-hand sides or {} s. e alone ranks: a run may reach a \
             loose error with events missed. Times are of one machine; their ratios travel better.",
            count_of(rows.len(), "run"),
            count(Status::Ok),
            count(Status::Failed),
            count(Status::Cut),
            plan.max_rhs,
            plan.max_seconds
        )),
    ]
}

fn heading(name: &str, about: &str) -> Heading {
    Heading { name: name.into(), about: about.into() }
}

/// Every run with the columns in which runs differ; what all have in common is said once.
fn runs(subject: &About, rows: &[Row]) -> Vec<Part> {
    let common = |column: &&Column| {
        let mut values = rows.iter().map(|row| (column.value)(row));
        let first = values.next();
        values.all(|value| Some(value) == first)
    };
    let columns = shown(rows);
    let (same, differing): (Vec<&Column>, Vec<&Column>) = columns.iter().copied().partition(common);
    let same = same.iter().filter_map(|column| {
        let value = text((column.value)(rows.first()?));
        (!value.is_empty()).then(|| format!("{} {value}", column.label()))
    });
    let leading = subject.leading.iter().map(|(name, _, value)| format!("{name} {value}"));
    let same: Vec<String> = leading.chain(same).collect();
    let mut caption = format!("{}, in the order of the configuration", count_of(rows.len(), "run"));
    if !same.is_empty() {
        caption += &format!("; the same in all: {}", same.join(", "));
    }
    let leading = subject.leading.iter().map(|(name, about, _)| fact(name, *about));
    let about = leading.chain(columns.iter().map(|column| fact(&column.label(), column.about)));
    vec![
        Part::Folded("What the columns mean".into(), vec![Part::Facts(about.collect())]),
        Part::Table(Table {
            caption,
            columns: differing.iter().map(|c| heading(&c.label(), c.about)).collect(),
            rows: rows
                .iter()
                .map(|row| differing.iter().map(|column| (column.value)(row)).collect())
                .collect(),
        }),
    ]
}

fn text(value: Value) -> String {
    match value {
        Value::Text(text) => text,
        Value::Number(x) => super::number(x),
        Value::Count(n) => n.map_or_else(String::new, |n| n.to_string()),
    }
}

fn method(table: &WorkPrecision, plan: &Plan) -> Vec<Part> {
    let mut methods: Vec<&Method> = plan.settings.iter().map(|setting| setting.method).collect();
    methods.dedup_by_key(|method| method.name);
    let row = |method: &Method| {
        let order = Value::Count(Some(method.order as u64));
        vec![Value::Text(method.name.into()), order, Value::Text(method.about.into())]
    };
    vec![
        Part::Text(
            "Located: the mode is frozen within a step, and every step that crosses the zero of a guard is retaken until it \
             ends there. Blind: the mode is read off the state at every stage, as a model written with branches \
             does."
                .into(),
        ),
        Part::Text(format!(
            "The error e is the worst sample's {}. Events pair in order with those of the reference; missed and \
             spurious are those without a partner. The time of a run is that of its thread on the processor, the shortest of {} in turns \
             round all runs, with {} at the same time. A run that warns of itself is timed once, and so is one of more than \
             {} ms that took more than {BEATEN} times as long as another of no larger error, unless that has events wrong and \
             it has not.",
            table.reference.measure(), count_of(plan.repeats, "repeat"), count_of(plan.threads, "run"), 1e3 * SHORT_S
        )),
        Part::Table(Table {
            caption: "The methods compared".into(),
            columns: ["method", "order", "what it is for"].map(|name| heading(name, "")).into(),
            rows: methods.into_iter().map(row).collect(),
        }),
    ]
}

fn reference(table: &WorkPrecision) -> Vec<Part> {
    let reference = &table.reference;
    let times = reference.event_time_agreement_s;
    let facts = vec![
        fact("Made by", reference.method.clone()),
        fact("Checked by", reference.check.clone()),
        fact("Its own error", format!("e = {}, by the check", reference.own_error())),
        fact(
            "Its event times",
            times.map_or_else(
                || "not decided: the check has other events".into(),
                |t| format!("good to {t:.1e} s, by the check"),
            ),
        ),
        fact(
            "Horizon",
            format!(
                "{} s, part by part: up to there a last-bit change of the start grows to no more than \
                 e = {HORIZON_ERROR:e}, and errors are taken",
                reference.horizons()
            ),
        ),
    ];
    let limits = table.limits().into_iter().map(Part::Text);
    std::iter::once(Part::Facts(facts)).chain(limits).collect()
}

/// The program, and the machine that it ran on.
pub(super) fn machine(provenance: &Provenance) -> Vec<(String, String)> {
    let mut facts = vec![fact("Program", format!("deltazero {}", provenance.version))];
    if let Some(machine) = &provenance.machine {
        facts.extend([
            fact("Built by", machine.built_by.clone()),
            fact("Processor", machine.cpu.clone().unwrap_or_else(|| "not known".into())),
            fact("Cores", machine.cores.to_string()),
            fact("System", machine.os.clone()),
        ]);
    }
    facts.extend(provenance.time.as_ref().map(|time| fact("Measured", time.clone())));
    facts
}
