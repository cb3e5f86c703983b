//! Two runs of systems of a kind, each with its own numbers.

use wide::f64x2;

use super::attempt::Attempt;
use super::field::OfEach;
use super::lane::{Fate, Lane, TableauLane};
use super::series::SeriesPair;
use crate::control::Control;
use crate::erk::ExplicitRk;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::{OneStep, OneStepSolver};
use crate::record::Record;
use crate::system::Alike;
use crate::tableau::Tableau;
use crate::taylor::{TaylorMethod, order_for};
use crate::tolerance::Tolerance;

/// Steps of two runs by the methods `M`.
pub(super) trait Together<P: Alike, M> {
    /// Takes steps of both, or of one that is left, along `field` until one is rejected, begins another phase or ends.
    fn go<'r, 'a, R: Record<P>>(
        &mut self,
        field: &OfEach<P, f64x2>,
        first: &mut Lane<'r, 'a, P, R, M>,
        second: Option<&mut Lane<'r, 'a, P, R, M>>,
    ) -> [Fate; 2];
}

/// Integrates `runs` to `t_end` by the method of `tableau`, each shown to its recorder; how each ended.
pub(crate) fn by_stages<P: Alike, R: Record<P>, const S: usize>(
    tableau: &'static Tableau<S>,
    controls: [&Control; 2],
    t_end: f64,
    runs: [&mut Integration<'_, P>; 2],
    records: [&mut R; 2],
) -> [Result<Outcome, Error>; 2] {
    let steps = Attempt::new(runs[0].problem, tableau, |index| controls[index]);
    let methods = runs.each_ref().map(|run| ExplicitRk::new(tableau, run.problem.dim()));
    run((steps, methods), controls, t_end, runs, records)
}

/// As [`by_stages`] by the Taylor method, under `controls` with these tolerances, which series of one order serve.
pub(crate) fn by_series<P: Alike, R: Record<P>>(
    tolerances: [&Tolerance; 2],
    controls: [&Control; 2],
    t_end: f64,
    runs: [&mut Integration<'_, P>; 2],
    records: [&mut R; 2],
) -> [Result<Outcome, Error>; 2] {
    let problem = runs[0].problem;
    let (n, n_guards, order) = (problem.dim(), problem.n_guards(), order_for(tolerances[0].rtol));
    let steps = SeriesPair::new(problem, order, tolerances);
    let methods = [(); 2].map(|()| TaylorMethod::new(n, n_guards, order));
    run((steps, methods), controls, t_end, runs, records)
}

/// Integrates `runs` to `t_end` by `steps` of both, or the methods of their own, each shown to its recorder; how
/// each ended.
///
/// A run whose mode has no numbers goes on alone until it has some again.
fn run<P: Alike, R: Record<P>, M: OneStep<P>>(
    (mut steps, methods): (impl Together<P, M>, [M; 2]),
    controls: [&Control; 2],
    t_end: f64,
    runs: [&mut Integration<'_, P>; 2],
    records: [&mut R; 2],
) -> [Result<Outcome, Error>; 2] {
    let mut ends = [Ok(Outcome::Finished), Ok(Outcome::Finished)];
    let mut lanes = Vec::with_capacity(2);
    for (index, ((run, record), method)) in runs.into_iter().zip(records).zip(methods).enumerate() {
        let solver = OneStepSolver::new(run.problem, method, controls[index].clone());
        match Lane::begin((index, run, record), solver, t_end) {
            Ok(lane) => lanes.push(lane),
            Err(end) => ends[index] = end,
        }
    }
    while let [first, others @ ..] = &mut lanes[..] {
        let mut second = others.first_mut();
        let numbers = [Some(&*first), second.as_deref()].map(|lane| lane?.numbers());
        let fates = match (numbers, &mut second) {
            ([None, _], _) => [first.go_alone(), Fate::Attempts],
            ([_, None], Some(second)) => [Fate::Attempts, second.go_alone()],
            ([Some(a), b], _) => {
                let b = b.unwrap_or_else(|| a.clone());
                steps.go(&OfEach::new(&[a, b]), first, second)
            }
        };
        for (i, fate) in fates.into_iter().enumerate().rev() {
            if let Fate::Ends(end) = fate {
                ends[lanes.remove(i).index] = end;
            }
        }
    }
    ends
}

impl<P: Alike, const S: usize> Together<P, ExplicitRk<P::State<f64>, S>> for Attempt<P, f64x2, S> {
    fn go<'r, 'a, R: Record<P>>(
        &mut self,
        field: &OfEach<P, f64x2>,
        first: &mut TableauLane<'r, 'a, P, R, S>,
        second: Option<&mut TableauLane<'r, 'a, P, R, S>>,
    ) -> [Fate; 2] {
        let Some(second) = second else { return [first.go_alone(), Fate::Attempts] };
        self.start(field, &[first.aim(), second.aim()]);
        loop {
            self.take(field, &[first.aim(), second.aim()]);
            let received = [first.receive_needed(self, 0), second.receive_needed(self, 1)];
            self.weigh();
            self.look(field);
            let fates =
                [first.settle((self, 0), received[0]), second.settle((self, 1), received[1])];
            let both_go_on = matches!(fates, [Fate::Attempts, Fate::Attempts])
                && self.is_before(0, first.run.point.t)
                && self.is_before(1, second.run.point.t);
            self.go_on();
            if !both_go_on {
                first.refresh(self, 0);
                second.refresh(self, 1);
                return fates;
            }
        }
    }
}
