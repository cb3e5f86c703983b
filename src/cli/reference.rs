//! The reference of a study, kept beside its results: made once for a model and a run.

use std::sync::atomic::AtomicBool;

use deltazero::config::Config;
use deltazero::keys::Study;
use deltazero::study::plan;
use deltazero_solvers::lanes::FUSED;
use deltazero_study::reference::{RECIPE, Reference};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::output::{Output, hash};
use super::{Failure, say};

/// Its file.
const FILE: &str = "reference.json";

#[derive(Serialize, Deserialize)]
struct Kept<R> {
    /// The hash of all that it follows from.
    hash: String,
    reference: R,
}

/// The reference of `config`: the one on disk if it is of the same model, run and recipe, else made anew
/// and written.
pub(super) fn reference(
    output: &Output,
    config: &Config,
    stop: &AtomicBool,
    quiet: bool,
) -> Result<Reference, Failure> {
    let hash = hash_of(config);
    if let Some(text) = output.bytes(FILE) {
        match serde_json::from_slice::<Kept<Reference>>(&text) {
            Ok(kept) if kept.hash == hash => return Ok(kept.reference),
            Ok(_) => {}
            Err(error) if !quiet => {
                say(&format!("{}/{FILE}: {error}; the reference is made anew", output.path()));
            }
            Err(_) => {}
        }
    }
    let reference =
        plan::reference(config, stop).map_err(|error| Failure::Run(error.to_string()))?;
    let kept = Kept { hash, reference: &reference };
    let text = serde_json::to_vec(&kept).map_err(|error| Failure::Run(error.to_string()))?;
    output.write(FILE, &text)?;
    Ok(reference)
}

/// What methods are compared, and which one `simulate` takes, is nothing to a reference.
fn hash_of(config: &Config) -> String {
    let mut json = config.to_json();
    if let Value::Object(tables) = &mut json {
        tables.remove("solver");
        for table in ["study", "contest", "regimes"] {
            tables.remove(table);
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let Study { reference: digits, max_rhs, max_seconds, .. } = config.study;
    // Taylor series with fused multiply-add and without have other last bits.
    let build = if FUSED { " fused" } else { "" };
    hash(&format!("reference {version} {RECIPE} {digits} {max_rhs} {max_seconds}{build}"), &json)
}
