//! Configurations as TOML files: the default one commented, any one plain.

use serde_json::{Map, Value};

use super::Config;
use super::keys::{DefaultValue, JOINT_TABLES, KEYS, Key, SLIDER_CRANK_DEFAULTS};

const HEAD: &str = "\
# The default configuration of deltazero: Table 1 of \"Dynamic Analysis of Deployable
# Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array\".
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
    let mut out = HEAD.to_owned();
    let mut table = None;
    for key in KEYS {
        if key.table() != table {
            // Once the last of the tables that may differ is done, say how they do.
            if table == JOINT_TABLES.last().copied() {
                out += ONE_JOINT;
            }
            table = key.table();
            out += &format!("\n[{}]", table.unwrap_or_default());
        }
        out += &entry(key);
    }
    out += SLIDER_CRANK;
    for (path, value) in SLIDER_CRANK_DEFAULTS {
        out += &format!("# {path} = {value}\n");
    }
    out
}

/// What it is; unit, range and source; the assignment.
fn entry(key: &Key) -> String {
    let limits = match key.kind.limits(key.unit) {
        limits if limits.is_empty() => "true or false".to_owned(),
        limits => limits,
    };
    let (mark, value) = match key.default {
        DefaultValue::Toml(value) => ("", value),
        DefaultValue::Absent(example) => ("# ", example),
    };
    let (doc, source, name) = (key.doc, key.source, key.name());
    format!("\n# {doc}.\n# {limits}; {source}.\n{mark}{name} = {value}\n")
}

impl Config {
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
