//! One configuration after another that differ in a few keys, without reading the others again.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::Config;
use super::check::check;
use super::error::{ConfigError, Place};
use super::model::{Model, defaults, kind_of};
use super::raw_value::{Datum, Given, excerpt};
use super::unused::law_without;
use super::values::{Target, Values, parameter_path, table, typed};
use crate::keys::{JOINT_TABLES, JOINTS, Key, Kind, one_joint};
use crate::mechanisms::Chosen;
use crate::mechanisms::text::{MODEL, PARAMETERS};

/// The part that holds the tables of the mechanism.
const OWN: &str = "tables of the mechanism";

/// A configuration of which some keys take other values from run to run.
///
/// ```
/// use deltazero_mechanics::config::{Config, ConfigError, Place, Variants};
///
/// let key = ("joint2.contact.stiffness", Place::Default);
/// let mut variants = Variants::new(None, None, &[], &[key])?;
/// let stiffer = Config::load(None, &["joint2.contact.stiffness=2e7".to_owned()])?;
/// assert_eq!(*variants.set(&[2e7.into()])?, stiffer);
/// # Ok::<(), ConfigError>(())
/// ```
///
/// Where [`Config::load`] reads every key, [`set`](Self::set) keeps those parts of the configuration as JSON in which a
/// key varies, enters the values there, and reads these parts alone: of a sweep with three keys a whole run of two
/// steps takes 11 µs of the processor, with its row. A model from a file is compiled anew where a parameter of it varies,
/// and read no more.
#[derive(Clone)]
pub struct Variants {
    /// All values but the varied ones.
    settings: Values,
    config: Config,
    keys: Vec<Varied>,
    /// Name and content of each part in which a key varies.
    parts: Vec<(&'static str, Value)>,
    /// Whether defaults follow from what varies, so that all keys are looked at each time.
    has_defaults: bool,
}

/// A key, or a parameter of the model, that varies.
#[derive(Clone)]
pub struct Varied {
    /// Its path; that of a parameter is its name.
    pub path: String,
    /// The values that it takes.
    pub kind: Kind,
    /// Unit; empty for what has none.
    pub unit: String,
    /// The key; none of a parameter.
    pub key: Option<&'static Key>,
    /// Whether it is a parameter of which the columns of runs may follow.
    pub is_of_shape: bool,
    places: Vec<Entered>,
}

/// A place that its value is entered at.
#[derive(Clone)]
struct Entered {
    /// Index of the part.
    part: usize,
    /// Names of tables and key inside it; none for a part that is the value.
    path: Vec<String>,
}

impl Variants {
    /// The configuration that [`Config::load_with`] makes of `model`, `file` and `sets`, of which `paths` are to vary, each
    /// with the place that it is named at.
    ///
    /// # Errors
    /// As [`Config::load_with`]; a path that is neither a key nor a parameter of the model, or the key `mechanism`, which
    /// changes what keys there are.
    pub fn new(
        model: Option<Model>,
        file: Option<&Path>,
        sets: &[String],
        paths: &[(&str, Place)],
    ) -> Result<Self, ConfigError> {
        let mut settings = Values::load(model, file, sets)?;
        let config = settings.config()?;
        let varied = |(path, place): &(&str, Place)| varied(&settings, path, place);
        let keys: Vec<Varied> = paths.iter().map(varied).collect::<Result<_, _>>()?;
        let has_model = settings.model.is_some();
        let has_defaults = has_model && keys.iter().any(|key| key.path == "run.t_end");
        let mut variants = Self { settings, config, keys, parts: Vec::new(), has_defaults };
        for i in 0..variants.keys.len() {
            variants.keys[i].places = variants.places(i);
        }
        Ok(variants)
    }

    /// What varies.
    pub fn varied(&self) -> &[Varied] {
        &self.keys
    }

    /// The configuration as it was set last.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The keys that were not given and follow `run.t_end` in each variant: those of a model where that varies.
    pub fn following(&self) -> Vec<&'static str> {
        if !self.has_defaults {
            return Vec::new();
        }
        let all = defaults(self.config.run.t_end).map(|(path, _)| path).into_iter();
        all.filter(|path| self.settings.place(path) == Place::Default).collect()
    }

