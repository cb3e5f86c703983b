//! The words that the configuration knows, each list in one place.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The methods that `solver.method` and `study.methods` accept.
///
/// A new method is one line here; it joins the study by default with one word in the default of
/// `study.methods`.
pub const METHODS: &[&str] = &[
    "rk4", "rk43", "bs32", "rk45", "dop853", "vern98", "taylor", "rodas5p", "radau5", "bdf",
    "tr_bdf2", "esdirk34", "tsit45", "auto",
];

/// The columns of `study.csv` that `study.x` and `study.y` accept: those of errors and of work.
pub const AXES: &[&str] = &[
    "rtol",
    "step",
    "e",
    "event_time_error_s",
    "e_max",
    "e_l2",
    "e_final",
    "peak_force_error",
    "contact_impulse_error",
    "impulse_error",
    "dissipation_error",
    "energy_residual",
    "wall_s_min",
    "wall_s_median",
    "wall_s_max",
    "cpu_s_min",
    "cpu_s_median",
    "n_rhs",
    "n_rhs_flight",
    "n_rhs_contact",
    "n_rhs_stick",
    "n_rhs_restart",
    "n_rhs_location",
    "n_rhs_per_event",
    "n_accepted",
    "n_rejected",
    "n_retaken",
    "n_jac",
    "n_factorisations",
    "n_lin_solves",
];

/// An enum whose variants are words of the configuration, with their list.
macro_rules! words {
    (
        $(#[$meta:meta])*
        $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $word:literal,)+ }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$variant_meta])* #[serde(rename = $word)] $variant,)+
        }

        impl $name {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// The words for them, in the same order.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The word that the configuration uses for it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(self.name())
            }
        }
    };
}

words! {
    /// Reading of the paper: where the contact force enters and how friction acts.
    ReadingName {
        /// Contact force at the pin, friction as a torque only.
        Pin = "pin",
        /// Contact force at the pin, friction as a torque and a tangential force on the pin.
        Full = "full",
        /// Contact force at the strut's centroid with derived signs, friction as a torque only.
        Centroid = "centroid",
        /// Eqs. (12), (14) and (17) of the paper verbatim, friction as a torque only.
        Printed = "printed",
        /// As `Centroid` without the sin θ terms, friction as a torque and a force.
        Cosine = "cosine",
    }
}

words! {
    /// Normal force law of a contact; equations and sources are in [`LAWS`](crate::laws::LAWS).
    ContactLaw {
        /// F_N = K δⁿ + D δ̇, Eqs. (3) and (5) of the paper with n = 1.
        Power = "power",
        /// Hysteresis after Hunt and Crossley (1975).
        HuntCrossley = "hunt_crossley",
        /// Hysteresis after Herbert and McWhannell (1977).
        HerbertMcWhannell = "herbert_mcwhannell",
        /// Hysteresis after Lee and Wang (1983).
        LeeWang = "lee_wang",
        /// Hysteresis after Lankarani and Nikravesh (1990).
        LankaraniNikravesh = "lankarani_nikravesh",
        /// Hysteresis after Gonthier and others (2004).
        Gonthier = "gonthier",
        /// Hysteresis after Hu and Guo (2015).
        HuGuo = "hu_guo",
        /// Hysteresis after Flores and others (2011).
        Flores = "flores",
        /// Hysteresis after Carvalho and Martins (2019).
        CarvalhoMartins = "carvalho_martins",
        /// Hysteresis with the factor that delivers the restitution asked for.
        ExactRestitution = "exact_restitution",
        /// Cylinders after Dubowsky and Freudenstein (1971), Eq. (1) of the paper, with D δ̇.
        DubowskyFreudenstein = "dubowsky_freudenstein",
        /// Cylinders after Johnson (1985), with D δ̇.
        Johnson = "johnson",
        /// Cylinders after ESDU 78035 (1978), with D δ̇.
        Esdu78035 = "esdu_78035",
        /// Cylinders after Liu and others (2007), with D δ̇.
        Liu = "liu",
        /// Cylinders after Lankarani and Nikravesh (1994), with their hysteresis.
        LankaraniNikraveshCylinder = "lankarani_nikravesh_cylinder",
    }
}

impl ContactLaw {
    /// Whether its force depends on the speed at which a contact began: no state tells that.
    pub fn has_memory(self) -> bool {
        !matches!(
            self,
            Self::Power | Self::DubowskyFreudenstein | Self::Johnson | Self::Esdu78035 | Self::Liu
        )
    }

    /// Whether its stiffness follows from the radii and the material of two cylinders.
    pub fn is_of_cylinders(self) -> bool {
        matches!(
            self,
            Self::DubowskyFreudenstein
                | Self::Johnson
                | Self::Esdu78035
                | Self::Liu
                | Self::LankaraniNikraveshCylinder
        )
    }
}

words! {
    /// How two cylinders touch.
    Curvature {
        /// A pin inside its bush.
        Internal = "internal",
        /// Beside each other.
        External = "external",
    }
}

words! {
    /// Friction law of a contact; equations and sources are at [`Shape`](crate::model::sliding::Shape).
    FrictionLaw {
        /// F_T = −σ μ F_N with σ the sign of the tangential velocity, Eq. (4) of the paper.
        Coulomb = "coulomb",
        /// Coulomb's with a coefficient that falls from the static one.
        Stribeck = "stribeck",
        /// Regularised by a hyperbolic tangent.
        Tanh = "tanh",
        /// Regularised piece by piece along straight lines.
        Ambrosio = "ambrosio",
        /// Regularised by an exponential.
        Threlfall = "threlfall",
        /// With the deflection of bristles as a state.
        Lugre = "lugre",
    }
}
