//! The search for falls within one step, apart from any method: steps of the exact flow, up to three
//! quarters of a turn long.

use std::f64::consts::TAU;

use deltazero_solvers::Step;
use deltazero_solvers::event_location::GuardWatch;
use fastrand::Rng;

use crate::SEED;
use crate::common::at_most;
use crate::draw::{Drawn, Flow, Mode, T_END};
use crate::oracle::Arc;

/// Systems drawn.
const N_DRAWS: u64 = 20_000;

/// Longest step, in radians.
const LONGEST: f64 = 0.75 * TAU;
/// Least depth of a dip, and least distance of two falls, that is asked for.
const MARGIN: f64 = 1e-6;

/// A step of the exact flow, its dense output exact too.
struct ExactStep<'a> {
    flow: &'a Flow,
    t: [f64; 2],
    y: [[f64; 2]; 2],
    slope: [[f64; 2]; 2],
}

impl<'a> ExactStep<'a> {
    fn new(flow: &'a Flow, t0: f64, h: f64, y0: [f64; 2]) -> Self {
        let y1 = flow.at(h, &y0);
        Self { flow, t: [t0, t0 + h], y: [y0, y1], slope: [flow.slope(&y0), flow.slope(&y1)] }
    }
}

impl Step<[f64; 2]> for ExactStep<'_> {
    fn t0(&self) -> f64 {
        self.t[0]
    }

    fn t1(&self) -> f64 {
        self.t[1]
    }

    fn y0(&self) -> &[f64; 2] {
        &self.y[0]
    }

    fn y1(&self) -> &[f64; 2] {
        &self.y[1]
    }

    fn slope0(&self) -> &[f64; 2] {
        &self.slope[0]
    }

    fn slope1(&self) -> &[f64; 2] {
        &self.slope[1]
    }

    fn interpolate(&self, t: f64, y: &mut [f64; 2]) {
        *y = self.flow.at(t - self.t[0], &self.y[0]);
    }
}

/// The first fall that the search finds from the start of `system` in steps of `h`, and how many steps
/// it took, and looked at more closely than at their ends.
pub(crate) fn first_found(system: &Drawn, h: f64) -> (Option<(usize, f64)>, [usize; 2]) {
    let flow = &system.modes[0].flow;
    let mut watch = GuardWatch::new(system);
    watch.begin(system, 0, 0.0, &system.start, &flow.slope(&system.start));
    let (mut t, mut y, mut n) = (0.0, system.start, [0; 2]);
    while t < T_END {
        let step = ExactStep::new(flow, t, h, y);
        n[0] += 1;
        if !watch.is_clear(system, 0, &step) {
            n[1] += 1;
            let fall = watch.first_to_fall(system, 0, &step, f64::EPSILON, None).unwrap();
            if let Some(fall) = fall {
                return (Some((fall.guard, fall.t)), n);
            }
        }
        (t, y) = (step.t[1], step.y[1]);
    }
    (None, n)
}

/// The first fall in the first mode of `system` before `end`, if any, and how soon it is over; none
/// where that cannot be told to the margin.
fn first_fall(system: &Drawn, end: f64) -> Option<(Option<(usize, f64)>, f64)> {
    let Mode { flow, guards } = &system.modes[0];
    let arcs = guards.iter().map(|guard| Arc { flow, guard, start: system.start });
    let (starts, falls): (Vec<_>, Vec<_>) =
        arcs.map(|arc| (arc.value(0.0), arc.fall(end + MARGIN, MARGIN))).unzip();
    let mut times: Vec<_> = falls.iter().enumerate().map(|(i, fall)| (fall.time(), i)).collect();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(first, guard) = times.first()?;
    let can_be_told = starts.iter().all(|g| *g > MARGIN)
        && falls.iter().all(|fall| fall.grazes_at > first.min(end) + MARGIN)
        && times.get(1).is_none_or(|second| second.0 > first + MARGIN)
        && (first - end).abs() > MARGIN;
    let found = (first < end).then_some((guard, first));
    can_be_told.then_some((found, falls[guard].recovers_at - first))
}

#[test]
fn no_first_fall_is_missed_on_exact_steps_up_to_three_quarters_of_a_turn() {
    let rng = &mut Rng::with_seed(SEED);
    let (mut n, mut n_short, mut n_steps, mut n_looked, mut late) = (0, 0, 0, 0, 0.0_f64);
    for index in 0..N_DRAWS {
        let system = Drawn::number(index, SEED);
        let turn = LONGEST * 10_f64.powf(-2.0 * rng.f64());
        let h = turn / system.modes[0].flow.rate().max(1.0);
        let Some((exact, excursion)) = first_fall(&system, (T_END / h).ceil() * h) else {
            continue;
        };
        let (found, [steps, looked]) = first_found(&system, h);
        let guard = |fall: Option<(usize, f64)>| fall.map(|(guard, _)| guard);
        let at = format!("seed {SEED:#x}, index {index}, {turn} rad");
        assert_eq!(guard(found), guard(exact), "{at}: {found:?} for {exact:?}");
        if let (Some(found), Some(exact)) = (found, exact) {
            late = late.max((found.1 - exact.1).abs());
        }
        n += 1;
        n_short += usize::from(exact.is_some() && excursion < h);
        n_steps += steps;
        n_looked += looked;
    }
    println!(
        "{n} arcs, {n_short} falls shorter than the step; {n_looked} of {n_steps} steps looked at"
    );
    assert!(n_short > N_DRAWS as usize / 10, "{n_short}");
    // Measured: 1.9e-12, the rounding bound of a guard over its rate.
    at_most("time", late, 1.5e-11);
}
