//! The keys that a plan names: each once, and one that the mechanism or the model has.

use super::SweepError;
use super::table::Table;
use crate::config::{Place, Variants};

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

/// Whether each key is named once, and is one that can vary.
pub(super) fn check(variants: &Variants, named: &[(&str, Place)]) -> Result<(), SweepError> {
    let varied = variants.varied();
    for (i, (own, (path, place))) in varied.iter().zip(named).enumerate() {
        if let Some(first) = varied[..i].iter().position(|known| known.path == own.path) {
            let reason = format!("it is swept already, at {}; give it once", named[first].1);
            return Err(not_swept(place, path, reason));
        }
        if let Some(reason) = variants.why_not(i) {
            return Err(not_swept(place, path, reason));
        }
    }
    Ok(())
}

fn not_swept(place: &Place, key: &str, reason: String) -> SweepError {
    SweepError::NotSwept { place: place.clone(), key: key.to_owned(), reason }
}
