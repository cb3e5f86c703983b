//! The default configuration as a commented TOML file.

use super::keys::{DefaultValue, JOINT_TABLES, KEYS, Key};

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
