//! One configuration after another that differ in a few keys, without reading the others again.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::error::{ConfigError, Place};
use super::given::{Datum, Given, excerpt};
use super::keys::{JOINT_TABLES, JOINTS, Key, find, one_joint};
use super::settings::{Settings, not_a_key, table, typed};
use super::{Config, Kind};
use crate::mechanisms::Chosen;

/// The part that holds the tables of the mechanism.
const OWN: &str = "tables of the mechanism";

/// A configuration of which some keys take other values from run to run.
///
/// ```
/// use deltazero::config::{Config, ConfigError, Variants};
///
/// let mut variants = Variants::new(None, &[], &["joint2.contact.stiffness"])?;
/// let stiffer = Config::load(None, &["joint2.contact.stiffness=2e7".to_owned()])?;
/// assert_eq!(*variants.set(&[2e7.into()])?, stiffer);
/// # Ok::<(), ConfigError>(())
/// ```
///
/// Where [`Config::load`] reads every key, [`set`](Self::set) keeps those parts of the configuration as JSON in which a
/// key varies, enters the values there, and reads these parts alone: of a sweep with three keys a whole run of two
/// steps takes 11 µs of the processor, with its row.
#[derive(Clone)]
pub struct Variants {
    /// All values but the varied ones.
    settings: Settings,
    config: Config,
    keys: Vec<Varied>,
    /// Name and content of each part in which a key varies.
    parts: Vec<(&'static str, Value)>,
}

/// A key that varies.
#[derive(Clone)]
struct Varied {
    path: String,
    kind: Kind,
    unit: &'static str,
    targets: Vec<Target>,
}

/// A place that its value is entered at.
#[derive(Clone)]
struct Target {
    /// Index of the part.
    part: usize,
    /// Names of tables and key inside it; none for a part that is the value.
    path: Vec<&'static str>,
}

impl Variants {
    /// The configuration that [`Config::load`] makes of `file` and `sets`, of which `paths` are to vary.
    ///
    /// # Errors
    /// As [`Config::load`]; a path that is no key, or the key `mechanism`, which changes what keys there are.
    pub fn new(file: Option<&Path>, sets: &[String], paths: &[&str]) -> Result<Self, ConfigError> {
        let mut settings = Settings::load(None, file, sets)?;
        let config = settings.config()?;
        let mut variants = Self { settings, config, keys: Vec::new(), parts: Vec::new() };
        for path in paths {
            let key = find(path).filter(|key| key.path != "mechanism");
            let key = key.ok_or_else(|| table(path, &"no key that may vary"))?;
            let targets = variants.targets(path, key, paths);
            let varied =
                Varied { path: (*path).to_owned(), kind: key.kind, unit: key.unit, targets };
            variants.keys.push(varied);
        }
        Ok(variants)
    }

    /// The configuration as it was set last.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The value that `given` has as the key number `i`.
    ///
    /// # Errors
    /// What the key does not take.
    pub(crate) fn checked(&self, i: usize, given: &Given) -> Result<Value, ConfigError> {
        let key = &self.keys[i];
        key.kind.check(&key.path, key.unit, given)
    }

    /// The configuration with these values, one for each path, in their normal form.
    ///
    /// # Errors
    /// As [`Config::load`] with each value as an argument of `--set`.
    ///
    /// # Panics
    /// With fewer values than paths.
    pub fn set(&mut self, values: &[Value]) -> Result<&Config, ConfigError> {
        let is_set = self.keys.iter().zip(values).all(|(key, value)| is_in_range(key, value))
            && self.enter(values).is_ok()
            && self.settings.cross_check(&self.config).is_ok();
        if !is_set {
            self.config = self.loaded(values)?;
        }
        Ok(&self.config)
    }

    /// The same by the way of every other configuration, which finds the words for what is wrong.
    fn loaded(&self, values: &[Value]) -> Result<Config, ConfigError> {
        let mut settings = self.settings.clone();
        for (key, value) in self.keys.iter().zip(values) {
            let place = Place::Set(excerpt(&format!("{}={value}", key.path)).into());
            settings.apply(&key.path, &Given { place, ..Given::from_json(value) })?;
        }
        settings.config()
    }

