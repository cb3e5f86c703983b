//! Which method, at which setting, reaches which error at what price?

mod cheapest;
mod others;
mod row;

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use deltazero_solvers::{Error, Grid, Outcome};
use serde::{Deserialize, Serialize};

use crate::forecast::Forecast;
use crate::measured::Measured;
use crate::parallel::{cores, in_parallel};
use crate::part::Subject;
use crate::plan::Plan;
use crate::reference::{Reference, ReferenceError, ReferenceSummary};
use crate::run::{Accuracy, Limits, Setting};
use crate::setting::Digits;

pub(crate) use others::ENOUGH;

pub use cheapest::{ACCURACIES, cheapest, cheapest_right, doubt, in_doubt, within_noise};
pub use row::{Row, Status};

/// A run with all that is measured takes this many times as long as one for its time: 6.5 s for 2.2 s, all runs of
/// the default study.
const MEASURED: f64 = 3.0;
/// Cost of a fixed step of h seconds, times h; that of a tolerance is `p² rtol^(−1/p)` at order p. On Table 1 both are
/// right within a factor of two for located runs.
const FIXED: f64 = 0.075;
/// A run that took more than this many times as long as another of no larger error, and longer than [`SHORT_S`], is not
/// timed again.
pub const BEATEN: f64 = 3.0;
/// Runs up to here are always timed again: it costs little, and one disturbance makes much of them [s].
pub const SHORT_S: f64 = 5e-3;
/// What a turn after the first takes, in turns: 0.08 of Table 1, up to 0.45 of other mechanisms.
const REPEATED: f64 = 0.2;

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

/// Runs every setting of `plan` on `subject` and compares it with the reference, then times all of them, and again in
/// turns all that may be the cheapest at some error. Rows in `known` that have an end are not run for that again, and
/// timed as often as is still to do. Once `stop` is set, what is not compared is `interrupted`, and what is has the
/// times that were made.
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
    // What no time is taken of is done on all cores.
    let mut rows = in_parallel(&jobs, cores().max(*threads), |&(job, setting)| {
        let start = Instant::now();
        let done = known.iter().find(|row| row.status != Status::Interrupted && row.is_of(setting));
        let row = done.cloned().unwrap_or_else(|| bench.row(setting));
        report(&row, progress);
        left.done(job, setting, done.is_none().then(|| left.share(start.elapsed())));
        row
    });
    let mut is_timed: Vec<bool> = rows.iter().map(|row| row.status == Status::Ok).collect();
    left.without_repeats(0, &is_timed);
    // In turns round all runs: a slow moment of the machine is then one repeat of many of them, not every
    // repeat of one.
    for turn in 0..*repeats {
        if turn == 1 {
            is_timed = rows.iter().map(|row| may_win(row, &rows)).collect();
            left.without_repeats(1, &is_timed);
        }
        let jobs: Vec<(usize, (&Setting, &Row))> = settings.iter().zip(&rows).enumerate().collect();
        rows = in_parallel(&jobs, *threads, |&(job, (setting, row))| {
            let start = Instant::now();
            let is_due = is_timed[job] && row.walls_s.len() <= turn;
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

/// Whether a run may be the cheapest: it trusts itself, and no other took far less time for no larger error, with the
/// events right where this one has them so.
fn may_win(row: &Row, rows: &[Row]) -> bool {
    let Some((e, time)) = row.e.zip(row.time_s()) else { return false };
    let is_right = row.events_are_right();
    let is_beaten_by = |(other, least): (&Row, f64)| {
        BEATEN * least < time && (other.events_are_right() || !is_right)
    };
    row.warnings.is_empty() && (time <= SHORT_S || !cheapest::reaching(rows, e).any(is_beaten_by))
}

/// How long a study still takes.
struct Left<'a> {
    forecast: Mutex<Forecast>,
    /// Runs that are timed at the same time, over those that are measured.
    share: f64,
    repeats: usize,
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
        let share = plan.threads as f64 / cores().max(plan.threads) as f64;
        let measured = |own: &Setting| share * MEASURED * cost(own);
        let mut costs: Vec<f64> = plan.settings.iter().map(measured).collect();
        for turn in 0..plan.repeats {
            let share = if turn == 0 { 1.0 } else { REPEATED };
            costs.extend(plan.settings.iter().map(|own| share * cost(own)));
        }
        let forecast = Mutex::new(Forecast::new(costs, plan.threads));
        Self { forecast, share, repeats: plan.repeats, progress }
    }

    /// What a run that is measured takes of the time of all, where that is counted by those that are timed.
    fn share(&self, took: Duration) -> Duration {
        took.mul_f64(self.share)
    }

    /// From this turn on only those that are timed are ahead.
    fn without_repeats(&self, turn: usize, is_timed: &[bool]) {
        let Ok(mut forecast) = self.forecast.lock() else { return };
        let n = is_timed.len();
        for (job, _) in is_timed.iter().enumerate().filter(|(_, is_timed)| !**is_timed) {
            (1 + turn..=self.repeats).for_each(|turn| forecast.known(job + turn * n));
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
        let judged = compared.map(|compared| compared.judged);
        Row {
            method: setting.method.name.to_owned(),
            events: setting.events,
            rtol: setting.rtol(),
            step: setting.step(),
            status,
            e: judged.map(|judged| judged.e),
            event_time_error_s: judged.and_then(|judged| judged.event_time_error_s),
            n_events: compared.map(|compared| compared.n_events),
            missed: judged.map(|judged| judged.missed),
            spurious: judged.map(|judged| judged.spurious),
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

impl WorkPrecision {
    /// Whether the reference is good enough to tell which runs reach an error `e`.
    pub fn can_decide(&self, e: f64) -> bool {
        self.reference.can_decide(e)
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::BouncingBall;

    use super::*;
    use crate::part::Part;
    use crate::run::Events;
    use crate::warning::{Code, Warning};

    #[test]
    fn what_is_far_slower_and_no_better_may_not_win() {
        let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
        let subject = Subject { parts: vec![Part::new(ball)] };
        let method = Method::named("rk45").unwrap();
        let accuracy = Accuracy::Rtol(1e-8, None);
        let setting = Setting { method, events: Events::Located, accuracy };
        let plan = Plan { settings: vec![setting], repeats: 1, ..Plan::new(1.0) };
        let table = work_precision(&subject, &plan, &[], &AtomicBool::new(false), &|_| {}).unwrap();
        let row = |e: f64, time: f64, missed: usize| Row {
            e: Some(e),
            cpu_s_min: Some(time),
            missed: Some(missed),
            ..table.rows[0].clone()
        };
        let may_win_beside = |other: Row| may_win(&row(1e-6, 1.0, 0), &[row(1e-6, 1.0, 0), other]);
        assert!(!may_win_beside(row(1e-6, 0.33, 0)));
        assert!(may_win_beside(row(1e-6, 0.34, 0)));
        assert!(may_win_beside(row(2e-6, 0.33, 0)));
        // What has the events wrong is no answer where they must be right.
        assert!(may_win_beside(row(1e-7, 0.01, 1)));
        assert!(!may_win(&row(1e-6, 1.0, 2), &[row(1e-7, 0.1, 1)]));
        // What does not trust itself wins nothing and beats nobody.
        let warning = Warning { code: Code::Energy, message: String::new() };
        let doubtful = Row { warnings: vec![warning], ..row(1e-7, 0.01, 0) };
        assert!(!may_win(&doubtful, &[]));
        assert!(may_win_beside(doubtful));
        assert!(may_win(&row(1e-6, 5e-3, 0), &[row(1e-7, 1e-4, 0)]));
    }

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