    /// Why the key number `i` cannot vary, if it cannot: the mechanism, a joint or the parts of a model have their own values, or
    /// no law has it, so that it would change nothing, or `--set` gives it a value, which would change nothing.
    pub fn why_not(&self, i: usize) -> Option<String> {
        let (entry, Varied { path, key, .. }) = (self.config.mechanism.entry, &self.keys[i]);
        let name = entry.name;
        if key.is_some_and(|key| !entry.has(key)) {
            return Some(format!(
                "mechanism = {name} does not use it; `deltazero config --set mechanism={name}` lists the keys that it uses"
            ));
        }
        if one_joint(path).is_some() && !entry.has_two_joints {
            return Some(format!(
                "mechanism = {name} has one joint; give the key without joint1 or joint2"
            ));
        }
        let own = if key.is_some() { path.clone() } else { parameter_path(path) };
        match self.settings.place(&own) {
            set @ Place::Set(_) => {
                Some(format!("{set} gives it one value; leave one of the two away"))
            }
            _ => self.why_unused(i),
        }
    }

    /// Why the key number `i` would change nothing, if it would not.
    fn why_unused(&self, i: usize) -> Option<String> {
        let Varied { path, key, places, .. } = &self.keys[i];
        let Some(key) = key else {
            let is_of_parts = self.settings.model.as_ref()?.is_set_by_parts(path);
            return is_of_parts.then(|| {
                "parts of the model give it values of their own; take it out of the parts, or leave it out".to_owned()
            });
        };
        let table = key.table().filter(|table| JOINT_TABLES.contains(table))?;
        // What is stored of a plan does not tell who gave a joint its value: it would be taken for one that reaches both.
        let given = |joint: &&&str| self.settings.values.contains_key(&format!("{joint}.{path}"));
        if let Some(own) = JOINTS.iter().find(given) {
            let other = JOINTS.iter().find(|joint| !given(joint)).unwrap_or(own);
            return Some(format!(
                "{own}.{path} has a value of its own, which it would not change; name the joint that is to vary, as in {other}.{path}"
            ));
        }
        let law = format!("{table}.law");
        let without = |entered: &Entered| {
            let joint = self.parts[entered.part].0;
            let own = format!("{joint}.{law}");
            let varies = self.keys.iter().any(|varied| varied.path == law || varied.path == own);
            let number = usize::from(joint == JOINTS[1]);
            if varies { None } else { law_without(key.path, &self.config.joints[number]) }
        };
        let laws: Option<Vec<String>> = places.iter().map(without).collect();
        let law = laws?.pop()?;
        Some(format!("{law} does not have it; `deltazero laws` tells what each is of"))
    }

    /// The value that `given` has as the key number `i`.
    ///
    /// # Errors
    /// What the key does not take.
    pub fn checked(&self, i: usize, given: &Given) -> Result<Value, ConfigError> {
        let key = &self.keys[i];
        check(&key.kind, &key.path, &key.unit, given)
    }

    /// The value that the number `x` is as the key number `i`.
    ///
    /// # Errors
    /// As [`Config::load`] with it, at [`Place::Varied`].
    pub fn number(&self, i: usize, x: f64) -> Result<Value, ConfigError> {
        let place = Place::Varied(excerpt(&format!("{}={x:?}", self.keys[i].path)).into());
        self.checked(i, &Given { place, text: format!("{x:?}"), datum: Datum::Number(x) })
    }

