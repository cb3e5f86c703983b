//! Configurations that once went wrong: `tests/cases/README.md` says how.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

#[path = "../benches/drawn/mod.rs"]
mod drawn;

use std::path::Path;

use deltazero::config::Config;
use drawn::audit::Budget;
use drawn::verdict::{Class, Verdict};

const BUDGET: Budget = Budget { work: 5e6, wall_s: 60.0 };

/// What is wrong with these cases.
fn wrong(names: &[&str]) -> Vec<String> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    let verdict = |name: &&str| {
        let config = Config::load(Some(&dir.join(format!("{name}.toml"))), &[]).unwrap();
        let verdict = Verdict::of(&config, BUDGET);
        let is_wrong = verdict.class > Class::Refused;
        is_wrong.then(|| format!("{name}: {}\n  {}", verdict.class, verdict.lines.join("\n  ")))
    };
    names.iter().filter_map(verdict).collect()
}

fn assert_right(names: &[&str]) {
    let wrong = wrong(names);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_step_passes_over_what_bristles_feel_before_they_stop() {
    assert_right(&["r1-480"]);
}

#[test]
fn a_flat_force_ends_where_its_penetration_does() {
    assert_right(&["r1-565"]);
}

#[test]
fn a_pin_deeper_than_its_radius_is_beyond_the_model() {
    assert_right(&["r1-928"]);
}

#[test]
fn a_contact_without_adhesion_ends_where_its_pin_leaves_the_bush() {
    assert_right(&["flores", "hunt-crossley"]);
}

#[test]
fn a_contact_without_adhesion_ends_in_five_bays_too() {
    assert_right(&["p1-97"]);
}

// Two tests, as these take most of the time of this file, and tests run side by side.
#[test]
fn cylinders_by_logarithm_that_were_drawn_first_run_by_every_method() {
    assert_right(&["p1-0", "p1-41", "p1-96", "p1-143", "p2-17", "p2-70"]);
}

#[test]
fn cylinders_by_logarithm_that_were_drawn_later_run_by_every_method() {
    assert_right(&["p2-73", "p2-74", "p2-77", "p2-91", "p2-103", "p2-144"]);
}

#[test]
fn a_contact_without_adhesion_ends_under_friction_in_pieces_too() {
    assert_right(&["p2-63"]);
}

#[test]
fn no_step_is_longer_than_the_series_of_its_gap() {
    assert_right(&["r2-937"]);
}
