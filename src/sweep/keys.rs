//! The keys that a plan names: each once, and one that the mechanism or the model has.

use super::SweepError;
use super::table::Table;
use crate::config::{Config, Place, Variants, Varied};
use crate::keys::one_joint;

/// The keys that the tables name, and where.
pub(super) fn named<'a>(
    tables: impl Iterator<Item = &'a Table<'a>>,
) -> Result<Vec<(&'a str, Place)>, SweepError> {
    let mut keys = Vec::new();
    for table in tables {
        let (path, given) = table.word("key", "has no \"key\"; give a key of the configuration")?;
        if path == "mechanism" {
            let reason =
                "each mechanism has keys and columns of its own; make a plan for each".to_owned();
            return Err(not_swept(&given.place, path, reason));
        }
        keys.push((path, given.place.clone()));
    }
    Ok(keys)
}

/// Whether each key is named once, and is one that the mechanism uses.
pub(super) fn check(variants: &Variants, named: &[(&str, Place)]) -> Result<(), SweepError> {
    let varied = variants.varied();
    for (i, (own, (path, place))) in varied.iter().zip(named).enumerate() {
        if let Some(first) = varied[..i].iter().position(|known| known.path == own.path) {
            let reason = format!("it is swept already, at {}; give it once", named[first].1);
            return Err(not_swept(place, path, reason));
        }
        is_of_mechanism(variants.config(), own, place)?;
    }
    Ok(())
}

/// Whether the mechanism uses a key: one that it does not use would change nothing.
fn is_of_mechanism(config: &Config, varied: &Varied, place: &Place) -> Result<(), SweepError> {
    let (entry, path) = (config.mechanism.entry, &varied.path);
    let reason = if varied.key.is_some_and(|key| !entry.has(key)) {
        format!(
            "mechanism = {} does not use it; `deltazero config --set mechanism={}` lists the keys that it uses",
            entry.name, entry.name
        )
    } else if one_joint(path).is_some() && !entry.has_two_joints {
        format!("mechanism = {} has one joint; give the key without joint1 or joint2", entry.name)
    } else {
        return Ok(());
    };
    Err(not_swept(place, path, reason))
}

fn not_swept(place: &Place, key: &str, reason: String) -> SweepError {
    SweepError::NotSwept { place: place.clone(), key: key.to_owned(), reason }
}
