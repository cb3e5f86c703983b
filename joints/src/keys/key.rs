//! What a key is: its path, the values that it takes, its default with the source.

use super::kind::Kind;
use super::range::Range;

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

/// `joint2` and `contact.stiffness` of `joint2.contact.stiffness`; none for a path that is not of
/// one joint.
pub fn one_joint(path: &str) -> Option<(&'static str, &str)> {
    JOINTS.iter().find_map(|joint| {
        let rest = path.strip_prefix(joint)?.strip_prefix('.')?;
        Some((*joint, rest))
    })
}
