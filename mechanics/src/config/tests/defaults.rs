//! The default: as values, as the printed file, as the schema.

use serde_json::Value;

use super::super::*;
use super::load;
use crate::keys::*;
use crate::laws::ContactLaw;
use crate::mechanisms::{Entry, MECHANISMS};

#[test]
fn table_1_is_the_default() {
    let config = Config::table1().unwrap();
    assert_eq!(config.reading, ReadingName::Pin);
    assert_eq!(config.bays, 1);
    let strut = Strut { length: 2.5, density: 7800.0, radius: 0.005, inertia: Inertia::Axial };
    assert_eq!(config.strut, strut);
    assert_eq!(config.drive, Drive { m1: 1.0, m4: 0.3 });
    let joint = JointConfig {
        joint: Joint { clearance: 1e-4, pin_radius: 4.9e-3 },
        contact: Contact {
            law: ContactLaw::named("power").unwrap(),
            stiffness: 1e7,
            damping: 178.7,
            exponent: 1.0,
            adhesion: true,
            restitution: 0.9,
            impact_speed_floor: 1e-6,
            young_modulus: 2.07e11,
            poisson_ratio: 0.3,
            length: 0.02,
            curvature: Curvature::Internal,
        },
        friction: Friction {
            law: FrictionLaw::Coulomb,
            coefficient: 0.1,
            static_coefficient: 0.15,
            stribeck_speed: 1e-3,
            regularisation_speed: 1e-4,
            dead_ratio: 0.1,
            bristle_stiffness: 1e5,
            bristle_damping: 10.0,
            viscosity: 0.0,
        },
    };
    assert_eq!(config.joints, [joint.clone(), joint]);
    assert_eq!(config.run, Run { t_end: 2.0, sample: 0.01, stop_at_90: true });
    assert_eq!(config.run.n_samples(), Some(200));
    let solver = Solver {
        method: "rk45".to_owned(),
        rtol: 1e-8,
        atol: None,
        events: Events::Located,
        step: 1e-5,
    };
    assert_eq!(config.solver, solver);
    let study = Study {
        methods: ["rk4", "rk45", "dop853", "vern98", "taylor", "radau5", "bdf"]
            .map(str::to_owned)
            .to_vec(),
        events: vec![Events::Located, Events::Blind],
        rtol: vec![1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12],
        steps: vec![1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6],
        reference: deltazero_study::setting::Digits::Double,
        x: "n_rhs".to_owned(),
        y: "event_time_error_s".to_owned(),
        repeats: 3,
        threads: 1,
        max_rhs: 50_000_000,
        max_seconds: 60.0,
    };
    assert_eq!(config.study, study);
}

#[test]
fn an_empty_file_is_the_default() {
    assert_eq!(load("", &[]), Config::table1());
    assert_eq!(load("# nothing\n\n[contact]\n[joint2.friction]\n", &[]), Config::table1());
    assert_eq!(Config::load(None, &[]), Config::table1());
}

#[test]
fn the_printed_default_is_the_default() {
    assert_eq!(load(&default_toml(), &[]), Config::table1());
}

#[test]
fn a_printed_configuration_holds_every_key_of_its_mechanism_once() {
    for entry in MECHANISMS {
        let config = load("", &[&format!("mechanism={}", entry.name)]).unwrap();
        holds_every_key_once(&config.commented_toml(), entry);
    }
    holds_every_key_once(&default_toml(), MECHANISMS[0]);
}

fn holds_every_key_once(text: &str, entry: &Entry) {
    for key in keys().filter(|key| entry.has(key)) {
        let mut table = None;
        let mut lines = text.lines().filter(|line| {
            if line.starts_with('[') {
                table = Some(line.trim_matches(['[', ']']));
            }
            let line = line.strip_prefix("# ").unwrap_or(line);
            table == key.table() && line.starts_with(&format!("{} = ", key.name()))
        });
        assert!(lines.next().is_some(), "{} is missing", key.path);
        assert_eq!(lines.next(), None, "{} is there twice", key.path);
    }
}

#[test]
fn the_printed_examples_are_accepted_without_their_comment_marks() {
    let mut changed = 0;
    let mut text = default_toml();
    for example in ["# atol = ", "# [joint2.contact]", "# stiffness = "] {
        assert!(text.contains(example), "{example}");
        text = text.replacen(example, &example[2..], 1);
        changed += 1;
    }
    assert_eq!(changed, 3);
    let config = load(&text, &[]).unwrap();
    assert_eq!(config.solver.atol, Some(Atol::Same(1e-12)));
    assert_eq!(config.joints[1].contact.stiffness, 2e7);
}

