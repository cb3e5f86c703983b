//! A four-bar linkage with clearance between coupler and rocker.

use deltazero_study::warning::Warning;
use serde::Deserialize;

use super::in_words::{fact, joint, joint_warnings, no_blind_joints};
use super::{Entry, Mechanism, Misfit, OURS, read_table};
use crate::keys::{FINITE, Key, POSITIVE, ReadingName, Shared};
use crate::model::{self, AnyLinkage, Body, Joints, Part, block};

/// Where lengths and masses are from; the same numbers are in the examples of the program Siconos.
const SOURCE: &str = "four-bar with joint clearances of Akhadkar, Acary and Brogliato, Multibody Syst. Dyn. 38 (2016)";

/// Its line in the list.
pub(super) const FOUR_BAR: Entry = Entry {
    name: "four-bar",
    about: "crank, coupler and rocker, with clearance between the last two",
    keys: KEYS,
    uses: &["joint", "contact", "friction"],
    defaults: &[
        ("joint.clearance", "1e-3", OURS),
        ("joint.pin_radius", "0.059", OURS),
        ("contact.law", "\"lankarani_nikravesh\"", OURS),
        ("contact.stiffness", "1e9", OURS),
        ("contact.exponent", "1.5", OURS),
        ("contact.restitution", "0.8", OURS),
        ("friction.coefficient", "0.1", OURS),
        ("run.t_end", "1.0", OURS),
        ("run.sample", "5e-3", OURS),
        ("solver.step", "2e-5", OURS),
        ("study.steps", "[2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6]", OURS),
    ],
    has_two_joints: false,
    read: |tables| read_table::<FourBar>(tables, "four_bar"),
};

const KEYS: &[Key] = &[
    Key::new("four_bar.crank_length", POSITIVE, "1.0", "m", "Length r of the crank", SOURCE),
    Key::new("four_bar.coupler_length", POSITIVE, "4.0", "m", "Length l of the coupler", SOURCE),
    Key::new("four_bar.rocker_length", POSITIVE, "2.5", "m", "Length b of the rocker", SOURCE),
    Key::new(
        "four_bar.ground_length",
        POSITIVE,
        "3.0",
        "m",
        "Distance g of the pivots of crank and rocker",
        SOURCE,
    ),
    Key::new(
        "four_bar.coupler_mass",
        POSITIVE,
        "1.0",
        "kg",
        "Mass of the coupler, its centroid in its middle",
        SOURCE,
    ),
    Key::new(
        "four_bar.rocker_mass",
        POSITIVE,
        "1.0",
        "kg",
        "Mass of the rocker, its centroid in its middle",
        SOURCE,
    ),
    Key::new(
        "four_bar.coupler_inertia",
        POSITIVE,
        "1.3333333333333333",
        "kg m²",
        "Inertia of the coupler about its centroid, of a slender rod m l²/12",
        SOURCE,
    ),
    Key::new(
        "four_bar.rocker_inertia",
        POSITIVE,
        "0.5208333333333334",
        "kg m²",
        "Inertia of the rocker about its centroid, of a slender rod m b²/12",
        SOURCE,
    ),
    Key::new(
        "four_bar.crank_speed",
        POSITIVE,
        "6.283185307179586",
        "rad/s",
        "Speed of the crank, which is held",
        "our choice: a turn a second; the source controls a torque",
    ),
    Key::new(
        "four_bar.start_angle",
        FINITE,
        "1.5707963267948966",
        "rad",
        "Angle of the crank at the start, from the line of the pivots",
        OURS,
    ),
];

/// Crank, coupler and rocker.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct FourBar {
    /// Lengths of crank, coupler and rocker, and distance of the pivots [m].
    crank_length: f64,
    coupler_length: f64,
    rocker_length: f64,
    ground_length: f64,
    /// Masses [kg] and inertias about the centroids [kg m²].
    coupler_mass: f64,
    rocker_mass: f64,
    coupler_inertia: f64,
    rocker_inertia: f64,
    /// Speed of the crank, held [rad/s].
    crank_speed: f64,
    /// Angle of the crank at the start [rad].
    start_angle: f64,
}

impl Mechanism for FourBar {
    fn joints(&self, shared: &Shared) -> Joints {
        let body = model::FourBar {
            crank: self.crank_length,
            coupler: self.coupler_length,
            rocker: self.rocker_length,
            ground: self.ground_length,
            coupler_mass: self.coupler_mass,
            coupler_inertia: self.coupler_inertia,
            rocker_mass: self.rocker_mass,
            rocker_inertia: self.rocker_inertia,
            speed: self.crank_speed,
            start: self.start_angle,
            pin_radius: shared.joints[0].joint.pin_radius,
        };
        let body = Body::Linkage(AnyLinkage::FourBar(body));
        let of_rocker = (self.rocker_length, ReadingName::Full);
        Joints { parts: vec![Part::of(block(shared, 1, body, of_rocker), 1)] }
    }

    fn n_tolerances(&self) -> usize {
        6
    }

    /// The crank must turn around, and the rocker swing, whatever the pin does in its bush.
    fn check(&self, shared: &Shared) -> Result<(), Misfit> {
        let c = 2.0 * shared.joints[0].joint.clearance;
        let [r, l, b, g] =
            [self.crank_length, self.coupler_length, self.rocker_length, self.ground_length];
        let refused = |key, found: f64, reason| {
            Err(Misfit { key, found: found.to_string(), against: "mechanism", reason })
        };
        if (l - b).abs() >= g - r - c {
            let reason = "no crank-rocker: |coupler_length − rocker_length| must be below ground_length − crank_length by \
                          twice the clearance";
            return refused("four_bar.coupler_length", l, reason);
        }
        if g + r + c >= l + b {
            let reason = "no crank-rocker: ground_length + crank_length must be below coupler_length + rocker_length by \
                          twice the clearance";
            return refused("four_bar.ground_length", g, reason);
        }
        Ok(())
    }

    fn title(&self, _shared: &Shared) -> String {
        "Mechanism `four-bar`".to_owned()
    }

    fn lead(&self) -> &str {
        "The pin of a coupler rattles in the bush of a rocker: free flight, then contact through a stiff spring, with \
         friction; each change is an event, the zero crossing of the penetration δ."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let mechanism = format!(
            "four-bar: crank {} m at {} rad/s, coupler {} m, {} kg, {} kg m², rocker {} m, {} kg, {} kg m², pivots {} m apart",
            self.crank_length,
            self.crank_speed,
            self.coupler_length,
            self.coupler_mass,
            self.coupler_inertia,
            self.rocker_length,
            self.rocker_mass,
            self.rocker_inertia,
            self.ground_length
        );
        vec![
            fact("Mechanism", mechanism),
            fact("Time", format!("0 to {} s", shared.run.t_end)),
            fact("Joint of coupler and rocker", joint(&shared.joints[0])),
        ]
    }

    fn warnings(&self, shared: &Shared) -> Vec<Warning> {
        joint_warnings("the joint", &shared.joints[0])
    }

    fn no_blind_runs(&self, shared: &Shared) -> Option<String> {
        no_blind_joints(&shared.joints[..1], || None)
    }
}
