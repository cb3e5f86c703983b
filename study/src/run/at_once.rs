//! Runs of several problems of one kind.

use deltazero_solvers::{Alike, Integration, Record, System};

use super::{Events, OwnRun, Ran, Setting, Stopwatch, ended, integrate};
use crate::problem::Problem;

/// A problem with the state that a run of it starts from.
pub type Begun<'a, P> = (&'a P, <P as System>::State<f64>);

/// Integrates each problem from its start as [`integrate`] does, with the same bits: those whose method and model
/// allow it [at once](Problem::integrate_at_once), the others one after the other.
///
/// # Panics
/// Where there are fewer records than runs.
pub fn integrate_all<P: Problem, R: Record<P>>(
    runs: &[Begun<'_, P>],
    setting: &Setting,
    t_end: f64,
    records: &mut [R],
) -> Vec<OwnRun<P>> {
    assert!(records.len() >= runs.len(), "a run needs a record");
    let records = records.iter_mut().map(|own| own as &mut dyn Record<P>);
    let all = runs.iter().cloned().zip(records).enumerate();
    let (mut several, mut alone): (Vec<_>, Vec<_>) =
        all.partition(|(_, ((problem, _), _))| is_at_once(*problem, setting));
    if several.len() == 1 {
        alone.append(&mut several);
    }
    let mut made: Vec<Option<OwnRun<P>>> = runs.iter().map(|_| None).collect();
    for (i, ((problem, y0), record)) in alone {
        made[i] = Some(integrate(problem, setting, y0, t_end, record));
    }
    let (places, several): (Vec<_>, Vec<_>) = several.into_iter().unzip();
    let (begun, mut records): (Vec<_>, Vec<_>) = several.into_iter().unzip();
    if !begun.is_empty() {
        let at_once = P::integrate_at_once(&begun, setting, t_end, &mut records);
        for (i, run) in places.into_iter().zip(at_once) {
            made[i] = Some(run);
        }
    }
    made.into_iter().flatten().collect()
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

/// Whether a run of `problem` at `setting` is computed at once with others that are so.
pub(crate) fn is_at_once<P: Problem>(problem: &P, setting: &Setting) -> bool {
    is_for_batches(setting) && problem.runs_at_once() && problem.check().is_ok()
}

/// Whether runs at `setting` can be computed at once: located ones of methods that can, but for series of fixed steps.
fn is_for_batches(setting: &Setting) -> bool {
    let Setting { method, events, .. } = setting;
    let is_series_of_fixed_steps = method.series_order(None).is_some() && setting.rtol().is_none();
    *events == Events::Located && method.is_for_batches() && !is_series_of_fixed_steps
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
    let (n, share) = (runs.len(), watch.took().share(runs.len()));
    let pairs = batch.into_iter().zip(ends).zip(runs);
    let end = |((run, end), (problem, _)): ((_, _), &Begun<'_, P>)| Ran {
        batch: n,
        ..ended(*problem, run, end, share)
    };
    pairs.map(end).collect()
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::BouncingBall;

    use super::*;
    use crate::run::Accuracy;

    fn setting(method: &str, accuracy: Accuracy) -> Setting {
        Setting { method: Method::named(method).unwrap(), events: Events::Located, accuracy }
    }

    #[test]
    fn runs_at_once_say_so_and_have_the_bits_of_runs_alone() {
        let ball = |gravity| BouncingBall { restitution: 0.5, gravity, height: 1.0 };
        let balls = [9.8, 1.6, 3.7].map(ball);
        let begun: Vec<Begun<'_, BouncingBall>> =
            balls.iter().map(|ball| (ball, ball.start())).collect();
        let [rtol, step] = [Accuracy::Rtol(1e-8, None), Accuracy::Step(1e-2)];
        for (method, accuracy, batch) in [
            ("rk45", &rtol, 3),
            ("rk45", &step, 3),
            ("taylor", &rtol, 3),
            ("taylor", &step, 1),
            ("auto", &rtol, 3),
            ("radau5", &rtol, 1),
        ] {
            let setting = setting(method, accuracy.clone());
            let runs = integrate_all(&begun, &setting, 1.2, &mut [(); 3]);
            for ((ball, y0), run) in begun.iter().zip(runs) {
                let alone = integrate(*ball, &setting, *y0, 1.2, &mut ());
                assert_eq!((alone.batch, run.batch), (1, batch), "{setting}");
                assert_eq!((alone.y, alone.stats), (run.y, run.stats), "{setting}");
            }
            let one = integrate_all(&begun[..1], &setting, 1.2, &mut [()]);
            assert_eq!(one[0].batch, 1, "{setting}");
        }
    }

    #[test]
    #[should_panic(expected = "a run needs a record")]
    fn a_run_without_a_record_is_not_left_out() {
        let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
        let begun = [(&ball, ball.start()); 2];
        integrate_all(&begun, &setting("rk45", Accuracy::Rtol(1e-8, None)), 1.0, &mut [()]);
    }
}
