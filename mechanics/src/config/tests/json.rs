//! The JSON form: complete, canonical, and read back to the same bits.

use super::super::*;
use super::load;
use crate::mechanisms::MECHANISMS;

fn configurations() -> Vec<Config> {
    let texts = [
        "",
        "reading = 'cosine'\nstrut.inertia = 0.79767\ncontact.damping = 0",
        "joint1.contact.stiffness = 2e7\njoint2.friction.coefficient = 0",
        "solver.atol = 1e-12\nrun.sample = 0\nstrut.inertia = 'transverse'",
        "mechanism = 'slider-crank'\njoint.clearance = 0\nslider_crank.start_angle = -1.5",
        "solver.atol = [1e-12, 1e-12, 1e-9, 1e-9, 1e-9, 1e-6]\nstudy.events = ['blind']",
        // Numbers whose shortest decimal form a careless reader misses by one bit.
        "drive = { m1 = 0.1000000000000000055511151231257827, m4 = 2.2250738585072014e-308 }\n\
         contact = { stiffness = 8.41e21, damping = 5e-324 }\nstrut.length = 0.30000000000000004\n\
         strut.density = 1.7976931348623157e308\nstrut.radius = 9.5e-8",
    ];
    texts.map(|text| load(text, &[]).unwrap()).to_vec()
}

#[test]
fn a_configuration_reads_back_from_its_json() {
    for config in configurations() {
        assert_eq!(Config::from_json(&config.to_json()), Ok(config));
    }
}

#[test]
fn a_configuration_reads_back_from_the_text_of_its_json() {
    // Needs serde_json's feature `float_roundtrip`.
    for config in configurations() {
        let text = serde_json::to_string_pretty(&config).unwrap();
        assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config);
    }
}

#[test]
fn a_configuration_reads_back_from_its_toml() {
    for config in configurations() {
        assert_eq!(load(&config.to_toml(), &[]).as_ref(), Ok(&config), "{}", config.to_toml());
    }
}

#[test]
fn the_json_holds_every_key() {
    let json = load("solver.atol = 1e-12\nregimes.readings = ['full']", &[]).unwrap().to_json();
    for key in keys().filter(|key| MECHANISMS[0].has(key)) {
        let path = format!("/{}", key.path.replace('.', "/"));
        assert!(json.pointer(&path).is_some_and(|value| !value.is_null()), "{}", key.path);
    }
    assert_eq!(json.get("joint1"), None);
    assert_eq!(json.get("joint2"), None);
}

