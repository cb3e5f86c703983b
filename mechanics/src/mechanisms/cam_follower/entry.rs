//! The cam and its follower in the list of mechanisms: its keys, and what a report says of it.

use deltazero_study::Subject;
use deltazero_study::warning::Warning;
use serde::Deserialize;

use super::CamFollower;
use crate::keys::{Curvature, Joint, JointConfig, Key, NOT_NEGATIVE, POSITIVE, Shared};
use crate::mechanisms::in_words::{fact, normal_contact, normal_warnings};
use crate::mechanisms::{Entry, Mechanism, Misfit, read_table};
use crate::model::contact::NormalLaw;

/// Where its numbers are from.
const SOURCE: &str = "our choice, of the size of a small engine's valve train";

/// Its line in the list.
pub(in crate::mechanisms) const CAM_FOLLOWER: Entry = Entry {
    name: "cam-follower",
    about: "a cam with a flat-faced follower that lifts off: valve float",
    keys: KEYS,
    // Laws of cylinders take the radii of [joint].
    uses: &["joint", "contact"],
    defaults: &[
        ("contact.stiffness", "1e8", SOURCE),
        ("contact.damping", "900.0", SOURCE),
        ("contact.adhesion", "false", SOURCE),
        ("run.t_end", "0.13", SOURCE),
        ("run.sample", "5e-4", SOURCE),
        ("solver.step", "2e-6", SOURCE),
        ("study.steps", "[2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7]", SOURCE),
    ],
    has_two_joints: false,
    read: |tables| read_table::<Parameters>(tables, "cam_follower"),
};

const KEYS: &[Key] = &[
    Key::new(
        "cam_follower.mass",
        POSITIVE,
        "0.2",
        "kg",
        "Mass m of the follower, with a third of the spring's",
        SOURCE,
    ),
    Key::new("cam_follower.stiffness", POSITIVE, "1e4", "N/m", "Stiffness k of the spring", SOURCE),
    Key::new("cam_follower.preload", POSITIVE, "100.0", "N", "Preload F_0 of the spring", SOURCE),
    Key::new(
        "cam_follower.damping",
        NOT_NEGATIVE,
        "5.0",
        "N s/m",
        "Damping c of the spring",
        SOURCE,
    ),
    Key::new("cam_follower.lift", POSITIVE, "0.01", "m", "Greatest lift h of the cam", SOURCE),
    Key::new(
        "cam_follower.speed",
        POSITIVE,
        "480.0",
        "rad/s",
        "Speed Ω of the cam, which is held; separation begins at 447",
        SOURCE,
    ),
];

/// What its table holds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    mass: f64,
    stiffness: f64,
    preload: f64,
    damping: f64,
    lift: f64,
    speed: f64,
}

impl Parameters {
    fn follower(&self, shared: &Shared) -> CamFollower {
        let Self { mass, stiffness, preload, damping, lift, speed } = *self;
        let joint = &shared.joints[0];
        let normal = NormalLaw::new(&joint.contact, &joint.joint);
        CamFollower { mass, stiffness, preload, damping, lift, speed, normal }
    }
}

/// The contact in words, with the radii of the cylinders that its law may be of.
fn contact(JointConfig { joint, contact, .. }: &JointConfig) -> String {
    let law = normal_contact(contact);
    if !contact.law.is_of_cylinders() {
        return law;
    }
    let Joint { clearance, pin_radius } = joint;
    format!("{law}, radii r = {pin_radius:e} m and r + c, c = {clearance:e} m")
}

impl Mechanism for Parameters {
    fn subject(&self, shared: &Shared) -> Subject {
        Subject::of(self.follower(shared))
    }

    fn n_tolerances(&self) -> usize {
        3
    }

    /// Cylinders inside each other must leave a gap: without one they touch all over, and their law has no number.
    fn check(&self, shared: &Shared) -> Result<(), Misfit> {
        let JointConfig { joint, contact, .. } = &shared.joints[0];
        let is_inside = contact.law.is_of_cylinders() && contact.curvature == Curvature::Internal;
        if is_inside && joint.clearance == 0.0 {
            let reason = "cylinders inside each other need a gap; use a clearance above zero, or contact.curvature = \
                          \"external\"";
            let (key, found) = ("joint.clearance", joint.clearance.to_string());
            return Err(Misfit { key, found, against: "contact.law", reason });
        }
        Ok(())
    }

    fn title(&self, _shared: &Shared) -> String {
        "Mechanism `cam-follower`".to_owned()
    }

    fn lead(&self) -> &str {
        "A follower on a spring rides on a turning cam, lifts off where the spring is too weak, flies, lands and bounces; each \
         change is an event, the zero crossing of the gap or of the contact force."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let Self { mass, stiffness, preload, damping, lift, speed } = self;
        let spring = format!("{stiffness} N/m, preload {preload} N, damping {damping} N s/m");
        vec![
            fact(
                "Mechanism",
                format!("cam and follower: {mass} kg, lift {lift} m, cam at {speed} rad/s"),
            ),
            fact("Spring", spring),
            fact(
                "Separation",
                format!(
                    "above {:.1} rad/s on a rigid contact",
                    self.follower(shared).separation_speed()
                ),
            ),
            fact("Time", format!("0 to {} s", shared.run.t_end)),
            fact("Contact", contact(&shared.joints[0])),
        ]
    }

    fn warnings(&self, shared: &Shared) -> Vec<Warning> {
        normal_warnings("the contact", &shared.joints[0].contact)
    }
}
