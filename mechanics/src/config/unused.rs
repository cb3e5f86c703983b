//! Keys of joints that a law does not have: a value of theirs changes nothing.

use deltazero_study::warning::{Code, Warning};
use serde_json::Value;

use super::{Config, find, json};
use crate::keys::{FrictionLaw, JOINTS, JointConfig};
use crate::laws::Relation;

/// Whether the law of a joint has a key.
type Has = fn(&JointConfig) -> bool;

/// A table of keys that belong to one law.
struct OfLaw {
    table: &'static str,
    /// The law of a joint.
    law: fn(&JointConfig) -> String,
    /// Keys that only some laws have.
    of_some: &'static [(&'static str, Has)],
}

const CONTACT: OfLaw = OfLaw {
    table: "contact",
    law: |joint| joint.contact.law.to_string(),
    of_some: &[
        ("stiffness", |joint| !joint.contact.law.is_of_cylinders()),
        ("exponent", |joint| !joint.contact.law.is_of_cylinders()),
        ("damping", |joint| !joint.contact.law.has_memory()),
        ("restitution", |joint| joint.contact.law.has_memory()),
        ("impact_speed_floor", |joint| joint.contact.law.has_memory()),
        ("young_modulus", |joint| joint.contact.law.is_of_cylinders()),
        ("poisson_ratio", |joint| joint.contact.law.is_of_cylinders()),
        ("length", |joint| matches!(joint.contact.law.relation, Relation::Line(_))),
        ("curvature", |joint| joint.contact.law.is_of_cylinders()),
    ],
};

const FRICTION: OfLaw = OfLaw {
    table: "friction",
    law: |joint| joint.friction.law.to_string(),
    of_some: &[
        ("static_coefficient", falls_from_rest),
        ("stribeck_speed", falls_from_rest),
        ("regularisation_speed", is_regularised),
        ("dead_ratio", |joint| joint.friction.law == FrictionLaw::Ambrosio),
        ("bristle_stiffness", has_bristles),
        ("bristle_damping", has_bristles),
        ("viscosity", has_bristles),
    ],
};

fn falls_from_rest(joint: &JointConfig) -> bool {
    matches!(joint.friction.law, FrictionLaw::Stribeck | FrictionLaw::Lugre)
}

fn is_regularised(joint: &JointConfig) -> bool {
    use FrictionLaw::{Ambrosio, Tanh, Threlfall};
    matches!(joint.friction.law, Tanh | Ambrosio | Threlfall)
}

fn has_bristles(joint: &JointConfig) -> bool {
    joint.friction.law == FrictionLaw::Lugre
}

/// The law of a joint, where it does not have this key.
pub(super) fn law_without(path: &str, joint: &JointConfig) -> Option<String> {
    let (table, name) = path.split_once('.')?;
    let OfLaw { law, of_some, .. } =
        [CONTACT, FRICTION].into_iter().find(|of| of.table == table)?;
    let (_, has) = of_some.iter().find(|(own, _)| *own == name)?;
    (!has(joint)).then(|| format!("{table}.law = {}", law(joint)))
}

/// Warnings of keys of the mechanism that have another value than by default, which the law of their joint does not have.
pub(super) fn unused(config: &Config) -> Vec<Warning> {
    let entry = config.mechanism.entry;
    let Ok(default) = Config::load(None, &[format!("mechanism={}", entry.name)]) else {
        return Vec::new();
    };
    let [one, two] = &config.joints;
    let n = if entry.has_two_joints && one != two { 2 } else { 1 };
    let mut warnings = Vec::new();
    for (i, (joint, usual)) in config.joints.iter().zip(&default.joints).enumerate().take(n) {
        let [given, usual] = [joint, usual].map(json);
        for OfLaw { table, of_some, .. } in [CONTACT, FRICTION] {
            for (name, _) in of_some {
                let key = format!("{table}.{name}");
                let value = &given[table][name];
                let is_own = find(&key).is_some_and(|key| entry.has(key));
                if is_own
                    && *value != usual[table][name]
                    && let Some(law) = law_without(&key, joint)
                {
                    let key = if n == 2 { format!("{}.{key}", JOINTS[i]) } else { key };
                    warnings.push(warning(&key, value, &law));
                }
            }
        }
    }
    warnings
}

fn warning(key: &str, value: &Value, law: &str) -> Warning {
    let message = format!(
        "{key} = {value} changes nothing: {law} does not have it; `deltazero laws` tells what each is of"
    );
    Warning { code: Code::Unused, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(sets: &[&str]) -> Vec<String> {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let warnings = unused(&Config::load(None, &sets).unwrap());
        warnings.into_iter().map(|warning| warning.message).collect()
    }

    #[test]
    fn a_key_that_the_law_does_not_have_is_told_where_it_has_another_value() {
        assert_eq!(told(&[]), [] as [&str; 0]);
        let damped = told(&["contact.law=hunt_crossley", "contact.damping=900"]);
        assert!(
            damped.len() == 1
                && damped[0]
                    .starts_with("contact.damping = 900.0 changes nothing: contact.law = hunt"),
            "{damped:?}"
        );
        assert_eq!(told(&["contact.damping=900", "joint2.contact.stiffness=1e8"]), [] as [&str; 0]);
        let second = told(&["joint2.contact.restitution=0.5"]);
        assert!(
            second.len() == 1 && second[0].starts_with("joint2.contact.restitution"),
            "{second:?}"
        );
        let rough = told(&["friction.viscosity=0.1", "friction.regularisation_speed=1e-3"]);
        assert_eq!(rough.len(), 2, "{rough:?}");
        assert_eq!(told(&["friction.law=lugre", "friction.viscosity=0.1"]), [] as [&str; 0]);
    }

    #[test]
    fn defaults_of_each_mechanism_are_no_reason_to_warn() {
        for entry in crate::mechanisms::MECHANISMS {
            assert_eq!(
                told(&[&format!("mechanism={}", entry.name)]),
                [] as [&str; 0],
                "{}",
                entry.name
            );
        }
    }
}