#[test]
fn keys_are_grouped_by_table_and_unique() {
    let tables = all_keys::tables();
    for (i, key) in keys().enumerate() {
        assert_eq!(keys().position(|other| other.path == key.path), Some(i), "{}", key.path);
        assert!(key.path.matches('.').count() <= 1, "{}", key.path);
    }
    for (i, table) in tables.iter().enumerate() {
        assert!(!tables[..i].contains(table), "[{table}] is opened twice");
    }
    assert_eq!(
        keys().next().and_then(Key::table),
        None,
        "keys of the root come before the first table"
    );
}

#[test]
fn every_key_for_one_joint_has_a_default() {
    // The canonical form writes a difference as the value of joint 2: it has no way to write
    // "absent there".
    for key in keys().filter(|key| key.per_joint()) {
        assert!(matches!(key.default, DefaultValue::Toml(_)), "{}", key.path);
    }
}

/// Whether `value` has everything that `schema` asks for; of the keywords this crate writes.
fn valid(schema: &Value, value: &Value) -> bool {
    let x = value.as_f64().unwrap_or(f64::NAN);
    let list = value.as_array().map_or(&[][..], Vec::as_slice);
    schema.as_object().unwrap().iter().all(|(keyword, want)| match keyword.as_str() {
        "type" => match want.as_str().unwrap() {
            "number" => value.is_number(),
            "integer" => value.is_i64(),
            "boolean" => value.is_boolean(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            other => panic!("type {other}"),
        },
        "minimum" => x >= want.as_f64().unwrap(),
        "exclusiveMinimum" => x > want.as_f64().unwrap(),
        "maximum" => x <= want.as_f64().unwrap(),
        "enum" => want.as_array().unwrap().contains(value),
        "items" => list.iter().all(|entry| valid(want, entry)),
        "minItems" => list.len() as u64 >= want.as_u64().unwrap(),
        "uniqueItems" => (1..list.len()).all(|i| !list[..i].contains(&list[i])),
        "anyOf" => want.as_array().unwrap().iter().any(|schema| valid(schema, value)),
        "properties" => {
            let entries = value.as_object().unwrap();
            entries.iter().all(|(key, entry)| want.get(key).is_some_and(|s| valid(s, entry)))
        }
        "additionalProperties" => want == &Value::Bool(false),
        "default" | "description" | "title" | "$schema" => true,
        other => panic!("keyword {other}"),
    })
}

#[test]
fn the_schema_accepts_the_default_and_overrides() {
    let schema = json_schema();
    assert!(valid(&schema, &Config::table1().unwrap().to_json()));
    let sets = ["joint2.contact.stiffness=2e7", "solver.atol=[1,1,1,2,2,2]", "strut.inertia=0.8"];
    assert!(valid(&schema, &load("", &sets).unwrap().to_json()));
}

#[test]
fn the_schema_refuses_what_is_refused() {
    let schema = json_schema();
    for (path, bad) in [
        ("/contact/stiffness", Value::from(0.0)),
        ("/contact/law", Value::from("hertz")),
        ("/solver/rtol", Value::from(0.5)),
        ("/study/rtol", Value::from(Vec::<f64>::new())),
        ("/study/rtol", Value::from(vec![1e-4, 1e-4])),
        ("/bays", Value::from(0)),
        ("/strut", serde_json::json!({ "lenght": 1.0 })),
    ] {
        let mut config = Config::table1().unwrap().to_json();
        *config.pointer_mut(path).unwrap() = bad;
        assert!(!valid(&schema, &config), "{path}");
        assert!(Config::from_json(&config).is_err(), "{path}");
    }
}

#[test]
fn the_schema_holds_every_key_with_its_default_and_description() {
    let schema = json_schema();
    let default = Config::table1().unwrap().to_json();
    for key in keys().filter(|key| MECHANISMS[0].has(key)) {
        let path = format!("/{}", key.path.replace('.', "/"));
        let pointer = format!("/properties/{}", key.path.replace('.', "/properties/"));
        let property = schema.pointer(&pointer).expect(key.path);
        assert_eq!(property.get("default"), default.pointer(&path), "{}", key.path);
        assert!(property["description"].as_str().unwrap().starts_with(key.doc), "{}", key.path);
        for joint in JOINTS {
            let pointer = format!("/properties/{joint}{pointer}");
            let property = schema.pointer(&pointer);
            assert_eq!(property.is_some(), key.per_joint(), "{joint}.{}", key.path);
            assert_eq!(property.and_then(|p| p.get("default")), None, "{joint}.{}", key.path);
        }
    }
}
