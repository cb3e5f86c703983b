//! The table of keys: everything the configuration knows of them is here, once.
//!
//! The default file, the JSON Schema, the check of what is given and the suggestions for what is
//! misspelt all follow from [`keys`].

use deltazero_study::setting::{Digits, Events};

use super::kind::Kind;
use super::range::{End, Range};
use super::words::{AXES, ContactLaw, Curvature, FrictionLaw, METHODS, ReadingName};
use crate::mechanisms::{MECHANISMS, NAMES};

/// One key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Path from the root: `contact.stiffness`.
    pub path: &'static str,
    /// The values it takes.
    pub kind: Kind,
    /// The default.
    pub default: DefaultValue,
    /// Unit; empty for what has none.
    pub unit: &'static str,
    /// What it is, in one line.
    pub doc: &'static str,
    /// Where the default is from. Tables and equations are those of "Dynamic Analysis of
    /// Deployable Strut-Mechanism with Clearance Root-Joints for Spacial Flexible Solar Array".
    pub source: &'static str,
}

/// The default of a key, as TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultValue {
    /// This value.
    Toml(&'static str),
    /// Absent, which means something of its own; with a value as an example.
    Absent(&'static str),
}

/// The tables whose keys may differ for one joint.
pub const JOINT_TABLES: [&str; 3] = ["joint", "contact", "friction"];

/// The tables that hold what differs for joint 1 and joint 2.
pub const JOINTS: [&str; 2] = ["joint1", "joint2"];

impl Key {
    /// A key with a default as TOML.
    pub const fn new(
        path: &'static str,
        kind: Kind,
        default: &'static str,
        unit: &'static str,
        doc: &'static str,
        source: &'static str,
    ) -> Self {
        Self { path, kind, default: DefaultValue::Toml(default), unit, doc, source }
    }

    /// The table it is in; none for a key at the root.
    pub fn table(&self) -> Option<&'static str> {
        self.path.split_once('.').map(|(table, _)| table)
    }

    /// Its name in that table.
    pub fn name(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, name)| name)
    }

    /// Whether it may differ for one joint.
    pub fn per_joint(&self) -> bool {
        self.table().is_some_and(|table| JOINT_TABLES.contains(&table))
    }
}

/// A number above zero.
pub const POSITIVE: Kind = Kind::Number(Range::POSITIVE);
/// A number of at least zero.
pub const NOT_NEGATIVE: Kind = Kind::Number(Range::NOT_NEGATIVE);
/// Any finite number.
pub const FINITE: Kind = Kind::Number(Range::FINITE);
const RTOL: Kind = Kind::Number(Range::closed(1e-14, 1e-1));
const ACCURACY: Kind = Kind::Number(Range::closed(1e-12, 1e-1));

use DefaultValue::{Absent, Toml};

/// The key that chooses the mechanism.
const MECHANISM: Key = Key {
    path: "mechanism",
    kind: Kind::Word(&NAMES),
    default: Toml("\"strut\""),
    unit: "",
    doc: "What is integrated; `deltazero config --set mechanism=NAME` prints its keys and defaults",
    source: "the paper's case",
};