#[test]
fn the_json_of_the_default_is_this_text() {
    let json = Config::table1().unwrap().to_json();
    let text = "{\"bays\":1,\
        \"contact\":{\"adhesion\":true,\"curvature\":\"internal\",\"damping\":178.7,\"exponent\":1.0,\
        \"impact_speed_floor\":1e-6,\"law\":\"power\",\"length\":0.02,\"poisson_ratio\":0.3,\
        \"restitution\":0.9,\"stiffness\":10000000.0,\"young_modulus\":207000000000.0},\
        \"contest\":{\"events\":[\"located\",\"blind\"],\"max_work\":300000000.0,\
        \"methods\":[\"rk4\",\"rk43\",\"bs32\",\"rk45\",\"dop853\",\"vern98\",\"taylor\",\"rodas5p\",\"radau5\",\
        \"bdf\",\"auto\"],\"repeats\":5,\"right_events\":true},\
        \"drive\":{\"m1\":1.0,\"m4\":0.3},\
        \"friction\":{\"bristle_damping\":10.0,\"bristle_stiffness\":100000.0,\"coefficient\":0.1,\
        \"dead_ratio\":0.1,\"law\":\"coulomb\",\"regularisation_speed\":0.0001,\
        \"static_coefficient\":0.15,\"stribeck_speed\":0.001,\"viscosity\":0.0},\
        \"joint\":{\"clearance\":0.0001,\"pin_radius\":0.0049},\
        \"mechanism\":\"strut\",\
        \"reading\":\"pin\",\
        \"regimes\":{\"accuracy\":[0.001,1e-6],\"damping_ratio\":[0.0,0.01,0.1,1.0,3.0],\"max_events\":100,\
        \"stiffness\":[100000.0,1000000.0,10000000.0,100000000.0,1000000000.0,10000000000.0,\
        100000000000.0,1000000000000.0],\"threads\":2},\
        \"run\":{\"sample\":0.01,\"stop_at_90\":true,\"t_end\":2.0},\
        \"solver\":{\"events\":\"located\",\"method\":\"rk45\",\"rtol\":1e-8,\"step\":0.00001},\
        \"strut\":{\"density\":7800.0,\"inertia\":\"axial\",\"length\":2.5,\"radius\":0.005},\
        \"study\":{\"events\":[\"located\",\"blind\"],\"max_rhs\":50000000,\"max_seconds\":60.0,\
        \"methods\":[\"rk4\",\"rk45\",\"dop853\",\"vern98\",\"taylor\",\"radau5\",\"bdf\"],\"reference\":\"double\",\"repeats\":3,\
        \"rtol\":[0.001,0.0001,0.00001,1e-6,1e-7,1e-8,1e-9,1e-10,1e-11,1e-12],\
        \"steps\":[0.001,0.0005,0.0002,0.0001,0.00005,0.00002,0.00001,5e-6],\"threads\":1,\
        \"x\":\"n_rhs\",\"y\":\"event_time_error_s\"}}";
    // The hash of results is taken of this text: a change of it makes all results another's.
    assert_eq!(json.to_string(), text);
}

#[test]
fn equal_configurations_have_equal_json() {
    let texts = [
        "joint2.contact.stiffness = 2e7",
        "contact.stiffness = 2e7\njoint1.contact.stiffness = 1e7",
        "joint1.contact.stiffness = 10_000_000\n[joint2]\ncontact = { stiffness = 20000000 }",
    ];
    let json = texts.map(|text| load(text, &[]).unwrap().to_json().to_string());
    assert_eq!(json[0], json[1]);
    assert_eq!(json[0], json[2]);
    assert!(json[0].contains("\"joint2\":{\"contact\":{\"stiffness\":20000000.0}}"), "{}", json[0]);
    let zeros = ["drive.m4 = 0", "drive.m4 = -0.0"].map(|text| load(text, &[]).unwrap().to_json());
    assert_eq!(zeros[0].to_string(), zeros[1].to_string());
}

#[test]
fn threads_are_no_part_of_the_identity() {
    let identity = |text: &str| load(text, &[]).unwrap().identity();
    assert_eq!(identity("study.threads = 3\nregimes.threads = 5"), identity(""));
    assert_ne!(identity("study.repeats = 2"), identity(""));
    let one = load("study.threads = 1\nregimes.threads = 1", &[]).unwrap();
    assert_eq!(identity(""), one.to_json());
}

#[test]
fn json_is_checked_like_a_file() {
    let refusal = |text: &str| serde_json::from_str::<Config>(text).unwrap_err().to_string();
    assert_eq!(
        refusal("{\"contact\": {\"damping\": -1}}"),
        "configuration in JSON: contact.damping = -1 is out of range: N s/m, at least 0"
    );
    assert_eq!(
        refusal("{\"contact.damping\": 1}"),
        "configuration in JSON: unknown key \"'contact.damping'\"; \
         did you mean \"contact.damping\"?"
    );
    assert_eq!(
        refusal("{\"solver\": null}"),
        "configuration in JSON: solver = null is null: \
         expected a table with any of method, rtol, atol, events, step"
    );
    assert_eq!(
        refusal("[]"),
        "configuration in JSON: the configuration = [] is a list: expected a table of keys"
    );
}
