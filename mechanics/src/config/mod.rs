//! The configuration: every parameter with its unit and source, the paper's Table 1 as the default.
//!
//! ```
//! use deltazero_mechanics::config::{Config, ConfigError};
//!
//! let stiffer = Config::load(None, &["joint2.contact.stiffness=2e7".to_owned()])?;
//! assert_eq!(stiffer.joints[0].contact.stiffness, 1e7);
//! assert_eq!(stiffer.joints[1].contact.stiffness, 2e7);
//!
//! let wrong = Config::load(None, &["contact.stifness=2e7".to_owned()]);
//! assert_eq!(
//!     wrong.map_err(|error| error.to_string()),
//!     Err("--set contact.stifness=2e7: unknown key \"contact.stifness\"; \
//!          did you mean \"contact.stiffness\"?".to_owned()),
//! );
//! # Ok::<(), ConfigError>(())
//! ```
//!
//! One table, [`keys`], is the home of every key: its default, range, unit and documentation. What
//! a user gives passes through it key by key (`toml_source` → `values` → `cross_check` → [`Config`]), and the
//! default file ([`default_toml`]) and the JSON Schema ([`json_schema`]) are printed from it.
//!
//! Each [mechanism](crate::mechanisms) has keys of its own, and may have other defaults for those that all share.
//!
//! A value for one joint (`joint2.contact.stiffness`) stands before the common one
//! (`contact.stiffness`), wherever each was given; of the same key the last one counts: first the
//! file, then every `--set` in order.

mod all_keys;
mod check;
mod cross_check;
mod error;
mod model;
mod nearest;
mod print;
mod raw_value;
mod schema;
pub mod toml_source;
mod unused;
mod values;
mod variants;

#[cfg(test)]
mod tests;

use std::ops::{Deref, DerefMut};
use std::path::Path;

use deltazero_study::setting::Events;
use deltazero_study::warning::Warning;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use all_keys::{find, is_of_runs, keys};
pub use cross_check::MOST_ROWS;
pub use error::{ConfigError, Place, ROW_BYTES};
pub use model::Model;
pub use nearest::nearest_word;
pub use print::default_toml;
pub use raw_value::{Datum, Given};
pub use schema::json_schema;
pub use variants::{Variants, Varied};

use crate::keys::{JOINT_TABLES, JOINTS, Shared};
use crate::mechanisms::Chosen;
use crate::model::Joints;
use values::Values;

/// A complete configuration, checked.
///
/// What it shares with others stands for itself: `config.run.t_end`. Serialised it is [`Config::to_json`], and it is read
/// back through [`Config::from_json`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Value", into = "Value")]
pub struct Config {
    /// What is integrated.
    pub mechanism: Chosen,
    /// What it shares with other mechanisms.
    pub shared: Shared,
}

impl Deref for Config {
    type Target = Shared;

    fn deref(&self) -> &Shared {
        &self.shared
    }
}

impl DerefMut for Config {
    fn deref_mut(&mut self) -> &mut Shared {
        &mut self.shared
    }
}

impl From<&Config> for Joints {
    fn from(config: &Config) -> Self {
        config.mechanism.joints(config)
    }
}

impl Config {
    /// The default configuration: the paper's Table 1, 0–2 s.
    ///
    /// # Errors
    /// A mistake in the table of keys; a test excludes it.
    pub fn table1() -> Result<Self, ConfigError> {
        Values::defaults()?.config()
    }

    /// The defaults, then the TOML file, then every `key=value` of `sets` in order.
    ///
    /// # Errors
    /// The first complaint: an unreadable file, its syntax, an unknown key, a wrong type, a value
    /// out of range or an unknown word, values that do not go together.
    pub fn load(file: Option<&Path>, sets: &[String]) -> Result<Self, ConfigError> {
        Self::load_with(None, file, sets)
    }

    /// The same with a model from a file in the place of a mechanism: its settings come before those of the
    /// configuration, and its parameters are keys.
    ///
    /// # Errors
    /// As [`load`](Self::load), and what is wrong with the model.
    pub fn load_with(
        model: Option<&Path>,
        file: Option<&Path>,
        sets: &[String],
    ) -> Result<Self, ConfigError> {
        let model = model.map(Model::read).transpose()?;
        Values::load(model, file, sets)?.config()
    }

