//! The values of all keys, layer upon layer: defaults, file, `--set` in order.

use std::collections::BTreeMap;
use std::path::Path;

use deltazero_text::{Parameter, SETTINGS};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::all_keys::{find, is_of_runs, keys, names_in};
use super::check::check;
use super::error::{ConfigError, Place};
use super::model::{self, Model};
use super::nearest::{nearest_key, nearest_of};
use super::raw_value::{Datum, Given, excerpt};
use super::toml_source;
use crate::keys::{DefaultValue, JOINT_TABLES, JointConfig, Key, Run, one_joint};
use crate::mechanisms::text::{MODEL, PARAMETERS};
use crate::mechanisms::{Chosen, Entry};

/// A default that a model from a file brings: path, value as TOML, and where it is from.
pub(super) type OfModel = (String, String, &'static str);

/// Where defaults of settings are from that a model has no size for.
const SHARE: &str = "a share of run.t_end";

/// What a path leads to.
pub(super) enum Target<'a> {
    /// A parameter of the model.
    Parameter(&'a Parameter),
    /// A key.
    Key(&'static Key),
    /// A table of keys.
    Table,
    /// Nothing.
    Nothing,
}

/// Where the value of a parameter is kept.
pub(super) fn parameter_path(name: &str) -> String {
    format!("{PARAMETERS}.{name}")
}

/// Checked values by path, each with the place it came from.
#[derive(Clone)]
pub(super) struct Values {
    pub(super) values: BTreeMap<String, (Value, Place)>,
    /// The model from a file that is integrated in place of a mechanism; its parameters are keys.
    pub(super) model: Option<Model>,
}

impl Values {
    /// The defaults of the table of keys.
    ///
    /// # Errors
    /// A default that is not TOML or not of its key's kind; a test excludes it.
    pub(super) fn defaults() -> Result<Self, ConfigError> {
        let mut all = Self { values: BTreeMap::new(), model: None };
        for key in keys() {
            if let DefaultValue::Toml(text) = key.default {
                all.apply(key.path, &toml_source::value(text, Place::Default)?)?;
            }
        }
        Ok(all)
    }

    /// Sets all that a document has, and the model that it carries.
    ///
    /// # Errors
    /// The first complaint.
    pub(super) fn apply_all(&mut self, given: &Given) -> Result<(), ConfigError> {
        if let Some(model) = Model::carried_by(given)? {
            self.take_model(model)?;
        }
        self.apply("", given)
    }

    /// Puts a model from a file in the place of the mechanism, with the settings that the file holds.
    ///
    /// # Errors
    /// A setting that is none.
    pub(super) fn take_model(&mut self, model: Model) -> Result<(), ConfigError> {
        let settings = model.settings()?;
        self.model = Some(model.clone());
        let mut settings = settings.iter();
        let applied = settings.try_for_each(|(path, given)| self.apply(path, given));
        applied.map_err(|error| model.shown(error))
    }

    /// The defaults that a model from a file brings to runs up to `t_end` [s]: those that it holds, then those that follow.
    ///
    /// # Errors
    /// As [`take_model`](Self::take_model).
    pub(super) fn of_model(model: Model, t_end: f64) -> Result<Vec<OfModel>, ConfigError> {
        let mut all = Self { values: BTreeMap::new(), model: None };
        all.take_model(model)?;
        let held = all.values.into_iter();
        let held = held.map(|(path, (value, _))| (path, value.to_string(), "the model's own"));
        let shares = model::defaults(t_end).map(|(path, text)| (path.to_owned(), text, SHARE));
        Ok(held.chain(shares).collect())
    }

    /// What is integrated, once its own defaults are in the place of what was not given.
    ///
    /// # Errors
    /// As [`defaults`](Self::defaults), and what is wrong with a model at the values of its parameters.
    pub(super) fn chosen(&mut self) -> Result<Chosen, ConfigError> {
        let Some(model) = self.model.clone() else {
            let entry = self.for_mechanism()?;
            return self.mechanism(entry);
        };
        let t_end: f64 = self.part::<Run>("run")?.t_end;
        for (path, text) in model::defaults(t_end) {
            if self.place(path) == Place::Default {
                self.apply(path, &toml_source::value(&text, Place::Default)?)?;
            }
        }
        let value = |name: &str| {
            let (value, _) = self.values.get(&parameter_path(name))?;
            Some((name.to_owned(), value.as_f64()?))
        };
        model.chosen(&model.names().filter_map(value).collect::<Vec<_>>(), t_end)
    }

    /// The defaults, then the model with its settings, then the TOML file, then every `key=value` of `sets` in order.
    ///
    /// # Errors
    /// The first complaint.
    pub(super) fn load(
        model: Option<Model>,
        file: Option<&Path>,
        sets: &[String],
    ) -> Result<Self, ConfigError> {
        let mut all = Self::defaults()?;
        if let Some(model) = model {
            all.take_model(model)?;
        }
        if let Some(path) = file {
            let text = toml_source::read(path)?;
            all.apply_all(&toml_source::document(&path.display().to_string(), &text)?)?;
        }
        for argument in sets {
            let (key, given) = toml_source::assignment(argument)?;
            all.apply(&key, &given)?;
        }
        Ok(all)
    }

    /// Puts the defaults of the mechanism in the place of what was not given.
    ///
    /// # Errors
    /// As [`defaults`](Self::defaults).
    fn for_mechanism(&mut self) -> Result<&'static Entry, ConfigError> {
        let name: String = self.part("mechanism")?;
        let entry = Entry::named(&name).ok_or_else(|| table("mechanism", &name))?;
        for &(path, text, _) in entry.defaults {
            if self.place(path) == Place::Default {
                self.apply(path, &toml_source::value(text, Place::Default)?)?;
            }
        }
        Ok(entry)
    }

    /// The mechanism with what is given in its own tables.
    fn mechanism(&self, entry: &'static Entry) -> Result<Chosen, ConfigError> {
        let mut own: Vec<&str> = entry.keys.iter().filter_map(Key::table).collect();
        own.dedup();
        let tables = own.into_iter().map(|name| (name.to_owned(), self.table(name, None)));
        Chosen::new(entry, tables.collect()).map_err(|error| table(entry.name, &error))
    }

    /// Sets one key, or all keys of a table; the path of the whole is empty.
    ///
    /// # Errors
    /// The first complaint in the order of the lines.
    pub(super) fn apply(&mut self, path: &str, given: &Given) -> Result<(), ConfigError> {
        let mut first = None;
        self.walk(path, given, &mut first);
        first.map_or(Ok(()), |(_, complaint)| Err(complaint))
    }

    /// As `apply`; `first` is the first complaint so far, with its line.
    fn walk(&mut self, path: &str, given: &Given, first: &mut Option<(usize, ConfigError)>) {
        let line = line(&given.place);
        if first.as_ref().is_some_and(|(first, _)| *first <= line) {
            return;
        }
        let checked = match (self.target(path, &given.datum), &given.datum) {
            (Target::Parameter(parameter), _) => model::value_of(parameter, given)
                .map(|value| (parameter_path(&parameter.name), value)),
            (Target::Key(key), _) => {
                check(&key.kind, path, key.unit, given).map(|value| (path.to_owned(), value))
            }
            (Target::Table, Datum::Table(entries)) => {
                for (name, entry) in entries {
                    if !self.is_carried(path, name) {
                        let at = if path.is_empty() { "" } else { "." };
                        self.walk(&format!("{path}{at}{name}"), entry, first);
                    }
                }
                return;
            }
            (Target::Table | Target::Nothing, _) => Err(self.not_a_key(path, given)),
        };
        match checked {
            Ok((path, value)) => {
                self.values.insert(path, (value, given.place.clone()));
            }
            Err(complaint) => *first = Some((line, complaint)),
        }
    }

    /// The key, or the parameter of the model, of this path, which is named at `place`.
    ///
    /// # Errors
    /// A path of neither.
    pub(super) fn named(&self, path: &str, place: &Place) -> Result<Target<'_>, ConfigError> {
        let datum = Datum::Word(path.to_owned());
        match self.target(path, &datum) {
            Target::Table | Target::Nothing => {
                let (place, text) = (place.clone(), path.to_owned());
                Err(self.not_a_key(path, &Given { place, text, datum }))
            }
            target => Ok(target),
        }
    }

    /// What a path leads to.
    fn target(&self, path: &str, datum: &Datum) -> Target<'_> {
        if let Some(model) = &self.model {
            let name = path.strip_prefix(PARAMETERS).and_then(|rest| rest.strip_prefix('.'));
            // A parameter may have the name of a table, such as `run`.
            let is_table = matches!(datum, Datum::Table(_)) && name.is_none();
            if let Some(parameter) = model.parameter(name.unwrap_or(path)).filter(|_| !is_table) {
                return Target::Parameter(parameter);
            }
        }
        let is_used = |table: &str| self.model.is_none() || SETTINGS.contains(&table);
        match find(path) {
            Some(key) if is_used(key.table().unwrap_or(key.path)) => Target::Key(key),
            None if path.is_empty() || names_in(path).is_some() && is_used(path) => Target::Table,
            None if self.model.is_some() && path == PARAMETERS => Target::Table,
            _ => Target::Nothing,
        }
    }

    /// Whether an entry of the root is how a configuration carries its model, and no setting.
    fn is_carried(&self, path: &str, name: &str) -> bool {
        self.model.is_some() && path.is_empty() && ["mechanism", MODEL].contains(&name)
    }

    /// The complaint about a path that is no key, or about a table that is none.
    fn not_a_key(&self, path: &str, given: &Given) -> ConfigError {
        let Some(model) = self.model.as_ref().filter(|_| !path.is_empty()) else {
            return not_a_key(path, given);
        };
        if self.model.is_some() && names_in(path).is_some() && SETTINGS.contains(&path) {
            return not_a_key(path, given);
        }
        let (place, key) = (given.place.clone(), excerpt(path).into());
        if model.has_state(path) {
            return ConfigError::StateOfModel { place, key };
        }
        let settings = keys().filter(|key| is_of_runs(key));
        let names = model.names().chain(settings.map(|key| key.path));
        let nearest = nearest_of(path, names.map(str::to_owned).collect());
        ConfigError::NotOfModel { place, key, nearest: nearest.map(Into::into) }
    }

    /// Whether a key has its default.
    pub(super) fn is_default(&self, path: &str) -> bool {
        let Some((value, _)) = self.values.get(path) else { return true };
        let default = find(path).and_then(|key| match key.default {
            DefaultValue::Toml(text) => {
                let given = toml_source::value(text, Place::Default).ok()?;
                check(&key.kind, key.path, key.unit, &given).ok()
            }
            DefaultValue::Absent(_) => None,
        });
        default.as_ref() == Some(value)
    }

    pub(super) fn place(&self, path: &str) -> Place {
        self.values.get(path).map_or(Place::Default, |(_, place)| place.clone())
    }

    /// A table, or a key of the root, as its type.
    pub(super) fn part<T: DeserializeOwned>(&self, part: &str) -> Result<T, ConfigError> {
        let value = match self.values.get(part) {
            Some((value, _)) => value.clone(),
            None => self.table(part, None),
        };
        typed(part, value)
    }

    /// The three tables of one joint, each key its own value or else the common one.
    pub(super) fn joint(&self, joint: &str) -> Result<JointConfig, ConfigError> {
        typed(joint, self.joint_tables(joint))
    }

    /// The same as JSON.
    pub(super) fn joint_tables(&self, joint: &str) -> Value {
        let tables = JOINT_TABLES.map(|table| (table.to_owned(), self.table(table, Some(joint))));
        Value::Object(Map::from_iter(tables))
    }

    pub(super) fn table(&self, table: &str, joint: Option<&str>) -> Value {
        let value = |key: &Key| {
            let own = joint.and_then(|joint| self.values.get(&format!("{joint}.{}", key.path)));
            let (value, _) = own.or_else(|| self.values.get(key.path))?;
            Some((key.name().to_owned(), value.clone()))
        };
        let own = keys().filter(|key| key.table() == Some(table));
        Value::Object(own.filter_map(value).collect())
    }
}

