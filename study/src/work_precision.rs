//! Which method, at which setting, reaches which error at what price?

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use deltazero_solvers::{Error, Grid, Outcome};
use serde::{Deserialize, Serialize};

use crate::errors::work::WorkByPhase;
use crate::forecast::Forecast;
use crate::json_number;
use crate::measured::{Errors, Measured};
use crate::parallel::in_parallel;
use crate::part::{Subject, Timing};
use crate::plan::Plan;
use crate::quantile::quantile;
use crate::reference::{Reference, ReferenceError, ReferenceSummary};
use crate::run::{Accuracy, Events, Limits, Setting};
use crate::setting::Digits;
use crate::warning::Warning;

/// A run with all that is measured takes this many times as long as one for its time: 6.5 s for 2.2 s, all runs of
/// the default study.
const MEASURED: f64 = 3.0;
/// Cost of a fixed step of h seconds, times h; that of a tolerance is `p² rtol^(−1/p)` at order p. On Table 1 both are
/// right within a factor of two for located runs.
const FIXED: f64 = 0.075;

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
    /// Counted events, the start's own left out.
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
    /// Median of it [s].
    #[serde(default)]
    pub cpu_s_median: Option<f64>,
    /// Times of the repeats in their order [s]: those of a run that reached its end, as many as were made before
    /// an interruption; none where an earlier version did not keep them.
    #[serde(default)]
    pub walls_s: Vec<f64>,
    /// The same of the processor [s].
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

/// What earlier versions, which do not say it, did.
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

    /// How uncertain that is, as a factor: the median of the repeats over the shortest.
    pub fn noise(&self) -> f64 {
        let median = self.cpu_s_min.and(self.cpu_s_median).or(self.wall_s_median);
        median.zip(self.time_s()).map_or(1.0, |(median, least)| median / least)
    }

    /// Takes the time of one more repeat. Earlier ones with other numbers of parts at once, which an earlier version
    /// may have made, are times of another kind and dropped.
    fn take(&mut self, Timing { took, batch }: Timing) {
        if self.batch != batch as u64 {
            self.batch = batch as u64;
            self.walls_s.clear();
            self.cpus_s.clear();
        }
        self.walls_s.push(took.wall.as_secs_f64());
        self.cpus_s.push(took.cpu.as_secs_f64());
        let of = |times: &[f64]| {
            let mut times = times.to_vec();
            [0.0, 0.5, 1.0].map(|fraction| quantile(&mut times, fraction))
        };
        [self.wall_s_min, self.wall_s_median, self.wall_s_max] = of(&self.walls_s);
        [self.cpu_s_min, self.cpu_s_median, _] = of(&self.cpus_s);
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

/// The table of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkPrecision {
    /// What the errors are measured against.
    pub reference: ReferenceSummary,
    /// One row a run, in the order of the plan.
    pub rows: Vec<Row>,
}

/// Reported while a study runs.
#[derive(Clone, Debug)]
pub enum Progress {
    /// This many runs and repeats of runs are ahead.
    Runs(usize),
    /// One of them is done.
    Done(String),
    /// With that, so much time is left.
    Left(Duration),
    /// What is known of a run that has an end, each time that more is known of it.
    Row(Box<Row>),
}

