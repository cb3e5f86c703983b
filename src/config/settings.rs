//! The values of all keys, layer upon layer: defaults, file, `--set` in order.

use std::collections::BTreeMap;

use deltazero_solvers::Method;
use deltazero_study::setting::{Digits, Events};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::error::{ConfigError, Place};
use super::given::{Datum, Given, excerpt};
use super::keys::{
    DefaultValue, JOINT_TABLES, JOINTS, KEYS, Key, SLIDER_CRANK_DEFAULTS, find, names_in, one_joint,
};
use super::nearest::nearest_key;
use super::toml_source;
use super::words::{MechanismName, ReadingName};
use super::{Config, FrictionLaw, JointConfig};

/// Most rows of `trajectory.csv`, all joints together: 1 GB of it, and 0.9 GB of memory (measured on Table 1).
pub const MOST_ROWS: f64 = 5e6;

/// Bytes of a row, about.
pub const ROW_BYTES: f64 = 200.0;

/// Largest number of fixed steps of a run, 1e12: some three days.
const MOST_STEPS: f64 = 1e12;

/// Checked values by path, each with the place it came from.
pub(super) struct Settings {
    values: BTreeMap<String, (Value, Place)>,
}

impl Settings {
    /// The defaults of the table of keys.
    ///
    /// # Errors
    /// A default that is not TOML or not of its key's kind; a test excludes it.
    pub(super) fn defaults() -> Result<Self, ConfigError> {
        let mut settings = Self { values: BTreeMap::new() };
        for key in KEYS {
            if let DefaultValue::Toml(text) = key.default {
                settings.apply(key.path, &toml_source::value(text, Place::Default)?)?;
            }
        }
        Ok(settings)
    }

    /// Puts the defaults of the mechanism in the place of what was not given.
    ///
    /// # Errors
    /// As [`defaults`](Self::defaults).
    fn for_mechanism(&mut self) -> Result<(), ConfigError> {
        let mechanism: MechanismName = self.part("mechanism")?;
        if mechanism == MechanismName::SliderCrank {
            for &(path, text) in SLIDER_CRANK_DEFAULTS {
                if self.place(path) == Place::Default {
                    self.apply(path, &toml_source::value(text, Place::Default)?)?;
                }
            }
        }
        Ok(())
    }

    /// Sets one key, or all keys of a table; the path of the whole is empty.
    ///
    /// # Errors
    /// The first complaint in the order of the lines.
    pub(super) fn apply(&mut self, path: &str, given: &Given) -> Result<(), ConfigError> {
        let mut first = None;
        self.walk(path, given, &mut first);
        first.map_or(Ok(()), |(_, complaint)| Err(complaint))
    }

    /// As `apply`; `first` is the first complaint so far, with its line.
    fn walk(&mut self, path: &str, given: &Given, first: &mut Option<(usize, ConfigError)>) {
        let line = line(&given.place);
        if first.as_ref().is_some_and(|(first, _)| *first <= line) {
            return;
        }
        match (find(path), &given.datum) {
            (Some(key), _) => match key.kind.check(path, key.unit, given) {
                Ok(value) => {
                    self.values.insert(path.to_owned(), (value, given.place.clone()));
                }
                Err(complaint) => *first = Some((line, complaint)),
            },
            (None, Datum::Table(entries)) if path.is_empty() => {
                for (name, entry) in entries {
                    self.walk(name, entry, first);
                }
            }
            (None, Datum::Table(entries)) if names_in(path).is_some() => {
                for (name, entry) in entries {
                    self.walk(&format!("{path}.{name}"), entry, first);
                }
            }
            _ => *first = Some((line, not_a_key(path, given))),
        }
    }

    /// The typed configuration.
    ///
    /// # Errors
    /// Values that do not go together.
    pub(super) fn config(&mut self) -> Result<Config, ConfigError> {
        self.for_mechanism()?;
        let config = Config {
            mechanism: self.part("mechanism")?,
            reading: self.part("reading")?,
            bays: self.part("bays")?,
            strut: self.part("strut")?,
            drive: self.part("drive")?,
            slider_crank: self.part("slider_crank")?,
            joints: [self.joint(JOINTS[0])?, self.joint(JOINTS[1])?],
            run: self.part("run")?,
            solver: self.part("solver")?,
            study: self.part("study")?,
            contest: self.part("contest")?,
            regimes: self.part("regimes")?,
        };
        self.cross_check(&config)?;
        Ok(config)
    }

