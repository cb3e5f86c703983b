//! What a study has so far, kept on disk while it runs: also what ends it without a word leaves its finished runs.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use deltazero::study::record::StudyRecord;
use deltazero_study::work_precision::Row;

use super::Failure;
use super::output::Output;

/// The record of a study.
pub(super) const RECORD: &str = "study.json";
/// `study.json` is not written more often than this.
const PAUSE: Duration = Duration::from_secs(1);

/// A study that is not finished.
pub(super) struct Kept<'a> {
    output: &'a Output,
    stop: &'a AtomicBool,
    state: Mutex<State>,
}

struct State {
    study: StudyRecord,
    /// When it was written last.
    written: Option<Instant>,
    failure: Option<Failure>,
}

impl<'a> Kept<'a> {
    /// Of `study` the rows that are known already; a failure to write more of them sets `stop`.
    pub(super) fn new(output: &'a Output, study: StudyRecord, stop: &'a AtomicBool) -> Self {
        let state = State { study, written: None, failure: None };
        Self { output, stop, state: Mutex::new(state) }
    }

    /// Takes what is now known of a run, and writes all rows unless that was done just before.
    pub(super) fn take(&self, row: Row) {
        let Ok(mut state) = self.state.lock() else { return };
        let rows = &mut state.study.table.rows;
        match rows.iter_mut().find(|known| known.is_same_run(&row)) {
            Some(known) => *known = row,
            None => rows.push(row),
        }
        if state.written.is_some_and(|at| at.elapsed() < PAUSE) {
            return;
        }
        if let Err(failure) = write_json(self.output, &state.study) {
            self.stop.store(true, Ordering::Relaxed);
            state.failure = Some(failure);
        }
        state.written = Some(Instant::now());
    }

    /// The study, of which nothing is to be kept any more; or why it could not be kept.
    pub(super) fn into_study(self) -> Result<StudyRecord, Failure> {
        let state = self.state.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        state.failure.map_or(Ok(state.study), Err)
    }
}

/// `study.json`; `finished` once figures and report are on disk too.
pub(super) fn write_json(output: &Output, study: &StudyRecord) -> Result<(), Failure> {
    output.write_json(RECORD, &study.to_json())
}