/// Runs every setting of `plan` on `subject` and compares it with the reference, then times all of them in turns. Rows in
/// `known` that have an end are not run for that again, and timed as often as is still to do. Once `stop` is set,
/// what is not compared is `interrupted`, and what is has the times that were made.
///
/// # Errors
/// [`ReferenceError`] where the reference cannot be made.
pub fn work_precision(
    subject: &Subject,
    plan: &Plan,
    known: &[Row],
    stop: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<WorkPrecision, ReferenceError> {
    let reference = reference(subject, plan, stop)?;
    Ok(against(subject, &reference, plan, known, stop, progress))
}

/// The reference of a study.
///
/// # Errors
/// [`ReferenceError`].
pub fn reference(
    subject: &Subject,
    plan: &Plan,
    stop: &AtomicBool,
) -> Result<Reference, ReferenceError> {
    let limits = plan.limits(stop);
    match plan.digits {
        Digits::Double => Reference::new(subject, plan.t_end, &plan.times, limits),
        Digits::Extended => Reference::extended(subject, plan.t_end, &plan.times, limits),
    }
}

/// As [`work_precision`], with a reference that is there already.
pub fn against(
    subject: &Subject,
    reference: &Reference,
    plan: &Plan,
    known: &[Row],
    stop: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> WorkPrecision {
    let Plan { settings, repeats, threads, t_end, .. } = plan;
    progress(Progress::Runs(settings.len() * (1 + repeats)));

    let (grid, limits) = (Grid::Times(plan.times.clone()), plan.limits(stop));
    let bench = Bench { subject, reference, t_end: *t_end, grid, limits };
    let left = Left::new(plan, progress);
    let jobs: Vec<(usize, &Setting)> = settings.iter().enumerate().collect();
    let mut rows = in_parallel(&jobs, *threads, |&(job, setting)| {
        let start = Instant::now();
        let done = known.iter().find(|row| row.status != Status::Interrupted && row.is_of(setting));
        let row = done.cloned().unwrap_or_else(|| bench.row(setting));
        report(&row, progress);
        left.done(job, setting, done.is_none().then(|| start.elapsed()));
        row
    });
    left.without_repeats(&rows, *repeats);
    // In turns round all runs: a slow moment of the machine is then one repeat of many of them, not every
    // repeat of one.
    for turn in 0..*repeats {
        let jobs: Vec<(usize, (&Setting, &Row))> = settings.iter().zip(&rows).enumerate().collect();
        rows = in_parallel(&jobs, *threads, |&(job, (setting, row))| {
            let start = Instant::now();
            let is_due = row.status == Status::Ok && row.walls_s.len() <= turn;
            let mut row = row.clone();
            let took = || bench.subject.took(setting, bench.t_end, &bench.grid, bench.limits);
            if let Some(took) = is_due.then(took).flatten() {
                row.take(took);
                report(&row, progress);
            }
            let job = job + (1 + turn) * settings.len();
            left.done(job, setting, is_due.then(|| start.elapsed()));
            row
        });
    }
    WorkPrecision { reference: reference.summary.clone(), rows }
}

/// How long a study still takes.
struct Left<'a> {
    forecast: Mutex<Forecast>,
    progress: &'a (dyn Fn(Progress) + Sync),
}

impl<'a> Left<'a> {
    /// Each setting measured, then timed again and again.
    fn new(plan: &Plan, progress: &'a (dyn Fn(Progress) + Sync)) -> Self {
        let cost = |setting: &Setting| match setting.accuracy {
            Accuracy::Step(h) => FIXED / h,
            Accuracy::Rtol(rtol, _) => {
                let method = setting.method;
                let order = method.series_order(Some(rtol)).unwrap_or(method.order) as f64;
                order * order * libm::pow(rtol, -1.0 / order)
            }
        };
        let mut costs: Vec<f64> = plan.settings.iter().map(|own| MEASURED * cost(own)).collect();
        for _ in 0..plan.repeats {
            costs.extend(plan.settings.iter().map(cost));
        }
        Self { forecast: Mutex::new(Forecast::new(costs, plan.threads)), progress }
    }

    /// Those of these runs that are not repeated are known now.
    fn without_repeats(&self, rows: &[Row], repeats: usize) {
        let Ok(mut forecast) = self.forecast.lock() else { return };
        for (job, _) in rows.iter().enumerate().filter(|(_, row)| row.status != Status::Ok) {
            (1..=repeats).for_each(|turn| forecast.known(job + turn * rows.len()));
        }
    }

    /// A run is done, if it was not before, and took so long.
    fn done(&self, job: usize, setting: &Setting, took: Option<Duration>) {
        (self.progress)(Progress::Done(setting.to_string()));
        let Ok(mut forecast) = self.forecast.lock() else { return };
        match took {
            Some(took) => {
                forecast.done(job, took);
                if forecast.tells() {
                    (self.progress)(Progress::Left(forecast.left()));
                }
            }
            None => forecast.known(job),
        }
    }
}

/// Reports a row, unless its run has no end.
fn report(row: &Row, progress: &(dyn Fn(Progress) + Sync)) {
    if row.status != Status::Interrupted {
        progress(Progress::Row(Box::new(row.clone())));
    }
}

/// All that the runs of a study share.
struct Bench<'a> {
    subject: &'a Subject,
    reference: &'a Reference,
    t_end: f64,
    grid: Grid,
    limits: Limits<'a>,
}

/// The first failure of these ends, and whether one was broken off.
fn failure<'a>(
    ends: impl Iterator<Item = &'a Result<Outcome, Error>> + Clone,
) -> (Option<&'a Error>, bool) {
    let is_broken_off = ends.clone().any(|end| *end == Ok(Outcome::Interrupted));
    (ends.clone().find_map(|end| end.as_ref().err()), is_broken_off)
}

impl Bench<'_> {
    /// One run measured and compared.
    fn row(&self, setting: &Setting) -> Row {
        let Self { subject, reference, t_end, grid, limits } = self;
        let measured = Measured::new(subject, reference, setting, *t_end, grid, *limits);
        let stats = measured.stats();
        let ends = measured.parts.iter().map(|part| &part.run.outcome);
        let (error, is_broken_off) = failure(ends);
        let status = if error.is_some() {
            Status::Failed
        } else if !is_broken_off {
            Status::Ok
        } else if measured.cut.is_some() {
            Status::Cut
        } else {
            Status::Interrupted
        };
        let cut_by = measured.cut.map(|limit| limits.told(limit));
        let error = error.map(ToString::to_string).or(cut_by);
        let compared = (status == Status::Ok).then(|| measured.compared(reference));
        Row {
            method: setting.method.name.to_owned(),
            events: setting.events,
            rtol: setting.rtol(),
            step: setting.step(),
            status,
            e: compared.as_ref().map(|compared| compared.e),
            event_time_error_s: compared.as_ref().and_then(|compared| compared.event_time_error_s),
            n_events: compared.as_ref().map(|compared| compared.n_events),
            missed: compared.as_ref().map(|compared| compared.missed),
            spurious: compared.as_ref().map(|compared| compared.spurious),
            horizon_s: self.reference.horizon(),
            n_rhs: stats.work.n_rhs,
            n_accepted: stats.n_accepted,
            n_rejected: stats.n_rejected,
            n_jac: stats.work.n_jac,
            n_lin_solves: stats.work.n_lin_solves,
            wall_s_min: None,
            wall_s_median: None,
            wall_s_max: None,
            walls_s: Vec::new(),
            cpu_s_min: None,
            cpu_s_median: None,
            cpus_s: Vec::new(),
            batch: 1,
            n_retaken: stats.n_retaken,
            n_factorisations: stats.work.n_factorisations,
            n_rhs_restart: stats.restart.n_rhs,
            n_rhs_location: stats.location.n_rhs,
            errors: compared.map(|compared| compared.errors).unwrap_or_default(),
            work_by_phase: measured.work,
            warnings: self.reference.summary.not_shared(measured.warnings),
            error,
        }
    }
}

