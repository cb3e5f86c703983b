//! How many steps does each method take in a contact, in a flight, or in a mode that has a name?

use serde::{Deserialize, Serialize};

use super::step_size::StepHistory;

/// A contact, from its beginning to its end through all slip reversals and sticks, or a flight; where modes have names,
/// the time in one from one event to the next.
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
    /// What it is called: contact, flight, or the name of the mode.
    pub mode: String,
    /// Its beginning [s].
    pub t_s: f64,
    /// How long it lasts [s].
    pub duration_s: f64,
    /// Whether it began and ended within the run, which cuts the first one and the last.
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

/// The stays of each method and part, in their order.
pub fn stays(histories: &[StepHistory]) -> Vec<StayRow> {
    let mut rows = Vec::new();
    for history in histories {
        let stays = history.steps.chunk_by(|a, b| history.is_same_stay(a, b));
        let n_stays = stays.clone().count();
        for (i, steps) in stays.enumerate() {
            let (Some(first), Some(last)) = (steps.first(), steps.last()) else { continue };
            rows.push(StayRow {
                method: history.method.clone(),
                setting: history.setting.clone(),
                part: history.part,
                is_contact: first.kind().is_contact(),
                mode: history.stay_name(first).to_owned(),
                t_s: first.t_s,
                duration_s: last.end() - first.t_s,
                is_whole: 0 < i && i + 1 < n_stays,
                n_steps: steps.len(),
                n_rejected: steps.iter().map(|step| step.n_rejected).sum(),
            });
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::step_size::StepRow;

    /// Two steps in each phase: free twice, then two modes of one contact.
    fn history(modes: &[&str]) -> StepHistory {
        let row = |i: u16| StepRow {
            t_s: f64::from(i),
            h_s: 1.0,
            mode: [0, 0, 1, 2][usize::from(i / 2)],
            mode_number: [0, 0, 1, 2][usize::from(i / 2)],
            since_restart: usize::from(i % 2 + 1),
            n_rejected: 0,
            lands: false,
        };
        StepHistory {
            method: "any".into(),
            setting: String::new(),
            e: 0.0,
            part: 1,
            name: String::new(),
            n_sites: 1,
            modes: modes.iter().map(|name| (*name).to_owned()).collect(),
            steps: (0..8).map(row).collect(),
            events: vec![2.0, 4.0, 6.0],
            n_rhs: 0,
            n_rhs_restart: 0,
            n_rhs_location: 0,
        }
    }

    fn told(history: StepHistory) -> Vec<(String, usize)> {
        stays(&[history]).into_iter().map(|row| (row.mode, row.n_steps)).collect()
    }

    #[test]
    fn a_contact_is_one_stay_whatever_its_modes_and_a_mode_with_a_name_ends_at_each_event() {
        let pairs = |all: &[(&str, usize)]| -> Vec<(String, usize)> {
            all.iter().map(|(mode, n)| ((*mode).to_owned(), *n)).collect()
        };
        assert_eq!(told(history(&[])), pairs(&[("flight", 4), ("contact", 4)]));
        let named = pairs(&[("up", 2), ("up", 2), ("sliding", 2), ("held", 2)]);
        assert_eq!(told(history(&["up", "sliding", "held"])), named);
    }

    #[test]
    fn the_first_and_the_last_stay_are_cut_by_the_run() {
        let rows = stays(&[history(&["up", "sliding", "held"])]);
        let whole: Vec<bool> = rows.iter().map(|row| row.is_whole).collect();
        assert_eq!(whole, [false, true, true, false]);
    }
}
