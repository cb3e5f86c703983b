//! What the files of a study say of its subject, beside what was measured.

use super::html::Part;
use crate::config::Config;

/// A study's subject, in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Whether it is called a model; else it is called a contact.
    pub is_model: bool,
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
    pub redo: Vec<Part>,
}

/// What every study asks, after what its subject is.
const QUESTION: &str = "Every method runs over its tolerances or steps, every run is measured against an event-exact \
                        reference: which one reaches an error at the least cost?";

impl About {
    /// What a configuration chooses.
    pub fn of(config: &Config) -> Self {
        let mechanism = &config.mechanism;
        Self {
            is_model: mechanism.is_model(),
            subject: mechanism.title(config),
            lead: format!("{}{QUESTION}", sentence(mechanism.lead())),
            facts: mechanism.facts(config),
            warnings: config.warnings().into_iter().map(|warning| warning.message).collect(),
            leading: mechanism.leading(config),
            redo: redo(config),
        }
    }

    /// A subject of this name.
    pub fn new(subject: impl Into<String>) -> Self {
        let lead = format!(
            "Free motion and contact follow each other; each change is an event, the zero crossing of a guard. {QUESTION}"
        );
        Self { subject: subject.into(), lead, ..Self::default() }
    }

    /// The question that its files ask.
    pub fn question(&self) -> String {
        format!("Which integrator, at which setting, for this {}?", self.heading().to_lowercase())
    }

    /// What it is called, as a heading.
    pub fn heading(&self) -> &'static str {
        if self.is_model { "Model" } else { "Contact" }
    }
}

/// A text that another follows, with the full stop that it may lack.
fn sentence(text: &str) -> String {
    match text.trim() {
        "" => String::new(),
        text if text.ends_with(['.', '!', '?']) => format!("{text} "),
        text => format!("{text}. "),
    }
}

fn redo(config: &Config) -> Vec<Part> {
    vec![
        Part::Text("With the configuration below as study.toml:".into()),
        Part::Code("deltazero study study.toml --out redone".into()),
        Part::Text(
            "Errors, events and counts of work come out the same, times do not. The tables, the figures \
             and this page alone, from the directory that holds study.json:"
                .into(),
        ),
        Part::Code("deltazero report DIR".into()),
        Part::Folded("The configuration".into(), vec![Part::Code(config.to_toml())]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_ends_before_the_next_begins() {
        let all = ["A ball falls", "A ball falls.", "Does it?", ""].map(sentence);
        assert_eq!(all, ["A ball falls. ", "A ball falls. ", "Does it? ", ""]);
    }
}