    /// Enters values, and reads the parts that they are in.
    fn enter(&mut self, values: &[Value]) -> Result<(), ConfigError> {
        for (key, value) in self.keys.iter().zip(values) {
            for target in &key.targets {
                let (_, part) = &mut self.parts[target.part];
                let place = target.path.iter().fold(part, |part, name| &mut part[*name]);
                place.clone_from(value);
            }
        }
        self.parts.iter().try_for_each(|(name, part)| read(&mut self.config, name, part))
    }

    /// Where the value of a key is entered: common to both joints, it does not reach a joint that has its own.
    fn targets(&mut self, path: &str, key: &Key, paths: &[&str]) -> Vec<Target> {
        let mut targets = Vec::new();
        let Some(table) = key.table() else {
            let part = self.part(key.path);
            return vec![Target { part, path: Vec::new() }];
        };
        if JOINT_TABLES.contains(&table) {
            for joint in JOINTS {
                let own = format!("{joint}.{}", key.path);
                let has_own =
                    self.settings.values.contains_key(&own) || paths.contains(&own.as_str());
                if one_joint(path).map_or(!has_own, |(of, _)| of == joint) {
                    targets.push(Target { part: self.part(joint), path: vec![table, key.name()] });
                }
            }
            return targets;
        }
        if self.config.mechanism.tables.contains_key(table) {
            targets.push(Target { part: self.part(OWN), path: vec![table, key.name()] });
        }
        if is_typed(table) {
            targets.push(Target { part: self.part(table), path: vec![key.name()] });
        }
        targets
    }

    /// The number of a part, which is kept from now on.
    fn part(&mut self, name: &'static str) -> usize {
        if let Some(known) = self.parts.iter().position(|(known, _)| *known == name) {
            return known;
        }
        let value = match name {
            OWN => Value::Object(self.config.mechanism.tables.clone()),
            _ if JOINTS.contains(&name) => self.settings.joint_tables(name),
            // A key at the root is overwritten before it is read.
            _ => self.settings.table(name, None),
        };
        self.parts.push((name, value));
        self.parts.len() - 1
    }
}

/// The key at `path`, which is named at `place`.
///
/// # Errors
/// A path that is no key.
pub(crate) fn key_at(path: &str, place: &Place) -> Result<&'static Key, ConfigError> {
    let unknown = || {
        let datum = Datum::Word(path.to_owned());
        let given = Given { place: place.clone(), text: path.to_owned(), datum };
        not_a_key(path, &given)
    };
    find(path).ok_or_else(unknown)
}

/// Whether a number is one that its key takes; what is no number was checked when it was given.
fn is_in_range(key: &Varied, value: &Value) -> bool {
    match (&key.kind, value.as_f64()) {
        (Kind::Number(range), Some(x)) => range.contains(x),
        (Kind::Number(_), None) => false,
        (Kind::OneOf(_), Some(_)) => {
            key.kind.check(&key.path, key.unit, &Given::from_json(value)).is_ok()
        }
        _ => true,
    }
}

/// Whether a table is a part of [`Config`] with a type of its own.
fn is_typed(table: &str) -> bool {
    ["strut", "drive", "run", "solver", "study", "contest", "regimes"].contains(&table)
}

