//! The mechanisms: the list of them, and what each is to the program.
//!
//! A mechanism is a file here and a line in [`MECHANISMS`]: its keys with their defaults, the problem that a configuration
//! makes of it, and what a report says of it. Nothing else in the program asks which mechanism it has.

pub mod cam_follower;
mod four_bar;
pub mod impact_oscillator;
mod in_words;
pub mod rocking_block;
mod slider_crank;
pub mod strut;
#[cfg(test)]
mod test_runs;
pub mod text;

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use deltazero_study::Subject;
use deltazero_study::warning::Warning;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::keys::{Key, Shared};
use crate::model::Joints;

/// All mechanisms; the first is the default.
pub const MECHANISMS: &[&Entry] = &[
    &strut::STRUT,
    &slider_crank::SLIDER_CRANK,
    &four_bar::FOUR_BAR,
    &cam_follower::CAM_FOLLOWER,
    &rocking_block::ROCKING_BLOCK,
    &impact_oscillator::IMPACT_OSCILLATOR,
];

/// Their names, as the key `mechanism` takes them.
pub const NAMES: [&str; MECHANISMS.len()] = {
    let mut names = [""; MECHANISMS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = MECHANISMS[i].name;
        i += 1;
    }
    names
};

/// A mechanism in the list.
#[derive(Debug)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// What it is, in some words.
    pub about: &'static str,
    /// Its own keys: at the root, or in a table of its own.
    pub keys: &'static [Key],
    /// The tables, or single keys, that it shares with others and uses.
    pub uses: &'static [&'static str],
    /// Defaults of its own for keys that it shares.
    pub defaults: &'static [OwnDefault],
    /// Whether keys of the joint tables may differ for one joint.
    pub has_two_joints: bool,
    /// Reads what a configuration has in its own tables.
    pub read: fn(Value) -> serde_json::Result<Arc<dyn Mechanism>>,
}

/// Where a default is from that no source gives.
const OURS: &str = "our choice";

/// A default of its own that a mechanism has for a key that it shares: path, value as TOML, and where that is from.
pub type OwnDefault = (&'static str, &'static str, &'static str);

/// Tables that every mechanism uses, but for keys that some [name](Entry::uses) as theirs.
const OF_ALL: [&str; 6] = ["mechanism", "run", "solver", "study", "contest", "regimes"];

impl Entry {
    /// The mechanism of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        MECHANISMS.iter().find(|entry| entry.name == name).copied()
    }

    /// Whether it uses a key.
    pub fn has(&self, key: &Key) -> bool {
        let table = key.table().unwrap_or(key.path);
        // A model from a file is not chosen by the key `mechanism`.
        let is_of_all = OF_ALL.contains(&table)
            && !MECHANISMS.iter().any(|entry| entry.uses.contains(&key.path))
            && (key.path != "mechanism" || Self::named(self.name).is_some());
        is_of_all
            || self.uses.contains(&table)
            || self.uses.contains(&key.path)
            || self.keys.iter().any(|own| own.path == key.path)
    }

    /// Its own default of a key, as TOML, if it has one, and where that is from.
    pub fn default_of(&self, path: &str) -> Option<(&'static str, &'static str)> {
        self.defaults.iter().find(|(own, ..)| *own == path).map(|&(_, text, source)| (text, source))
    }
}

/// The mechanism that the table `name` holds.
fn read_table<M: Mechanism + DeserializeOwned + 'static>(
    mut tables: Value,
    name: &str,
) -> serde_json::Result<Arc<dyn Mechanism>> {
    let value: M = serde_json::from_value(tables[name].take())?;
    Ok(Arc::new(value))
}

/// Why values do not go together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    /// The key.
    pub key: &'static str,
    /// Its value.
    pub found: String,
    /// The key that it does not go with.
    pub against: &'static str,
    /// Why not, and the way out.
    pub reason: &'static str,
}

/// What is integrated: a value with its own parameters, to which the configuration adds those that all share.
pub trait Mechanism: Send + Sync {
    /// Whether the values go together.
    ///
    /// # Errors
    /// The first that does not.
    fn check(&self, _shared: &Shared) -> Result<(), Misfit> {
        Ok(())
    }

    /// What a study integrates.
    fn subject(&self, shared: &Shared) -> Subject {
        Subject { parts: self.joints(shared).parts.into_iter().map(Into::into).collect() }
    }

    /// Its joints with what hangs on them; empty of a mechanism that is not made of joints.
    fn joints(&self, _shared: &Shared) -> Joints {
        Joints::default()
    }

    /// Number of its sites, all parts together.
    fn n_sites(&self, _shared: &Shared) -> usize {
        1
    }

    /// Number of states that absolute tolerances are given for.
    fn n_tolerances(&self) -> usize;

    /// What is studied, in some words.
    fn title(&self, shared: &Shared) -> String;

    /// What moves, in a sentence or two, for the head of a report.
    fn lead(&self) -> &str;

    /// Whether a report calls it a model, which need not be of a contact.
    fn is_model(&self) -> bool {
        false
    }

    /// Names and what they are, for a report.
    fn facts(&self, shared: &Shared) -> Vec<(String, String)>;

    /// The unit of a parameter of its own that is no key of the configuration, if it has one.
    fn unit_of(&self, _parameter: &str) -> Option<&str> {
        None
    }

    /// Columns of `study.csv` before all others, the same in every row: name, meaning and value.
    fn leading(&self, _shared: &Shared) -> Vec<(&'static str, &'static str, String)> {
        Vec::new()
    }

    /// What to know before anything is run.
    fn warnings(&self, _shared: &Shared) -> Vec<Warning> {
        Vec::new()
    }

    /// Why it has no blind runs, where it has none.
    fn no_blind_runs(&self, _shared: &Shared) -> Option<String> {
        Some("the blind baseline is built for pins in bushes".to_owned())
    }
}

/// The mechanism of a configuration.
#[derive(Clone)]
pub struct Chosen {
    /// Its line in the list.
    pub entry: &'static Entry,
    /// Its own tables.
    pub tables: Map<String, Value>,
    value: Arc<dyn Mechanism>,
}

impl Chosen {
    /// The mechanism `entry` with these values of its own tables.
    ///
    /// # Errors
    /// Values that its type does not take: a mistake in its keys.
    pub fn new(entry: &'static Entry, tables: Map<String, Value>) -> serde_json::Result<Self> {
        let value = (entry.read)(Value::Object(tables.clone()))?;
        Ok(Self { entry, tables, value })
    }
}

impl Deref for Chosen {
    type Target = dyn Mechanism;

    fn deref(&self) -> &Self::Target {
        &*self.value
    }
}

impl PartialEq for Chosen {
    fn eq(&self, other: &Self) -> bool {
        self.entry.name == other.entry.name && self.tables == other.tables
    }
}

impl fmt::Debug for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(self.entry.name).field(&self.tables).finish()
    }
}

#[cfg(test)]
mod tests;
