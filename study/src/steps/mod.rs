//! All that is asked about steps, together.

pub mod proportionality;
pub mod restarts;
pub mod stays;
pub mod step_histogram;
pub mod step_size;

use proportionality::{ToleranceRow, proportionality};
use restarts::{RestartCost, RestartRow, restart_costs, restarts};
use serde::{Deserialize, Serialize};
use stays::{StayRow, stays};
use step_histogram::{BinRow, step_histogram};
use step_size::{StepHistory, step_histories};

use crate::part::Subject;
use crate::plan::Plan;
use crate::run::Limits;
use crate::work_precision::WorkPrecision;

/// The tables of step-size behaviour.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepTables {
    /// The steps of each method on each part.
    pub histories: Vec<StepHistory>,
    /// How many of each size.
    pub histogram: Vec<BinRow>,
    /// How many in each contact and flight, or mode with a name, of sites that step alone.
    pub stays: Vec<StayRow>,
    /// The first ones after an event, of sites that step alone.
    pub restarts: Vec<RestartRow>,
    /// What an event costs.
    pub restart_costs: Vec<RestartCost>,
    /// Error against tolerance.
    pub proportionality: Vec<ToleranceRow>,
}

impl StepTables {
    /// Runs each method of the study once more, at the setting at which methods are compared.
    pub fn new(subject: &Subject, plan: &Plan, table: &WorkPrecision, limits: Limits<'_>) -> Self {
        let histories = step_histories(subject, plan, table, limits);
        let histogram = step_histogram(&histories);
        // What a part does in a step is that of all its sites.
        let (alone, mut all): (Vec<_>, Vec<_>) =
            histories.into_iter().partition(|own| own.n_sites == 1);
        let (stays, restarts, restart_costs) =
            (stays(&alone), restarts(&alone), restart_costs(&alone));
        all.extend(alone);
        let (histories, proportionality) = (all, proportionality(table));
        Self { histories, histogram, stays, restarts, restart_costs, proportionality }
    }
}
