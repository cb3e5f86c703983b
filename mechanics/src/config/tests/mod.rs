//! Tests of the configuration, by what a user sees.

mod defaults;
mod files;
mod joints;
mod json;
mod mechanisms;
mod messages;
mod models;
mod numbers;

use super::values::Values;
use super::{Config, ConfigError, toml_source};
use crate::keys::Key;
use crate::mechanisms::MECHANISMS;

/// The configuration of a TOML text, called `bad.toml`, and `--set` arguments.
fn load(text: &str, sets: &[&str]) -> Result<Config, ConfigError> {
    let mut settings = Values::defaults()?;
    settings.apply("", &toml_source::document("bad.toml", text)?)?;
    for set in sets {
        let (key, given) = toml_source::assignment(set)?;
        settings.apply(&key, &given)?;
    }
    settings.config()
}

/// The assignment that chooses a mechanism with this key.
fn mechanism_of(key: &Key) -> String {
    let entry = MECHANISMS.iter().find(|entry| entry.has(key)).unwrap();
    format!("mechanism={}", entry.name)
}

/// The message with which a TOML text is refused.
fn refusal(text: &str) -> String {
    load(text, &[]).expect_err(text).to_string()
}

/// The message with which one `--set` argument is refused.
fn set_refusal(set: &str) -> String {
    load("", &[set]).expect_err(set).to_string()
}
