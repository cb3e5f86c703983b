//! A slider-crank with clearance between rod and slider.

use deltazero_study::warning::Warning;
use serde::Deserialize;

use super::in_words::{fact, joint, joint_warnings, no_blind_joints};
use super::{Entry, Mechanism, Misfit, OURS, read_table};
use crate::keys::{FINITE, Key, POSITIVE, ReadingName, Shared};
use crate::model::{self, AnyLinkage, Body, Joints, Part, block};

/// Where it is from.
const SOURCE: &str = "slider-crank benchmark of Flores, Ambrósio, Claro and Lankarani";

/// Its line in the list.
pub(super) const SLIDER_CRANK: Entry = Entry {
    name: "slider-crank",
    about: "crank, rod and slider, with clearance between the last two",
    keys: KEYS,
    uses: &["reading", "joint", "contact", "friction"],
    defaults: &[
        ("reading", "\"full\"", OURS),
        ("joint.clearance", "5e-4", SOURCE),
        ("joint.pin_radius", "9.5e-3", SOURCE),
        ("contact.law", "\"lankarani_nikravesh\"", SOURCE),
        ("contact.stiffness", "6.61e10", SOURCE),
        ("contact.exponent", "1.5", SOURCE),
        ("friction.coefficient", "0.03", SOURCE),
        ("friction.static_coefficient", "0.045", OURS),
        ("run.t_end", "0.024", OURS),
        ("run.sample", "1e-4", OURS),
        ("solver.step", "1e-6", OURS),
        ("study.steps", "[2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7, 1e-7]", OURS),
    ],
    has_two_joints: false,
    read: |tables| read_table::<SliderCrank>(tables, "slider_crank"),
};

const KEYS: &[Key] = &[
    Key::new("slider_crank.crank_length", POSITIVE, "0.05", "m", "Length r of the crank", SOURCE),
    Key::new(
        "slider_crank.rod_length",
        POSITIVE,
        "0.12",
        "m",
        "Length l of the rod, above crank_length + clearance",
        SOURCE,
    ),
    Key::new(
        "slider_crank.rod_mass",
        POSITIVE,
        "0.21",
        "kg",
        "Mass of the rod, its centroid in its middle",
        SOURCE,
    ),
    Key::new(
        "slider_crank.rod_inertia",
        POSITIVE,
        "2.5e-4",
        "kg m²",
        "Inertia of the rod about its centroid",
        SOURCE,
    ),
    Key::new(
        "slider_crank.slider_mass",
        POSITIVE,
        "0.14",
        "kg",
        "Mass of the slider, with the bush",
        SOURCE,
    ),
    Key::new(
        "slider_crank.crank_speed",
        POSITIVE,
        "523.5987755982989",
        "rad/s",
        "Speed of the crank, which is held",
        "5000 rpm, as in the same benchmark",
    ),
    Key::new(
        "slider_crank.start_angle",
        FINITE,
        "0.0",
        "rad",
        "Angle of the crank at the start; 0: crank and rod in line, the slider farthest",
        "the same benchmark",
    ),
];

/// Crank, rod and slider.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct SliderCrank {
    /// Length r of the crank [m].
    crank_length: f64,
    /// Length l of the rod [m].
    rod_length: f64,
    /// Mass of the rod, its centroid in its middle [kg].
    rod_mass: f64,
    /// Inertia of the rod about its centroid [kg m²].
    rod_inertia: f64,
    /// Mass of the slider [kg].
    slider_mass: f64,
    /// Speed of the crank, held [rad/s].
    crank_speed: f64,
    /// Angle of the crank at the start, 0 where crank and rod are in line and the slider is farthest [rad].
    start_angle: f64,
}

impl Mechanism for SliderCrank {
    fn joints(&self, shared: &Shared) -> Joints {
        let body = model::SliderCrank {
            crank: self.crank_length,
            rod: self.rod_length,
            rod_mass: self.rod_mass,
            rod_inertia: self.rod_inertia,
            slider_mass: self.slider_mass,
            speed: self.crank_speed,
            start: self.start_angle,
        };
        let of_rod = (self.rod_length, ReadingName::Full);
        Joints {
            parts: vec![Part::of(
                block(shared, 1, Body::Linkage(AnyLinkage::SliderCrank(body)), of_rod),
                1,
            )],
        }
    }

    fn n_tolerances(&self) -> usize {
        6
    }

    fn check(&self, shared: &Shared) -> Result<(), Misfit> {
        if shared.reading != ReadingName::Full {
            let reason = "readings are of the struts' paper, here force and torque of friction both act; use reading = \
                          \"full\", and for a file with all of its keys `deltazero config --set \
                          mechanism=slider-crank`";
            let (key, found) = ("reading", shared.reading.to_string());
            return Err(Misfit { key, found, against: "mechanism", reason });
        }
        if self.rod_length <= self.crank_length + shared.joints[0].joint.clearance {
            let reason =
                "the rod must be longer than crank_length + joint.clearance to turn around";
            let (key, found) = ("slider_crank.rod_length", self.rod_length.to_string());
            return Err(Misfit { key, found, against: "mechanism", reason });
        }
        Ok(())
    }

    fn title(&self, _shared: &Shared) -> String {
        "Mechanism `slider-crank`".to_owned()
    }

    fn lead(&self) -> &str {
        "The pin of a rod rattles in the bush of its slider: free flight, then contact through a stiff spring, with \
         friction; each change is an event, the zero crossing of the penetration δ."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let mechanism = format!(
            "slider-crank: crank {} m at {} rad/s, rod {} m, {} kg, {} kg m², slider {} kg",
            self.crank_length,
            self.crank_speed,
            self.rod_length,
            self.rod_mass,
            self.rod_inertia,
            self.slider_mass
        );
        vec![
            fact("Mechanism", mechanism),
            fact("Time", format!("0 to {} s", shared.run.t_end)),
            fact("Joint of rod and slider", joint(&shared.joints[0])),
        ]
    }

    fn leading(&self, shared: &Shared) -> Vec<(&'static str, &'static str, String)> {
        vec![("reading", "reading of the paper", shared.reading.to_string())]
    }

    fn warnings(&self, shared: &Shared) -> Vec<Warning> {
        joint_warnings("the joint", &shared.joints[0])
    }

    fn no_blind_runs(&self, shared: &Shared) -> Option<String> {
        no_blind_joints(&shared.joints[..1], || None)
    }
}
