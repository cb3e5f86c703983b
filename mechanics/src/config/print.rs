//! Configurations as TOML files: the default one commented, any one plain.

use serde_json::{Map, Value};

use super::all_keys::keys;
use super::check::check;
use super::error::Place;
use super::raw_value::is_bare_key;
use super::values::{OfModel, Values};
use super::{Config, Given, Model, toml_source};
use crate::keys::{DefaultValue, JOINT_TABLES, JOINTS, Key};
use crate::mechanisms::text::{MODEL, PARAMETERS};
use crate::mechanisms::{Entry, MECHANISMS};

const HEAD: &str = "\
# The default configuration of deltazero: Table 1 of \"Dynamic Analysis of Deployable
# Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array\".
";

const LEGEND: &str = "\
# Every key is optional. The comment says what it is, then its unit and range; then the source,
# whose tables and equations are the paper's.
";

const ONE_JOINT: &str = "
# Any key of [joint], [contact] and [friction] may differ for one joint:
# [joint2.contact]
# stiffness = 2e7
";

const OTHERS: &str = "
# Other mechanisms have keys and defaults of their own, which `deltazero config --set mechanism=NAME` prints:
";

/// The default configuration as TOML, every key with its meaning, unit, range and source.
///
/// Keys without a default stand there as comments, with an example.
///
/// ```
/// assert!(deltazero_mechanics::config::default_toml().contains("stiffness = 1e7"));
/// ```
pub fn default_toml() -> String {
    let [default, others @ ..] = MECHANISMS else { return String::new() };
    let mut out = commented(HEAD, default, None) + OTHERS;
    for Entry { name, about, .. } in others {
        out += &format!("# {name}: {about}\n");
    }
    out
}

/// Every key of a mechanism with its comment, and the values of `config`, or else the defaults.
fn commented(head: &str, mechanism: &Entry, config: Option<&Config>) -> String {
    let values = config.map(Config::to_json);
    let of_model = config.map_or_else(Vec::new, Config::defaults_of_model);
    let own = |key: &Key| {
        let of_model = of_model.iter().find(|(path, ..)| path == key.path);
        mechanism.default_of(key.path).or(of_model.map(|(_, text, source)| (&**text, *source)))
    };
    let mut out = format!("{head}{LEGEND}");
    let mut table = None;
    for key in keys().filter(|key| mechanism.has(key)) {
        if key.table() != table {
            // Once the last of the tables that may differ is done, say how they do.
            if table == JOINT_TABLES.last().copied() && mechanism.has_two_joints {
                out += ONE_JOINT;
                if let Some(Value::Object(own)) = values.as_ref().map(|all| &all[JOINTS[1]]) {
                    write_table(&mut out, JOINTS[1], own);
                }
            }
            table = key.table();
            out += &format!("\n[{}]", table.unwrap_or_default());
        }
        let given = values.as_ref().map(|all| value_at(all, key));
        out += &entry(key, own(key), given);
    }
    out
}

/// The value of a key in a configuration; null for none.
fn value_at<'a>(all: &'a Value, key: &Key) -> &'a Value {
    match key.table() {
        Some(table) => &all[table][key.name()],
        None => &all[key.name()],
    }
}

/// What it is; unit, range and source; the assignment. The default is the mechanism's `own`, where it has one, from
/// its own source; of a value that is `given` and is another one, the default and its source are told.
fn entry(key: &Key, own: Option<(&str, &str)>, given: Option<&Value>) -> String {
    let limits = match key.kind.limits(key.unit) {
        limits if limits.is_empty() => "true or false".to_owned(),
        limits => limits,
    };
    let source = own.map_or(key.source, |(_, source)| source);
    let (doc, name) = (key.doc, key.name());
    let assigned = |source: &str, mark: &str, value: &str| {
        format!("\n# {doc}.\n# {limits}; {source}.\n{mark}{name} = {value}\n")
    };
    let default = match (own, key.default) {
        (Some((value, _)), _) | (None, DefaultValue::Toml(value)) => value,
        (None, DefaultValue::Absent(example)) => {
            return match given {
                None | Some(Value::Null) => assigned(source, "# ", example),
                Some(value) => assigned(&format!("given; {source}"), "", &value.to_string()),
            };
        }
    };
    match given {
        Some(value) if !is_written(key, default, value) => {
            assigned(&format!("given; {default} is {source}"), "", &value.to_string())
        }
        _ => assigned(source, "", default),
    }
}

/// Whether `text` is how `value` is written.
fn is_written(key: &Key, text: &str, value: &Value) -> bool {
    let given = toml_source::value(text, Place::Default);
    given.and_then(|given| check(&key.kind, key.path, key.unit, &given)).is_ok_and(|v| v == *value)
}

impl Config {
    /// The defaults that its model from a file brings; none without one.
    fn defaults_of_model(&self) -> Vec<OfModel> {
        let model = Model::carried_by(&Given::from_json(&self.to_json())).ok().flatten();
        model.and_then(|model| Values::of_model(model, self.run.t_end).ok()).unwrap_or_default()
    }

    /// All of it as a TOML file like the [default one](default_toml), with comments; [`load`](Self::load) reads it
    /// back to the same bits.
    pub fn commented_toml(&self) -> String {
        let Entry { name, about, .. } = self.mechanism.entry;
        let tables = &self.mechanism.tables;
        let [model, parameters] = [MODEL, PARAMETERS].map(|name| tables.get(name));
        let head = match model {
            Some(model) => {
                let file = model["name"].as_str().unwrap_or_default();
                format!(
                    "# Settings of deltazero and parameters of a model, to be given with --model {file}.\n"
                )
            }
            None => format!("# A configuration of deltazero, of the mechanism {name}: {about}.\n"),
        };
        let mut text = commented(&head, self.mechanism.entry, Some(self));
        if let Some(Value::Object(own)) = parameters {
            write_table(&mut text, PARAMETERS, own);
        }
        text
    }

    /// All of it as a TOML file, tables and keys in alphabetical order; [`load`](Self::load) reads it
    /// back to the same bits.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        if let Value::Object(all) = self.to_json() {
            write_table(&mut out, "", &all);
        }
        out
    }
}

/// The values of a table, then the tables in it. JSON's numbers, words and lists are TOML's too.
fn write_table(out: &mut String, path: &str, table: &Map<String, Value>) {
    let (tables, values): (Vec<_>, Vec<_>) = table.iter().partition(|(_, value)| value.is_object());
    if !path.is_empty() && !values.is_empty() {
        *out += &format!("\n[{path}]\n");
    }
    for (name, value) in values {
        let name = if is_bare_key(name) { name.clone() } else { format!("\"{name}\"") };
        *out += &format!("{name} = {value}\n");
    }
    for (name, value) in tables {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        if let Value::Object(inner) = value {
            write_table(out, &path, inner);
        }
    }
}
