//! What a report says of each mechanism, as in `words.txt`: the words are those that it prints, and their numbers are held by tests of
//! the laws and of the mechanisms. And which values are refused.

use std::fmt::Write as _;

use deltazero_text::models::MODELS;
use tempfile::TempDir;

use crate::config::Config;

/// What a report says of the mechanism that these settings choose.
fn words(sets: &[&str]) -> String {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    words_of(&sets.join(" "), &Config::load(None, &sets).unwrap())
}

/// What it says of a model that comes with the program.
fn words_of_model(name: &str) -> String {
    let model = MODELS.iter().find(|model| model.name == name).unwrap();
    let dir = TempDir::new().unwrap();
    let file = dir.path().join(format!("{name}.toml"));
    std::fs::write(&file, model.text).unwrap();
    let config = Config::load_with(Some(&file), None, &[]).unwrap();
    let units = ["m", "e", "none"].map(|name| config.mechanism.unit_of(name));
    let folder = format!("{}/", dir.path().display());
    words_of(&format!("{name}, units {units:?}"), &config).replace(&folder, "")
}

fn words_of(head: &str, config: &Config) -> String {
    let mechanism = &config.mechanism;
    let mut text = format!("== {head}\n");
    let mut line = |name: &str, what: &str| writeln!(text, "{name}: {what}").unwrap();
    line("title", &mechanism.title(config));
    line("lead", mechanism.lead());
    line("model", &mechanism.is_model().to_string());
    line("sites", &mechanism.n_sites(config).to_string());
    line("tolerances", &mechanism.n_tolerances().to_string());
    for (name, what) in mechanism.facts(config) {
        line(&name, &what);
    }
    for (column, meaning, value) in mechanism.leading(config) {
        line("column", &format!("{column}, {meaning}, {value}"));
    }
    for warning in mechanism.warnings(config) {
        line("warning", &warning.message);
    }
    if let Some(reason) = mechanism.no_blind_runs(config) {
        line("no blind runs", &reason);
    }
    text
}

#[test]
fn a_report_says_of_each_mechanism_what_it_is() {
    let found: String = [
        &["mechanism=strut"] as &[_],
        &["bays=3", "reading=pin", "joint2.contact.stiffness=2e7"],
        &["contact.law=flores", "contact.restitution=0.5", "joint2.friction.law=lugre"],
        &["mechanism=slider-crank", "contact.law=johnson"],
        &["mechanism=four-bar", "friction.law=ambrosio", "contact.adhesion=false"],
        &["mechanism=cam-follower", "contact.law=lankarani_nikravesh", "contact.restitution=0.6"],
        &["mechanism=cam-follower", "contact.law=johnson", "contact.curvature=external"],
        &["mechanism=rocking-block", "rocking_block.base_amplitude=2"],
        &["mechanism=impact-oscillator"],
    ]
    .map(words)
    .into_iter()
    .chain(["carts", "bouncing_ball"].map(words_of_model))
    .collect();
    let expected = include_str!("words.txt");
    for (found, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(found, expected);
    }
    assert!(found == expected, "{found}");
}

/// Whether the settings are refused, which must be for the first of them.
fn is_refused(sets: &[(&str, f64)]) -> bool {
    let texts: Vec<String> = sets.iter().map(|(key, value)| format!("{key}={value:?}")).collect();
    let mechanism = sets[0].0.split('.').next().unwrap().replace('_', "-");
    let mut all = texts;
    all.push(format!("mechanism={mechanism}"));
    match Config::load(None, &all) {
        Ok(_) => false,
        Err(error) => {
            let error = error.to_string();
            assert!(error.contains(&format!("{} = ", sets[0].0)), "{error}");
            true
        }
    }
}

/// Fails unless the first setting is taken on one side of a value alone; the others go with it.
fn assert_limit(key: &str, limit: f64, is_upper: bool, others: &[(&str, f64)]) {
    for (value, is_beyond) in [(limit - 1e-9, !is_upper), (limit + 1e-9, is_upper)] {
        let sets: Vec<_> = [(key, value)].into_iter().chain(others.iter().copied()).collect();
        assert_eq!(is_refused(&sets), is_beyond, "{sets:?}");
    }
}

#[test]
fn a_mechanism_is_refused_from_the_value_on_at_which_it_cannot_move() {
    let clearance = ("joint.clearance", 0.01);
    // Crank 0.5 m, rocker 2 m, pivots 3 m apart: |coupler − rocker| < pivots − crank − 2 c.
    let bar = [("four_bar.crank_length", 0.5), ("four_bar.rocker_length", 2.0), clearance];
    let pivots = ("four_bar.ground_length", 3.0);
    let with = |other| bar.into_iter().chain([other]).collect::<Vec<_>>();
    assert_limit("four_bar.coupler_length", 2.0 + (3.0 - 0.5 - 0.02), true, &with(pivots));
    // pivots + crank + 2 c < coupler + rocker.
    let coupler = ("four_bar.coupler_length", 2.5);
    assert_limit("four_bar.ground_length", 2.5 + 2.0 - 0.5 - 0.02, true, &with(coupler));

    let crank = ("slider_crank.crank_length", 0.05);
    assert_limit("slider_crank.rod_length", 0.05 + 0.01, false, &[crank, clearance]);

    assert_limit("impact_oscillator.start_position", 0.0, true, &[]);
    let (no_force, no_gap) = (("impact_oscillator.amplitude", 0.0), ("impact_oscillator.gap", 0.0));
    assert!(is_refused(&[no_force, no_gap]));
    assert!(!is_refused(&[no_force]) && !is_refused(&[no_gap]));

    let alpha = libm::atan2(0.2, 0.8);
    let overturned = alpha + std::f64::consts::FRAC_PI_4;
    assert_limit("rocking_block.start_angle", overturned, true, &[]);
    assert_limit("rocking_block.start_angle", -overturned, false, &[]);
    // 1 − (3/2) sin²α ≥ 0: tan α ≤ √2.
    let height = ("rocking_block.half_height", 1.0);
    assert_limit("rocking_block.half_width", 2f64.sqrt(), true, &[height]);
}

#[test]
fn mechanisms_are_equal_if_name_and_values_are() {
    let chosen = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        Config::load(None, &sets).unwrap().mechanism
    };
    let block = chosen(&["mechanism=rocking-block"]);
    assert_eq!(block, chosen(&["mechanism=rocking-block", "rocking_block.mass=1000"]));
    assert_ne!(block, chosen(&["mechanism=rocking-block", "rocking_block.mass=999"]));
    assert_ne!(block, chosen(&["mechanism=impact-oscillator"]));
}