    /// What a slider-crank cannot have.
    fn check_slider_crank(&self, config: &Config) -> Result<(), ConfigError> {
        if config.mechanism != MechanismName::SliderCrank {
            return Ok(());
        }
        let refused = |key: &str, found: String, reason| {
            let (place, found) = (self.place(key), format!("{key} = {found}").into());
            Err(ConfigError::NotInASliderCrank { place, found, reason })
        };
        if config.bays != 1 {
            let reason = "bays are of struts; use bays = 1";
            return refused("bays", config.bays.to_string(), reason);
        }
        if config.reading != ReadingName::Full {
            let reason = "readings are of the struts' paper, here force and torque of friction both act; \
                          use reading = \"full\", and for a file with all of its keys \
                          `deltazero config --set mechanism=slider-crank`";
            return refused("reading", config.reading.to_string(), reason);
        }
        if let Some((key, (value, _))) =
            self.values.iter().find(|(path, _)| one_joint(path).is_some())
        {
            let reason = "it has one joint; give the key in [joint], [contact] or [friction]";
            return refused(key, value.to_string(), reason);
        }
        let (own, clearance) = (&config.slider_crank, config.joints[0].joint.clearance);
        if own.rod_length <= own.crank_length + clearance {
            let reason =
                "the rod must be longer than crank_length + joint.clearance to turn around";
            return refused("slider_crank.rod_length", own.rod_length.to_string(), reason);
        }
        Ok(())
    }

    /// What a chain of several bays cannot have.
    fn check_chain(&self, config: &Config) -> Result<(), ConfigError> {
        let bays = config.bays;
        let refused = |key: &str, found: String, reason| {
            let place = match self.place(key) {
                Place::Default => self.place("bays"),
                place => place,
            };
            let found = format!("{key} = {found}").into();
            Err(ConfigError::NotInAChain { place, bays, found, reason })
        };
        if bays == 1 {
            return Ok(());
        }
        if config.reading != ReadingName::Pin {
            let reason = "friction as a force couples the sticks of neighbours, and a force at the \
                          centroid has no reaction at the bush; use reading = \"pin\"";
            return refused("reading", config.reading.to_string(), reason);
        }
        let others = |readings: &&Vec<ReadingName>| readings.iter().any(|r| *r != ReadingName::Pin);
        if config.regimes.readings.as_ref().filter(others).is_some() {
            let reason = "a chain is one of reading \"pin\"; use regimes.readings = [\"pin\"]";
            return refused("regimes.readings", "others than pin".to_owned(), reason);
        }
        if config.joints[0].joint.clearance == 0.0 {
            let reason = "pins that are held couple the accelerations of all bays; use a clearance \
                          above zero";
            return refused("joint.clearance", "0".to_owned(), reason);
        }
        if config.study.reference == Digits::Extended {
            let reason =
                "extended precision is built for one bay; use study.reference = \"double\"";
            return refused("study.reference", config.study.reference.to_string(), reason);
        }
        Ok(())
    }

    /// What a joint whose friction has bristles cannot have.
    fn check_bristles(&self, config: &Config) -> Result<(), ConfigError> {
        let joints = JOINTS.iter().zip(&config.joints);
        for (name, joint) in joints.filter(|(_, joint)| joint.friction.law == FrictionLaw::Lugre) {
            let refused = |key: &str, value: String, reason| {
                let law = "friction.law";
                let own = |key| format!("{name}.{key}");
                let places = [own(key), key.to_owned(), own(law), law.to_owned()];
                let places = places.iter().map(|path| self.place(path));
                let place = places.into_iter().find(|place| *place != Place::Default);
                let found = format!("{key} = {value}").into();
                let place = place.unwrap_or(Place::Default);
                Err(ConfigError::NotWithBristles { place, found, reason })
            };
            if joint.joint.clearance == 0.0 {
                let reason =
                    "a pin that is held does not slide; use a clearance above zero, or coulomb";
                return refused("joint.clearance", "0".to_owned(), reason);
            }
            let friction = &joint.friction;
            let coefficients = [
                ("friction.coefficient", friction.coefficient),
                ("friction.static_coefficient", friction.static_coefficient),
            ];
            if let Some((key, _)) = coefficients.into_iter().find(|(_, mu)| *mu == 0.0) {
                let reason = "bristles that slide at no deflection have no rate; use coefficients above \
                              zero, or coulomb";
                return refused(key, "0".to_owned(), reason);
            }
            if config.study.reference == Digits::Extended {
                let reason =
                    "extended precision is built without them; use study.reference = \"double\"";
                return refused("study.reference", config.study.reference.to_string(), reason);
            }
        }
        Ok(())
    }