/// The keys of all mechanisms, table by table.
const COMMON: &[Key] = &[
    Key {
        path: "joint.clearance",
        kind: NOT_NEGATIVE,
        default: Toml("1e-4"),
        unit: "m",
        doc: "Clearance c: bush radius minus pin radius; 0 is the ideal joint, its pin fixed",
        source: "Table 1, r_1 − r_2 and r_3 − r_4",
    },
    Key {
        path: "joint.pin_radius",
        kind: POSITIVE,
        default: Toml("4.9e-3"),
        unit: "m",
        doc: "Pin radius, the arm of friction; the bush radius is pin_radius + clearance",
        source: "Table 1, r_2 and r_4",
    },
    Key {
        path: "contact.law",
        kind: Kind::Word(ContactLaw::WORDS),
        default: Toml("\"power\""),
        unit: "",
        doc: "Normal force law; power: F_N = K δⁿ + D δ̇; the others: `deltazero laws`",
        source: "Eqs. (3) and (5)",
    },
    Key {
        path: "contact.stiffness",
        kind: POSITIVE,
        default: Toml("1e7"),
        unit: "N/mⁿ",
        doc: "Contact stiffness K; laws of cylinders do not use it",
        source: "Table 1, K_1 and K_2 (printed in N.m)",
    },
    Key {
        path: "contact.damping",
        kind: NOT_NEGATIVE,
        default: Toml("178.7"),
        unit: "N s/m",
        doc: "Contact damping D; laws with hysteresis do not use it",
        source: "Table 1, D_1 and D_2",
    },
    Key {
        path: "contact.exponent",
        kind: Kind::Number(Range::at_least(1.0)),
        default: Toml("1.0"),
        unit: "",
        doc: "Exponent n of the penetration δ; laws of cylinders have their own",
        source: "Eq. (3), which is linear",
    },
    Key {
        path: "contact.adhesion",
        kind: Kind::Boolean,
        default: Toml("true"),
        unit: "",
        doc: "Whether F_N may pull before separation; if not, contact ends at F_N = 0",
        source: "Eq. (3), as printed",
    },
    Key {
        path: "contact.restitution",
        kind: Kind::Number(Range { low: End::Open(0.0), high: End::Closed(1.0) }),
        default: Toml("0.9"),
        unit: "",
        doc: "Coefficient of restitution e that laws with hysteresis are asked for",
        source: "choice of this study, as in the slider-crank benchmark of Flores and others",
    },
    Key {
        path: "contact.impact_speed_floor",
        kind: POSITIVE,
        default: Toml("1e-6"),
        unit: "m/s",
        doc: "Least speed of impact that laws with hysteresis reckon with",
        source: "choice of this study: at the start that speed is zero",
    },
    Key {
        path: "contact.young_modulus",
        kind: POSITIVE,
        default: Toml("2.07e11"),
        unit: "Pa",
        doc: "Young's modulus E of pin and bush of laws of cylinders; of two materials 2/(1/E_1 + 1/E_2)",
        source: "steel; choice of this study",
    },
    Key {
        path: "contact.poisson_ratio",
        kind: Kind::Number(Range { low: End::Open(-1.0), high: End::Closed(0.5) }),
        default: Toml("0.3"),
        unit: "",
        doc: "Poisson's ratio ν of both of laws of cylinders",
        source: "steel; choice of this study",
    },
    Key {
        path: "contact.length",
        kind: POSITIVE,
        default: Toml("0.02"),
        unit: "m",
        doc: "Length L of the line of contact, 2a in Eq. (1) of laws of cylinders",
        source: "choice of this study; the paper has no number",
    },
    Key {
        path: "contact.curvature",
        kind: Kind::Word(Curvature::WORDS),
        default: Toml("\"internal\""),
        unit: "",
        doc: "Cylinders inside each other, R = R_1 R_2/(R_2 − R_1), or beside each other, R_1 R_2/(R_1 + R_2)",
        source: "a pin is inside its bush; Eq. (1) prints the other",
    },
    Key {
        path: "friction.law",
        kind: Kind::Word(FrictionLaw::WORDS),
        default: Toml("\"coulomb\""),
        unit: "",
        doc: "Friction law; coulomb: F_T = μ F_N against the sliding; tanh, ambrosio and threlfall do not stick; lugre bends its bristles",
        source: "Eq. (4)",
    },
    Key {
        path: "friction.coefficient",
        kind: NOT_NEGATIVE,
        default: Toml("0.1"),
        unit: "",
        doc: "Friction coefficient μ",
        source: "Table 1, μ_1 and μ_2",
    },
    Key {
        path: "friction.static_coefficient",
        kind: NOT_NEGATIVE,
        default: Toml("0.15"),
        unit: "",
        doc: "Coefficient μ_s at rest, of stribeck and lugre",
        source: "choice of this study",
    },
    Key {
        path: "friction.stribeck_speed",
        kind: POSITIVE,
        default: Toml("1e-3"),
        unit: "m/s",
        doc: "Speed v_S over which stribeck and lugre fall to μ",
        source: "choice of this study",
    },
    Key {
        path: "friction.regularisation_speed",
        kind: POSITIVE,
        default: Toml("1e-4"),
        unit: "m/s",
        doc: "Speed v_r over which tanh, ambrosio and threlfall rise to μ",
        source: "choice of this study; `deltazero laws` prints what it costs",
    },
    Key {
        path: "friction.dead_ratio",
        kind: Kind::Number(Range::closed(0.01, 0.99)),
        default: Toml("0.1"),
        unit: "",
        doc: "Part of v_r up to which ambrosio has no friction",
        source: "choice of this study",
    },
    Key {
        path: "friction.bristle_stiffness",
        kind: POSITIVE,
        default: Toml("1e5"),
        unit: "1/m",
        doc: "Stiffness σ_0 of the bristles of lugre, for each newton of F_N: they slide at μ/σ_0",
        source: "choice of this study: they slide at a micrometre, a hundredth of the clearance",
    },
    Key {
        path: "friction.bristle_damping",
        kind: NOT_NEGATIVE,
        default: Toml("10.0"),
        unit: "s/m",
        doc: "Damping σ_1 of the bristles of lugre, for each newton of F_N",
        source: "choice of this study: at 10 mm/s it gives as much friction as μ",
    },
    Key {
        path: "friction.viscosity",
        kind: NOT_NEGATIVE,
        default: Toml("0.0"),
        unit: "s/m",
        doc: "Viscous friction σ_2 of lugre, for each newton of F_N",
        source: "choice of this study",
    },
    Key {
        path: "run.t_end",
        kind: POSITIVE,
        default: Toml("2.0"),
        unit: "s",
        doc: "End of the run, which starts at t = 0",
        source: "the transient of the paper's figures, 0 to 2 s",
    },
    Key {
        path: "run.sample",
        kind: NOT_NEGATIVE,
        default: Toml("0.01"),
        unit: "s",
        doc: "Distance of the samples, at most 5e6 of all joints; 0: every accepted step; beyond t_end: none",
        source: "choice of this study",
    },
    Key {
        path: "run.stop_at_90",
        kind: Kind::Boolean,
        default: Toml("true"),
        unit: "",
        doc: "Whether a joint's motion ends by itself where its strut reaches 90°",
        source: "choice of this study: there the model's inertia nearly vanishes",
    },
    Key {
        path: "solver.method",
        kind: Kind::Word(METHODS),
        default: Toml("\"rk45\""),
        unit: "",
        doc: "Method of integration",
        source: "choice of this study; the paper has rk4",
    },
    Key {
        path: "solver.rtol",
        kind: RTOL,
        default: Toml("1e-8"),
        unit: "",
        doc: "Relative tolerance",
        source: "choice of this study",
    },
    Key {
        path: "solver.atol",
        kind: Kind::OneOf(&[POSITIVE, Kind::List(&POSITIVE, None)]),
        default: Absent("1e-12"),
        unit: "",
        doc: "Absolute tolerance in each state's unit, one for all or one each: of a joint (m, m, rad, m/s, m/s, rad/s), its bristles (m) taking the one for all",
        source: "absent: rtol times the model's scale of each state",
    },
    Key {
        path: "solver.events",
        kind: Kind::Word(Events::WORDS),
        default: Toml("\"located\""),
        unit: "",
        doc: "located: modes frozen, steps end on events; blind: the baseline that branches on the state",
        source: "choice of this study",
    },
    Key {
        path: "solver.step",
        kind: POSITIVE,
        default: Toml("1e-5"),
        unit: "s",
        doc: "Step of fixed-step methods; the others choose their own",
        source: "choice of this study",
    },
    Key {
        path: "study.methods",
        kind: Kind::List(&Kind::Word(METHODS), None),
        default: Toml(
            "[\"rk4\", \"rk45\", \"dop853\", \"vern98\", \"taylor\", \"radau5\", \"bdf\"]",
        ),
        unit: "",
        doc: "Methods compared",
        source: "choice of this study",
    },
    Key {
        path: "study.events",
        kind: Kind::List(&Kind::Word(Events::WORDS), None),
        default: Toml("[\"located\", \"blind\"]"),
        unit: "",
        doc: "Treatments of events compared",
        source: "choice of this study",
    },
    Key {
        path: "study.rtol",
        kind: Kind::List(&RTOL, None),
        default: Toml("[1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12]"),
        unit: "",
        doc: "Relative tolerances of the methods that choose their step",
        source: "choice of this study",
    },
    Key {
        path: "study.steps",
        kind: Kind::List(&POSITIVE, None),
        default: Toml("[1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6]"),
        unit: "s",
        doc: "Steps of the fixed-step methods",
        source: "choice of this study",
    },
    Key {
        path: "study.reference",
        kind: Kind::Word(Digits::WORDS),
        default: Toml("\"double\""),
        unit: "",
        doc: "Numbers of the reference: double (at rounding, e near 1e-14) or extended (31 digits, some seconds)",
        source: "choice of this study",
    },
    Key {
        path: "study.x",
        kind: Kind::Word(AXES),
        default: Toml("\"n_rhs\""),
        unit: "",
        doc: "Column of study.csv along the figure of chosen axes",
        source: "choice of this study",
    },
    Key {
        path: "study.y",
        kind: Kind::Word(AXES),
        default: Toml("\"event_time_error_s\""),
        unit: "",
        doc: "Column of study.csv up the figure of chosen axes",
        source: "choice of this study",
    },
    Key {
        path: "study.repeats",
        kind: Kind::Integer(1, 1000),
        default: Toml("3"),
        unit: "",
        doc: "Timed repetitions of each run, in turns round all runs; its time is their minimum, median and maximum",
        source: "choice of this study",
    },
    Key {
        path: "study.threads",
        kind: Kind::Integer(1, 1024),
        default: Toml("1"),
        unit: "",
        doc: "Runs at the same time; more than one disturbs the timings",
        source: "choice of this study",
    },
    Key {
        path: "study.max_rhs",
        kind: Kind::Integer(1, 1_000_000_000_000_000),
        default: Toml("50_000_000"),
        unit: "right-hand sides",
        doc: "Work beyond which a run is cut; a series of order p counts 2 p, a rejected one a quarter of that",
        source: "choice of this study",
    },
    Key {
        path: "study.max_seconds",
        kind: POSITIVE,
        default: Toml("60.0"),
        unit: "s",
        doc: "Time beyond which a run is cut, of studies, references and contests alike",
        source: "choice of this study: a run of max_rhs in one bay takes 4 to 32 s (blind, rtol 1e-12, reading full)",
    },
    Key {
        path: "contest.methods",
        kind: Kind::List(&Kind::Word(METHODS), None),
        default: Toml(
            "[\"rk4\", \"rk43\", \"bs32\", \"rk45\", \"dop853\", \"vern98\", \"taylor\", \"rodas5p\", \"radau5\", \"bdf\", \"auto\"]",
        ),
        unit: "",
        doc: "Methods among which recommend and regimes choose",
        source: "choice of this study: all but tsit45, tr_bdf2 and esdirk34, never near the best",
    },
    Key {
        path: "contest.events",
        kind: Kind::List(&Kind::Word(Events::WORDS), None),
        default: Toml("[\"located\", \"blind\"]"),
        unit: "",
        doc: "Treatments of events among which they choose",
        source: "choice of this study",
    },
    Key {
        path: "contest.repeats",
        kind: Kind::Integer(1, 1000),
        default: Toml("5"),
        unit: "",
        doc: "Repetitions of each of the fastest, in turns; its time is their minimum",
        source: "choice of this study",
    },
    Key {
        path: "contest.max_work",
        kind: POSITIVE,
        default: Toml("3e8"),
        unit: "right-hand sides",
        doc: "Work beyond which a run is cut, a linear system counted as five right-hand sides",
        source: "choice of this study: some ten seconds",
    },
    Key {
        path: "contest.right_events",
        kind: Kind::Boolean,
        default: Toml("true"),
        unit: "",
        doc: "Whether only a run with every event right counts; if not, events may be wrong in blind runs, and in others above e = 1e-6",
        source: "choice of this study",
    },
    Key {
        path: "regimes.stiffness",
        kind: Kind::List(&POSITIVE, None),
        default: Toml("[1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]"),
        unit: "N/mⁿ",
        doc: "Contact stiffnesses K of the map",
        source: "choice of this study: rubber to more than steel",
    },
    Key {
        path: "regimes.damping_ratio",
        kind: Kind::List(&NOT_NEGATIVE, None),
        default: Toml("[0.0, 0.01, 0.1, 1.0, 3.0]"),
        unit: "",
        doc: "Damping ratios ζ of the map: D = 2ζ√(K m), m the mass of struts 1, 2, 5 and 6",
        source: "choice of this study; Table 1 is 0.011",
    },
    Key {
        path: "regimes.accuracy",
        kind: Kind::List(&ACCURACY, None),
        default: Toml("[1e-3, 1e-6]"),
        unit: "",
        doc: "Errors e to be reached",
        source: "choice of this study",
    },
    Key {
        path: "regimes.readings",
        kind: Kind::List(&Kind::Word(ReadingName::WORDS), None),
        default: Absent("[\"pin\", \"full\"]"),
        unit: "",
        doc: "Readings of the map",
        source: "absent: the configured one",
    },
    Key {
        path: "regimes.max_events",
        kind: Kind::Integer(1, 1_000_000),
        default: Toml("100"),
        unit: "",
        doc: "Events after which a contest ends: what a stiffer contact does later repeats it",
        source: "choice of this study; Table 1 has 60 in 2 s",
    },
    Key {
        path: "regimes.threads",
        kind: Kind::Integer(1, 1024),
        default: Toml("2"),
        unit: "",
        doc: "Cells of the map at the same time",
        source: "choice of this study",
    },
];

