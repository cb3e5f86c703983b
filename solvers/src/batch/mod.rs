//! Runs of systems of a kind computed several at once, each with its own start, step size, mode and events, and with
//! the bits that it has alone.
//!
//! A right-hand side is a chain of operations that wait for each other: a root, a division, a force, an acceleration.
//! A vector instruction computes one link of as many chains as a vector has [lanes](crate::lanes) in the time of one.
//! So runs whose modes differ only in [parameters](crate::Alike::parameters) are stepped together, whatever their times
//! and step sizes:
//!
//! ```text
//! starts, slopes, parameters, t, h of each run   →   vectors, a lane for each run
//! stages or series, ends, slopes there, errors, guards:   at once
//! verdict, record, next step; where a guard may have fallen, its search, landing, transition:   of each run
//! ```
//!
//! The code of a step is that of [`erk`](crate::erk) or [`taylor`](crate::taylor) over another scalar, and the code of
//! events is that of a single run. So no result depends on the other runs of the batch: states, times, events and
//! counts of work are those of the run alone. A step leaves its lane only where an event is near, where it is rejected,
//! or where the recorder [needs](crate::Needs) it.
//!
//! A run whose mode has no parameters goes on alone until it has some again; its lane waits. A run that ends leaves its
//! lane to the next one of the batch. A run of [`auto`](crate::auto) is in its lane in its explicit turns, and its rule sees the
//! ends of all steps; where its explicit method is chosen anew, it leaves the batch for one of that method.

mod member;
mod parameters;
mod runner;
mod series;
mod steps;
mod tableau;

use wide::{f64x2, f64x8};

use crate::auto::Explicit;
use crate::control::Control;
use crate::erk::ExplicitRk;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::lanes::{LANES, Lanes, Simd};
use crate::record::Record;
use crate::system::Alike;
use crate::tableau::Tableau;
use crate::taylor::TaylorMethod;
use member::{Fate, Member};
use parameters::ByParameters;
use series::SeriesSteps;
use steps::Steps;
use tableau::TableauSteps;

/// One run of a batch, which has [begun](Integration::begin), with its place among the results.
pub(crate) struct Entry<'r, 'a, P: Alike> {
    pub(crate) index: usize,
    pub(crate) run: &'r mut Integration<'a, P>,
    pub(crate) control: &'r Control,
    pub(crate) record: &'r mut dyn Record<P>,
    /// The method of the batch, where an implicit one takes turns with it.
    pub(crate) in_turns: Option<Explicit>,
}

/// How a run ended; none where it is to go on by another method.
pub(crate) type End = Option<Result<Outcome, Error>>;
/// How runs ended, by their places.
type Ends = [End];

/// Integrates runs of systems of one size to `t_end` by `tableau`, and writes how they ended to `ends`.
pub(crate) fn by_tableau<P: Alike, const S: usize>(
    tableau: &'static Tableau<S>,
    entries: Vec<Entry<'_, '_, P>>,
    t_end: f64,
    ends: &mut Ends,
) {
    let Some(problem) = entries.first().map(|entry| entry.run.problem) else { return };
    let method = || ExplicitRk::new(tableau, problem.dim());
    if entries.len() <= f64x2::N {
        let steps = TableauSteps::<P, f64x2, S>::new(problem, tableau);
        run((steps, method), entries, t_end, ends);
    } else {
        let steps = TableauSteps::<P, f64x8, S>::new(problem, tableau);
        run((steps, method), entries, t_end, ends);
    }
}

/// As [`by_tableau`] by series of `order`; every control has a tolerance.
pub(crate) fn by_series<P: Alike>(
    order: usize,
    entries: Vec<Entry<'_, '_, P>>,
    t_end: f64,
    ends: &mut Ends,
) {
    let Some(problem) = entries.first().map(|entry| entry.run.problem) else { return };
    let method = || TaylorMethod::new(problem.dim(), problem.n_guards(), order);
    run((SeriesSteps::<P, f64x2>::new(problem, order), method), entries, t_end, ends);
}

/// Integrates runs to `t_end` by `steps` at once, or each by a `method` of its own.
fn run<P: Alike, V: Simd, S: Steps<P, V>>(
    (mut steps, method): (S, impl Fn() -> S::Method),
    entries: Vec<Entry<'_, '_, P>>,
    t_end: f64,
    ends: &mut Ends,
) {
    let mut waiting = entries.into_iter();
    let mut next = |ends: &mut Ends| {
        waiting.find_map(|entry| {
            let index = entry.index;
            Member::begin(entry, method(), t_end).map_err(|end| ends[index] = end).ok()
        })
    };
    let mut members = Vec::with_capacity(V::N);
    while members.len() < V::N
        && let Some(member) = next(ends)
    {
        members.push(member);
    }
    let Some(first) = members.first() else { return };
    let mut field = ByParameters::all(first.parameters());
    // A lane without a run has the numbers of the first one, and steps of size zero.
    for lane in 0..V::N {
        members.get(lane).unwrap_or(&members[0]).load(lane, &mut field, &mut steps);
    }
    while members.len() >= S::LEAST {
        let fates = step(&mut members, &field, &mut steps);
        // From the last one, so that a run that takes over a lane has settled.
        for (lane, fate) in fates.into_iter().enumerate().rev() {
            match fate {
                Fate::Stays => {}
                Fate::Moves => members[lane].load(lane, &mut field, &mut steps),
                Fate::Ends(end) => {
                    members[lane].refresh(lane, &steps);
                    ends[members[lane].index] = end;
                    if let Some(member) = next(ends) {
                        members[lane] = member;
                        members[lane].load(lane, &mut field, &mut steps);
                        continue;
                    }
                    close_up(lane, &mut members, &mut field, &mut steps);
                    if members.is_empty() {
                        return;
                    }
                }
            }
        }
    }
    for (lane, mut member) in members.into_iter().enumerate() {
        member.refresh(lane, &steps);
        let index = member.index;
        ends[index] = Some(member.finish());
    }
}

/// Takes a step of every run, and returns what becomes of each.
#[inline(always)]
fn step<P: Alike, V: Simd, S: Steps<P, V>>(
    members: &mut [Member<'_, '_, P, S::Method>],
    field: &ByParameters<P, V>,
    steps: &mut S,
) -> [Fate; LANES] {
    steps.prepare(field);
    for (lane, member) in members.iter_mut().enumerate() {
        member.aim(lane, steps);
    }
    let t0 = steps.t0();
    let t1 = Lanes::from_fn(|lane| members.get(lane).map_or(t0.lane(lane), |run| run.t1));
    let h = Lanes::from_fn(|lane| members.get(lane).map_or(0.0, |run| run.h));
    steps.take(field, t1, h);
    let mut fates = [const { Fate::Stays }; LANES];
    for ((lane, member), fate) in members.iter_mut().enumerate().zip(&mut fates) {
        *fate = member.settle(lane, steps);
    }
    steps.advance();
    fates
}

/// Takes the run in `lane` out, and puts the last one there.
fn close_up<P: Alike, V: Simd, S: Steps<P, V>>(
    lane: usize,
    members: &mut Vec<Member<'_, '_, P, S::Method>>,
    field: &mut ByParameters<P, V>,
    steps: &mut S,
) {
    let last = members.len() - 1;
    members[last].refresh(last, steps);
    members.swap_remove(lane);
    let Some(first) = members.first_mut() else { return };
    first.refresh(0, steps);
    for lane in [lane, last] {
        members.get(lane).unwrap_or(&members[0]).load(lane, field, steps);
    }
}
