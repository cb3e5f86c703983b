//! A joint in words: of each law what it uses and nothing that it does not, and what to know of it before a run.

use deltazero_study::warning::{Code, Warning};

use crate::keys::{Contact, Curvature, Friction, FrictionLaw, Joint, JointConfig};
use crate::laws::Relation;
use crate::laws::hysteresis::delivered;

/// A restitution that is further off than this from the one asked for is warned of.
const TOLD: f64 = 0.01;

/// A name and what it is.
pub(super) fn fact(name: &str, what: impl Into<String>) -> (String, String) {
    (name.into(), what.into())
}

/// A joint with its laws.
pub(super) fn joint(JointConfig { joint, contact, friction }: &JointConfig) -> String {
    let Joint { clearance, pin_radius } = joint;
    if *clearance == 0.0 {
        return "without clearance: the pin is held, no contact law acts".to_owned();
    }
    let parts = [
        format!("clearance c = {clearance:e} m, pin radius {pin_radius:e} m"),
        normal_contact(contact),
        format!("friction law {}, {}", friction.law, sliding(friction)),
    ];
    parts.join(", ")
}

/// A contact without friction.
pub(super) fn normal_contact(contact: &Contact) -> String {
    let law = format!("contact law {}", contact.law);
    [law, elastic(contact), loss(contact), pull(contact).to_owned()].join(", ")
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
    match contact.law.relation {
        Relation::Power => {
            format!("stiffness K = {:e} N/mⁿ, exponent n = {}", contact.stiffness, contact.exponent)
        }
        Relation::Line(_) => cylinders(&format!(", length L = {} m", contact.length)),
        Relation::Point(_) => cylinders(""),
    }
}

/// What a law loses: by damping, or by hysteresis with the restitution that is asked of it and delivered.
fn loss(contact: &Contact) -> String {
    let e = contact.restitution;
    match contact.law.hysteresis_factor(e) {
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

/// Warnings of a contact law that delivers another restitution than it is asked for, in the joint or the joints called
/// `name`.
pub(super) fn joint_warnings(name: &str, joint: &JointConfig) -> Vec<Warning> {
    let has_contact = joint.joint.clearance > 0.0;
    if has_contact { normal_warnings(name, &joint.contact) } else { Vec::new() }
}

/// The same of the contact called `name`.
pub(super) fn normal_warnings(name: &str, contact: &Contact) -> Vec<Warning> {
    let warning = |off| Warning { code: Code::Restitution, message: format!("{name}: {off}") };
    off(contact).map(warning).into_iter().collect()
}

/// What a contact is asked for and what its law delivers, where these differ by more than [`TOLD`].
fn off(contact: &Contact) -> Option<String> {
    let (law, asked) = (contact.law, contact.restitution);
    let delivered = delivered(law.hysteresis_factor(asked)?);
    let elastic =
        if law.is_of_cylinders() { ", on K δⁿ in the place of its cylinders," } else { "" };
    ((delivered - asked).abs() > TOLD).then(|| {
        format!(
            "contact.law = {law} is asked for a restitution of {asked} and delivers {delivered:.3}; \
             exact_restitution{elastic} delivers what is asked"
        )
    })
}

/// Why these joints have no blind runs, where they have none; `or` may know another reason.
pub(super) fn no_blind_joints(
    joints: &[JointConfig],
    or: impl FnOnce() -> Option<String>,
) -> Option<String> {
    let mut laws = joints.iter().map(|joint| joint.contact.law);
    if let Some(law) = laws.find(|law| law.has_memory()) {
        return Some(format!(
            "contact.law = {law} depends on the speed of each impact, which is read off no state"
        ));
    }
    let bristles = || {
        let has_bristles = joints.iter().any(|joint| joint.friction.law == FrictionLaw::Lugre);
        let reason = "the bristles of lugre bend from the event on at which a contact begins";
        has_bristles.then(|| reason.to_owned())
    };
    or().or_else(bristles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::laws::ContactLaw;

    /// What is said of both joints with `sets`.
    fn said(sets: &[&str]) -> String {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let config = Config::load(None, &sets).unwrap();
        let facts = config.mechanism.facts(&config);
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

    fn messages(sets: &[&str]) -> Vec<String> {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let config = Config::load(None, &sets).unwrap();
        let warnings = config.mechanism.warnings(&config);
        assert!(warnings.iter().all(|warning| warning.code == Code::Restitution));
        warnings.into_iter().map(|warning| warning.message).collect()
    }

    #[test]
    fn a_law_that_delivers_another_restitution_is_told_with_both_numbers() {
        let lankarani = "contact.law=lankarani_nikravesh";
        assert_eq!(
            messages(&[lankarani, "contact.restitution=0.6"]),
            [
                "both joints: contact.law = lankarani_nikravesh is asked for a restitution of 0.6 and \
              delivers 0.756; exact_restitution delivers what is asked"
            ]
        );
        let one = messages(&["joint2.contact.law=flores", "contact.restitution=0.3"]);
        assert!(one.len() == 1 && one[0].starts_with("joint 2: contact.law = flores"), "{one:?}");
        let both = messages(&[lankarani, "joint2.contact.law=lee_wang"]);
        assert_eq!(both.len(), 2);
        let crank = messages(&["mechanism=slider-crank", "contact.restitution=0.6"]);
        assert!(crank.len() == 1 && crank[0].starts_with("the joint: "), "{crank:?}");
        let cylinder =
            messages(&["contact.law=lankarani_nikravesh_cylinder", "contact.restitution=0.5"]);
        assert!(cylinder[0].contains("exact_restitution, on K δⁿ"), "{cylinder:?}");
    }

    #[test]
    fn a_law_without_restitution_or_with_the_right_one_is_not_told() {
        for law in ["power", "johnson", "exact_restitution"] {
            let law = format!("contact.law={law}");
            assert_eq!(messages(&[&law, "contact.restitution=0.3"]), Vec::<String>::new());
        }
        // χ of Hunt and Crossley delivers 0.952 for 0.95; a joint without clearance has no impact.
        for other in ["contact.restitution=0.95", "joint.clearance=0"] {
            let sets = ["contact.law=hunt_crossley", "contact.restitution=0.6", other];
            assert_eq!(messages(&sets), Vec::<String>::new());
        }
    }
}
