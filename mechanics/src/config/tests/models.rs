//! Models from files: the settings that they hold, and their parameters as keys that vary.

use std::fs;
use std::path::PathBuf;

use deltazero_text::models::MODELS;
use serde_json::Value;
use tempfile::TempDir;

use crate::config::{Config, ConfigError, Model, Place, Variants};

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
fn a_parameter_with_a_long_name_is_set_and_read_again() {
    let name = "g".repeat(100);
    let text = BALL.replace("g = {", &format!("{name} = {{")).replace("-g", &format!("-{name}"));
    let config = load(&text, &[&format!("{name}=1.6")]).unwrap();
    assert_eq!(config.mechanism.tables["parameters"][&name], 1.6);
    let json = serde_json::to_value(&config).unwrap();
    assert_eq!(Config::from_json(&json).unwrap(), config);
}

#[test]
fn a_wrong_setting_of_a_model_is_told_with_its_line() {
    let refused = load(&format!("{BALL}[solver]\nmethod = \"none\"\n"), &[]);
    let refused = refused.unwrap_err().to_string();
    for own in [
        "solver.method = \"none\" is unknown",
        "ball.toml:10:10\n",
        "   |          ^^^^^^\n",
        "help: allowed: rk4, ",
    ] {
        assert!(refused.contains(own), "{own}: {refused}");
    }
    let refused = load(&BALL.replace("t_end = 2", "[run]\nt_end = -1"), &[]);
    let refused = refused.unwrap_err().to_string();
    let shown = "run.t_end = -1 is out of range\n --> DIR/ball.toml:2:9\n  |\n2 | t_end = -1\n  |         ^^\n  |\n  = help: allowed: s, greater than 0";
    let dir = refused.split("--> ").nth(1).and_then(|at| at.split("/ball.toml").next()).unwrap();
    assert_eq!(refused.replace(dir, "DIR"), shown);
}

#[test]
fn every_wrong_setting_of_a_model_is_shown_at_its_word_with_the_way_out() {
    for (table, place, help) in [
        ("[solver]\nrtoll = 1e-6\n", "10:1", "did you mean \"solver.rtol\"?"),
        ("[run]\nend = 1\n", "10:1", "did you mean \"run.t_end\"?"),
        ("[run]\nxyzzy = 1\n", "10:1", "`deltazero config` lists every setting"),
        ("[solver]\nrtol = \"tight\"\n", "10:8", "expected"),
        ("[study]\nmethods = [\"rk45\", \"rk455\"]\n", "10:20", "did you mean \"rk45\"?"),
        ("[run]\nsample = 1e-12\n", "10:1", "raise run.sample"),
        ("[contest]\nrepeats = 0\n", "10:11", "from 1"),
        // Signs that part a message are no part of it in a value, nor is a value looked for in its key.
        ("[solver]\nmethod = \"a; b: c\"\n", "10:10", "allowed: rk4, "),
        ("[run]\nsample = \"sample\"\n", "10:10", "expected a number"),
        ("[solver]\nrtoll = \"rtoll\"\n", "10:1", "did you mean \"solver.rtol\"?"),
        ("solver = { rtol = \"tight\" }\n", "1:19", "expected a number"),
        ("solver = 3\n", "1:10", "expected a table"),
    ] {
        let text = if table.starts_with('[') {
            format!("{BALL}{table}")
        } else {
            format!("{table}{BALL}")
        };
        let told = load(&text, &[]).unwrap_err().to_string();
        assert!(told.contains(&format!("ball.toml:{place}")), "{table}: {told}");
        assert!(
            told.contains('^') && told.contains("= help: ") && told.contains(help),
            "{table}: {told}"
        );
    }
}

#[test]
fn a_value_of_a_model_stands_in_its_message_as_it_is_given() {
    let refused = load(&format!("{BALL}[solver]\nmethod = \"a; b: c\"\n"), &[]).unwrap_err();
    let refused = refused.to_string();
    assert!(refused.starts_with("solver.method = \"a; b: c\" is unknown\n"), "{refused}");
}

