//! Where the energy of a run went.

use serde::{Deserialize, Serialize};

use crate::json_number;

/// Where the energy went, all in J, summed over parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Work of what drives the system.
    #[serde(with = "json_number::one")]
    pub work: f64,
    /// Kinetic energy at the end.
    #[serde(with = "json_number::one")]
    pub kinetic: f64,
    /// Elastic energy of the contacts at the end.
    #[serde(with = "json_number::one")]
    pub elastic: f64,
    /// Taken by damping, by friction, and by events that take energy: impacts, and contacts that end dented.
    #[serde(with = "json_number::one")]
    pub dissipated: f64,
    /// `work + energy at the start − kinetic − elastic − dissipated`: zero for an exact run of a
    /// model that conserves energy.
    #[serde(with = "json_number::one")]
    pub residual: f64,
}

impl std::ops::AddAssign for Balance {
    fn add_assign(&mut self, other: Self) {
        self.work += other.work;
        self.kinetic += other.kinetic;
        self.elastic += other.elastic;
        self.dissipated += other.dissipated;
        self.residual += other.residual;
    }
}