pub(super) fn typed<T: DeserializeOwned>(part: &str, value: Value) -> Result<T, ConfigError> {
    serde_json::from_value(value).map_err(|error| table(part, &error))
}

/// A mistake in the table of keys.
pub(super) fn table(part: &str, message: &dyn ToString) -> ConfigError {
    ConfigError::Table { part: part.into(), message: message.to_string().into() }
}

/// The complaint about a path that is no key, or about a table that is none.
fn not_a_key(path: &str, given: &Given) -> ConfigError {
    if path.is_empty() {
        return given.wrong_type("the configuration", "a table of keys");
    }
    if let Some(names) = names_in(path) {
        return given.wrong_type(path, &format!("a table with any of {}", names.join(", ")));
    }
    let (place, key) = (given.place.clone(), excerpt(path));
    let exists = |path| find(path).is_some() || names_in(path).is_some();
    if one_joint(path).is_some_and(|(_, rest)| exists(rest)) {
        return ConfigError::NotPerJoint { place, key: key.into() };
    }
    let nearest = nearest_key(&key, matches!(given.datum, Datum::Table(_)));
    ConfigError::UnknownKey { place, key: key.into(), nearest: nearest.map(Into::into) }
}

/// The line of a place; 0 where there are no lines.
fn line(place: &Place) -> usize {
    match place {
        Place::Line { line, .. } => *line,
        _ => 0,
    }
}
