//! The normal laws of contact: rows of a table, each with its words and its functions.
//!
//! A law is a relation of elastic force and penetration, [`elastic`], and what it loses: by damping, or by a factor of
//! [`hysteresis`]. The force that a contact has by it is a [`NormalLaw`](crate::model::contact::NormalLaw).

pub mod elastic;
pub mod hysteresis;

use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use elastic::{Conformal, Cylinders, Elastic};
use hysteresis::exact_factor;

use Relation::{Line, Point, Power};

/// A normal law: a row of [`ALL`](Self::ALL), known by its word.
pub struct ContactLaw {
    /// The word that the configuration uses for it.
    pub word: &'static str,
    /// Its equation: `χ` of `F_N = K δⁿ (1 + χ δ̇/δ̇₋)`, or `F` or `δ(F)` of `F_N = F + D δ̇`.
    pub equation: &'static str,
    /// Author, title, where, year.
    pub source: &'static str,
    /// Where it is valid, and what to know.
    pub remark: &'static str,
    /// What its elastic part is made of.
    pub relation: Relation,
    /// `χ`, by which it wants to deliver the restitution e, 0 < e ≤ 1; none where it has `D δ̇` instead.
    pub hysteresis: Option<fn(f64) -> f64>,
}

/// What the elastic part of a law is made of.
pub enum Relation {
    /// `K δⁿ` with the K and n of a configuration.
    Power,
    /// Radii and material of two cylinders that touch along a line.
    Line(fn(&Cylinders) -> Elastic),
    /// The same as if they touched at a point: of no length.
    Point(fn(&Cylinders) -> Elastic),
}

impl ContactLaw {
    /// Every law.
    pub const ALL: &'static [Self] = LAWS;

    /// Their words, in the same order.
    pub const WORDS: &'static [&'static str] = &{
        let mut words = [""; Self::ALL.len()];
        let mut i = 0;
        while i < words.len() {
            words[i] = Self::ALL[i].word;
            i += 1;
        }
        words
    };

    /// The law of a word.
    pub fn named(word: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|law| law.word == word)
    }

    /// Whether its force depends on the speed at which a contact began: no state tells that.
    pub fn has_memory(&self) -> bool {
        self.hysteresis.is_some()
    }

    /// Whether its stiffness follows from the radii and the material of two cylinders.
    pub fn is_of_cylinders(&self) -> bool {
        !matches!(self.relation, Power)
    }

    /// `χ`, by which it wants to deliver the restitution `e`, 0 < e ≤ 1; none where it has no such factor.
    pub fn hysteresis_factor(&self, e: f64) -> Option<f64> {
        self.hysteresis.map(|factor| factor(e))
    }
}

impl PartialEq for ContactLaw {
    fn eq(&self, other: &Self) -> bool {
        self.word == other.word
    }
}

impl fmt::Display for ContactLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word)
    }
}

impl fmt::Debug for ContactLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word)
    }
}

impl Serialize for ContactLaw {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.word)
    }
}

impl<'de> Deserialize<'de> for &'static ContactLaw {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        ContactLaw::named(&word).ok_or_else(|| D::Error::unknown_variant(&word, ContactLaw::WORDS))
    }
}

