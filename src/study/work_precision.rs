//! Which method, at which setting, reaches which error at what price?

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use deltazero_solvers::{Grid, Method};
use serde::{Deserialize, Serialize};

use crate::config::{Config, Events, ReadingName};
use crate::metrics::worse;
use crate::model::Mechanism;
use crate::reference::{Reference, ReferenceError, ReferenceSummary, counted};
use crate::run::{Accuracy, Limits, Run, Setting, mode_changes};

/// Sample times of a study whose configuration asks for none.
const DEFAULT_SAMPLES: u32 = 200;

/// What became of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It reached its end.
    Ok,
    /// It could not go on.
    Failed,
    /// It reached the limit of work.
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
    /// Reading of the paper.
    pub reading: ReadingName,
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
    pub e: Option<f64>,
    /// Worst time error of the paired events [s], if there are any.
    pub event_time_error_s: Option<f64>,
    /// Mode changes, the start's own left out.
    pub n_events: Option<usize>,
    /// Events of the reference that it lacks.
    pub missed: Option<usize>,
    /// Events that the reference lacks.
    pub spurious: Option<usize>,
    /// Time up to which it was compared [s].
    pub horizon_s: f64,
    /// Evaluations of the right-hand side of a block.
    pub n_rhs: u64,
    /// Accepted steps.
    pub n_accepted: u64,
    /// Rejected steps.
    pub n_rejected: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
    /// Shortest time of the repeats [s].
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
    /// Why it failed.
    pub error: Option<String>,
}

impl Row {
    /// Whether every event of the reference was found, and no other.
    pub fn events_are_right(&self) -> bool {
        self.missed == Some(0) && self.spurious == Some(0)
    }

    /// Tolerance or step as text: `rtol 1e-6`, `h 1e-4 s`.
    pub fn setting(&self) -> String {
        let accuracy = match (self.rtol, self.step) {
            (Some(rtol), _) => Some(Accuracy::Rtol(rtol, None)),
            (None, step) => step.map(Accuracy::Step),
        };
        accuracy.map_or_else(String::new, |accuracy| accuracy.to_string())
    }

    /// Whether it is the run of this setting.
    fn is_of(&self, setting: &Setting) -> bool {
        self.method == setting.method.name
            && self.events == setting.events
            && self.rtol == setting.rtol()
            && self.step == setting.step()
    }
}

/// The table of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkPrecision {
    /// What the errors are measured against.
    pub reference: ReferenceSummary,
    /// One row a run, in the order of the configuration.
    pub rows: Vec<Row>,
}

/// Reported while a study runs.
#[derive(Clone, Debug)]
pub enum Progress {
    /// This many runs are ahead.
    Runs(usize),
    /// One of them is done.
    Done(String),
}

/// The settings that a configuration's `[study]` asks for, in its order; an unknown method none.
pub fn settings(config: &Config) -> Vec<Setting> {
    let study = &config.study;
    let mut settings = Vec::new();
    for method in study.methods.iter().filter_map(|name| Method::named(name)) {
        let accuracies: Vec<Accuracy> = if method.is_fixed_step() {
            study.steps.iter().map(|step| Accuracy::Step(*step)).collect()
        } else {
            study.rtol.iter().map(|rtol| Accuracy::Rtol(*rtol, config.solver.atol)).collect()
        };
        for &events in &study.events {
            let setting = |accuracy: &Accuracy| Setting { method, events, accuracy: *accuracy };
            settings.extend(accuracies.iter().map(setting));
        }
    }
    settings
}

/// The times at which a study compares states.
pub fn sample_times(config: &Config) -> Vec<f64> {
    let t_end = config.run.t_end;
    let spacing = match config.run.n_samples() {
        None | Some(0) => t_end / f64::from(DEFAULT_SAMPLES),
        Some(_) => config.run.sample,
    };
    match Grid::uniform(spacing, t_end) {
        Grid::Times(times) => times,
        Grid::Steps => Vec::new(),
    }
}

