//! The settings that a model's file holds.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

use crate::config::{Config, ConfigError};

const BALL: &str = "t_end = 2\n[parameters]\ng = { value = 9.81, above = 0 }\n[states]\nx = 1\nv = 0\n\
                    [modes.flight]\nrates = { x = \"v\", v = \"-g\" }\n";

/// The configuration of a model's text, in a file called `ball.toml`, with `--set` arguments.
fn load(text: &str, sets: &[&str]) -> Result<Config, ConfigError> {
    let dir = TempDir::new().unwrap();
    let file: PathBuf = dir.path().join("ball.toml");
    fs::write(&file, text).unwrap();
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Config::load_with(Some(&file), None, &sets)
}

#[test]
fn settings_of_a_model_stand_under_those_that_are_set() {
    let text = format!("{BALL}[solver]\nmethod = \"rk45\"\nrtol = 1e-5\n");
    let config = load(&text, &["solver.rtol=1e-9"]).unwrap();
    assert_eq!((config.solver.method.as_str(), config.solver.rtol), ("rk45", 1e-9));
    assert_eq!((config.run.t_end, config.run.sample), (2.0, 2.0 / 500.0));
}

#[test]
fn a_wrong_setting_of_a_model_is_told_with_its_line() {
    let refused = load(&format!("{BALL}[solver]\nmethod = \"none\"\n"), &[]);
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("ball.toml:10: solver.method = \"none\" is unknown"), "{refused}");
    let refused = load(&BALL.replace("t_end = 2", "[run]\nt_end = -1"), &[]);
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("ball.toml:2: run.t_end = -1 is out of range"), "{refused}");
}