/// Reads a part into `config`.
fn read(config: &mut Config, name: &'static str, part: &Value) -> Result<(), ConfigError> {
    fn of<'de, T: Deserialize<'de>>(name: &str, part: &'de Value) -> Result<T, ConfigError> {
        T::deserialize(part).map_err(|error| table(name, &error))
    }
    match name {
        "joint1" => config.joints[0] = of(name, part)?,
        "joint2" => config.joints[1] = of(name, part)?,
        "reading" => config.reading = of(name, part)?,
        "bays" => config.bays = of(name, part)?,
        "strut" => config.strut = of(name, part)?,
        "drive" => config.drive = of(name, part)?,
        "run" => config.run = of(name, part)?,
        "solver" => config.solver = of(name, part)?,
        "study" => config.study = of(name, part)?,
        "contest" => config.contest = of(name, part)?,
        "regimes" => config.regimes = of(name, part)?,
        _ => {
            let tables = typed(name, part.clone())?;
            let entry = config.mechanism.entry;
            config.mechanism =
                Chosen::new(entry, tables).map_err(|error| table(entry.name, &error))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{DefaultValue, keys};
    use crate::mechanisms::MECHANISMS;

    /// Values of a kind, some of which it may refuse.
    fn some_values(kind: &Kind, default: &Value) -> Vec<Value> {
        let number = default.as_f64().unwrap_or(1.0);
        match kind {
            Kind::Number(_) => {
                vec![
                    (number * 1.0625).into(),
                    (number * 0.5 + 1e-3).into(),
                    0.0.into(),
                    (-1.0).into(),
                ]
            }
            Kind::Integer(low, high) => vec![(*low).into(), (low + 1).min(*high).into()],
            Kind::Boolean => vec![true.into(), false.into()],
            Kind::Word(words) => words.iter().map(|word| (*word).into()).collect(),
            Kind::List(..) => vec![default.clone()],
            Kind::OneOf(kinds) => {
                kinds.iter().flat_map(|kind| some_values(kind, default)).collect()
            }
        }
    }

    /// Of every key of a mechanism, as it is and for joint 2: its path and some values.
    fn cases() -> Vec<(String, String, Vec<Value>)> {
        let mut cases = Vec::new();
        for entry in MECHANISMS {
            let set = format!("mechanism={}", entry.name);
            for key in keys().filter(|key| key.path != "mechanism" && entry.has(key)) {
                let text = match key.default {
                    DefaultValue::Toml(text) => entry.default_of(key.path).unwrap_or(text),
                    DefaultValue::Absent(example) => example,
                };
                let given = super::super::toml_source::value(text, Place::Default).unwrap();
                let default = key.kind.check(key.path, key.unit, &given).unwrap();
                let values = some_values(&key.kind, &default);
                if key.per_joint() && entry.has_two_joints {
                    cases.push((set.clone(), format!("joint2.{}", key.path), values.clone()));
                }
                cases.push((set.clone(), key.path.to_owned(), values));
            }
        }
        cases
    }

    #[test]
    fn a_variant_is_the_configuration_that_set_gives() {
        let mut n_compared = 0;
        for (mechanism, path, values) in cases() {
            let base = [mechanism];
            let mut variants = Variants::new(None, &base, &[&path]).unwrap();
            for value in values {
                let sets = [base[0].clone(), format!("{path}={value}")];
                let loaded = Config::load(None, &sets).map_err(|error| error.to_string());
                let own = variants.set(&[value]).cloned().map_err(|error| error.to_string());
                assert_eq!(own, loaded, "{sets:?}");
                n_compared += 1;
            }
        }
        assert!(n_compared > 700, "{n_compared}");
    }

    #[test]
    fn keys_that_vary_together_do_not_disturb_each_other() {
        let paths = ["contact.stiffness", "joint2.contact.stiffness", "friction.law", "bays"];
        let base = ["joint1.contact.damping=7.0".to_owned()];
        let mut variants = Variants::new(None, &base, &paths).unwrap();
        let values: [[Value; 4]; 3] = [
            [1e6.into(), 2e6.into(), "coulomb".into(), 3.into()],
            [3e6.into(), 2e6.into(), "lugre".into(), 1.into()],
            [4e6.into(), 2.5e6.into(), "tanh".into(), 2.into()],
        ];
        for values in values {
            let sets = paths.iter().zip(&values).map(|(path, value)| format!("{path}={value}"));
            let sets: Vec<String> = base.iter().cloned().chain(sets).collect();
            assert_eq!(*variants.set(&values).unwrap(), Config::load(None, &sets).unwrap());
        }
    }

    #[test]
    fn a_variant_that_is_refused_leaves_the_next_one_right() {
        let mut variants = Variants::new(None, &[], &["friction.law", "joint.clearance"]).unwrap();
        let refused = variants.set(&["lugre".into(), 0.0.into()]).unwrap_err().to_string();
        assert!(refused.contains("does not go with friction.law = lugre"), "{refused}");
        let refused = variants.set(&["lugre".into(), (-1.0).into()]).unwrap_err().to_string();
        assert!(refused.contains("joint.clearance = -1.0 is out of range"), "{refused}");
        let sets = ["friction.law=coulomb".to_owned(), "joint.clearance=0".to_owned()];
        let loaded = Config::load(None, &sets).unwrap();
        assert_eq!(*variants.set(&["coulomb".into(), 0.0.into()]).unwrap(), loaded);
    }
}
