//! The messages, word for word.

use deltazero_study::setting::Events;

use super::{load, refusal, set_refusal};
use crate::config::Config;
use crate::keys::listing;
use crate::laws::ContactLaw;

#[test]
fn an_unknown_key_names_the_nearest() {
    assert_eq!(
        refusal("\n[contact]\nstifness = 1e7"),
        "bad.toml:3: unknown key \"contact.stifness\"; did you mean \"contact.stiffness\"?"
    );
    assert_eq!(
        refusal("stiffness = 1e7"),
        "bad.toml:1: unknown key \"stiffness\"; did you mean \"contact.stiffness\"?"
    );
    assert_eq!(
        refusal("[contct]\nstiffness = 1e7"),
        "bad.toml:1: unknown key \"contct\"; did you mean \"contact\"?"
    );
    assert_eq!(
        refusal("joint2.contact.dampng = 1"),
        "bad.toml:1: unknown key \"joint2.contact.dampng\"; \
         did you mean \"joint2.contact.damping\"?"
    );
    assert_eq!(
        refusal("joint1.clearance = 1"),
        "bad.toml:1: unknown key \"joint1.clearance\"; did you mean \"joint1.joint.clearance\"?"
    );
    assert_eq!(
        refusal("xyzzy = 1"),
        "bad.toml:1: unknown key \"xyzzy\"; `deltazero config` lists every key"
    );
    assert_eq!(
        set_refusal("Reading=full"),
        "--set Reading=full: unknown key \"Reading\"; did you mean \"reading\"?"
    );
}

#[test]
fn a_quoted_dot_is_no_path() {
    assert_eq!(
        refusal("\"contact.stiffness\" = 1e7"),
        "bad.toml:1: unknown key \"'contact.stiffness'\"; \
         did you mean \"contact.stiffness\"?"
    );
}

#[test]
fn a_number_out_of_range_names_unit_and_range() {
    assert_eq!(
        refusal("[contact]\n\ndamping = -1"),
        "bad.toml:3: contact.damping = -1 is out of range: N s/m, at least 0"
    );
    assert_eq!(
        refusal("contact.stiffness = nan"),
        "bad.toml:1: contact.stiffness = nan is out of range: N/mⁿ, greater than 0"
    );
    assert_eq!(
        refusal("drive.m1 = inf"),
        "bad.toml:1: drive.m1 = inf is out of range: N m, any finite number"
    );
    assert_eq!(
        set_refusal("solver.rtol=0.5"),
        "--set solver.rtol=0.5: solver.rtol = 0.5 is out of range: from 1e-14 to 0.1"
    );
    assert_eq!(
        refusal("study.repeats = 0"),
        "bad.toml:1: study.repeats = 0 is out of range: from 1 to 1000"
    );
    assert_eq!(
        refusal("study.rtol = [\n  1e-3,\n  1,\n]"),
        "bad.toml:3: study.rtol[1] = 1 is out of range: from 1e-14 to 0.1"
    );
    assert_eq!(
        refusal("strut.inertia = -1"),
        "bad.toml:1: strut.inertia = -1 is out of range: kg m², greater than 0"
    );
    assert_eq!(
        refusal("solver.atol = [1, 1, 1, 1, 1, 0]"),
        "bad.toml:1: solver.atol[5] = 0 is out of range: greater than 0"
    );
}

#[test]
fn an_unknown_word_names_the_words_and_the_nearest() {
    assert_eq!(
        refusal("reading = \"ful\""),
        "bad.toml:1: reading = \"ful\" is unknown: pin, full, centroid, printed or cosine; \
         did you mean \"full\"?"
    );
    assert_eq!(
        set_refusal("solver.method=RK4"),
        "--set solver.method=RK4: solver.method = \"RK4\" is unknown: rk4, rk43, bs32, rk45, dop853, vern98, taylor, rodas5p, radau5, bdf, tr_bdf2, esdirk34, tsit45 or auto; \
         did you mean \"rk4\"?"
    );
    let laws = listing(ContactLaw::WORDS);
    assert_eq!(
        refusal("contact.law = \"hertz\""),
        format!("bad.toml:1: contact.law = \"hertz\" is unknown: {laws}")
    );
    assert_eq!(
        refusal("study.methods = [\"rk4\", \"rk455\"]"),
        "bad.toml:1: study.methods[1] = \"rk455\" is unknown: rk4, rk43, bs32, rk45, dop853, vern98, taylor, rodas5p, radau5, bdf, tr_bdf2, esdirk34, tsit45 or auto; \
         did you mean \"rk45\"?"
    );
    assert_eq!(
        refusal("strut.inertia = \"axal\""),
        "bad.toml:1: strut.inertia = \"axal\" is unknown: axial or transverse; \
         did you mean \"axial\"?"
    );
}

