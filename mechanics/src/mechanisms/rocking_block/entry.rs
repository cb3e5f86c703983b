//! The rocking block in the list of mechanisms: its keys, and what a report says of it.

use deltazero_study::Subject;

use super::RockingBlock;
use crate::keys::{DefaultValue, FINITE, Key, Kind, NOT_NEGATIVE, POSITIVE, Range, Shared};
use crate::mechanisms::in_words::fact;
use crate::mechanisms::{Entry, Mechanism, Misfit, read_table};

/// Where its numbers are from.
const SOURCE: &str = "our choice";

/// Its line in the list.
pub(in crate::mechanisms) const ROCKING_BLOCK: Entry = Entry {
    name: "rocking-block",
    about: "Housner's rigid block that rocks from corner to corner",
    keys: KEYS,
    uses: &[],
    defaults: &[
        ("run.t_end", "7.5", SOURCE),
        ("run.sample", "0.025", SOURCE),
        ("solver.step", "1e-3", SOURCE),
        ("study.steps", "[0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4]", SOURCE),
    ],
    has_two_joints: false,
    read: |tables| read_table::<RockingBlock>(tables, "rocking_block"),
};

const KEYS: &[Key] = &[
    Key::new(
        "rocking_block.mass",
        POSITIVE,
        "1000.0",
        "kg",
        "Mass m; the motion does not depend on it",
        SOURCE,
    ),
    Key::new("rocking_block.half_width", POSITIVE, "0.2", "m", "Half the width, b", SOURCE),
    Key::new("rocking_block.half_height", POSITIVE, "0.8", "m", "Half the height, h", SOURCE),
    Key::new("rocking_block.gravity", POSITIVE, "9.81", "m/s²", "Gravity g", SOURCE),
    Key {
        path: "rocking_block.restitution",
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        default: DefaultValue::Absent("0.9"),
        unit: "",
        doc: "Ratio r of the angular velocities after and before an impact",
        source: "absent: Housner's, 1 − (3/2) sin²α",
    },
    Key::new(
        "rocking_block.base_amplitude",
        NOT_NEGATIVE,
        "0.0",
        "m/s²",
        "Amplitude A of the base's acceleration",
        SOURCE,
    ),
    Key::new(
        "rocking_block.base_frequency",
        POSITIVE,
        "6.0",
        "rad/s",
        "Angular frequency Ω of the base",
        SOURCE,
    ),
    Key::new(
        "rocking_block.start_angle",
        FINITE,
        "0.15",
        "rad",
        "Tilt θ at t = 0, less than atan(b/h) + π/4",
        SOURCE,
    ),
    Key::new(
        "rocking_block.start_velocity",
        FINITE,
        "0.0",
        "rad/s",
        "Angular velocity at t = 0",
        SOURCE,
    ),
];

impl Mechanism for RockingBlock {
    fn subject(&self, _shared: &Shared) -> Subject {
        Subject::of(*self)
    }

    fn n_sites(&self, _shared: &Shared) -> usize {
        2
    }

    fn n_tolerances(&self) -> usize {
        3
    }

    fn check(&self, _shared: &Shared) -> Result<(), Misfit> {
        if self.velocity_ratio() < 0.0 {
            let (key, found) = ("rocking_block.half_width", self.half_width.to_string());
            let reason = "Housner's ratio 1 − (3/2) sin²α is below zero; take a block with b/h below √2, or give the restitution";
            return Err(Misfit { key, found, against: "rocking_block.half_height", reason });
        }
        if self.start_angle.abs() < self.overturned_at() {
            return Ok(());
        }
        let (key, found) = ("rocking_block.start_angle", self.start_angle.to_string());
        let reason = "the block starts overturned: the tilt must be below atan(b/h) + π/4";
        Err(Misfit { key, found, against: "mechanism", reason })
    }

    fn title(&self, _shared: &Shared) -> String {
        "Mechanism `rocking-block`".to_owned()
    }

    fn lead(&self) -> &str {
        "A rigid block rocks from one corner of its base to the other and loses energy at each impact; where impacts accumulate \
         it comes to rest. Each impact is an event, the zero crossing of the tilt."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let block = format!(
            "rocking block: {} m wide, {} m high, α = {:.4} rad, p = {:.4} rad/s, velocity ratio r = {:.4}",
            2.0 * self.half_width,
            2.0 * self.half_height,
            self.slenderness(),
            self.frequency(),
            self.velocity_ratio()
        );
        let base = format!("{} m/s² at {} rad/s", self.base_amplitude, self.base_frequency);
        vec![
            fact("Mechanism", block),
            fact("Start", format!("θ = {} rad, {} rad/s", self.start_angle, self.start_velocity)),
            fact("Acceleration of the base", base),
            fact("Time", format!("0 to {} s", shared.run.t_end)),
        ]
    }
}
