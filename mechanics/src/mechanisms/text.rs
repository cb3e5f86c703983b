//! A model from a text file as a mechanism.

use std::sync::Arc;

use deltazero_study::Subject;
use deltazero_study::warning::{Code, Warning};
use deltazero_text::{ModelFile, Parameter};
use serde_json::{Map, Value, json};

use super::in_words::fact;
use super::{Chosen, Entry, Mechanism};
use crate::keys::Shared;

/// The table of a configuration that holds a model.
pub const MODEL: &str = "model";
/// The table of the values of its parameters.
pub const PARAMETERS: &str = "parameters";

/// The name of the column of a parameter: its long one where another column has its own.
pub fn column_of(parameter: &str, is_taken: bool) -> String {
    if is_taken { format!("{PARAMETERS}.{parameter}") } else { parameter.to_owned() }
}

/// Models from files stand in no list: a file chooses its own.
static TEXT: Entry = Entry {
    name: "text",
    about: "a model from a file",
    keys: &[],
    uses: &[],
    defaults: &[],
    has_two_joints: false,
    read: |_| Err(serde::de::Error::custom("a model from a file is given by --model FILE")),
};

/// A model with the values of its parameters.
struct Text {
    file: Arc<ModelFile>,
    subject: Subject,
    values: Vec<(String, f64)>,
}

impl Chosen {
    /// The model `file`, whose text is given, with these values of its parameters, to be run to `t_end` [s]; the others are as
    /// the file has them.
    ///
    /// # Errors
    /// What is wrong with the model at these values.
    pub fn text(
        file: &Arc<ModelFile>,
        text: &str,
        given: &[(String, f64)],
        t_end: f64,
    ) -> Result<Self, deltazero_text::Report> {
        let value = |parameter: &Parameter| {
            let own = given.iter().find(|(name, _)| *name == parameter.name);
            (parameter.name.clone(), own.map_or(parameter.value, |(_, value)| *value))
        };
        let values: Vec<_> = file.parameters().iter().map(value).collect();
        let subject = file.subject(given, t_end)?;
        let parameters: Map<String, Value> =
            values.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        let model = json!({ "name": file.file_name(), "text": text });
        let tables = [(MODEL, model), (PARAMETERS, parameters.into())];
        let tables = tables.map(|(name, table)| (name.to_owned(), table)).into_iter().collect();
        let value = Text { file: Arc::clone(file), subject, values };
        Ok(Self { entry: &TEXT, tables, value: Arc::new(value) })
    }
}

impl Mechanism for Text {
    fn subject(&self, _shared: &Shared) -> Subject {
        self.subject.clone()
    }

    fn n_sites(&self, _shared: &Shared) -> usize {
        self.subject.parts.iter().map(|part| part.sites.len()).sum()
    }

    fn n_tolerances(&self) -> usize {
        self.subject.parts.first().map_or(0, |part| part.states.len())
    }

    fn title(&self, _shared: &Shared) -> String {
        let name = self.file.name();
        let mut letters = name.chars();
        letters
            .next()
            .map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
    }

    fn lead(&self) -> &str {
        self.file.about()
    }

    fn is_model(&self) -> bool {
        true
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let mut facts = vec![fact("Model", self.file.file_name())];
        let unit = |parameter: &Parameter| match parameter.unit.as_str() {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let value = |((name, value), parameter): (&(String, f64), &Parameter)| {
            format!("{name} = {value:?}{}", unit(parameter))
        };
        let parameters: Vec<String> =
            self.values.iter().zip(self.file.parameters()).map(value).collect();
        if !parameters.is_empty() {
            facts.push(fact("Parameters", parameters.join(", ")));
        }
        if !self.file.source().is_empty() {
            facts.push(fact("Source", self.file.source()));
        }
        facts.push(fact("Time", format!("0 to {} s", shared.run.t_end)));
        facts
    }

    fn unit_of(&self, parameter: &str) -> Option<&str> {
        let own = self.file.parameters().iter().find(|own| own.name == parameter)?;
        Some(&own.unit)
    }

    fn warnings(&self, _shared: &Shared) -> Vec<Warning> {
        let warning = |report: deltazero_text::Report| {
            let text = report.to_string();
            let text = text.trim_end();
            let message = text.strip_prefix("warning: ").unwrap_or(text).to_owned();
            Warning { code: Code::NotSmooth, message }
        };
        self.file.warnings().into_iter().map(warning).collect()
    }

    fn no_blind_runs(&self, _shared: &Shared) -> Option<String> {
        Some("the mode of a model from a file is not read off its state".to_owned())
    }
}
