//! A run of a study, as a row of its table.

use serde::{Deserialize, Serialize};

use crate::errors::work::WorkByPhase;
use crate::json_number;
use crate::measured::Errors;
use crate::part::Timing;
use crate::quantile::quantile;
use crate::run::{Accuracy, Events, Setting};
use crate::warning::Warning;

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It reached its end.
    Ok,
    /// It could not go on.
    Failed,
    /// It reached the limit of work or of time.
    Cut,
    /// It was interrupted, or never begun.
    Interrupted,
}

impl Status {
    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Failed => "failed",
            Self::Cut => "cut",
            Self::Interrupted => "interrupted",
        }
    }
}

/// One run of the study; the columns of `study.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Method.
    pub method: String,
    /// What it does with events.
    pub events: Events,
    /// Relative tolerance, if it has one.
    pub rtol: Option<f64>,
    /// Fixed step [s], if it has one.
    pub step: Option<f64>,
    /// What became of it.
    pub status: Status,
    /// Error `e`, if it reached its end.
    #[serde(default, with = "json_number::maybe")]
    pub e: Option<f64>,
    /// Worst time error of the paired events [s], if there are any.
    #[serde(default, with = "json_number::maybe")]
    pub event_time_error_s: Option<f64>,
    /// Events that runs are compared by, of the whole run.
    pub n_events: Option<usize>,
    /// Events of the reference that it lacks.
    pub missed: Option<usize>,
    /// Events that the reference lacks.
    pub spurious: Option<usize>,
    /// Time up to which it was compared [s].
    pub horizon_s: f64,
    /// Evaluations of the right-hand side of a part.
    pub n_rhs: u64,
    /// Accepted steps.
    pub n_accepted: u64,
    /// Rejected steps.
    pub n_rejected: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
    /// Shortest time of the repeats [s]; none where there was none yet.
    pub wall_s_min: Option<f64>,
    /// Median time of the repeats [s].
    pub wall_s_median: Option<f64>,
    /// Steps retaken to land on events.
    pub n_retaken: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Evaluations of the right-hand side that began phases.
    pub n_rhs_restart: u64,
    /// Evaluations of the right-hand side that located events.
    pub n_rhs_location: u64,
    /// Longest time of the repeats [s].
    pub wall_s_max: Option<f64>,
    /// Shortest time of the processor of the repeats [s], by which runs are ranked; none where an earlier version did
    /// not say, and the shortest time ranks.
    #[serde(default)]
    pub cpu_s_min: Option<f64>,
    /// Median time of the processor of the repeats [s].
    #[serde(default)]
    pub cpu_s_median: Option<f64>,
    /// Times of the repeats in their order [s]: those of a run that reached its end; one where a long run cannot be
    /// the cheapest, as many as were made before an interruption; none where an earlier version did not keep them.
    #[serde(default)]
    pub walls_s: Vec<f64>,
    /// Times of the processor of these repeats [s].
    #[serde(default)]
    pub cpus_s: Vec<f64>,
    /// Most parts that were computed at once when it was timed; one where they were run one after the other, and
    /// before the first time.
    #[serde(default = "alone")]
    pub batch: u64,
    /// Further errors.
    #[serde(flatten)]
    pub errors: Errors,
    /// Where the work went.
    #[serde(default)]
    pub work_by_phase: WorkByPhase,
    /// What it tells of itself that the reference does not: such a run is never the cheapest.
    #[serde(default)]
    pub warnings: Vec<Warning>,
    /// Why it failed, or what cut it.
    pub error: Option<String>,
}

/// The batch of rows of earlier versions, which do not say it: they ran parts one after the other.
fn alone() -> u64 {
    1
}

impl Row {
    /// Whether every event of the reference was found, and no other.
    pub fn events_are_right(&self) -> bool {
        self.missed == Some(0) && self.spurious == Some(0)
    }

    /// Tolerance or step as text: `rtol 1e-6`, `h 1e-4 s`.
    pub fn setting(&self) -> String {
        let accuracy = Accuracy::of_columns(self.rtol, self.step, None);
        accuracy.map_or_else(String::new, |accuracy| accuracy.to_string())
    }

    /// The time that ranks [s]: of the processor, or on the wall where that is all that is known.
    pub fn time_s(&self) -> Option<f64> {
        self.cpu_s_min.or(self.wall_s_min)
    }

    /// Shortest, median and longest of the times of which that is the shortest [s].
    pub fn times_s(&self) -> [Option<f64>; 3] {
        match self.cpu_s_min {
            Some(_) => [self.cpu_s_min, self.cpu_s_median, spread(&self.cpus_s)[2]],
            None => [self.wall_s_min, self.wall_s_median, self.wall_s_max],
        }
    }

    /// How uncertain [`time_s`](Self::time_s) is, as a factor: the median of the repeats over the shortest.
    pub fn noise(&self) -> f64 {
        let median = self.cpu_s_min.and(self.cpu_s_median).or(self.wall_s_median);
        median.zip(self.time_s()).map_or(1.0, |(median, least)| median / least)
    }

    /// Takes the time of one more repeat. Earlier ones with other numbers of parts at once, which an earlier version
    /// may have made, are times of another kind and dropped.
    pub(super) fn take(&mut self, Timing { took, batch }: Timing) {
        if self.batch != batch as u64 {
            self.batch = batch as u64;
            self.walls_s.clear();
            self.cpus_s.clear();
        }
        self.walls_s.push(took.wall.as_secs_f64());
        self.cpus_s.push(took.cpu.as_secs_f64());
        [self.wall_s_min, self.wall_s_median, self.wall_s_max] = spread(&self.walls_s);
        [self.cpu_s_min, self.cpu_s_median, _] = spread(&self.cpus_s);
    }

    /// Whether it is of the same run as another row.
    pub fn is_same_run(&self, other: &Self) -> bool {
        let run = |row: &Self| (row.events, row.rtol, row.step);
        self.method == other.method && run(self) == run(other)
    }

    /// Whether it is the run of this setting.
    pub fn is_of(&self, setting: &Setting) -> bool {
        self.method == setting.method.name
            && self.events == setting.events
            && self.rtol == setting.rtol()
            && self.step == setting.step()
    }
}

/// Least, median and largest of these times.
fn spread(times: &[f64]) -> [Option<f64>; 3] {
    let mut times = times.to_vec();
    [0.0, 0.5, 1.0].map(|fraction| quantile(&mut times, fraction))
}