    /// All of it, in the structure of the TOML file, keys in alphabetical order.
    ///
    /// The form is canonical: equal configurations give equal texts. The tables `joint`, `contact`
    /// and `friction` are those of joint 1; `joint2` holds what differs there, and is absent if
    /// nothing does.
    pub fn to_json(&self) -> Value {
        let joints = self.joints.each_ref().map(json);
        let mut all = Map::new();
        for table in JOINT_TABLES {
            all.insert(table.to_owned(), joints[0][table].clone());
        }
        let difference = difference(&joints[0], &joints[1]);
        if !difference.is_empty() {
            all.insert(JOINTS[1].to_owned(), Value::Object(difference));
        }
        let parts = [
            ("mechanism", self.mechanism.entry.name.into()),
            ("reading", json(&self.reading)),
            ("bays", json(&self.bays)),
            ("strut", json(&self.strut)),
            ("drive", json(&self.drive)),
            ("run", json(&self.run)),
            ("solver", json(&self.solver)),
            ("study", json(&self.study)),
            ("contest", json(&self.contest)),
            ("regimes", json(&self.regimes)),
        ];
        all.extend(parts.map(|(name, part)| (name.to_owned(), part)));
        for (name, table) in self.mechanism.tables.clone() {
            all.entry(name).or_insert(table);
        }
        let used = |name: &str| {
            keys()
                .any(|key| key.table().unwrap_or(key.path) == name && self.mechanism.entry.has(key))
        };
        let is_own = |name: &str| self.mechanism.tables.contains_key(name);
        all.retain(|name, _| JOINTS.contains(&name.as_str()) || used(name) || is_own(name));
        let mut all = Value::Object(all);
        all.sort_all_objects();
        all
    }

    /// What to know before trusting a run of it.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut all = unused::unused(self);
        all.extend(self.mechanism.warnings(self));
        all
    }

    /// Why it has no blind runs, where it has none.
    pub fn no_blind_runs(&self) -> Option<String> {
        self.mechanism.no_blind_runs(self)
    }

    /// Those of `events` that it has runs of.
    pub fn permitted(&self, events: &[Events]) -> Vec<Events> {
        let has_blind = self.no_blind_runs().is_none();
        events.iter().copied().filter(|&e| e == Events::Located || has_blind).collect()
    }

    /// What results follow from: [all of it](Self::to_json), numbers of threads as 1, which change nothing but times.
    pub fn identity(&self) -> Value {
        let mut config = self.clone();
        (config.study.threads, config.regimes.threads) = (1, 1);
        config.to_json()
    }

    /// The configuration that [`to_json`](Self::to_json) wrote; what is absent has its default.
    ///
    /// A text of it must be parsed with serde_json's feature `float_roundtrip`, or numbers come back
    /// one bit off.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_json(value: &Value) -> Result<Self, ConfigError> {
        let mut values = Values::defaults()?;
        values.apply_all(&Given::from_json(value))?;
        values.config()
    }
}

impl TryFrom<Value> for Config {
    type Error = ConfigError;

    fn try_from(value: Value) -> Result<Self, ConfigError> {
        Self::from_json(&value)
    }
}

impl From<Config> for Value {
    fn from(config: Config) -> Self {
        config.to_json()
    }
}

/// A part as JSON. Numbers, words and lists of them have no way to fail; if they did, the null
/// would not read back.
fn json<T: Serialize>(part: &T) -> Value {
    serde_json::to_value(part).unwrap_or(Value::Null)
}

/// What is different in `two`, table by table.
fn difference(one: &Value, two: &Value) -> Map<String, Value> {
    let mut out = Map::new();
    for table in JOINT_TABLES {
        let Some(entries) = two[table].as_object() else {
            continue;
        };
        let differing = entries.iter().filter(|(name, value)| one[table].get(name) != Some(value));
        let differing: Map<_, _> = differing.map(|(k, v)| (k.clone(), v.clone())).collect();
        if !differing.is_empty() {
            out.insert(table.to_owned(), Value::Object(differing));
        }
    }
    out
}
