//! The models that come with this crate, as text to start from.

/// A model as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model {
    /// Name of its file, without the ending.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

impl Model {
    /// What it is, in a sentence: the line `about` of its text.
    pub fn about(&self) -> &'static str {
        let about = self.text.lines().find_map(|line| line.strip_prefix("about = \""));
        about.map_or("", |about| about.trim_end_matches('"'))
    }
}

macro_rules! models {
    ($($name:literal),* $(,)?) => {
        &[$(Model { name: $name, text: include_str!(concat!("../models/", $name, ".toml")) }),*]
    };
}

/// All of them.
pub const MODELS: &[Model] = models![
    "belt_oscillator",
    "bouncing_ball",
    "buck_converter",
    "cam_follower",
    "carts",
    "hunt_crossley_ball",
    "impact_oscillator",
    "integrate_and_fire",
    "lugre_brake",
    "mass_against_stop",
    "paper_joint",
    "rocking_block",
    "thermostat",
    "van_der_pol",
];
