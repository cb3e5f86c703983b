//! The contact that a report is about, in words: of each law what it uses, and nothing that it does not.

use super::About;
use super::html::Part;
use crate::config::{
    Config, Contact, ContactLaw, Curvature, Friction, FrictionLaw, Joint, JointConfig,
    MechanismName, SliderCrank,
};
use crate::model::restitution::{delivered, hysteresis_factor};
use crate::study::restitution;

/// What a study of `config` says of its subject.
pub fn about(config: &Config) -> About {
    let subject = match config.mechanism {
        MechanismName::Strut if config.bays > 1 => {
            format!("Reading `{}`, {} bays", config.reading, config.bays)
        }
        MechanismName::Strut => format!("Reading `{}`", config.reading),
        MechanismName::SliderCrank => "Mechanism `slider-crank`".to_owned(),
    };
    About {
        subject,
        lead: "A pin rattles in a bush with clearance: free flight, then contact through a stiff spring, \
               with friction; each change is an event, the zero crossing of the penetration δ. Every \
               method runs over its tolerances or steps, every run is measured against an event-exact \
               reference: which one reaches an error at the least cost?"
            .into(),
        facts: facts(config),
        warnings: restitution::warnings(config).into_iter().map(|warning| warning.message).collect(),
        leading: vec![("reading", "reading of the paper", config.reading.to_string())],
        redo: redo(config),
    }
}

fn redo(config: &Config) -> Vec<Part> {
    vec![
        Part::Text("With the configuration below as study.toml:".into()),
        Part::Code("deltazero study study.toml --out redone".into()),
        Part::Text(
            "Errors, events and counts of work come out the same, times do not. The tables, the figures \
             and this page alone, from the directory that holds study.json:"
                .into(),
        ),
        Part::Code("deltazero report DIR".into()),
        Part::Folded("The configuration".into(), vec![Part::Code(config.to_toml())]),
    ]
}

/// Names and what they are: mechanism, time, drive, joints.
fn facts(config: &Config) -> Vec<(String, String)> {
    let [one, two] = &config.joints;
    let time = fact("Time", format!("0 to {} s", config.run.t_end));
    if config.mechanism == MechanismName::SliderCrank {
        let mechanism = fact("Mechanism", slider_crank(&config.slider_crank));
        return vec![mechanism, time, fact("Joint of rod and slider", joint(one))];
    }
    let mut facts = vec![fact("Reading", config.reading.name())];
    if config.bays > 1 {
        facts.push(fact("Bays", config.bays.to_string()));
    }
    facts.extend([
        time,
        fact("Torques", format!("M1 = {} N m, M4 = {} N m", config.drive.m1, config.drive.m4)),
    ]);
    if one == two {
        facts.push(fact("Both joints", joint(one)));
    } else {
        facts.extend([fact("Joint 1", joint(one)), fact("Joint 2", joint(two))]);
    }
    facts
}

fn fact(name: &str, what: impl Into<String>) -> (String, String) {
    (name.into(), what.into())
}

fn slider_crank(own: &SliderCrank) -> String {
    format!(
        "slider-crank: crank {} m at {} rad/s, rod {} m, {} kg, {} kg m², slider {} kg",
        own.crank_length,
        own.crank_speed,
        own.rod_length,
        own.rod_mass,
        own.rod_inertia,
        own.slider_mass
    )
}

fn joint(JointConfig { joint, contact, friction }: &JointConfig) -> String {
    let Joint { clearance, pin_radius } = joint;
    if *clearance == 0.0 {
        return "without clearance: the pin is held, no contact law acts".to_owned();
    }
    let parts = [
        format!("clearance c = {clearance:e} m, pin radius {pin_radius:e} m"),
        format!("contact law {}", contact.law),
        elastic(contact),
        loss(contact),
        pull(contact).to_owned(),
        format!("friction law {}, {}", friction.law, sliding(friction)),
    ];
    parts.join(", ")
}

/// What the elastic part of a law is made of.
fn elastic(contact: &Contact) -> String {
    let cylinders = |length: &str| {
        let Contact { young_modulus, poisson_ratio, curvature, .. } = contact;
        let how = match curvature {
            Curvature::Internal => "inside each other",
            Curvature::External => "beside each other",
        };
        format!(
            "cylinders {how}, Young's modulus E = {young_modulus:e} Pa, Poisson's ratio ν = {poisson_ratio}{length}"
        )
    };
    match contact.law {
        ContactLaw::DubowskyFreudenstein
        | ContactLaw::Johnson
        | ContactLaw::Esdu78035
        | ContactLaw::Liu => cylinders(&format!(", length L = {} m", contact.length)),
        ContactLaw::LankaraniNikraveshCylinder => cylinders(""),
        _ => {
            format!("stiffness K = {:e} N/mⁿ, exponent n = {}", contact.stiffness, contact.exponent)
        }
    }
}