    /// The configuration with these values, one for each path, in their normal form.
    ///
    /// # Errors
    /// As [`Config::load`] with each value, at [`Place::Varied`].
    ///
    /// # Panics
    /// With fewer values than paths.
    pub fn set(&mut self, values: &[Value]) -> Result<&Config, ConfigError> {
        let is_set = !self.has_defaults
            && self.keys.iter().zip(values).all(|(key, value)| is_in_range(key, value))
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
            let place = Place::Varied(excerpt(&format!("{}={value}", key.path)).into());
            settings.apply(&key.path, &Given { place, ..Given::from_json(value) })?;
        }
        settings.config()
    }

    /// Enters values, and reads the parts that they are in.
    fn enter(&mut self, values: &[Value]) -> Result<(), ConfigError> {
        for (key, value) in self.keys.iter().zip(values) {
            for entered in &key.places {
                let (_, part) = &mut self.parts[entered.part];
                let place = entered.path.iter().fold(part, |part, name| &mut part[name.as_str()]);
                place.clone_from(value);
            }
        }
        let model = self.settings.model.as_ref();
        self.parts.iter().try_for_each(|(name, part)| read(&mut self.config, name, part, model))
    }

    /// Where the value number `i` is entered: common to both joints, it does not reach a joint that has its own.
    fn places(&mut self, i: usize) -> Vec<Entered> {
        let path = self.keys[i].path.clone();
        let Some(key) = self.keys[i].key else {
            return vec![Entered { part: self.part(OWN), path: vec![PARAMETERS.to_owned(), path] }];
        };
        let name = || key.name().to_owned();
        let Some(table) = key.table() else {
            return vec![Entered { part: self.part(key.path), path: Vec::new() }];
        };
        let mut places = Vec::new();
        if JOINT_TABLES.contains(&table) {
            for joint in JOINTS {
                let own = format!("{joint}.{}", key.path);
                let has_own = self.settings.values.contains_key(&own)
                    || self.keys.iter().any(|key| key.path == own);
                if one_joint(&path).map_or(!has_own, |(of, _)| of == joint) {
                    let path = vec![table.to_owned(), name()];
                    places.push(Entered { part: self.part(joint), path });
                }
            }
            return places;
        }
        if self.config.mechanism.tables.contains_key(table) {
            let path = vec![table.to_owned(), name()];
            places.push(Entered { part: self.part(OWN), path });
        }
        if is_typed(table) {
            places.push(Entered { part: self.part(table), path: vec![name()] });
        }
        places
    }

    /// The number of a part, which is kept from now on.
    fn part(&mut self, name: &'static str) -> usize {
        if let Some(known) = self.parts.iter().position(|(known, _)| *known == name) {
            return known;
        }
        let value = match name {
            OWN => {
                let own = self.config.mechanism.tables.iter();
                // The text of a model is no value.
                let own = own.filter(|(name, _)| *name != MODEL);
                own.map(|(name, table)| (name.clone(), table.clone())).collect()
            }
            _ if JOINTS.contains(&name) => self.settings.joint_tables(name),
            // A key at the root is overwritten before it is read.
            _ => self.settings.table(name, None),
        };
        self.parts.push((name, value));
        self.parts.len() - 1
    }
}

/// What is to vary at `path`, which is named at `place`.
fn varied(settings: &Values, path: &str, place: &Place) -> Result<Varied, ConfigError> {
    let varied = match settings.named(path, place)? {
        Target::Key(key) if key.path != "mechanism" => Varied {
            path: path.to_owned(),
            kind: key.kind,
            unit: key.unit.to_owned(),
            key: Some(key),
            is_of_shape: false,
            places: Vec::new(),
        },
        Target::Parameter(parameter) => Varied {
            path: parameter.name.clone(),
            kind: kind_of(parameter),
            unit: parameter.unit.clone(),
            key: None,
            is_of_shape: settings.model.as_ref().is_some_and(|model| model.is_of_shape(parameter)),
            places: Vec::new(),
        },
        _ => return Err(table(path, &"no key that may vary")),
    };
    Ok(varied)
}

/// Whether a number is one that its key takes; what is no number was checked when it was given.
fn is_in_range(key: &Varied, value: &Value) -> bool {
    match (&key.kind, value.as_f64()) {
        (Kind::Number(range), Some(x)) => range.contains(x),
        (Kind::Number(_), None) => false,
        (Kind::OneOf(_), Some(_)) => {
            check(&key.kind, &key.path, &key.unit, &Given::from_json(value)).is_ok()
        }
        _ => true,
    }
}

/// Whether a table is a part of [`Config`] with a type of its own.
fn is_typed(table: &str) -> bool {
    ["strut", "drive", "run", "solver", "study", "contest", "regimes"].contains(&table)
}

/// Reads a part into `config`.
fn read(
    config: &mut Config,
    name: &'static str,
    part: &Value,
    model: Option<&Model>,
) -> Result<(), ConfigError> {
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
        _ => config.mechanism = own(config, part, model)?,
    }
    Ok(())
}