/// Every key, in the order of the default file: the mechanism, the keys of each mechanism, those of all.
pub fn keys() -> impl Iterator<Item = &'static Key> + Clone {
    let own = MECHANISMS.iter().flat_map(|entry| entry.keys);
    std::iter::once(&MECHANISM).chain(own).chain(COMMON)
}

/// The key at `path`, which may be one for a single joint: `joint2.contact.stiffness`.
pub fn find(path: &str) -> Option<&'static Key> {
    let key = |path: &str| keys().find(|key| key.path == path);
    match one_joint(path) {
        Some((_, rest)) => key(rest).filter(|key| key.per_joint()),
        None => key(path),
    }
}

/// `joint2` and `contact.stiffness` of `joint2.contact.stiffness`; none for a path that is not of
/// one joint.
pub(crate) fn one_joint(path: &str) -> Option<(&'static str, &str)> {
    JOINTS.iter().find_map(|joint| {
        let rest = path.strip_prefix(joint)?.strip_prefix('.')?;
        Some((*joint, rest))
    })
}

/// The tables, in the order of the default file.
pub(super) fn tables() -> Vec<&'static str> {
    let mut tables: Vec<_> = keys().filter_map(Key::table).collect();
    tables.dedup();
    tables
}

/// The names one level below the table at `path`; none if there is no such table.
pub(super) fn names_in(path: &str) -> Option<Vec<&'static str>> {
    let table = match one_joint(path) {
        Some((_, table)) => JOINT_TABLES.contains(&table).then_some(table)?,
        None if JOINTS.contains(&path) => return Some(JOINT_TABLES.to_vec()),
        None => path,
    };
    let names: Vec<_> = keys().filter(|key| key.table() == Some(table)).map(Key::name).collect();
    (!names.is_empty()).then_some(names)
}