/// Errors at which a study names the cheapest run.
pub const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];

impl WorkPrecision {
    /// Whether the reference is good enough to tell which runs reach an error `e`.
    pub fn can_decide(&self, e: f64) -> bool {
        self.reference.can_decide(e)
    }
}

/// The runs whose error is at most `e`, with their times.
fn reaching(rows: &[Row], e: f64) -> impl Iterator<Item = (&Row, f64)> {
    let is_trusted = |row: &&Row| row.warnings.is_empty();
    let reaching = rows.iter().filter(move |row| row.e.is_some_and(|own| own <= e));
    reaching.filter(is_trusted).filter_map(|row| row.time_s().map(|time| (row, time)))
}

/// The cheapest run, by shortest [time](Row::time_s), among those whose error is at most `e`.
pub fn cheapest(rows: &[Row], e: f64) -> Option<&Row> {
    reaching(rows, e).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The same among those that have every event of the reference, and no other.
pub fn cheapest_right(rows: &[Row], e: f64) -> Option<&Row> {
    let right = reaching(rows, e).filter(|(row, _)| row.events_are_right());
    right.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The runs that the [noise](Row::noise) of their times, or of the cheapest's, does not tell from it: of each other
/// method and treatment of events the fastest whose error is at most `e`.
pub fn within_noise(rows: &[Row], e: f64) -> Vec<&Row> {
    let Some(best) = cheapest(rows, e) else { return Vec::new() };
    let same = |a: &Row, b: &Row| (&a.method, a.events) == (&b.method, b.events);
    let is_near = |row: &Row, time: f64| {
        best.time_s().is_some_and(|least| time <= least * row.noise().max(best.noise()))
    };
    let mut near: Vec<(&Row, f64)> =
        reaching(rows, e).filter(|(row, time)| !same(row, best) && is_near(row, *time)).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut fastest: Vec<&Row> = Vec::new();
    for (row, _) in near {
        if !fastest.iter().any(|known| same(known, row)) {
            fastest.push(row);
        }
    }
    fastest
}

/// Who else may be the cheapest at an accuracy, where the times do not tell: ` (within the noise: also taylor located)`.
pub fn doubt(rows: &[Row], e: f64) -> String {
    let near = within_noise(rows, e);
    if near.is_empty() {
        return String::new();
    }
    let names: Vec<String> =
        near.iter().map(|row| format!("{} {}", row.method, row.events)).collect();
    format!(" (within the noise: also {})", names.join(", "))
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::BouncingBall;

    use super::*;
    use crate::part::Part;

    #[test]
    fn times_of_parts_one_after_the_other_do_not_stand_among_those_at_once() {
        let ball = |gravity| Part::new(BouncingBall { restitution: 0.5, gravity, height: 1.0 });
        let subject = Subject { parts: vec![ball(9.8), ball(1.6)] };
        let (method, accuracy) = (Method::named("rk45").unwrap(), Accuracy::Rtol(1e-8, None));
        let setting = Setting { method, events: Events::Located, accuracy };
        let (stop, hear) = (AtomicBool::new(false), |_| {});
        let studied = |repeats, known: &[Row]| {
            let plan = Plan {
                settings: vec![setting.clone()],
                digits: Digits::Double,
                t_end: 1.0,
                times: vec![0.5, 1.0],
                repeats,
                threads: 1,
                max_rhs: u64::MAX,
                max_seconds: f64::INFINITY,
            };
            work_precision(&subject, &plan, known, &stop, &hear).unwrap().rows.remove(0)
        };
        let row = studied(1, &[]);
        assert_eq!((row.batch, row.walls_s.len()), (2, 1));
        // As a version made it that ran them one after the other.
        let known = Row { batch: 1, walls_s: vec![9.0], cpus_s: vec![9.0], ..row };
        let row = studied(3, &[known]);
        assert_eq!((row.batch, row.walls_s.len()), (2, 2));
        assert!(row.wall_s_max.is_some_and(|longest| longest < 9.0), "{row:?}");
    }
}
