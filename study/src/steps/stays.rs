//! How many steps does each method take in a contact, and in a flight?

use serde::{Deserialize, Serialize};

use super::step_size::{StepHistory, StepRow};

/// A contact, from its beginning to its end through all slip reversals and sticks, or a flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StayRow {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// Number of the part, from 1.
    pub part: usize,
    /// Whether it is a contact.
    pub is_contact: bool,
    /// Its beginning [s].
    pub t_s: f64,
    /// How long it lasts [s].
    pub duration_s: f64,
    /// Whether it ended by itself; the end of the run cuts the last one.
    pub is_whole: bool,
    /// Accepted steps.
    pub n_steps: usize,
    /// Rejected steps.
    pub n_rejected: u64,
}

impl StayRow {
    /// Mean step [s].
    pub fn mean_step(&self) -> f64 {
        self.duration_s / self.n_steps as f64
    }
}

/// The contacts and flights of each method and part, in their order.
pub fn stays(histories: &[StepHistory]) -> Vec<StayRow> {
    let mut rows = Vec::new();
    for history in histories {
        let same = |a: &StepRow, b: &StepRow| a.kind().is_contact() == b.kind().is_contact();
        let mut stays = history.steps.chunk_by(same).peekable();
        while let Some(steps) = stays.next() {
            let (Some(first), Some(last)) = (steps.first(), steps.last()) else { continue };
            rows.push(StayRow {
                method: history.method.clone(),
                setting: history.setting.clone(),
                part: history.part,
                is_contact: first.kind().is_contact(),
                t_s: first.t_s,
                duration_s: last.end() - first.t_s,
                is_whole: stays.peek().is_some(),
                n_steps: steps.len(),
                n_rejected: steps.iter().map(|step| step.n_rejected).sum(),
            });
        }
    }
    rows
}
