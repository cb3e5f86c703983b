//! The tables of a configuration that mechanisms share, as types.

use serde::{Deserialize, Serialize};

use deltazero_study::setting::{self, Digits, Events};

use super::words::{Curvature, FrictionLaw, ReadingName};
use crate::laws::ContactLaw;

/// What a configuration has beside the mechanism and its own tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// Reading of the paper.
    pub reading: ReadingName,
    /// Side frames in the chain.
    pub bays: u32,
    /// The struts.
    pub strut: Strut,
    /// The driving torques.
    pub drive: Drive,
    /// Root joints 1 (AB) and 2 (AF), what is common to both already entered in each.
    pub joints: [JointConfig; 2],
    /// Extent and output of a run.
    pub run: Run,
    /// Method and accuracy of a run.
    pub solver: Solver,
    /// What a study runs.
    pub study: Study,
    /// Who takes part in a contest.
    pub contest: Contest,
    /// The grid of `regimes`.
    pub regimes: Regimes,
}

/// Six equal, solid, round struts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strut {
    /// Length l \[m\].
    pub length: f64,
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Radius r' \[m\]; the mass is m = ρ π r'² l \[kg\].
    pub radius: f64,
    /// Inertia J about the centroid.
    pub inertia: Inertia,
}

/// Inertia of a strut about its centroid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Inertia {
    /// About its own axis, m r'²/2: the paper's, though its struts do not turn about it.
    Axial,
    /// About an axis across it, m l²/12.
    Transverse,
    /// This one \[kg m²\].
    #[serde(untagged)]
    Value(f64),
}

/// Driving torques.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// M1, on θ1 of every bay \[N m\].
    pub m1: f64,
    /// M4, on θ2 \[N m\].
    pub m4: f64,
}

/// All that may differ between the two root joints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointConfig {
    /// Geometry.
    pub joint: Joint,
    /// Normal force.
    pub contact: Contact,
    /// Tangential force.
    pub friction: Friction,
}

/// Geometry of a joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Clearance c: bush radius minus pin radius \[m\]; of a pin in a bush 0 is the ideal joint, its pin fixed.
    pub clearance: f64,
    /// Pin radius, the arm of friction \[m\].
    pub pin_radius: f64,
}

/// Normal force of a contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Force law.
    pub law: &'static ContactLaw,
    /// Stiffness K \[N/mⁿ\].
    pub stiffness: f64,
    /// Damping D \[N s/m\].
    pub damping: f64,
    /// Exponent n ≥ 1 of the penetration.
    pub exponent: f64,
    /// Whether F_N may be negative before separation; if not, contact ends at F_N = 0.
    pub adhesion: bool,
    /// Coefficient of restitution e that a law with hysteresis is asked for, 0 < e ≤ 1.
    pub restitution: f64,
    /// Least speed of impact δ̇₋ that such a law reckons with \[m/s\].
    pub impact_speed_floor: f64,
    /// Young's modulus E of pin and bush, for the laws of cylinders \[Pa\].
    pub young_modulus: f64,
    /// Poisson's ratio ν of both.
    pub poisson_ratio: f64,
    /// Length L of their line of contact \[m\].
    pub length: f64,
    /// How they touch.
    pub curvature: Curvature,
}

/// Tangential force of a contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Friction law.
    pub law: FrictionLaw,
    /// Coefficient μ.
    pub coefficient: f64,
    /// Coefficient μ_s at rest, of `stribeck` and `lugre`.
    pub static_coefficient: f64,
    /// Speed v_S over which it falls to μ \[m/s\].
    pub stribeck_speed: f64,
    /// Speed v_r over which a regularised law rises \[m/s\].
    pub regularisation_speed: f64,
    /// Part of it up to which `ambrosio` has no friction.
    pub dead_ratio: f64,
    /// Stiffness σ0 of the bristles of `lugre`, for each newton of F_N \[1/m\].
    pub bristle_stiffness: f64,
    /// Damping σ1 of them \[s/m\].
    pub bristle_damping: f64,
    /// Viscous friction σ2 of `lugre` \[s/m\].
    pub viscosity: f64,
}

