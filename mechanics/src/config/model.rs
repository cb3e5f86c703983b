//! A model from a file among the settings: its parameters are keys, and so are the settings that the file holds.

use std::path::Path;
use std::sync::Arc;

use deltazero_study::digits::rounded_to;
use deltazero_text::{ModelFile, Parameter, SETTINGS};
use serde_json::Value;

use super::check::check;
use super::error::ConfigError;
use super::raw_value::{Datum, Given};
use crate::keys::{End, Kind, Range};

use super::toml_source;
use crate::mechanisms::Chosen;
use crate::mechanisms::text::MODEL;

/// A model file, read and checked.
#[derive(Clone)]
pub struct Model {
    file: Arc<ModelFile>,
    text: Arc<str>,
}

impl Model {
    /// The file at `path`.
    ///
    /// # Errors
    /// It cannot be read, or is no model.
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        Self::new(&path.display().to_string(), &toml_source::read(path)?)
    }

    /// The file with this text, which messages call `name`.
    ///
    /// # Errors
    /// It is no model.
    pub fn new(name: &str, text: &str) -> Result<Self, ConfigError> {
        let file = ModelFile::parse(name, text).map_err(refused)?;
        Ok(Self { file: Arc::new(file), text: text.into() })
    }

    /// What the file declares and does not use, as warnings.
    pub fn leftovers(&self) -> Vec<String> {
        self.file.leftovers().iter().map(ToString::to_string).collect()
    }

    /// The same file by another name in messages.
    pub fn renamed(&self, name: &str) -> Self {
        Self { file: Arc::new(self.file.renamed(name)), text: Arc::clone(&self.text) }
    }

    /// The model that a configuration carries in its table `model`, if it carries one.
    ///
    /// # Errors
    /// It is no model.
    pub(super) fn carried_by(given: &Given) -> Result<Option<Self>, ConfigError> {
        let Some(table) = given.entry(MODEL) else { return Ok(None) };
        let word = |name| match table.entry(name).map(|given| &given.datum) {
            Some(Datum::Word(word)) => Ok(word.clone()),
            _ => Err(table.wrong_type(MODEL, "a table with the words name and text")),
        };
        Self::new(&word("name")?, &word("text")?).map(Some)
    }

    /// The same error, with its line shown if that is one of this file.
    pub(super) fn shown(&self, error: ConfigError) -> ConfigError {
        let Some((file, line, words)) =
            error.line().filter(|(file, ..)| *file == self.file.file_name())
        else {
            return error;
        };
        let told = error.to_string();
        let message = told.strip_prefix(&format!("{file}:{line}: ")).unwrap_or(&told);
        let help = error.way_out();
        let message = message.strip_suffix(&help).unwrap_or(message);
        let message = message.trim_end_matches([' ', ':', ';']);
        // Apart from its message, a range or a list of words does not say what it is.
        let help = match error {
            ConfigError::OutOfRange { .. } | ConfigError::UnknownWord { .. } => {
                format!("allowed: {help}")
            }
            _ => help,
        };
        refused(self.file.report_of_line(line, &words, message, &help))
    }

    /// The settings that the file holds.
    ///
    /// # Errors
    /// The text is not TOML; a [`ModelFile`] is.
    pub(super) fn settings(&self) -> Result<Vec<(String, Given)>, ConfigError> {
        let document = toml_source::document(self.file.file_name(), &self.text)?;
        let Datum::Table(entries) = document.datum else { return Ok(Vec::new()) };
        let own = entries.into_iter().filter_map(|(name, given)| match name.as_str() {
            "t_end" => Some(("run.t_end".to_owned(), given)),
            name if SETTINGS.contains(&name) => Some((name.to_owned(), given)),
            _ => None,
        });
        Ok(own.collect())
    }

    /// The parameter of this name.
    pub(super) fn parameter(&self, name: &str) -> Option<&Parameter> {
        // A name that TOML needs quotes for is quoted in a path.
        let name = name.trim_matches('\'');
        self.file.parameters().iter().find(|parameter| parameter.name == name)
    }

    /// Whether a part gives this parameter a value of its own.
    pub(super) fn is_set_by_parts(&self, parameter: &str) -> bool {
        self.file.is_set_by_parts(parameter)
    }

    /// Whether the columns of runs may follow from the value of this parameter.
    pub(super) fn is_of_shape(&self, parameter: &Parameter) -> bool {
        self.file.is_of_shape(&parameter.name)
    }

    /// Whether this is the name of a state.
    pub(super) fn has_state(&self, name: &str) -> bool {
        self.file.has_state(name)
    }

    /// Names of the parameters.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.file.parameters().iter().map(|parameter| parameter.name.as_str())
    }

    /// What is integrated with these values of parameters, to `t_end` [s].
    ///
    /// # Errors
    /// What is wrong with the model at these values.
    pub(super) fn chosen(
        &self,
        values: &[(String, f64)],
        t_end: f64,
    ) -> Result<Chosen, ConfigError> {
        Chosen::text(&self.file, &self.text, values, t_end).map_err(refused)
    }
}

/// The numbers that a parameter takes.
pub(super) fn kind_of(parameter: &Parameter) -> Kind {
    let own = &parameter.range;
    let end = |closed: Option<f64>, open: Option<f64>| match (closed, open) {
        (Some(bound), _) => End::Closed(bound),
        (None, Some(bound)) => End::Open(bound),
        (None, None) => End::Free,
    };
    Kind::Number(Range { low: end(own.min, own.above), high: end(own.max, own.below) })
}

/// The value given to a parameter.
///
/// # Errors
/// No number, or one that the parameter does not take.
pub(super) fn value_of(parameter: &Parameter, given: &Given) -> Result<Value, ConfigError> {
    check(&kind_of(parameter), &parameter.name, &parameter.unit, given)
}

fn refused(report: deltazero_text::Report) -> ConfigError {
    // The command line says itself that it is an error.
    let text = report.to_string();
    let text = text.trim_end();
    ConfigError::Model { report: text.strip_prefix("error: ").unwrap_or(text).into() }
}

/// Defaults of settings that a model has no size for: shares of the end of its runs. Path and value.
pub(super) fn defaults(t_end: f64) -> [(&'static str, String); 3] {
    let share = |part: f64| format!("{:e}", rounded_to(part * t_end, 12));
    let steps = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5].map(share);
    [
        ("run.sample", share(2e-3)),
        ("solver.step", share(1e-4)),
        ("study.steps", format!("[{}]", steps.join(", "))),
    ]
}
