//! What the files of a study say of its subject, beside what was measured.

use crate::study::machine::Machine;

/// A study's subject, in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// What was studied, in some words: ``Reading `pin` ``.
    pub subject: String,
    /// The question, in some sentences.
    pub lead: String,
    /// Names and what they are.
    pub facts: Vec<(String, String)>,
    /// What to know of it before anything is run.
    pub warnings: Vec<String>,
    /// Columns of `study.csv` before all others, the same in every row: name, meaning and value.
    pub leading: Vec<(&'static str, &'static str, String)>,
    /// How to do it again.
    pub redo: Vec<super::html::Part>,
}

impl About {
    /// A subject of this name.
    pub fn new(subject: impl Into<String>) -> Self {
        let lead = "Free motion and contact follow each other; each change is an event, the zero crossing of a guard. \
                    Every method runs over its tolerances or steps, every run is measured against an event-exact \
                    reference: which one reaches an error at the least cost?";
        Self { subject: subject.into(), lead: lead.into(), ..Self::default() }
    }
}

/// Where and when a study was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The machine, where it is known.
    pub machine: Option<Machine>,
    /// When, where it is known.
    pub time: Option<String>,
}
