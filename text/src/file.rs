//! A checked file: what the crate's users hold.

use std::path::Path;

use toml::de::DeTable;

use deltazero_study::{Part, Subject};

use crate::columns::check_columns;
use crate::compile::{Compiled, compile};
use crate::declarations::{Declarations, PartDeclaration, declarations};
use crate::dimensions::{check_units, contact_units, unread_units};
use crate::document::not_toml;
use crate::groups::check_groups;
use crate::leftovers::leftovers;
use crate::names::Names;
use crate::report::{Checked, Complaint, Report, Source, Span};
use crate::shape::parameters_of_shape;
use crate::system::TextModel;

/// What to do with a value out of its range.
const RANGE: &str = "give another value, or change `min`, `max`, `above`, `below` of the parameter";

/// Bytes of a file, at most.
const MOST_BYTES: usize = 1_000_000;

/// A file that was parsed and checked: its equations hold together, and compile with the values that it gives.
#[derive(Clone, Debug)]
pub struct ModelFile {
    source: Source,
    file: Declarations,
    names: Names,
    parameters: Vec<Parameter>,
    warnings: Vec<Complaint>,
}

/// A number of a model that a user may set.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Value in the file.
    pub value: f64,
    /// Unit; empty where none is given.
    pub unit: String,
    /// What it is, in some words; empty where none are given.
    pub about: String,
    /// Values that it may have.
    pub range: Range,
}

/// Values that a parameter may have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// All values are above it.
    pub above: Option<f64>,
    /// All values are below it.
    pub below: Option<f64>,
}

impl Range {
    /// What a value breaks, as the end of a sentence.
    fn broken_by(&self, x: f64) -> Option<String> {
        let bounds = [
            (self.min.filter(|min| x < *min), "at least"),
            (self.max.filter(|max| x > *max), "at most"),
            (self.above.filter(|above| x <= *above), "above"),
            (self.below.filter(|below| x >= *below), "below"),
        ];
        bounds.into_iter().find_map(|(bound, words)| Some(format!("{words} {}", bound?)))
    }
}