    /// What no key alone can tell.
    fn cross_check(&self, config: &Config) -> Result<(), ConfigError> {
        self.check_slider_crank(config)?;
        self.check_chain(config)?;
        self.check_bristles(config)?;
        self.check_events(config)?;
        let (t_end, sample) = (config.run.t_end, config.run.sample);
        let joints = config.n_joints();
        if sample > 0.0 && t_end / sample * joints as f64 > MOST_ROWS {
            let place = match self.place("run.sample") {
                Place::Default => self.place("run.t_end"),
                place => place,
            };
            return Err(ConfigError::TooManySamples {
                place,
                sample,
                t_end,
                joints,
                most: MOST_ROWS,
            });
        }
        let step = config.solver.step;
        let is_fixed = Method::named(&config.solver.method).is_some_and(Method::is_fixed_step);
        if is_fixed && t_end / step > MOST_STEPS {
            let place = match self.place("solver.step") {
                Place::Default => self.place("run.t_end"),
                place => place,
            };
            return Err(ConfigError::TooManySteps { place, step, t_end, most: MOST_STEPS });
        }
        Ok(())
    }

    /// Whether there are runs of the kind that is asked for.
    fn check_events(&self, config: &Config) -> Result<(), ConfigError> {
        let asked: [(_, &[Events]); 3] = [
            ("solver.events", &[config.solver.events]),
            ("study.events", &config.study.events),
            ("contest.events", &config.contest.events),
        ];
        let Some(reason) = config.no_blind_runs() else { return Ok(()) };
        match asked.iter().find(|(_, events)| !events.contains(&Events::Located)) {
            Some((key, _)) => {
                Err(ConfigError::NoBlindRuns { place: self.place(key), key, reason: reason.into() })
            }
            None => Ok(()),
        }
    }

    fn place(&self, path: &str) -> Place {
        self.values.get(path).map_or(Place::Default, |(_, place)| place.clone())
    }

    /// A table, or a key of the root, as its type.
    fn part<T: DeserializeOwned>(&self, part: &str) -> Result<T, ConfigError> {
        let value = match self.values.get(part) {
            Some((value, _)) => value.clone(),
            None => self.table(part, None),
        };
        typed(part, value)
    }

    /// The three tables of one joint, each key its own value or else the common one.
    fn joint(&self, joint: &str) -> Result<JointConfig, ConfigError> {
        let tables = JOINT_TABLES.map(|table| (table.to_owned(), self.table(table, Some(joint))));
        typed(joint, Value::Object(Map::from_iter(tables)))
    }

    fn table(&self, table: &str, joint: Option<&str>) -> Value {
        let value = |key: &Key| {
            let own = joint.and_then(|joint| self.values.get(&format!("{joint}.{}", key.path)));
            let (value, _) = own.or_else(|| self.values.get(key.path))?;
            Some((key.name().to_owned(), value.clone()))
        };
        let keys = KEYS.iter().filter(|key| key.table() == Some(table));
        Value::Object(keys.filter_map(value).collect())
    }
}

fn typed<T: DeserializeOwned>(part: &str, value: Value) -> Result<T, ConfigError> {
    serde_json::from_value(value).map_err(|error| ConfigError::Table {
        part: part.into(),
        message: error.to_string().into(),
    })
}

/// The complaint about a path that is no key, or about a table that is none.
fn not_a_key(path: &str, given: &Given) -> ConfigError {
    if path.is_empty() {
        return given.wrong_type("the configuration", "a table of keys");
    }
    if let Some(names) = names_in(path) {
        return given.wrong_type(path, &format!("a table with any of {}", names.join(", ")));
    }
    let (place, key) = (given.place.clone(), excerpt(path));
    let exists = |path| find(path).is_some() || names_in(path).is_some();
    if one_joint(path).is_some_and(|(_, rest)| exists(rest)) {
        return ConfigError::NotPerJoint { place, key: key.into() };
    }
    let nearest = nearest_key(&key, matches!(given.datum, Datum::Table(_)));
    ConfigError::UnknownKey { place, key: key.into(), nearest: nearest.map(Into::into) }
}

/// The line of a place; 0 where there are no lines.
fn line(place: &Place) -> usize {
    match place {
        Place::Line { line, .. } => *line,
        _ => 0,
    }
}
