//! The table of keys: everything the configuration knows of them is here, once.
//!
//! The default file, the JSON Schema, the check of what is given and the suggestions for what is
//! misspelt all follow from [`keys`].

mod common;

use deltazero_text::SETTINGS;

use common::COMMON;

use super::kind::Kind;
use super::range::Range;
use crate::mechanisms::{MECHANISMS, NAMES};

/// One key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Path from the root: `contact.stiffness`.
    pub path: &'static str,
    /// The values it takes.
    pub kind: Kind,
    /// The default.
    pub default: DefaultValue,
    /// Unit; empty for what has none.
    pub unit: &'static str,
    /// What it is, in one line.
    pub doc: &'static str,
    /// Where the default is from. Tables and equations are those of "Dynamic Analysis of
    /// Deployable Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array".
    pub source: &'static str,
}

/// The default of a key, as TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultValue {
    /// This value.
    Toml(&'static str),
    /// Absent, which means something of its own; with a value as an example.
    Absent(&'static str),
}

/// The tables whose keys may differ for one joint.
pub const JOINT_TABLES: [&str; 3] = ["joint", "contact", "friction"];

/// The tables that hold what differs for joint 1 and joint 2.
pub const JOINTS: [&str; 2] = ["joint1", "joint2"];

impl Key {
    /// A key with a default as TOML.
    pub const fn new(
        path: &'static str,
        kind: Kind,
        default: &'static str,
        unit: &'static str,
        doc: &'static str,
        source: &'static str,
    ) -> Self {
        Self { path, kind, default: DefaultValue::Toml(default), unit, doc, source }
    }

    /// The table it is in; none for a key at the root.
    pub fn table(&self) -> Option<&'static str> {
        self.path.split_once('.').map(|(table, _)| table)
    }

    /// Its name in that table.
    pub fn name(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, name)| name)
    }

    /// Whether it is a setting of runs, not a key of what is run.
    pub fn is_of_runs(&self) -> bool {
        self.table().is_some_and(|table| SETTINGS.contains(&table))
    }

    /// Whether it may differ for one joint.
    pub fn per_joint(&self) -> bool {
        self.table().is_some_and(|table| JOINT_TABLES.contains(&table))
    }
}

/// A number above zero.
pub const POSITIVE: Kind = Kind::Number(Range::POSITIVE);
/// A number of at least zero.
pub const NOT_NEGATIVE: Kind = Kind::Number(Range::NOT_NEGATIVE);
/// Any finite number.
pub const FINITE: Kind = Kind::Number(Range::FINITE);

use DefaultValue::Toml;

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

/// `joint2` and `contact.stiffness` of `joint2.contact.stiffness`; none for a path that is not of
/// one joint.
pub(crate) fn one_joint(path: &str) -> Option<(&'static str, &str)> {
    JOINTS.iter().find_map(|joint| {
        let rest = path.strip_prefix(joint)?.strip_prefix('.')?;
        Some((*joint, rest))
    })
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