#[test]
fn a_wrong_type_names_the_right_one() {
    assert_eq!(
        refusal("contact.damping = \"178.7\""),
        "bad.toml:1: contact.damping = \"178.7\" is a string: \
         expected a number (N s/m, at least 0)"
    );
    assert_eq!(
        set_refusal("contact.adhesion=True"),
        "--set contact.adhesion=True: contact.adhesion = \"True\" is a string: \
         expected true or false"
    );
    assert_eq!(
        refusal("study.repeats = 2.5"),
        "bad.toml:1: study.repeats = 2.5 is a decimal number: \
         expected an integer (from 1 to 1000)"
    );
    assert_eq!(
        refusal("contact = 3"),
        "bad.toml:1: contact = 3 is an integer: \
         expected a table with any of law, stiffness, damping, exponent, adhesion, \
         restitution, impact_speed_floor, young_modulus, poisson_ratio, length, curvature"
    );
    assert_eq!(
        refusal("joint1 = 3"),
        "bad.toml:1: joint1 = 3 is an integer: expected a table with any of joint, contact, friction"
    );
    assert_eq!(
        refusal("[contact.stiffness]\nvalue = 3"),
        "bad.toml:1: contact.stiffness = {…} is a table: expected a number (N/mⁿ, greater than 0)"
    );
    assert_eq!(
        refusal("[[contact]]\nstiffness = 3"),
        "bad.toml:1: contact = […] is a list: \
         expected a table with any of law, stiffness, damping, exponent, adhesion, \
         restitution, impact_speed_floor, young_modulus, poisson_ratio, length, curvature"
    );
    assert_eq!(
        refusal("reading = 2020-01-01"),
        "bad.toml:1: reading = 2020-01-01 is a date or time: \
         expected a word (pin, full, centroid, printed or cosine)"
    );
    assert_eq!(
        refusal("solver.atol = true"),
        "bad.toml:1: solver.atol = true is a boolean: expected a number (greater than 0), \
         or a list, at least one entry, each a number (greater than 0)"
    );
}

#[test]
fn a_list_of_the_wrong_length_names_the_right_one() {
    assert_eq!(
        refusal("study.steps = []"),
        "bad.toml:1: study.steps = [] has 0 entries: \
         expected a list, at least one entry, each a number (s, greater than 0)"
    );
    assert_eq!(
        refusal("solver.atol = [1, 2]"),
        "bad.toml:1: solver.atol = [1.0, 2.0] has 2 entries: expected one number for all states, or 6"
    );
}

#[test]
fn a_list_that_has_an_entry_twice_names_it() {
    assert_eq!(
        refusal("study.rtol = [1e-4, 1e-6, 1e-4]"),
        "bad.toml:1: study.rtol = [1e-4, 1e-6, 1e-4] has 1e-4 twice: leave one of them"
    );
    assert_eq!(
        refusal("study.methods = [\"rk45\", \"rk45\"]"),
        "bad.toml:1: study.methods = [\"rk45\", \"rk45\"] has \"rk45\" twice: leave one of them"
    );
    assert!(Config::load(None, &["solver.atol=[1,1,1,2,2,2]".to_owned()]).is_ok());
}

#[test]
fn more_fixed_steps_than_a_run_can_take_are_refused_for_fixed_step_methods_alone() {
    let sets = |method: &str| [format!("solver.method={method}"), "solver.step=1e-300".to_owned()];
    let message = Config::load(None, &sets("rk4")).unwrap_err().to_string();
    let text = "--set solver.step=1e-300: solver.step = 1e-300 s up to run.t_end = 2e0 s makes \
                2.0e300 steps, at most 1e12; raise solver.step";
    assert_eq!(message, text);
    assert!(Config::load(None, &sets("rk45")).is_ok());
}

