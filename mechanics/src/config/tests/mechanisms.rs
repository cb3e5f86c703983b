//! The slider-crank: defaults of its own, and what does not go with it.

use super::super::*;
use super::{load, refusal};
use crate::keys::*;
use crate::mechanisms::MECHANISMS;

#[test]
fn a_slider_crank_has_its_own_defaults_for_what_is_not_given() {
    let config = load("mechanism = 'slider-crank'\nrun.t_end = 0.1", &[]).unwrap();
    let [one, two] = &config.joints;
    assert_eq!(
        (config.reading, config.run.t_end, config.run.sample),
        (ReadingName::Full, 0.1, 1e-4)
    );
    assert_eq!(one.joint, Joint { clearance: 5e-4, pin_radius: 9.5e-3 });
    assert_eq!((one.contact.law.word, one.contact.exponent), ("lankarani_nikravesh", 1.5));
    assert_eq!((one.contact.stiffness, one.friction.coefficient), (6.61e10, 0.03));
    assert_eq!(one, two);
    // As given, wherever the mechanism is chosen.
    let given = load("joint.clearance = 1e-4", &["mechanism=slider-crank"]).unwrap();
    assert_eq!(given.joints[0].joint.clearance, 1e-4);
    assert_eq!(load("", &[]).unwrap(), Config::table1().unwrap());
}

#[test]
fn every_default_of_a_mechanism_is_of_a_key_that_it_has_and_printed() {
    for entry in MECHANISMS {
        let config = load("", &[&format!("mechanism={}", entry.name)]).unwrap();
        let text = config.commented_toml();
        for (path, value, _) in entry.defaults {
            let key = find(path).unwrap();
            assert!(entry.has(key), "{}: {path}", entry.name);
            assert!(text.contains(&format!("\n{} = {value}\n", key.name())), "{path}");
        }
    }
}

#[test]
fn every_mechanism_is_named_in_the_printed_default() {
    for entry in &MECHANISMS[1..] {
        assert!(default_toml().contains(&format!("# {}: {}\n", entry.name, entry.about)));
    }
}

#[test]
fn a_table_of_another_mechanism_is_not_used_and_a_key_of_its_own_at_the_root_refused() {
    let alone = load("mechanism = 'slider-crank'", &[]).unwrap();
    let beside =
        "mechanism = 'slider-crank'\nbays = 1\nstrut.length = 2\nfour_bar.crank_length = 0.5";
    assert_eq!(load(beside, &[]).unwrap().mechanism, alone.mechanism);
    let message = refusal("bays = 2\nmechanism = 'rocking-block'");
    let start = "bad.toml:1: bays = 2 does not go with mechanism = rocking-block: the mechanism has no such key";
    assert!(message.starts_with(start), "{message}");
    let set = ["mechanism=rocking-block", "friction.coefficient=0.2"].map(str::to_owned);
    let message = Config::load(None, &set).unwrap_err().to_string();
    let start = "--set friction.coefficient=0.2: friction.coefficient = 0.2 does not go with mechanism = rocking-block";
    assert!(message.starts_with(start), "{message}");
}

#[test]
fn the_stiffness_of_the_slider_crank_is_that_of_its_steel_and_radii() {
    let [JointConfig { joint, contact, .. }, _] =
        load("mechanism = 'slider-crank'", &[]).unwrap().shared.joints;
    // Lankarani and Nikravesh: K = 4/(3 (σ_1 + σ_2)) √(R_1 R_2/c), σ = (1 − ν²)/E.
    let sigma = (1.0 - contact.poisson_ratio * contact.poisson_ratio) / contact.young_modulus;
    let bush = joint.pin_radius + joint.clearance;
    let stiffness = 2.0 / (3.0 * sigma) * (joint.pin_radius * bush / joint.clearance).sqrt();
    assert!((contact.stiffness / stiffness - 1.0).abs() < 1e-4, "{stiffness:e}");
}

#[test]
fn what_a_slider_crank_cannot_have_is_refused_with_the_reason() {
    for (text, line, reason) in [
        (
            "bays = 2",
            2,
            "bays = 2 does not go with mechanism = slider-crank: the mechanism has no such key",
        ),
        (
            "reading = 'pin'",
            2,
            "reading = pin does not go with mechanism = slider-crank: readings are",
        ),
        ("joint2.contact.stiffness = 1e9", 2, "only a mechanism of two joints"),
        ("slider_crank.rod_length = 0.05", 2, "the rod must be longer"),
    ] {
        let message = refusal(&format!("mechanism = 'slider-crank'\n{text}"));
        assert!(message.starts_with(&format!("bad.toml:{line}: ")), "{message}");
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn a_printed_configuration_reads_back_with_what_was_given_in_place() {
    for sets in [
        &["mechanism=slider-crank"][..],
        &["mechanism=slider-crank", "contact.stiffness=1e9", "bays=1", "solver.atol=1e-13"],
        &["bays=3", "run.t_end=0.1"],
        &["joint1.contact.damping=9", "joint2.contact.stiffness=2e7", "joint2.friction.law=tanh"],
        &["contact.stiffness=0.1", "regimes.readings=[\"pin\"]", "solver.atol=[1,1,1,1,1,2e-9]"],
    ] {
        let config = load("", sets).unwrap();
        let text = config.commented_toml();
        assert_eq!(load(&text, &[]).unwrap(), config, "{text}");
        for key in keys().filter(|key| config.mechanism.entry.has(key)) {
            assert!(text.contains(&format!("# {}.\n", key.doc)), "{}", key.path);
        }
    }
}

#[test]
fn a_printed_configuration_says_what_was_given_and_what_is_the_default() {
    let crank = load("", &["mechanism=slider-crank", "contact.exponent=2"]).unwrap();
    let text = crank.commented_toml();
    assert!(text.contains("Lankarani.\nstiffness = 6.61e10\n"), "{text}");
    assert!(
        text.contains("given; 1.5 is slider-crank benchmark of Flores, Ambrósio, Claro and Lankarani.\nexponent = 2.0\n"),
        "{text}"
    );
    assert!(text.contains("; our choice.\nstatic_coefficient = 0.045\n"), "{text}");
    assert!(text.contains("; our choice.\nstep = 1e-6\n"), "{text}");
    assert!(text.contains("given; \"strut\" is the paper's case.\nmechanism = \"slider-crank\"\n"));
    assert!(!text.contains("joint2"), "{text}");
    let strut = load("", &["joint2.contact.stiffness=2e7"]).unwrap().commented_toml();
    assert!(strut.contains("\n[joint2.contact]\nstiffness = 20000000.0\n"), "{strut}");
    assert!(strut.contains("printed in N.m).\nstiffness = 1e7\n"), "{strut}");
}

#[test]
fn keys_of_the_struts_alone_are_refused_where_they_are_set_for_others_and_read_in_files() {
    for set in [
        "run.stop_at_90=false",
        "regimes.stiffness=[1e6]",
        "regimes.damping_ratio=[0.1]",
        "regimes.readings=[\"pin\"]",
    ] {
        assert!(load("", &[set]).is_ok(), "{set}");
        for entry in &MECHANISMS[1..] {
            let choice = format!("mechanism={}", entry.name);
            let message = load("", &[&choice, set]).unwrap_err().to_string();
            assert!(message.contains("the mechanism has no such key"), "{message}");
            let written = load(&set.replace('=', " = "), &[&choice]).unwrap();
            assert_eq!(Config::from_json(&written.to_json()), Ok(written), "{set}");
        }
    }
}
