//! Which runs are computed with at once: those that are in the same mode.

use wide::f64x8;

use super::attempt::Attempt;
use super::lane::{Fate, Lane, TableauLane};
use super::scalar::LANES;
use crate::control::Control;
use crate::erk::{ExplicitRk, InMode};
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::OneStepSolver;
use crate::record::Record;
use crate::system::System;
use crate::tableau::Tableau;

/// Runs that are under way at a time: so many that the rarer modes have some too.
const POOL: usize = 64;

/// Integrates `runs` of `problem` to `t_end` by the method of `tableau`, each shown to its recorder; how
/// each ended.
pub(crate) fn run<P: System, R: Record<P>, const S: usize>(
    problem: &P,
    tableau: &'static Tableau<S>,
    control: &Control,
    (runs, t_end): (&mut [Integration<'_, P>], f64),
    records: &mut [R],
) -> Vec<Result<Outcome, Error>> {
    let mut attempt = Attempt::<P, f64x8, S>::new(problem, tableau, |_| control);
    let mut pool = Pool { groups: Vec::new() };
    let mut waiting = runs.iter_mut().zip(records).enumerate();
    let mut ended = Vec::with_capacity(waiting.len());
    let mut n_begun = 0;
    loop {
        while n_begun - ended.len() < POOL
            && let Some((index, (run, record))) = waiting.next()
        {
            n_begun += 1;
            let method = ExplicitRk::new(tableau, problem.dim());
            let solver = OneStepSolver::new(problem, method, control.clone());
            match Lane::begin((index, run, record), solver, t_end) {
                Ok(lane) => pool.put(Box::new(lane)),
                Err(end) => ended.push((index, end)),
            }
        }
        let Some(mut group) = pool.take_fullest() else { break };
        let mode = group[0].mode().clone();
        loop {
            let n = group.len().min(LANES);
            // Lanes without a run of their own repeat the last.
            let aims: [_; LANES] = std::array::from_fn(|lane| group[lane.min(n - 1)].aim());
            let field = InMode { problem, mode: &mode };
            attempt.start(&field, &aims);
            attempt.take(&field, &aims);
            // The next attempt is gathered from the runs.
            for (lane, run) in group.iter_mut().enumerate().take(n) {
                run.receive(&attempt, lane);
            }
            attempt.weigh();
            attempt.look(&field);
            // From the last one, so that what takes the place of one that leaves is settled.
            for lane in (0..n).rev() {
                match group[lane].settle((&attempt, lane), true) {
                    Fate::Ends(end) => ended.push((group.swap_remove(lane).index, end)),
                    Fate::Begins if *group[lane].mode() != mode => {
                        pool.put(group.swap_remove(lane));
                    }
                    Fate::Begins | Fate::Attempts => {}
                }
            }
            let is_best = !group.is_empty() && group.len() >= pool.most();
            let admits = waiting.len() > 0 && n_begun - ended.len() < POOL;
            if group.len() < LANES && (admits || !is_best) {
                break;
            }
        }
        group.into_iter().for_each(|lane| pool.put(lane));
    }
    ended.sort_unstable_by_key(|(index, _)| *index);
    ended.into_iter().map(|(_, end)| end).collect()
}

/// Runs that are not computed with at the moment, grouped by mode.
struct Pool<'r, 'a, P: System, R, const S: usize> {
    groups: Vec<Group<'r, 'a, P, R, S>>,
}

/// Runs in one mode; boxed, as they move from group to group.
type Group<'r, 'a, P, R, const S: usize> = Vec<Box<TableauLane<'r, 'a, P, R, S>>>;

impl<'r, 'a, P: System, R: Record<P>, const S: usize> Pool<'r, 'a, P, R, S> {
    /// Puts a run to those in its mode.
    fn put(&mut self, lane: Box<TableauLane<'r, 'a, P, R, S>>) {
        match self.groups.iter_mut().find(|group| group[0].mode() == lane.mode()) {
            Some(group) => group.push(lane),
            None => self.groups.push(vec![lane]),
        }
    }

    /// Runs in the largest group.
    fn most(&self) -> usize {
        self.groups.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The largest group.
    fn take_fullest(&mut self) -> Option<Group<'r, 'a, P, R, S>> {
        let (index, _) = self.groups.iter().enumerate().max_by_key(|(_, group)| group.len())?;
        Some(self.groups.swap_remove(index))
    }
}
