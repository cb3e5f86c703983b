//! The words that the configuration knows, each list in one place.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The methods that `solver.method` and `study.methods` accept: all.
pub const METHODS: [&str; deltazero_solvers::METHODS.len()] = {
    let mut names = [""; deltazero_solvers::METHODS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = deltazero_solvers::METHODS[i].name;
        i += 1;
    }
    names
};

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
    "impact_speed_error",
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