impl ModelFile {
    /// Parses and checks the text of a file, which messages call `name`.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn parse(name: &str, text: &str) -> Result<Self, Report> {
        let source = Source { name: name.into(), text: text.into() };
        Self::checked(&source).map_err(|complaint| source.error(complaint))
    }

    fn checked(source: &Source) -> Checked<Self> {
        let text = &*source.text;
        let start = Span { start: 0, end: 0 };
        if text.len() > MOST_BYTES {
            let complaint = Complaint::new(start, format!("a file has {MOST_BYTES} bytes at most"));
            return Err(
                complaint.help("many states of one kind are a vector: `x = { length = \"n\" }`")
            );
        }
        let table = DeTable::parse(text).map_err(|error| not_toml(text, &error))?;
        let file = declarations(text, table.get_ref())?;
        let names = Names::new(&file)?;
        check_columns(&file)?;
        check_groups(&file)?;
        let parameters = parameters(&file)?;
        let mut checked =
            Self { source: source.clone(), file, names, parameters, warnings: Vec::new() };
        let of_parts = checked.compiled(&[], checked.file.t_end)?;
        let doubts = check_units(&checked.file, &checked.names)?;
        let of_parts = of_parts.into_iter().flat_map(|part| part.warnings);
        let of_units = contact_units(&checked.file, &checked.names).into_iter();
        let of_units = of_units.chain(unread_units(&checked.file)).chain(doubts);
        checked.warnings = of_parts.chain(of_units).collect();
        checked.warnings.sort_by_key(|warning| warning.place());
        checked.warnings.dedup_by_key(|warning| warning.place());
        Ok(checked)
    }

    /// The name of the model; that of its file, without folder and ending, where the file gives none.
    pub fn name(&self) -> &str {
        let of_file = || Path::new(&*self.source.name).file_stem()?.to_str();
        if self.file.name.is_empty() { of_file().unwrap_or_default() } else { &self.file.name }
    }

    /// What messages call the file.
    pub fn file_name(&self) -> &str {
        &self.source.name
    }

    /// Sentences about the model.
    pub fn about(&self) -> &str {
        &self.file.about
    }

    /// Where its equations and numbers are from.
    pub fn source(&self) -> &str {
        &self.file.source
    }

    /// Its parameters, in the order of the file.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Whether this is the name of a state, or of a vector of them.
    pub fn has_state(&self, name: &str) -> bool {
        self.file.states.iter().any(|state| state.name.value == name)
    }

    /// The end of the runs that it gives [s].
    pub fn t_end(&self) -> Option<f64> {
        self.file.t_end
    }

    /// What is not wrong but should be looked at.
    pub fn warnings(&self) -> Vec<Report> {
        self.warnings.iter().map(|warning| self.source.warning(warning.clone())).collect()
    }

    /// What the file declares and does not use, as warnings: parameters, discrete values, modes.
    pub fn leftovers(&self) -> Vec<Report> {
        let all = leftovers(&self.file).into_iter();
        all.map(|warning| self.source.warning(warning)).collect()
    }

    /// What is wrong with a setting of the program that stands on a line of the file, counted from 1: at the last of the `words`
    /// that is on the line, each looked for after the one before, else at all of it.
    pub fn report_of_line(&self, line: usize, words: &[&str], message: &str, help: &str) -> Report {
        let text = &*self.source.text;
        let start = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let own = text[start..].lines().next().unwrap_or_default();
        let (mut from, mut end) = (own.len() - own.trim_start().len(), own.trim_end().len());
        let mut seen = 0;
        for word in words.iter().filter(|word| !word.is_empty()) {
            if let Some(at) = own[seen..].find(word) {
                (from, end) = (seen + at, seen + at + word.len());
                seen = end;
            }
        }
        let span = Span { start: start + from, end: start + end };
        let complaint = Complaint::new(span, message);
        self.source.error(if help.is_empty() { complaint } else { complaint.help(help) })
    }

    /// The systems with these values of parameters, all others as in the file: one for each part.
    ///
    /// # Errors
    /// A name that is none of a parameter, a value out of its range, or what is wrong with the equations at these values.
    pub fn models(&self, values: &[(String, f64)]) -> Result<Vec<TextModel>, Report> {
        match self.compiled(values, self.file.t_end) {
            Ok(parts) => Ok(parts.into_iter().map(|part| part.model).collect()),
            Err(complaint) => Err(self.source.error(complaint)),
        }
    }

    /// The [models](Self::models) as what a study to `t_end` \[s\] is about.
    ///
    /// # Errors
    /// As [`models`](Self::models).
    pub fn subject(&self, values: &[(String, f64)], t_end: f64) -> Result<Subject, Report> {
        let parts = self.compiled(values, Some(t_end)).map_err(|error| self.source.error(error))?;
        Ok(Subject { parts: parts.into_iter().map(|own| part(own.model)).collect() })
    }

    /// Whether the number of states or observables may follow from the value of this parameter.
    pub fn is_of_shape(&self, parameter: &str) -> bool {
        parameters_of_shape(&self.file).contains(&parameter)
    }

    /// Whether a part gives this parameter a value of its own, so that none can be set for all parts.
    pub fn is_set_by_parts(&self, parameter: &str) -> bool {
        let all = self.file.parts.iter().flat_map(|part| &part.parameters);
        all.into_iter().any(|(name, _)| name.value == parameter)
    }

    /// The same file by another name in messages.
    pub fn renamed(&self, name: &str) -> Self {
        let mut own = self.clone();
        own.source.name = name.into();
        own
    }

    fn compiled(&self, values: &[(String, f64)], t_end: Option<f64>) -> Checked<Vec<Compiled>> {
        let mut parameters: Vec<f64> = self.parameters.iter().map(|own| own.value).collect();
        for (name, value) in values {
            let i = self.parameter(name, Span { start: 0, end: 0 })?;
            self.check_range(i, *value, self.file.parameters[i].name.span)?;
            parameters[i] = *value;
        }
        if self.file.parts.is_empty() {
            return Ok(vec![compile(
                &self.source,
                &self.file,
                &self.names,
                parameters,
                None,
                t_end,
            )?]);
        }
        self.check_shape_of_parts(&parameters)?;
        let parts = self.file.parts.iter();
        parts.map(|part| self.part(part, parameters.clone(), values, t_end)).collect()
    }

    fn part(
        &self,
        part: &PartDeclaration,
        mut parameters: Vec<f64>,
        values: &[(String, f64)],
        t_end: Option<f64>,
    ) -> Checked<Compiled> {
        for (name, value) in &part.parameters {
            let i = self.parameter(&name.value, name.span)?;
            let file = self.parameters[i].value;
            if values.iter().any(|(given, x)| *given == name.value && *x != file) {
                let message = format!("`{}` is set by parts and cannot be set for all", name.value);
                let help = "leave it out here, or take it out of the parts";
                return Err(Complaint::new(name.span, message).help(help));
            }
            self.check_range(i, *value, name.span)?;
            parameters[i] = *value;
        }
        compile(&self.source, &self.file, &self.names, parameters, Some(part), t_end)
    }

    /// Checks that all parts have as many states and observables: their rows stand in one table.
    fn check_shape_of_parts(&self, parameters: &[f64]) -> Checked<()> {
        for name in parameters_of_shape(&self.file) {
            let given = self
                .file
                .parts
                .iter()
                .map(|part| part.parameters.iter().find(|(own, _)| own.value == name));
            let common = parameters[self.parameter(name, Span { start: 0, end: 0 })?];
            let mut first = None;
            for own in given {
                let value = own.map_or(common, |(_, value)| *value);
                let (first_value, first_own) = *first.get_or_insert((value, own));
                if let Some((here, _)) = own.or(first_own)
                    && value != first_value
                {
                    let message = format!(
                        "`{name}` is {first_value} in one part and {value} in another, and lengths are made of it"
                    );
                    return Err(Complaint::new(here.span, message).help(
                        "all parts have as many states and observables: give it one value in [parameters], or make each part a file",
                    ));
                }
            }
        }
        Ok(())
    }

    fn parameter(&self, name: &str, span: Span) -> Checked<usize> {
        let found = self.parameters.iter().position(|parameter| parameter.name == name);
        found.ok_or_else(|| {
            let complaint = Complaint::new(span, format!("no parameter is called `{name}`"));
            complaint.nearest(name, self.parameters.iter().map(|parameter| &*parameter.name))
        })
    }

    fn check_range(&self, i: usize, value: f64, span: Span) -> Checked<()> {
        let parameter = &self.parameters[i];
        let broken = if value.is_finite() {
            parameter.range.broken_by(value)
        } else {
            Some("a finite number".to_owned())
        };
        match broken {
            None => Ok(()),
            Some(bound) => {
                let message = format!("`{}` = {value} must be {bound}", parameter.name);
                Err(Complaint::new(span, message).help(RANGE))
            }
        }
    }
}

/// A model as a part of a study, its states in an array where there are as many as most models have: two of a mass, four of two
/// masses, six of a body in the plane. Each number costs some ten seconds of compiling.
fn part(model: TextModel) -> Part {
    match (model.few::<2>(), model.few::<4>(), model.few::<6>()) {
        (Some(two), ..) => Part::new(two),
        (_, Some(four), _) => Part::new(four),
        (.., Some(six)) => Part::new(six),
        _ => Part::new(model),
    }
}

/// The parameters as users see them.
fn parameters(file: &Declarations) -> Checked<Vec<Parameter>> {
    let parameter = |declared: &crate::declarations::ParameterDeclaration| {
        if let Some(bound) = declared.range.broken_by(declared.value) {
            let message = format!("`{}` must be {bound}", declared.name.value);
            return Err(Complaint::new(declared.value_span, message).help(RANGE));
        }
        Ok(Parameter {
            name: declared.name.value.clone(),
            value: declared.value,
            unit: declared.unit.as_ref().map_or(String::new(), |unit| unit.value.clone()),
            about: declared.about.clone(),
            range: declared.range,
        })
    };
    file.parameters.iter().map(parameter).collect()
}