/// Runs every setting of `config` and compares it with the reference. Rows in `known` that have
/// an end are taken as they are. Once `stop` is set, what is not done is `interrupted`.
///
/// # Errors
/// [`ReferenceError`] where the reference cannot be made.
pub fn work_precision(
    config: &Config,
    known: &[Row],
    stop: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<WorkPrecision, ReferenceError> {
    let mechanism = Mechanism::new(config);
    let times = sample_times(config);
    let limits = Limits { max_rhs: config.study.max_rhs, stop };
    let reference = Reference::new(&mechanism, config.run.t_end, &times, limits)?;
    let settings = settings(config);
    progress(Progress::Runs(settings.len()));

    let contest = Contest { config, mechanism: &mechanism, reference: &reference, times, limits };
    let next = AtomicUsize::new(0);
    let rows: Vec<Mutex<Option<Row>>> = settings.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..config.study.threads.min(settings.len()) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(setting) = settings.get(i) else {
                        break;
                    };
                    let done = known
                        .iter()
                        .find(|row| row.status != Status::Interrupted && row.is_of(setting));
                    let row = done.cloned().unwrap_or_else(|| contest.row(setting));
                    progress(Progress::Done(format!("{} {}", row.method, row.setting())));
                    if let Ok(mut place) = rows[i].lock() {
                        *place = Some(row);
                    }
                }
            });
        }
    });
    let rows = rows.into_iter().filter_map(|row| row.into_inner().ok().flatten()).collect();
    Ok(WorkPrecision { reference: reference.summary, rows })
}

/// All that the runs of a study share.
struct Contest<'a> {
    config: &'a Config,
    mechanism: &'a Mechanism,
    reference: &'a Reference,
    times: Vec<f64>,
    limits: Limits<'a>,
}

impl Contest<'_> {
    fn row(&self, setting: &Setting) -> Row {
        let grid = Grid::Times(self.times.clone());
        let t_end = self.config.run.t_end;
        let run = || Run::new(self.mechanism, setting, t_end, &grid, self.limits);
        let first = run();
        let stats = first.stats();
        let status = if first.error().is_some() {
            Status::Failed
        } else if !first.is_broken_off() {
            Status::Ok
        } else if stats.work.n_rhs > self.limits.max_rhs {
            Status::Cut
        } else {
            Status::Interrupted
        };
        let mut row = Row {
            reading: self.config.reading,
            method: setting.method.name.to_owned(),
            events: setting.events,
            rtol: setting.rtol(),
            step: setting.step(),
            status,
            e: None,
            event_time_error_s: None,
            n_events: None,
            missed: None,
            spurious: None,
            horizon_s: self.reference.horizon(),
            n_rhs: stats.work.n_rhs,
            n_accepted: stats.n_accepted,
            n_rejected: stats.n_rejected,
            n_jac: stats.work.n_jac,
            n_lin_solves: stats.work.n_lin_solves,
            wall_s_min: None,
            wall_s_median: None,
            n_retaken: stats.n_retaken,
            n_factorisations: stats.work.n_factorisations,
            n_rhs_restart: stats.restart.n_rhs,
            n_rhs_location: stats.location.n_rhs,
            error: first.error().map(ToString::to_string),
        };
        if status == Status::Ok {
            self.compare(&first, &mut row);
            let mut walls = vec![first.wall()];
            for _ in 1..self.config.study.repeats {
                let repeat = run();
                // A time that was broken off is no time.
                if repeat.is_broken_off() {
                    row.status = Status::Interrupted;
                    return row;
                }
                walls.push(repeat.wall());
            }
            walls.sort_unstable();
            row.wall_s_min = walls.first().map(std::time::Duration::as_secs_f64);
            row.wall_s_median = walls.get(walls.len() / 2).map(std::time::Duration::as_secs_f64);
        }
        row
    }

    /// Fills in what the reference says of a run.
    fn compare(&self, run: &Run, row: &mut Row) {
        let (mut e, mut worst_time) = (0.0_f64, None::<f64>);
        let (mut n_events, mut missed, mut spurious) = (0, 0, 0);
        let blocks = self.mechanism.blocks.iter().zip(&self.reference.blocks);
        for ((block, reference), trajectory) in blocks.zip(&run.trajectories) {
            let own = reference.error(trajectory);
            e = worse(e, own);
            let events = reference.matched(block, trajectory);
            n_events += counted(&mode_changes(trajectory), block).len();
            missed += events.missed;
            spurious += events.spurious;
            if events.paired > 0 {
                worst_time = Some(worst_time.unwrap_or(0.0).max(events.time_error));
            }
        }
        row.e = Some(e);
        row.event_time_error_s = worst_time;
        row.n_events = Some(n_events);
        row.missed = Some(missed);
        row.spurious = Some(spurious);
    }
}

/// Errors at which a study names the cheapest run.
pub const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];

impl WorkPrecision {
    /// Whether the reference is good enough to tell which runs reach an error `e`.
    pub fn can_decide(&self, e: f64) -> bool {
        self.reference.agreement <= 0.1 * e
    }
}

/// The cheapest run, by shortest time, among those whose error is at most `e`.
pub fn cheapest(rows: &[Row], e: f64) -> Option<&Row> {
    let reaching = rows.iter().filter(|row| row.e.is_some_and(|own| own <= e));
    let timed = reaching.filter_map(|row| row.wall_s_min.map(|wall| (row, wall)));
    timed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}