/// Extent and output of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// End \[s\]; the start is t = 0.
    pub t_end: f64,
    /// Distance of the samples \[s\]; 0 is every accepted step.
    pub sample: f64,
    /// Whether a block ends by itself at θ = π/2.
    pub stop_at_90: bool,
}

impl Run {
    /// Number of samples, ⌊t_end/sample + 1e-9⌋; none if every accepted step is one.
    ///
    /// Sample k = 1 … n is at t = sample·k. A `sample` beyond `t_end` leaves no sample.
    pub fn n_samples(&self) -> Option<usize> {
        (self.sample > 0.0).then(|| (self.t_end / self.sample + 1e-9) as usize)
    }
}

/// Method and accuracy of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Name of the method, one of [`METHODS`](super::METHODS).
    pub method: String,
    /// Relative tolerance, 1e-14 … 1e-1.
    pub rtol: f64,
    /// Absolute tolerance; absent: `rtol` times the model's scale of each state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub atol: Option<Atol>,
    /// What is done with events.
    pub events: Events,
    /// Step of fixed-step methods \[s\].
    pub step: f64,
}

/// Absolute tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Atol {
    /// The same number for every state, in that state's unit.
    Same(f64),
    /// One for each state: of a joint two pin displacements \[m\], angle \[rad\], and their rates
    /// \[m/s, m/s, rad/s\].
    Each(Vec<f64>),
}

impl From<Atol> for setting::Atol {
    fn from(atol: Atol) -> Self {
        match atol {
            Atol::Same(atol) => Self::Same(atol),
            Atol::Each(each) => Self::Each(each.into()),
        }
    }
}

/// What a study runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Names of the methods compared, of [`METHODS`](super::METHODS).
    pub methods: Vec<String>,
    /// Treatments of events compared.
    pub events: Vec<Events>,
    /// Relative tolerances of the methods that choose their step.
    pub rtol: Vec<f64>,
    /// Steps of the fixed-step methods \[s\].
    pub steps: Vec<f64>,
    /// Numbers of the reference.
    pub reference: Digits,
    /// Column of `study.csv` along the figure of chosen axes, one of [`AXES`](super::AXES).
    pub x: String,
    /// Column up that figure.
    pub y: String,
    /// How often a run is timed, in turns round all runs; its time is their minimum, median and maximum. Once where it is
    /// long and cannot be the cheapest.
    pub repeats: u32,
    /// Runs timed at the same time; more than one disturbs the timings. Errors are measured on all cores.
    pub threads: usize,
    /// Work beyond which a run is cut, in right-hand sides.
    pub max_rhs: u64,
    /// Time beyond which a run is cut \[s\].
    pub max_seconds: f64,
}

/// Who takes part in a contest: `recommend` and `regimes`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contest {
    /// Names of the methods, of [`METHODS`](super::METHODS).
    pub methods: Vec<String>,
    /// Treatments of events.
    pub events: Vec<Events>,
    /// Times that each of the fastest is run.
    pub repeats: u32,
    /// Work beyond which a run is cut, in right-hand sides.
    pub max_work: f64,
    /// Whether a run counts only with every event right, or events may be wrong where the accuracy is loose.
    pub right_events: bool,
}

/// The grid of `regimes`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Regimes {
    /// Contact stiffnesses K \[N/mⁿ\].
    pub stiffness: Vec<f64>,
    /// Damping ratios ζ, D = 2ζ√(K m_ref).
    pub damping_ratio: Vec<f64>,
    /// Errors `e` to be reached.
    pub accuracy: Vec<f64>,
    /// Readings; absent: the configured one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub readings: Option<Vec<ReadingName>>,
    /// Events to which a contest is cut short.
    pub max_events: usize,
    /// Cells at the same time.
    pub threads: usize,
}
