//! The normal laws, told: equation, source, range. Their forces are in [`contact`](crate::model::contact),
//! [`hysteresis`] and [`elastic`], their words in [`keys`](crate::keys).

pub mod elastic;
pub mod hysteresis;

use crate::keys::ContactLaw;

/// What is to be said of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// The law.
    pub law: ContactLaw,
    /// Its equation: `χ` of `F_N = K δⁿ (1 + χ δ̇/δ̇₋)`, or `F` or `δ(F)` of `F_N = F + D δ̇`.
    pub equation: &'static str,
    /// Author, title, where, year.
    pub source: &'static str,
    /// Where it is valid, and what to know.
    pub remark: &'static str,
}

/// Every law, in the order of the configuration's words.
pub const LAWS: &[Law] = &[
    Law {
        law: ContactLaw::Power,
        equation: "F_N = K δⁿ + D δ̇",
        source: "Kelvin–Voigt; Eqs. (3) and (5) of the paper, n = 1",
        remark: "jumps by D δ̇ at δ = 0 and pulls before separation, unless adhesion = false",
    },
    Law {
        law: ContactLaw::HuntCrossley,
        equation: "χ = 3(1 − e)/2",
        source: "K. H. Hunt, F. R. E. Crossley, \"Coefficient of restitution interpreted as damping in vibroimpact\", J. Appl. Mech. 42, 440–445 (1975)",
        remark: "right to first order in 1 − e",
    },
    Law {
        law: ContactLaw::HerbertMcWhannell,
        equation: "χ = 6(1 − e)/((2e − 1)² + 3)",
        source: "R. G. Herbert, D. C. McWhannell, \"Shape and frequency composition of pulses from an impact pair\", J. Eng. Ind. 99, 513–518 (1977)",
        remark: "right to first order in 1 − e",
    },
    Law {
        law: ContactLaw::LeeWang,
        equation: "χ = 3(1 − e)/4",
        source: "T. W. Lee, A. C. Wang, \"On the dynamics of intermittent-motion mechanisms\", J. Mech. Transm. Autom. Des. 105, 534–540 (1983)",
        remark: "half of what a small loss takes: delivers about (1 + e)/2 even for e near 1",
    },
    Law {
        law: ContactLaw::LankaraniNikravesh,
        equation: "χ = 3(1 − e²)/4",
        source: "H. M. Lankarani, P. E. Nikravesh, \"A contact force model with hysteresis damping for impact analysis of multibody systems\", J. Mech. Des. 112, 369–376 (1990)",
        remark: "for nearly elastic impacts, as its authors say",
    },
    Law {
        law: ContactLaw::Gonthier,
        equation: "χ = (1 − e²)/e",
        source: "Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedbœuf, \"A regularized contact model with asymmetric damping and dwell-time dependent friction\", Multibody Syst. Dyn. 11, 209–233 (2004)",
        remark: "χ → 2(1 − e) for e → 1, a third too much; meant for all e",
    },
    Law {
        law: ContactLaw::HuGuo,
        equation: "χ = 3(1 − e)/(2e)",
        source: "S. Hu, X. Guo, \"A dissipative contact force model for impact analysis in multibody dynamics\", Multibody Syst. Dyn. 35, 131–151 (2015)",
        remark: "meant for all e; a program in use has half of it, 3(1 − e)/(4e), which is wrong for e → 1",
    },
    Law {
        law: ContactLaw::Flores,
        equation: "χ = 8(1 − e)/(5e)",
        source: "P. Flores, M. Machado, M. T. Silva, J. M. Martins, \"On the continuous contact force models for soft materials in multibody dynamics\", Multibody Syst. Dyn. 25, 357–375 (2011)",
        remark: "meant for all e",
    },
    Law {
        law: ContactLaw::CarvalhoMartins,
        equation: "χ = 3(1 − e)(11 − e)/(2(1 + 9e))",
        source: "A. S. Carvalho, J. M. Martins, \"Exact restitution and generalizations for the Hunt–Crossley contact model\", Mech. Mach. Theory 139, 174–194 (2019)",
        remark: "meets Gonthier's at e = 1/3, below which theirs is the better one",
    },
    Law {
        law: ContactLaw::ExactRestitution,
        equation: "χ(1 + e) = ln[(1 + χ)/(1 − χe)]",
        source: "the energy integral of a free impact, solved once for χ",
        remark: "delivers e in a free impact, whatever K, n, mass and speed",
    },
    Law {
        law: ContactLaw::DubowskyFreudenstein,
        equation: "δ = (k/L) F [ln(L³/(k R F)) + 1]",
        source: "S. Dubowsky, F. Freudenstein, \"Dynamic analysis of mechanical systems with clearances, part 1\", J. Eng. Ind. 93, 305–309 (1971); Eq. (1) of the paper, L = 2a",
        remark: "Goldsmith's relation with L³ for L; the paper prints R of curvature = external",
    },
    Law {
        law: ContactLaw::Johnson,
        equation: "δ = (k/L) F [ln(4 L ΔR/(k F)) − 1]",
        source: "K. L. Johnson, Contact Mechanics, Cambridge University Press, ch. 5 (1985), there k = 1/(π E*)",
        remark: "half-spaces: the half-width √(4 F R k/L) must stay well below the radii",
    },
    Law {
        law: ContactLaw::Esdu78035,
        equation: "δ = (k/L) F [ln(4 L ΔR/(k F)) + 1]",
        source: "ESDU 78035, Contact phenomena I: stresses, deflections and contact dimensions for normally loaded unlubricated elastic components (1978), as overviews of such laws quote it",
        remark: "Johnson's but for the sign of the 1; not seen in the original",
    },
    Law {
        law: ContactLaw::Liu,
        equation: "F = (π/2) L E* δ √(δ/(2(ΔR + δ)))",
        source: "C. Liu, K. Zhang, L. Yang, \"The FEM analysis and approximate model for cylindrical joints with clearances\", Mech. Mach. Theory 42, 183–197 (2007)",
        remark: "conforming cylinders too; any penetration",
    },
    Law {
        law: ContactLaw::LankaraniNikraveshCylinder,
        equation: "K = (4/3) E* √R, n = 3/2, χ = 3(1 − e²)/4",
        source: "H. M. Lankarani, P. E. Nikravesh, \"Continuous contact force models for impact analysis in multibody systems\", Nonlinear Dyn. 5, 193–207 (1994), as used for cylinders",
        remark: "the stiffness of spheres: it knows no length",
    },
];
