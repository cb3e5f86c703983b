//! Puts the values of all keys together, and says whether they go together.

use deltazero_solvers::Method;
use deltazero_study::setting::{Digits, Events};
use serde_json::Value;

use super::Config;
use super::all_keys::find;
use super::error::{ConfigError, Place};
use super::values::Values;
use crate::keys::{Atol, FrictionLaw, JOINTS, Key, Shared, one_joint};
use crate::mechanisms::Misfit;

/// Most rows of `trajectory.csv`, all joints together: 1 GB of it, and 0.9 GB of memory (measured on Table 1).
pub const MOST_ROWS: f64 = 5e6;

/// Largest number of fixed steps of a run, 1e12: some three days.
const MOST_STEPS: f64 = 1e12;

impl Values {
    /// The typed configuration.
    ///
    /// # Errors
    /// Values that do not go together.
    pub(super) fn config(&mut self) -> Result<Config, ConfigError> {
        let config = Config {
            mechanism: self.chosen()?,
            shared: Shared {
                reading: self.part("reading")?,
                bays: self.part("bays")?,
                strut: self.part("strut")?,
                drive: self.part("drive")?,
                joints: [self.joint(JOINTS[0])?, self.joint(JOINTS[1])?],
                run: self.part("run")?,
                solver: self.part("solver")?,
                study: self.part("study")?,
                contest: self.part("contest")?,
                regimes: self.part("regimes")?,
            },
        };
        match (self.cross_check(&config), &self.model) {
            (Err(error), Some(model)) => Err(model.shown(error)),
            (checked, _) => checked.map(|()| config),
        }
    }

    /// What the mechanism cannot have: a key of another one, at the root or set by an argument, where it is not at its
    /// default, and values that do not go together. A table of another mechanism in a file is not used.
    fn check_mechanism(&self, config: &Config) -> Result<(), ConfigError> {
        let entry = config.mechanism.entry;
        let refused = |key: &str, found: String, against: &str, reason: String| {
            let place = match self.place(key) {
                Place::Default => self.place(against),
                place => place,
            };
            let value = self.values.get(against).map_or(Value::Null, |(value, _)| value.clone());
            let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            let (found, with) = (format!("{key} = {found}"), format!("{against} = {value}"));
            let (found, with) = (found.into(), with.into());
            Err(ConfigError::NotInMechanism { place, found, with, reason: reason.into() })
        };
        for (path, (value, place)) in &self.values {
            if *place == Place::Default {
                continue;
            }
            let value = || value.to_string();
            if one_joint(path).is_some() && !entry.has_two_joints {
                let reason = "only a mechanism of two joints has such keys; give the key without joint1 or joint2";
                return refused(path, value(), "mechanism", reason.to_owned());
            }
            // A file may hold the tables of other mechanisms; who sets a key means this one.
            let is_meant = |key: &Key| {
                key.table().is_none() || matches!(place, Place::Set(_) | Place::Varied(_))
            };
            let is_foreign = find(path).is_some_and(|key| is_meant(key) && !entry.has(key));
            if is_foreign && !self.is_default(path) {
                if self.model.is_some() {
                    let (place, key) = (place.clone(), path.as_str().into());
                    return Err(ConfigError::NotOfModel { place, key, nearest: None });
                }
                let reason = format!(
                    "the mechanism has no such key; `deltazero config --set mechanism={}` lists those that it has",
                    entry.name
                );
                return refused(path, value(), "mechanism", reason);
            }
        }
        if let Some(Atol::Each(each)) = &config.solver.atol
            && each.len() != config.mechanism.n_tolerances()
        {
            return Err(ConfigError::WrongLength {
                place: self.place("solver.atol"),
                key: "solver.atol".into(),
                value: format!("{each:?}").into(),
                found: each.len(),
                expected: format!(
                    "one number for all states, or {}",
                    config.mechanism.n_tolerances()
                )
                .into(),
            });
        }
        match config.mechanism.check(config) {
            Ok(()) => Ok(()),
            Err(Misfit { key, found, against, reason }) => {
                refused(key, found, against, reason.to_owned())
            }
        }
    }

    /// What a joint whose friction has bristles cannot have.
    fn check_bristles(&self, config: &Config) -> Result<(), ConfigError> {
        if !config.mechanism.entry.uses.contains(&"friction") {
            return Ok(());
        }
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
    pub(super) fn cross_check(&self, config: &Config) -> Result<(), ConfigError> {
        self.check_mechanism(config)?;
        self.check_bristles(config)?;
        self.check_events(config)?;
        let (t_end, sample) = (config.run.t_end, config.run.sample);
        let joints = config.mechanism.n_sites(config);
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
}
