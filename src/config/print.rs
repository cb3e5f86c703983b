//! Configurations as TOML files: the default one commented, any one plain.

use serde_json::{Map, Value};

use super::error::Place;
use super::keys::{DefaultValue, JOINT_TABLES, JOINTS, KEYS, Key, SLIDER_CRANK_DEFAULTS};
use super::{Config, MechanismName, toml_source};

const HEAD: &str = "\
# The default configuration of deltazero: Table 1 of \"Dynamic Analysis of Deployable
# Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array\".
";

const GIVEN_HEAD: &str = "\
# A configuration of deltazero; what was not given is from Table 1 of \"Dynamic Analysis of Deployable
# Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array\".
";

const SLIDER_CRANK_HEAD: &str = "\
# A configuration of deltazero, of the slider-crank; the tables of the struts are not used.
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

const SLIDER_CRANK: &str = "
# With mechanism = \"slider-crank\" a key that is not given, in a file without it, has another default:
";

/// The default configuration as TOML, every key with its meaning, unit, range and source.
///
/// Keys without a default stand there as comments, with an example.
///
/// ```
/// assert!(deltazero::config::default_toml().contains("stiffness = 1e7"));
/// ```
pub fn default_toml() -> String {
    let mut out = commented(HEAD, None);
    out += SLIDER_CRANK;
    for (path, value) in SLIDER_CRANK_DEFAULTS {
        out += &format!("# {path} = {value}\n");
    }
    out
}

/// Every key with its comment, and the values of `config`, or else the defaults.
fn commented(head: &str, config: Option<&Config>) -> String {
    let values = config.map(Config::to_json);
    let is_crank = config.is_some_and(|config| config.mechanism == MechanismName::SliderCrank);
    let mut out = format!("{head}{LEGEND}");
    let mut table = None;
    for key in KEYS {
        if key.table() != table {
            // Once the last of the tables that may differ is done, say how they do.
            if table == JOINT_TABLES.last().copied() && !is_crank {
                out += ONE_JOINT;
                if let Some(Value::Object(own)) = values.as_ref().map(|all| &all[JOINTS[1]]) {
                    write_table(&mut out, JOINTS[1], own);
                }
            }
            table = key.table();
            out += &format!("\n[{}]", table.unwrap_or_default());
        }
        let own = SLIDER_CRANK_DEFAULTS.iter().find(|(path, _)| is_crank && *path == key.path);
        let given = values.as_ref().map(|all| value_at(all, key));
        out += &entry(key, own.map(|(_, text)| *text), given);
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

/// What it is; unit, range and source; the assignment. The default is the mechanism's `own`, where it has one; of
/// a value that is `given` and is another one, the default and its source are told.
fn entry(key: &Key, own: Option<&str>, given: Option<&Value>) -> String {
    let limits = match key.kind.limits(key.unit) {
        limits if limits.is_empty() => "true or false".to_owned(),
        limits => limits,
    };
    let source = if own.is_some() { "default of the slider-crank" } else { key.source };
    let (doc, name) = (key.doc, key.name());
    let assigned = |source: &str, mark: &str, value: &str| {
        format!("\n# {doc}.\n# {limits}; {source}.\n{mark}{name} = {value}\n")
    };
    let default = match key.default {
        DefaultValue::Toml(value) => own.unwrap_or(value),
        DefaultValue::Absent(example) => {
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
    given.and_then(|given| key.kind.check(key.path, key.unit, &given)).is_ok_and(|v| v == *value)
}

impl Config {
    /// All of it as a TOML file like the [default one](default_toml), with comments; [`load`](Self::load) reads it
    /// back to the same bits.
    pub fn commented_toml(&self) -> String {
        let head = match self.mechanism {
            MechanismName::Strut => GIVEN_HEAD,
            MechanismName::SliderCrank => SLIDER_CRANK_HEAD,
        };
        commented(head, Some(self))
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
        *out += &format!("{name} = {value}\n");
    }
    for (name, value) in tables {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        if let Value::Object(inner) = value {
            write_table(out, &path, inner);
        }
    }
}
