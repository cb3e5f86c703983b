//! All that is asked about steps, together.

use serde::{Deserialize, Serialize};

use super::proportionality::{ToleranceRow, proportionality};
use super::restarts::{RestartCost, RestartRow, restart_costs, restarts};
use super::stability::{Stability, stability};
use super::stays::{StayRow, stays};
use super::step_histogram::{BinRow, step_histogram};
use super::step_size::{StepHistory, step_histories};
use super::work_precision::WorkPrecision;
use crate::config::Config;
use crate::run::Limits;

/// The tables of step-size behaviour.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepTables {
    /// The steps of each method on each joint.
    pub histories: Vec<StepHistory>,
    /// How many of each size.
    pub histogram: Vec<BinRow>,
    /// How many in each contact and flight, of joints that step alone.
    pub stays: Vec<StayRow>,
    /// The first ones after an event, of joints that step alone.
    pub restarts: Vec<RestartRow>,
    /// What an event costs.
    pub restart_costs: Vec<RestartCost>,
    /// The limit of rk4, where it is among the methods.
    pub stability: Option<Stability>,
    /// Error against tolerance.
    pub proportionality: Vec<ToleranceRow>,
}

impl StepTables {
    /// Runs each method of the study once more, at the setting at which methods are compared, and rk4
    /// around its limit of stability.
    pub fn new(config: &Config, table: &WorkPrecision, limits: Limits<'_>) -> Self {
        let histories = step_histories(config, table, limits);
        let histogram = step_histogram(&histories);
        // What a chain does in a step is that of several joints.
        let (alone, mut all): (Vec<_>, Vec<_>) =
            histories.into_iter().partition(|own| own.bays == 1);
        let (stays, restarts, restart_costs) =
            (stays(&alone), restarts(&alone), restart_costs(&alone));
        all.extend(alone);
        let stability = stability(config, table, limits);
        let (histories, proportionality) = (all, proportionality(table));
        Self { histories, histogram, stays, restarts, restart_costs, stability, proportionality }
    }
}
