//! The page of a study: question, answer, figures, runs, method, reference, machine, how to redo it.

use deltazero_solvers::Method;

use super::{Heading, Page, Part, Section, Table};
use crate::config::Config;
use crate::figures::Picture;
use crate::reference::{HORIZON_ERROR, ReferenceSummary};
use crate::report::{ANSWER, answer_rows, contact};
use crate::study::columns::{COLUMNS, Column, Value};
use crate::study::record::StudyRecord;
use crate::study::restitution;
use crate::study::work_precision::{Row, Status};

/// The page of a study with its figures.
pub fn page(study: &StudyRecord, pictures: Vec<Picture>) -> Page {
    Page {
        title: "Which integrator, at which setting, for this contact?".into(),
        lead: "A pin rattles in a bush with clearance: free flight, then contact through a stiff spring, \
               with friction; each change is an event, the zero crossing of the penetration δ. Every \
               method runs over its tolerances or steps, every run is measured against an event-exact \
               reference: which one reaches an error at the least cost?"
            .into(),
        sections: vec![
            section("Contact", contact_told(&study.config)),
            section("Answer", answer(study)),
            section("Figures", pictures.into_iter().map(Part::Figure).collect()),
            section("All runs", runs(&study.table.rows)),
            section("Method", method(study)),
            section("Reference", reference(&study.table.reference)),
            section("Machine", vec![Part::Facts(machine(study))]),
            section("Redo it", redo(study)),
        ],
    }
}

fn section(title: &str, parts: Vec<Part>) -> Section {
    Section { title: title.into(), parts }
}

fn fact(name: &str, what: impl Into<String>) -> (String, String) {
    (name.into(), what.into())
}

/// The contact, and what to know of it.
fn contact_told(config: &Config) -> Vec<Part> {
    let warnings = restitution::warnings(config).into_iter().map(|w| Part::Text(w.message));
    std::iter::once(Part::Facts(contact::facts(config))).chain(warnings).collect()
}

fn answer(study: &StudyRecord) -> Vec<Part> {
    let rows = &study.table.rows;
    let count = |status| rows.iter().filter(|row| row.status == status).count();
    let cells = answer_rows(&study.table).into_iter();
    vec![
        Part::Table(Table {
            caption: "The run of the shortest processor time among those whose error e is at most so large"
                .into(),
            columns: ANSWER.iter().map(|name| heading(name, "")).collect(),
            rows: cells.map(|row| row.into_iter().map(Value::Text).collect()).collect(),
        }),
        Part::Text(format!(
            "{} runs: {} ok, {} failed, {} cut at {} right-hand sides or {} s. e alone ranks: a run may reach a \
             loose error with events missed. Times are of one machine; their ratios travel better.",
            rows.len(),
            count(Status::Ok),
            count(Status::Failed),
            count(Status::Cut),
            study.config.study.max_rhs,
            study.config.study.max_seconds
        )),
    ]
}

fn heading(name: &str, about: &str) -> Heading {
    Heading { name: name.into(), about: about.into() }
}

/// Every run with the columns in which runs differ; what all have in common is said once.
fn runs(rows: &[Row]) -> Vec<Part> {
    let common = |column: &&Column| {
        let mut values = rows.iter().map(|row| (column.value)(row));
        let first = values.next();
        values.all(|value| Some(value) == first)
    };
    let (same, differing): (Vec<&Column>, Vec<&Column>) = COLUMNS.iter().partition(common);
    let same = same.iter().filter_map(|column| {
        let value = text((column.value)(rows.first()?));
        (!value.is_empty()).then(|| format!("{} {value}", column.label()))
    });
    let same: Vec<String> = same.collect();
    let mut caption = format!("All {} runs, in the order of the configuration", rows.len());
    if !same.is_empty() {
        caption += &format!("; the same in all: {}", same.join(", "));
    }
    let about = COLUMNS.iter().map(|column| fact(&column.label(), column.about));
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

fn method(study: &StudyRecord) -> Vec<Part> {
    let asked = &study.config.study;
    let methods = asked.methods.iter().filter_map(|name| Method::named(name));
    let row = |method: &Method| {
        let order = Value::Count(Some(method.order as u64));
        vec![Value::Text(method.name.into()), order, Value::Text(method.about.into())]
    };
    vec![
        Part::Text(
            "Located: the mode (free, slip, stick) is frozen within a step, and every step that crosses \
             δ = 0 is retaken until it ends there. Blind: the mode is read off the state at every stage, \
             as a model written with branches does."
                .into(),
        ),
        Part::Text(format!(
            "The error e is the worst sample's larger of pin error over clearance and angle error over \
             the largest angle, {:.4} rad. Events pair in order with those of the reference; missed and \
             spurious are those without a partner. The time of a run is that of its thread on the processor, the shortest of its repeats, {} each in \
             turns round all runs, with {} runs at the same time.",
            study.table.reference.theta_scale_rad, asked.repeats, asked.threads
        )),
        Part::Table(Table {
            caption: "The methods compared".into(),
            columns: ["method", "order", "what it is for"].map(|name| heading(name, "")).into(),
            rows: methods.map(row).collect(),
        }),
    ]
}

fn reference(reference: &ReferenceSummary) -> Vec<Part> {
    let times = reference.event_time_agreement_s;
    let facts = vec![
        fact("Made by", reference.method.clone()),
        fact("Checked by", reference.check.clone()),
        fact("Its own error", format!("e = {:.1e}, by the check", reference.agreement)),
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
    let limits = reference.limits().into_iter().map(Part::Text);
    std::iter::once(Part::Facts(facts)).chain(limits).collect()
}

fn machine(study: &StudyRecord) -> Vec<(String, String)> {
    let mut facts = vec![fact("Program", format!("deltazero {}", study.version))];
    if let Some(machine) = &study.machine {
        facts.extend([
            fact("Built by", machine.built_by.clone()),
            fact("Processor", machine.cpu.clone().unwrap_or_else(|| "not known".into())),
            fact("Cores", machine.cores.to_string()),
            fact("System", machine.os.clone()),
        ]);
    }
    facts.extend(study.time.as_ref().map(|time| fact("Measured", time.clone())));
    facts
}

fn redo(study: &StudyRecord) -> Vec<Part> {
    vec![
        Part::Text("With the configuration below as study.toml:".into()),
        Part::Code("deltazero study study.toml --out redone".into()),
        Part::Text(
            "Errors, events and counts of work come out the same, times do not. The tables, the figures \
             and this page alone, from the directory that holds study.json:"
                .into(),
        ),
        Part::Code("deltazero report DIR".into()),
        Part::Folded("The configuration".into(), vec![Part::Code(study.config.to_toml())]),
    ]
}