#[test]
fn values_that_do_not_go_together_are_refused() {
    assert_eq!(
        refusal("\nbays = 3\nreading = 'full'"),
        "bad.toml:3: reading = full does not go with bays = 3: friction as a force couples the sticks of \
         neighbours, and a force at the centroid has no reaction at the bush; use reading = \"pin\""
    );
    assert_eq!(
        refusal("bays = 2\njoint.clearance = 0"),
        "bad.toml:2: joint.clearance = 0 does not go with bays = 2: pins that are held couple the \
         accelerations of all bays; use a clearance above zero"
    );
    assert_eq!(
        refusal("bays = 2\nsolver.events = 'blind'"),
        "bad.toml:2: solver.events asks for blind runs, but the blind baseline is built for one bay; use \
         events = \"located\""
    );
    for bays in ["0", "1000000"] {
        let text = format!("bad.toml:1: bays = {bays} is out of range: from 1 to 2000");
        assert_eq!(refusal(&format!("bays = {bays}")), text);
    }
    let text = "run.sample = 1e-2 s up to run.t_end = 1e9 s makes 2.0e11 rows of \
                trajectory.csv (one a joint: 2), 4.0e13 bytes, at most 5e6 rows; raise run.sample above 4.00e2 s";
    assert_eq!(set_refusal("run.t_end=1e9"), format!("--set run.t_end=1e9: {text}"));
}

#[test]
fn an_assignment_needs_a_key_and_a_value() {
    for set in ["foo", "=3", "contact.stiffness=", "", " = "] {
        assert_eq!(
            set_refusal(set),
            format!("--set {set}: expected key=value, such as contact.stiffness=1e9")
        );
    }
    assert_eq!(
        set_refusal("contact.stiffness=1e"),
        "--set contact.stiffness=1e: invalid exponent, expected digits; a number has no unit beside it, as in 1.5e8, and \
         a word stands in quotes"
    );
    assert_eq!(
        set_refusal("study.methods=[rk4]"),
        "--set study.methods=[rk4]: string values must be quoted, expected literal string; a number has no unit beside \
         it, as in 1.5e8, and a word stands in quotes"
    );
    assert_eq!(
        set_refusal("drive.m1=1\n[contact]"),
        "--set drive.m1=1 [contact]: unexpected content"
    );
}

#[test]
fn the_first_line_with_a_mistake_is_the_one_named() {
    let text = "[study]\nrepeats = 0\n[contact]\ndamping = -1\n[strut]\nlength = 0";
    assert!(refusal(text).starts_with("bad.toml:2: study.repeats = 0 "));
}

#[test]
fn a_blind_run_of_a_law_that_remembers_is_refused() {
    assert_eq!(
        refusal("joint2.contact.law = \"flores\"\nsolver.events = \"blind\""),
        "bad.toml:2: solver.events asks for blind runs, but contact.law = flores depends on the speed of \
         each impact, which is read off no state; use events = \"located\""
    );
    let both = "contact.law = \"flores\"\nstudy.events = [\"blind\", \"located\"]";
    let config = load(both, &[]).unwrap();
    assert_eq!(config.permitted(&config.study.events), [Events::Located]);
}

#[test]
fn bristles_say_what_they_do_not_go_with() {
    for (text, expected) in [
        (
            "friction.law = \"lugre\"\nsolver.events = \"blind\"",
            "bad.toml:2: solver.events asks for blind",
        ),
        (
            "[joint2]\nfriction.law = \"lugre\"\njoint.clearance = 0",
            "bad.toml:3: joint.clearance = 0 does not",
        ),
        (
            "friction.law = \"lugre\"\njoint2.joint.clearance = 0",
            "bad.toml:2: joint.clearance = 0 does not",
        ),
        (
            "friction.law = \"lugre\"\njoint2.friction.static_coefficient = 0",
            "bad.toml:2: friction.static_coefficient = 0 does not",
        ),
        (
            "friction.law = \"lugre\"\nfriction.coefficient = 0",
            "bad.toml:2: friction.coefficient = 0 does not",
        ),
        (
            "study.reference = \"extended\"\nfriction.law = \"lugre\"",
            "bad.toml:1: study.reference = extended does",
        ),
    ] {
        let message = refusal(text);
        assert!(message.starts_with(expected), "{message}");
    }
    let config = load("[joint2]\nfriction.law = \"lugre\"", &[]).unwrap();
    assert_eq!(config.permitted(&config.study.events), [Events::Located]);
}