#[test]
fn a_variant_of_a_model_is_the_configuration_that_set_gives() {
    for model in MODELS {
        let own = load(model.text, &[]).unwrap();
        let (name, value) =
            own.mechanism.tables["parameters"].as_object().unwrap().iter().next().unwrap();
        let paths = [name.as_str(), "solver.rtol", "run.t_end"];
        let values: [Value; 3] = [value.clone(), 1e-5.into(), (0.5 * own.run.t_end).into()];
        for n in 1..=3 {
            let keys: Vec<_> = paths[..n].iter().map(|path| (*path, Place::Default)).collect();
            let from = Model::new("ball.toml", model.text).unwrap();
            let mut variants = Variants::new(Some(from), None, &[], &keys).unwrap();
            let sets = paths.iter().zip(&values).map(|(path, value)| format!("{path}={value}"));
            let sets: Vec<String> = sets.take(n).collect();
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            // The file of the other is called by its folder too.
            let mut loaded = load(model.text, &sets).unwrap();
            loaded.mechanism.tables["model"]["name"] = "ball.toml".into();
            assert_eq!(*variants.set(&values[..n]).unwrap(), loaded, "{}: {sets:?}", model.name);
        }
    }
}

#[test]
fn a_value_that_a_parameter_refuses_leaves_the_next_one_right() {
    let model = Model::new("ball.toml", BALL).unwrap();
    let mut variants = Variants::new(Some(model), None, &[], &[("g", Place::Default)]).unwrap();
    let refused = variants.set(&[(-1.0).into()]).unwrap_err().to_string();
    assert_eq!(refused, "g=-1.0: g = -1.0 is out of range: greater than 0");
    assert_eq!(variants.set(&[2.0.into()]).unwrap().mechanism.tables["parameters"]["g"], 2.0);
}

#[test]
fn a_parameter_that_parts_set_cannot_vary() {
    let text = format!("{BALL}[parts.moon]\ng = 1.6\n[parts.earth]\n");
    let why = |text: &str| {
        let model = Model::new("ball.toml", text).unwrap();
        Variants::new(Some(model), None, &[], &[("g", Place::Default)]).unwrap().why_not(0)
    };
    assert!(why(&text).unwrap().starts_with("parts of the model give it values of their own"));
    assert_eq!(why(BALL), None);
}

#[test]
fn what_follows_the_end_of_a_run_is_told_from_what_was_given() {
    let following = |sets: &[&str], path: &str| {
        let model = Model::new("ball.toml", BALL).unwrap();
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        Variants::new(Some(model), None, &sets, &[(path, Place::Default)]).unwrap().following()
    };
    assert_eq!(following(&[], "run.t_end"), ["run.sample", "solver.step", "study.steps"]);
    assert_eq!(following(&["solver.step=2e-4"], "run.t_end"), ["run.sample", "study.steps"]);
    assert_eq!(following(&[], "g"), [] as [&str; 0]);
}

#[test]
fn a_printed_configuration_tells_the_defaults_of_its_model_from_what_was_given() {
    let text = BALL.replace("t_end = 2", "t_end = 3") + "[solver]\natol = 1e-9\n";
    let printed = load(&text, &[]).unwrap().commented_toml();
    for own in [
        "; the model's own.\nt_end = 3.0\n",
        "; the model's own.\natol = 1e-9\n",
        "; a share of run.t_end.\nsample = 6e-3\n",
        "; our choice.\nrtol = 1e-8\n",
    ] {
        assert!(printed.contains(own), "{own}: {printed}");
    }
    assert!(!printed.contains("; given"), "{printed}");
    let printed = load(&text, &["run.t_end=1", "run.sample=0.1"]).unwrap().commented_toml();
    for own in [
        "; given; 3.0 is the model's own.\nt_end = 1.0\n",
        "; given; 2e-3 is a share of run.t_end.\nsample = 0.1\n",
        "; a share of run.t_end.\nstep = 1e-4\n",
    ] {
        assert!(printed.contains(own), "{own}: {printed}");
    }
    let printed = load(&text, &["run.t_end=2.1"]).unwrap().commented_toml();
    assert!(printed.contains("\nsample = 4.2e-3\n"), "{printed}");
}

#[test]
fn what_a_model_does_not_use_is_refused_where_it_is_set() {
    let message = load(BALL, &["run.stop_at_90=false"]).unwrap_err().to_string();
    let start = "--set run.stop_at_90=false: \"run.stop_at_90\" is neither a parameter of the model nor a setting";
    assert!(message.starts_with(start), "{message}");
}