/// What is integrated, with these values of its own tables.
fn own(config: &Config, tables: &Value, model: Option<&Model>) -> Result<Chosen, ConfigError> {
    let Some(model) = model else {
        let entry = config.mechanism.entry;
        let tables = typed(OWN, tables.clone())?;
        return Chosen::new(entry, tables).map_err(|error| table(entry.name, &error));
    };
    let parameters = tables[PARAMETERS].as_object().into_iter().flatten();
    let values = parameters.filter_map(|(name, value)| Some((name.clone(), value.as_f64()?)));
    model.chosen(&values.collect::<Vec<_>>(), config.run.t_end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::keys;
    use crate::keys::DefaultValue;
    use crate::mechanisms::MECHANISMS;

    fn variants(sets: &[String], paths: &[&str]) -> Variants {
        let paths: Vec<_> = paths.iter().map(|path| (*path, Place::Default)).collect();
        Variants::new(None, None, sets, &paths).unwrap()
    }

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
            Kind::List(_) | Kind::Set(_) => vec![default.clone()],
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
                    DefaultValue::Toml(text) => {
                        entry.default_of(key.path).map_or(text, |(own, _)| own)
                    }
                    DefaultValue::Absent(example) => example,
                };
                let given = super::super::toml_source::value(text, Place::Default).unwrap();
                let default = check(&key.kind, key.path, key.unit, &given).unwrap();
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
            let mut variants = variants(&base, &[&path]);
            for value in values {
                let sets = [base[0].clone(), format!("{path}={value}")];
                // A value that is no argument does not say that it is one.
                let said = |error: ConfigError| {
                    error.to_string().replacen(&format!("--set {path}="), &format!("{path}="), 1)
                };
                let loaded = Config::load(None, &sets).map_err(said);
                let own = variants.set(&[value]).cloned().map_err(|error| error.to_string());
                assert_eq!(own, loaded, "{sets:?}");
                n_compared += 1;
            }
        }
        assert!(n_compared > 700, "{n_compared}");
    }

    #[test]
    fn a_key_that_reaches_no_joint_or_that_no_law_has_cannot_vary() {
        let own = ["joint1.contact.stiffness=1e7", "joint2.contact.stiffness=2e7"];
        let own = own.map(str::to_owned);
        let why = |sets: &[String], paths: &[&str]| variants(sets, paths).why_not(0);
        let said = why(&own, &["contact.stiffness"]).unwrap();
        assert!(said.starts_with("joint1.contact.stiffness has a value of its own"), "{said}");
        let said = why(&own[1..], &["contact.stiffness"]).unwrap();
        assert!(said.contains("as in joint1.contact.stiffness"), "{said}");
        assert_eq!(why(&[], &["contact.stiffness", "joint2.contact.stiffness"]), None);
        let said = why(&[], &["contact.restitution"]).unwrap();
        assert!(said.starts_with("contact.law = power does not have it"), "{said}");
        assert_eq!(why(&[], &["contact.restitution", "contact.law"]), None);
        assert!(why(&[], &["joint2.contact.restitution", "joint1.contact.law"]).is_some());
        let of_one = ["joint2.contact.law=hunt_crossley".to_owned()];
        assert_eq!(why(&of_one, &["joint1.contact.stiffness"]), None);
        assert_eq!(why(&of_one, &["contact.restitution"]), None);
        assert_eq!(why(&of_one, &["joint2.contact.restitution"]), None);
        assert!(why(&of_one, &["joint1.contact.restitution"]).is_some());
    }

    #[test]
    fn keys_that_vary_together_do_not_disturb_each_other() {
        let paths = ["contact.stiffness", "joint2.contact.stiffness", "friction.law", "bays"];
        let base = ["joint1.contact.damping=7.0".to_owned()];
        let mut variants = variants(&base, &paths);
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
        let mut variants = variants(&[], &["friction.law", "joint.clearance"]);
        let refused = variants.set(&["lugre".into(), 0.0.into()]).unwrap_err().to_string();
        assert!(refused.contains("does not go with friction.law = lugre"), "{refused}");
        let refused = variants.set(&["lugre".into(), (-1.0).into()]).unwrap_err().to_string();
        let expected = "joint.clearance=-1.0: joint.clearance = -1.0 is out of range";
        assert!(refused.starts_with(expected), "{refused}");
        let sets = ["friction.law=coulomb".to_owned(), "joint.clearance=0".to_owned()];
        let loaded = Config::load(None, &sets).unwrap();
        assert_eq!(*variants.set(&["coulomb".into(), 0.0.into()]).unwrap(), loaded);
    }
}
