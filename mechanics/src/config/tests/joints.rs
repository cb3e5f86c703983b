//! Values for one joint, and which of several values counts.

use super::super::*;
use super::{load, refusal};
use crate::keys::*;

#[test]
fn a_key_for_one_joint_leaves_the_other_alone() {
    let config = load("joint1.contact.stiffness = 2e7\n[joint2.joint]\nclearance = 5e-4", &[]);
    let [one, two] = config.unwrap().shared.joints;
    assert_eq!((one.contact.stiffness, one.joint.clearance), (2e7, 1e-4));
    assert_eq!((two.contact.stiffness, two.joint.clearance), (1e7, 5e-4));
}

#[test]
fn a_value_for_one_joint_stands_before_the_common_one() {
    let text = "joint2.friction.coefficient = 0.3\n[friction]\ncoefficient = 0.2";
    for sets in [&[][..], &["friction.coefficient=0.2"]] {
        let [one, two] = load(text, sets).unwrap().shared.joints;
        assert_eq!((one.friction.coefficient, two.friction.coefficient), (0.2, 0.3));
    }
}

#[test]
fn every_key_of_a_joint_may_differ() {
    for key in keys().filter(|key| key.per_joint()) {
        let DefaultValue::Toml(default) = key.default else { panic!("{}", key.path) };
        for joint in JOINTS {
            let text = format!("{joint}.{} = {default}", key.path);
            assert_eq!(load(&text, &[]), Config::table1(), "{text}");
        }
    }
}

#[test]
fn only_keys_of_a_joint_may_differ() {
    let message = "bad.toml:1: joint1.strut cannot differ for one joint; \
                   only the keys of [joint], [contact] and [friction] can";
    assert_eq!(refusal("joint1.strut.length = 3"), message);
    for key in keys().filter(|key| !key.per_joint()) {
        let message = refusal(&format!("[joint2]\n{} = 1", key.path));
        assert!(message.contains("cannot differ for one joint"), "{message}");
    }
}

#[test]
fn dotted_keys_tables_and_inline_tables_are_the_same() {
    let dotted = load("contact.stiffness = 3e7\ncontact.damping = 5", &[]);
    assert_eq!(dotted, load("[contact]\nstiffness = 3e7\ndamping = 5", &[]));
    assert_eq!(dotted, load("contact = { stiffness = 3e7, damping = 5 }", &[]));
    assert_eq!(dotted, load("", &["contact={stiffness=3e7, damping=5}"]));
    assert_eq!(dotted, load("\"contact\".'stiffness' = 3e7\ncontact.damping = 5.0", &[]));
}

#[test]
fn sets_count_after_the_file_and_in_order() {
    let text = "[contact]\nstiffness = 2e7\ndamping = 1";
    let config = load(text, &["contact.stiffness=3e7", "contact.stiffness = 4e7"]).unwrap();
    assert_eq!(config.joints[0].contact.stiffness, 4e7);
    assert_eq!(config.joints[0].contact.damping, 1.0);
}

#[test]
fn a_set_takes_toml_values_and_bare_words() {
    let sets = [
        "reading=full",
        "solver.method=\"rk4\"",
        "solver.events = 'blind'",
        "contact.adhesion=false",
        "drive.m1=-2",
        "study.methods=[\"bdf\"]",
        "study.max_rhs=1e6",
        "strut.inertia=transverse",
    ];
    let config = load("", &sets).unwrap();
    assert_eq!(config.reading, ReadingName::Full);
    assert_eq!(config.solver.method, "rk4");
    assert_eq!(config.solver.events, Events::Blind);
    assert!(!config.joints[1].contact.adhesion);
    assert_eq!(config.drive.m1, -2.0);
    assert_eq!(config.study.methods, ["bdf"]);
    assert_eq!(config.study.max_rhs, 1_000_000);
    assert_eq!(config.strut.inertia, Inertia::Transverse);
}

#[test]
fn atol_is_absent_or_one_number_or_six() {
    let atol = |text| load(text, &[]).unwrap().shared.solver.atol;
    assert_eq!(atol(""), None);
    assert_eq!(atol("solver.atol = 1e-12"), Some(Atol::Same(1e-12)));
    let six = Atol::Each(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(atol("solver.atol = [1, 2, 3, 4, 5, 6]"), Some(six));
    let message = refusal("solver.atol = [1, 2]");
    assert!(
        message.contains("has 2 entries: expected one number for all states, or 6"),
        "{message}"
    );
}

#[test]
fn samples_follow_the_documented_count() {
    let n = |t_end, sample| Run { t_end, sample, stop_at_90: true }.n_samples();
    assert_eq!(n(0.3, 0.1), Some(3)); // 0.3/0.1 is just below 3 in f64
    assert_eq!(n(0.25, 0.1), Some(2));
    assert_eq!(n(0.005, 0.01), Some(0));
    assert_eq!(n(2.0, 0.0), None);
}

#[test]
fn a_sample_beyond_the_end_is_allowed() {
    assert_eq!(load("run.t_end = 0.005", &[]).unwrap().run.n_samples(), Some(0));
}
