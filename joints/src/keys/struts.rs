//! The keys of the paper's struts.

use super::DefaultValue::Toml;
use super::{FINITE, Key, Kind, POSITIVE, ReadingName};

/// The keys of the paper's struts and of what drives them.
pub const STRUTS: &[Key] = &[
    Key {
        path: "reading",
        kind: Kind::Word(ReadingName::WORDS),
        default: Toml("\"pin\""),
        unit: "",
        doc: "Reading of the paper: where the contact force enters and how friction acts",
        source: "the consistent one with friction as in Eq. (9)",
    },
    Key {
        path: "bays",
        // Work grows with their square: 1000 leave the start after 5 s of computing, 2000 after 19 s, 10 000 after minutes.
        kind: Kind::Integer(1, 2_000),
        default: Toml("1"),
        unit: "",
        doc: "Side frames in the chain, work growing with their square; more than one: reading \"pin\" and located events only, and not `audit`",
        source: "the paper's case",
    },
    Key {
        path: "strut.length",
        kind: POSITIVE,
        default: Toml("2.5"),
        unit: "m",
        doc: "Length l of each of the six equal struts",
        source: "Table 1, l_i",
    },
    Key {
        path: "strut.density",
        kind: POSITIVE,
        default: Toml("7800.0"),
        unit: "kg/m³",
        doc: "Density ρ of the struts",
        source: "Table 1, ρ_i (printed in kg/m²)",
    },
    Key {
        path: "strut.radius",
        kind: POSITIVE,
        default: Toml("0.005"),
        unit: "m",
        doc: "Radius r' of the solid round struts: mass m = ρ π r'² l",
        source: "Table 1, r'_i",
    },
    Key {
        path: "strut.inertia",
        kind: Kind::OneOf(&[Kind::Word(&["axial", "transverse"]), POSITIVE]),
        default: Toml("\"axial\""),
        unit: "kg m²",
        doc: "Inertia J about the centroid: axial m r'²/2, transverse m l²/12, or a number",
        source: "Table 1, J_i, which is the axial one rounded",
    },
    Key {
        path: "drive.m1",
        kind: FINITE,
        default: Toml("1.0"),
        unit: "N m",
        doc: "Torque M1 on θ1 of every bay",
        source: "Table 1, M_1",
    },
    Key {
        path: "drive.m4",
        kind: FINITE,
        default: Toml("0.3"),
        unit: "N m",
        doc: "Torque M4 on θ2",
        source: "Table 1, M_4",
    },
];
