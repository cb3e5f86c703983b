//! Two runs of systems of a kind, each with its own numbers.

use wide::f64x2;

use super::attempt::Attempt;
use super::field::OfEach;
use super::lane::{Fate, Lane};
use crate::control::Control;
use crate::erk::ExplicitRk;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::OneStepSolver;
use crate::record::Record;
use crate::system::Alike;
use crate::tableau::Tableau;

/// Integrates `runs` to `t_end` by the method of `tableau`, each shown to its recorder; how each ended.
///
/// A run whose mode has no numbers goes on alone until it has some again, and the last one to the end.
pub(crate) fn run<P: Alike, R: Record<P>, const S: usize>(
    tableau: &'static Tableau<S>,
    controls: [&Control; 2],
    t_end: f64,
    runs: [&mut Integration<'_, P>; 2],
    records: [&mut R; 2],
) -> [Result<Outcome, Error>; 2] {
    let mut attempt = Attempt::new(runs[0].problem, tableau, |index| controls[index]);
    let mut ends = [Ok(Outcome::Finished), Ok(Outcome::Finished)];
    let mut lanes = Vec::with_capacity(2);
    for (index, (run, record)) in runs.into_iter().zip(records).enumerate() {
        let method = ExplicitRk::new(tableau, run.problem.dim());
        let solver = OneStepSolver::new(run.problem, method, controls[index].clone());
        match Lane::begin((index, run, record), solver, t_end) {
            Ok(lane) => lanes.push(lane),
            Err(end) => ends[index] = end,
        }
    }
    while let [first, others @ ..] = &mut lanes[..] {
        let fates = match others {
            [] => [first.go_alone(), Fate::Attempts],
            [second, ..] => match (first.numbers(), second.numbers()) {
                (None, _) => [first.go_alone(), Fate::Attempts],
                (_, None) => [Fate::Attempts, second.go_alone()],
                (Some(a), Some(b)) => {
                    together(&mut attempt, &OfEach::new(&[a, b]), [first, second])
                }
            },
        };
        for (i, fate) in fates.into_iter().enumerate().rev() {
            if let Fate::Ends(end) = fate {
                ends[lanes.remove(i).index] = end;
            }
        }
    }
    ends
}

/// Takes steps of both runs until one begins another phase or ends.
fn together<P: Alike, R: Record<P>, const S: usize>(
    attempt: &mut Attempt<P, f64x2, S>,
    field: &OfEach<P, f64x2>,
    [first, second]: [&mut Lane<'_, '_, P, R, S>; 2],
) -> [Fate; 2] {
    attempt.start(field, &[first.aim(), second.aim()]);
    loop {
        attempt.take(field, &[first.aim(), second.aim()]);
        first.receive(attempt, 0);
        second.receive(attempt, 1);
        attempt.weigh();
        attempt.look(field);
        let fates = [first.settle(attempt, 0), second.settle(attempt, 1)];
        if !matches!(fates, [Fate::Attempts, Fate::Attempts]) {
            return fates;
        }
        let aims = [first.aim(), second.aim()];
        if attempt.is_before(0, &aims[0]) && attempt.is_before(1, &aims[1]) {
            attempt.go_on();
        } else {
            attempt.start(field, &aims);
        }
    }
}
