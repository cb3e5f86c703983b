//! What the targets share: a folder in memory for readers that take a path, and what holds of each configuration that is read.

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use deltazero::config::Config;
use tempfile::TempDir;

/// A folder that lives as long as the process; it is left behind where that crashes.
static FOLDER: LazyLock<Option<TempDir>> = LazyLock::new(|| {
    let builder = || tempfile::Builder::new().prefix("deltazero-fuzz-").to_owned();
    builder().tempdir_in("/dev/shm").or_else(|_| builder().tempdir()).ok()
});

/// The path of a file of this name in the folder.
///
/// # Panics
/// Where no folder can be made.
pub fn path(name: &str) -> PathBuf {
    FOLDER.as_ref().map(|folder| folder.path().join(name)).expect("a folder")
}

/// The path of a file with this content.
///
/// # Panics
/// Where it cannot be written.
pub fn file(name: &str, content: &[u8]) -> PathBuf {
    let path = path(name);
    fs::write(&path, content).expect("a file");
    path
}

/// What holds of a configuration, however it was given: what is written of it reads back to what writes the same.
///
/// # Panics
/// Where it does not hold.
pub fn is_sound(config: &Config) {
    let json = config.to_json();
    let text = json.to_string();
    let parsed = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        Config::from_json(&parsed).map(|own| own.to_json()).as_ref(),
        Ok(&json),
        "read back from JSON"
    );
    let printed = file("printed.toml", config.to_toml().as_bytes());
    assert_eq!(
        Config::load(Some(&printed), &[]).map(|own| own.to_json()).as_ref(),
        Ok(&json),
        "read back from TOML"
    );
    let _ = config.mechanism.warnings(config);
}
