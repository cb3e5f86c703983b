//! The impact oscillator in the list of mechanisms: its keys, and what a report says of it.

use deltazero_study::Subject;

use super::ImpactOscillator;
use crate::keys::{FINITE, Key, Kind, NOT_NEGATIVE, POSITIVE, Range, Shared};
use crate::mechanisms::in_words::fact;
use crate::mechanisms::{Entry, Mechanism, Misfit, read_table};

/// Where its numbers are from.
const SOURCE: &str = "our choice";

/// Its line in the list.
pub(in crate::mechanisms) const IMPACT_OSCILLATOR: Entry = Entry {
    name: "impact-oscillator",
    about: "a driven mass on a spring that hits a rigid stop",
    keys: KEYS,
    uses: &[],
    defaults: &[
        ("run.t_end", "21.0", SOURCE),
        ("run.sample", "0.05", SOURCE),
        ("solver.step", "1e-3", SOURCE),
        ("study.steps", "[0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4]", SOURCE),
    ],
    has_two_joints: false,
    read: |tables| read_table::<ImpactOscillator>(tables, "impact_oscillator"),
};

const FRACTION: Kind = Kind::Number(Range::closed(0.0, 1.0));

const KEYS: &[Key] = &[
    Key::new("impact_oscillator.mass", POSITIVE, "1.0", "kg", "Mass m", SOURCE),
    Key::new("impact_oscillator.damping", NOT_NEGATIVE, "1.0", "N s/m", "Damping c", SOURCE),
    Key::new(
        "impact_oscillator.stiffness",
        POSITIVE,
        "100.0",
        "N/m",
        "Stiffness k of the spring",
        SOURCE,
    ),
    Key::new(
        "impact_oscillator.amplitude",
        NOT_NEGATIVE,
        "10.0",
        "N",
        "Amplitude F of the force",
        SOURCE,
    ),
    Key::new(
        "impact_oscillator.frequency",
        POSITIVE,
        "6.0",
        "rad/s",
        "Angular frequency ω of the force",
        SOURCE,
    ),
    Key::new(
        "impact_oscillator.gap",
        NOT_NEGATIVE,
        "0.1",
        "m",
        "Gap d between the rest of the spring and the stop",
        SOURCE,
    ),
    Key::new(
        "impact_oscillator.restitution",
        FRACTION,
        "0.6",
        "",
        "Restitution e of an impact",
        SOURCE,
    ),
    Key::new(
        "impact_oscillator.start_position",
        FINITE,
        "-0.1",
        "m",
        "Position at t = 0, from the stop, at most 0",
        SOURCE,
    ),
    Key::new("impact_oscillator.start_velocity", FINITE, "0.0", "m/s", "Velocity at t = 0", SOURCE),
];

impl Mechanism for ImpactOscillator {
    fn subject(&self, _shared: &Shared) -> Subject {
        Subject::of(*self)
    }

    fn n_tolerances(&self) -> usize {
        2
    }

    fn check(&self, _shared: &Shared) -> Result<(), Misfit> {
        if self.gap == 0.0 && self.amplitude == 0.0 {
            let (key, found) = ("impact_oscillator.amplitude", self.amplitude.to_string());
            let reason = "without a gap and a force nothing has a size; give one of them";
            return Err(Misfit { key, found, against: "impact_oscillator.gap", reason });
        }
        if self.start_position > 0.0 {
            let (key, found) =
                ("impact_oscillator.start_position", self.start_position.to_string());
            let reason = "the mass must start on its side of the stop, at 0 or below";
            return Err(Misfit { key, found, against: "mechanism", reason });
        }
        Ok(())
    }

    fn title(&self, _shared: &Shared) -> String {
        "Mechanism `impact-oscillator`".to_owned()
    }

    fn lead(&self) -> &str {
        "A driven mass on a spring hits a rigid stop and bounces; where bounces accumulate it rests there until the force lets \
         it go. Each impact is an event, the zero crossing of the distance."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let Self { mass, damping, stiffness, amplitude, frequency, gap, restitution, .. } = self;
        vec![
            fact(
                "Mechanism",
                format!(
                    "impact oscillator: m = {mass} kg, c = {damping} N s/m, k = {stiffness} N/m"
                ),
            ),
            fact("Force", format!("{amplitude} N at {frequency} rad/s")),
            fact("Stop", format!("at {gap} m, restitution {restitution}")),
            fact("Time", format!("0 to {} s", shared.run.t_end)),
        ]
    }
}