/// What a law loses: by damping, or by hysteresis with the restitution that is asked of it and delivered.
fn loss(contact: &Contact) -> String {
    let e = contact.restitution;
    match hysteresis_factor(contact.law, e) {
        None => format!("damping D = {} N s/m", contact.damping),
        Some(chi) => format!(
            "hysteresis χ = {chi:.4}, restitution asked e = {e}, delivered {:.4}, impact speeds from {:e} m/s on",
            delivered(chi),
            contact.impact_speed_floor
        ),
    }
}

fn pull(contact: &Contact) -> &'static str {
    if contact.adhesion { "adhesion: F_N may pull" } else { "no adhesion: contact ends at F_N = 0" }
}

/// What a law of friction is made of.
fn sliding(friction: &Friction) -> String {
    let Friction { coefficient, static_coefficient, stribeck_speed, .. } = friction;
    let at_rest = || format!(", at rest μ_s = {static_coefficient}, v_S = {stribeck_speed:e} m/s");
    let rises = || format!(", v_r = {:e} m/s", friction.regularisation_speed);
    let more = match friction.law {
        FrictionLaw::Coulomb => String::new(),
        FrictionLaw::Stribeck => at_rest(),
        FrictionLaw::Tanh | FrictionLaw::Threlfall => rises(),
        FrictionLaw::Ambrosio => format!("{}, dead up to {} v_r", rises(), friction.dead_ratio),
        FrictionLaw::Lugre => format!(
            "{}, bristles σ0 = {:e} 1/m, σ1 = {} s/m, σ2 = {} s/m",
            at_rest(),
            friction.bristle_stiffness,
            friction.bristle_damping,
            friction.viscosity
        ),
    };
    format!("coefficient μ = {coefficient}{more}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of both joints with `sets`.
    fn said(sets: &[&str]) -> String {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let facts = facts(&Config::load(None, &sets).unwrap());
        let joints = facts.into_iter().filter(|(name, _)| name.contains("oint"));
        joints.map(|(_, what)| what).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn the_printed_law_has_its_damping_and_no_restitution() {
        let text = said(&[]);
        for part in [
            "K = 1e7 N/mⁿ",
            "n = 1,",
            "D = 178.7 N s/m",
            "F_N may pull",
            "law coulomb, coefficient μ = 0.1",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        for part in ["restitution", "E = ", "L = ", "μ_s", "v_r", "σ", "impact"] {
            assert!(!text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn every_law_of_contact_tells_what_it_uses_and_nothing_else() {
        for law in ContactLaw::ALL {
            let text = said(&[&format!("contact.law={law}"), "contact.restitution=0.6"]);
            let is_of_cylinders = text.contains("Young's modulus");
            assert_eq!(text.contains("stiffness K"), !is_of_cylinders, "{law}: {text}");
            assert_eq!(
                text.contains("restitution asked e = 0.6, "),
                law.has_memory(),
                "{law}: {text}"
            );
            assert_eq!(text.contains("damping D"), !law.has_memory(), "{law}: {text}");
            let n_cylinders = ["dubowsky", "johnson", "esdu", "liu", "cylinder"];
            let named = n_cylinders.iter().any(|part| law.to_string().contains(part));
            assert_eq!(is_of_cylinders, named, "{law}: {text}");
            let has_length = is_of_cylinders && !law.has_memory();
            assert_eq!(text.contains("length L = 0.02 m"), has_length, "{law}: {text}");
        }
        let text = said(&["contact.law=lankarani_nikravesh", "contact.restitution=0.6"]);
        assert!(text.contains("χ = 0.4800") && text.contains("delivered 0.756"), "{text}");
    }

    #[test]
    fn every_law_of_friction_tells_what_it_uses_and_nothing_else() {
        let parts = ["μ_s = 0.15, v_S", "v_r = ", "dead up to 0.1", "σ0 = 1e5"];
        for (law, uses) in [
            ("coulomb", [false, false, false, false]),
            ("stribeck", [true, false, false, false]),
            ("tanh", [false, true, false, false]),
            ("ambrosio", [false, true, true, false]),
            ("threlfall", [false, true, false, false]),
            ("lugre", [true, false, false, true]),
        ] {
            let text = said(&[&format!("friction.law={law}")]);
            assert_eq!(parts.map(|part| text.contains(part)), uses, "{law}: {text}");
        }
    }

    #[test]
    fn joints_that_differ_are_told_apart_and_an_ideal_one_has_no_law() {
        let text = said(&["joint2.contact.stiffness=2e7"]);
        assert!(text.contains("K = 1e7") && text.contains("K = 2e7"), "{text}");
        let text = said(&["joint.clearance=0"]);
        assert!(text.contains("the pin is held") && !text.contains("K = "), "{text}");
    }
}