/// The table, in the order in which a configuration lists the words.
const LAWS: &[ContactLaw] = &[
    ContactLaw {
        word: "power",
        equation: "F_N = K δⁿ + D δ̇",
        source: "Kelvin–Voigt; Eqs. (3) and (5) of the paper, n = 1",
        remark: "jumps by D δ̇ at δ = 0 and pulls before separation, unless adhesion = false",
        relation: Power,
        hysteresis: None,
    },
    ContactLaw {
        word: "hunt_crossley",
        equation: "χ = 3(1 − e)/2",
        source: "K. H. Hunt, F. R. E. Crossley, \"Coefficient of restitution interpreted as damping in vibroimpact\", J. Appl. Mech. 42, 440–445 (1975)",
        remark: "right to first order in 1 − e",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e) / 2.0),
    },
    ContactLaw {
        word: "herbert_mcwhannell",
        equation: "χ = 6(1 − e)/((2e − 1)² + 3)",
        source: "R. G. Herbert, D. C. McWhannell, \"Shape and frequency composition of pulses from an impact pair\", J. Eng. Ind. 99, 513–518 (1977)",
        remark: "right to first order in 1 − e",
        relation: Power,
        hysteresis: Some(|e| 6.0 * (1.0 - e) / ((2.0 * e - 1.0) * (2.0 * e - 1.0) + 3.0)),
    },
    ContactLaw {
        word: "lee_wang",
        equation: "χ = 3(1 − e)/4",
        source: "T. W. Lee, A. C. Wang, \"On the dynamics of intermittent-motion mechanisms\", J. Mech. Transm. Autom. Des. 105, 534–540 (1983)",
        remark: "half of what a small loss takes: delivers about (1 + e)/2 even for e near 1",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e) / 4.0),
    },
    ContactLaw {
        word: "lankarani_nikravesh",
        equation: "χ = 3(1 − e²)/4",
        source: "H. M. Lankarani, P. E. Nikravesh, \"A contact force model with hysteresis damping for impact analysis of multibody systems\", J. Mech. Des. 112, 369–376 (1990)",
        remark: "for nearly elastic impacts, as its authors say",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e * e) / 4.0),
    },
    ContactLaw {
        word: "gonthier",
        equation: "χ = (1 − e²)/e",
        source: "Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedbœuf, \"A regularized contact model with asymmetric damping and dwell-time dependent friction\", Multibody Syst. Dyn. 11, 209–233 (2004)",
        remark: "χ → 2(1 − e) for e → 1, a third too much; meant for all e",
        relation: Power,
        hysteresis: Some(|e| (1.0 - e * e) / e),
    },
    ContactLaw {
        word: "zhiying_qishao",
        equation: "χ = 3(1 − e²) exp(2(1 − e))/4",
        source: "Qin Zhiying, Lu Qishao, \"Analysis of impact process model based on restitution coefficient\", J. Dyn. Control 4, 294–298 (2006), in Chinese; as another program has it, not seen in the original",
        remark: "right to first order in 1 − e; delivers 0.18 for e → 0",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e * e) * libm::exp(2.0 * (1.0 - e)) / 4.0),
    },
    ContactLaw {
        word: "hu_guo",
        equation: "χ = 3(1 − e)/(2e)",
        source: "S. Hu, X. Guo, \"A dissipative contact force model for impact analysis in multibody dynamics\", Multibody Syst. Dyn. 35, 131–151 (2015)",
        remark: "meant for all e; a program in use has half of it, 3(1 − e)/(4e), which is wrong for e → 1",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e) / (2.0 * e)),
    },
    ContactLaw {
        word: "flores",
        equation: "χ = 8(1 − e)/(5e)",
        source: "P. Flores, M. Machado, M. T. Silva, J. M. Martins, \"On the continuous contact force models for soft materials in multibody dynamics\", Multibody Syst. Dyn. 25, 357–375 (2011)",
        remark: "meant for all e",
        relation: Power,
        hysteresis: Some(|e| 8.0 * (1.0 - e) / (5.0 * e)),
    },
    ContactLaw {
        word: "carvalho_martins",
        equation: "χ = 3(1 − e)(11 − e)/(2(1 + 9e))",
        source: "A. S. Carvalho, J. M. Martins, \"Exact restitution and generalizations for the Hunt–Crossley contact model\", Mech. Mach. Theory 139, 174–194 (2019)",
        remark: "meets Gonthier's at e = 2/7 and 1/3; below 2/7 theirs is the better one",
        relation: Power,
        hysteresis: Some(|e| 3.0 * (1.0 - e) * (11.0 - e) / (2.0 * (1.0 + 9.0 * e))),
    },
    ContactLaw {
        word: "exact_restitution",
        equation: "χ(1 + e) = ln[(1 + χ)/(1 − χe)]",
        source: "the energy integral of a free impact, solved once for χ",
        remark: "delivers e in a free impact, whatever K, n, mass and speed",
        relation: Power,
        hysteresis: Some(exact_factor),
    },
    ContactLaw {
        word: "dubowsky_freudenstein",
        equation: "δ = (k/L) F [ln(L³/(k R F)) + 1]",
        source: "S. Dubowsky, F. Freudenstein, \"Dynamic analysis of mechanical systems with clearances, part 1\", J. Eng. Ind. 93, 305–309 (1971); Eq. (1) of the paper, L = 2a",
        remark: "Goldsmith's relation with L³ for L; the paper prints R of curvature = external",
        relation: Line(|of| {
            of.logarithmic(of.length * of.length * of.length / (of.radius * of.k), 1.0)
        }),
        hysteresis: None,
    },
    ContactLaw {
        word: "johnson",
        equation: "δ = (k/L) F [ln(4 L ΔR/(k F)) − 1]",
        source: "K. L. Johnson, Contact Mechanics, Cambridge University Press, ch. 5 (1985), there k = 1/(π E*)",
        remark: "half-spaces: the half-width √(4 F R k/L) must stay well below the radii",
        relation: Line(|of| of.logarithmic(4.0 * of.length * of.gap / of.k, -1.0)),
        hysteresis: None,
    },
    ContactLaw {
        word: "esdu_78035",
        equation: "δ = (k/L) F [ln(4 L ΔR/(k F)) + 1]",
        source: "ESDU 78035, Contact phenomena I: stresses, deflections and contact dimensions for normally loaded unlubricated elastic components (1978), as overviews of such laws quote it",
        remark: "Johnson's but for the sign of the 1; not seen in the original",
        relation: Line(|of| of.logarithmic(4.0 * of.length * of.gap / of.k, 1.0)),
        hysteresis: None,
    },
    ContactLaw {
        word: "liu",
        equation: "F = (π/2) L E* δ √(δ/(2(ΔR + δ)))",
        source: "C. Liu, K. Zhang, L. Yang, \"The FEM analysis and approximate model for cylindrical joints with clearances\", Mech. Mach. Theory 42, 183–197 (2007)",
        remark: "conforming cylinders too; any penetration",
        relation: Line(|of| Elastic::Conformal(Conformal::new(of.modulus, of.length, of.gap))),
        hysteresis: None,
    },
    ContactLaw {
        word: "lankarani_nikravesh_cylinder",
        equation: "K = (4/3) E* √R, n = 3/2, χ = 3(1 − e²)/4",
        source: "H. M. Lankarani, P. E. Nikravesh, \"Continuous contact force models for impact analysis in multibody systems\", Nonlinear Dyn. 5, 193–207 (1994), as used for cylinders",
        remark: "the stiffness of spheres: it knows no length",
        relation: Point(|of| Elastic::power(4.0 / 3.0 * of.modulus * of.radius.sqrt(), 1.5)),
        hysteresis: Some(|e| 3.0 * (1.0 - e * e) / 4.0),
    },
];

#[cfg(test)]
mod tests {
    use serde::de::IntoDeserializer as _;
    use serde::de::value::{Error, StrDeserializer};

    use super::*;

    #[test]
    fn every_law_is_read_by_a_word_of_its_own() {
        let read = |word: &'static str| {
            let word: StrDeserializer<'_, Error> = word.into_deserializer();
            <&ContactLaw>::deserialize(word)
        };
        for (i, law) in ContactLaw::ALL.iter().enumerate() {
            assert_eq!(ContactLaw::ALL.iter().position(|other| other == law), Some(i), "{law}");
            assert_eq!(read(ContactLaw::WORDS[i]).unwrap(), law);
        }
        let refused = read("hertz").unwrap_err().to_string();
        assert!(
            refused.starts_with("unknown variant `hertz`, expected one of `power`"),
            "{refused}"
        );
    }
}
