//! The table of keys: those of the mechanisms and those that they share.
//!
//! The default file, the JSON Schema, the check of what is given and the suggestions for what is
//! misspelt all follow from [`keys`].

use deltazero_text::SETTINGS;

use crate::keys::DefaultValue::Toml;
use crate::keys::{COMMON, JOINT_TABLES, JOINTS, Key, Kind, one_joint};
use crate::mechanisms::{MECHANISMS, NAMES};

/// The key that chooses the mechanism.
const MECHANISM: Key = Key {
    path: "mechanism",
    kind: Kind::Word(&NAMES),
    default: Toml("\"strut\""),
    unit: "",
    doc: "What is integrated; `deltazero config --set mechanism=NAME` prints its keys and defaults",
    source: "the paper's case",
};

/// Every key, in the order of the default file: the mechanism, the keys of each mechanism, those of all.
pub fn keys() -> impl Iterator<Item = &'static Key> + Clone {
    let own = MECHANISMS.iter().flat_map(|entry| entry.keys);
    std::iter::once(&MECHANISM).chain(own).chain(COMMON)
}

/// The key at `path`, which may be one for a single joint: `joint2.contact.stiffness`.
pub fn find(path: &str) -> Option<&'static Key> {
    let key = |path: &str| keys().find(|key| key.path == path);
    match one_joint(path) {
        Some((_, rest)) => key(rest).filter(|key| key.per_joint()),
        None => key(path),
    }
}

/// Whether a key is a setting of runs, not one of what is run.
pub fn is_of_runs(key: &Key) -> bool {
    key.table().is_some_and(|table| SETTINGS.contains(&table))
}

/// The tables, in the order of the default file.
pub(super) fn tables() -> Vec<&'static str> {
    let mut tables: Vec<_> = keys().filter_map(Key::table).collect();
    tables.dedup();
    tables
}

/// The names one level below the table at `path`; none if there is no such table.
pub(super) fn names_in(path: &str) -> Option<Vec<&'static str>> {
    let table = match one_joint(path) {
        Some((_, table)) => JOINT_TABLES.contains(&table).then_some(table)?,
        None if JOINTS.contains(&path) => return Some(JOINT_TABLES.to_vec()),
        None => path,
    };
    let names: Vec<_> = keys().filter(|key| key.table() == Some(table)).map(Key::name).collect();
    (!names.is_empty()).then_some(names)
}
