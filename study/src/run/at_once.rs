//! Runs of several problems of one kind.

use deltazero_solvers::{Alike, Integration, Record, System};

use super::{Events, OwnRun, Setting, Stopwatch, ended, integrate};
use crate::problem::Problem;

/// A problem with the state that a run of it starts from.
pub type Begun<'a, P> = (&'a P, <P as System>::State<f64>);

/// Integrates each problem from its start as [`integrate`] does, with the same bits: several
/// [at once](Problem::integrate_at_once) where the method and the problems allow it, else one after the other.
///
/// # Panics
/// Where there are fewer records than runs.
pub fn integrate_all<P: Problem>(
    runs: &[Begun<'_, P>],
    setting: &Setting,
    t_end: f64,
    records: &mut [&mut dyn Record<P>],
) -> Vec<OwnRun<P>> {
    let are_at_once = |(problem, _): &Begun<'_, P>| {
        is_for_batches(setting) && problem.runs_at_once() && problem.check().is_ok()
    };
    if runs.len() > 1 && runs.iter().all(are_at_once) {
        return P::integrate_at_once(runs, setting, t_end, records);
    }
    one_by_one(runs, setting, t_end, records)
}

/// Each after the one before.
pub(crate) fn one_by_one<P: Problem>(
    runs: &[Begun<'_, P>],
    setting: &Setting,
    t_end: f64,
    records: &mut [&mut dyn Record<P>],
) -> Vec<OwnRun<P>> {
    let pairs = runs.iter().zip(records);
    pairs.map(|((problem, y), r)| integrate(*problem, setting, y.clone(), t_end, *r)).collect()
}

/// Whether runs at `setting` can be computed at once.
pub fn is_for_batches(setting: &Setting) -> bool {
    setting.events == Events::Located && setting.method.is_for_batches()
}

/// Runs with located events as one [batch](deltazero_solvers::Method::run_batch); what
/// [`Problem::integrate_at_once`] calls where it is offered. The time is shared evenly among the runs.
///
/// # Panics
/// Where there are fewer records than runs.
pub fn at_once<P: Problem + Alike>(
    runs: &[Begun<'_, P>],
    setting: &Setting,
    t_end: f64,
    records: &mut [&mut dyn Record<P>],
) -> Vec<OwnRun<P>> {
    let watch = Stopwatch::start();
    let controls: Vec<_> = runs.iter().map(|(problem, _)| setting.control(*problem)).collect();
    let mut batch: Vec<_> =
        runs.iter().map(|(problem, y)| Integration::new(*problem, 0.0, y.clone())).collect();
    let ends = setting.method.run_batch(&mut batch, t_end, &controls, records);
    let ends = ends.unwrap_or_else(|error| vec![Err(error); runs.len()]);
    let share = watch.took().share(runs.len());
    let pairs = batch.into_iter().zip(ends).zip(runs);
    pairs.map(|((run, end), (problem, _))| ended(*problem, run, end, share)).collect()
}
