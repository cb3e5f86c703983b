//! Where the work of a run goes: steps in each kind of mode, restarts, location.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod auto;
#[path = "../common/mod.rs"]
mod common;

use std::cell::Cell;
use std::ops::ControlFlow;

use common::{steps_itself, tolerance};
use deltazero_solvers::problems::{BeltMode, BeltOscillator, BouncingBall, BouncingMode};
use deltazero_solvers::{
    Accepted, Control, Event, Integration, METHODS, Method, Next, Outcome, Real, Record, Stats,
    System, Tolerance, Work, WorkByKind,
};

/// On the stick–slip cycle, from the beginning of stick.
fn belt() -> BeltOscillator {
    let belt = BeltOscillator {
        mass: 2.0,
        stiffness: 50.0,
        belt_speed: 0.3,
        static_friction: 8.0,
        kinetic_friction: 3.0,
        start: [0.0, 0.0],
    };
    BeltOscillator { start: belt.cycle_start(), ..belt }
}

#[test]
fn work_by_kind_adds_up_to_that_of_the_run() {
    let belt = belt();
    for method in METHODS {
        for control in [Control::Fixed(0.01), tolerance(1e-7)] {
            let Ok(mut solver) = method.solver(&belt, control) else {
                continue;
            };
            let mut split = WorkByKind::new(|mode| mode == BeltMode::Stick);
            let mut run = Integration::new(&belt, 0.0, belt.start);
            run.run(10.5 * belt.period(), &mut *solver, &mut split).unwrap();
            let mut sum = Stats::default();
            split.kinds.iter().for_each(|kind| sum += kind.1);
            assert_eq!(sum, run.stats, "{}", method.name);
            let [(true, stick), (false, slip)] = split.kinds[..] else {
                panic!("{}: {:?}", method.name, split.kinds);
            };
            assert_eq!((stick.n_events, slip.n_events), (11, 10), "{}", method.name);
            // Stick is a straight line, slip most of a turn.
            assert!(slip.n_accepted > stick.n_accepted, "{}", method.name);
        }
    }
}

#[test]
fn a_low_bounce_takes_as_few_retaken_steps_as_a_high_one() {
    let ball = BouncingBall { restitution: 0.85, gravity: 9.8, height: 1.0 };
    for method in METHODS.iter().filter(|method| !steps_itself(method, &ball)) {
        let control = if method.is_fixed_step() { Control::Fixed(0.1) } else { tolerance(1e-6) };
        let mut solver = method.solver(&ball, control).unwrap();
        let mut run = Integration::new(&ball, 0.0, ball.start());
        assert_eq!(run.run(20.0, &mut *solver, &mut ()), Ok(Outcome::Finished));
        let Stats { n_retaken, n_events, .. } = run.stats;
        // Down to bounces of 1e-31 m.
        assert!(n_events > 200, "{}", method.name);
        // Measured: 5.5.
        assert!(n_retaken < 7 * n_events, "{}: {n_retaken} for {n_events}", method.name);
    }
}

/// A ball that counts how often its guard, and the bound of that, is looked at.
struct Looked {
    ball: BouncingBall,
    n: Cell<usize>,
    n_bounds: Cell<usize>,
}

impl System for Looked {
    type Mode = BouncingMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> BouncingMode {
        self.ball.initial_mode(t, y)
    }

    fn rhs<S: Real>(&self, mode: BouncingMode, t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        self.ball.rhs(mode, t, y, dydt);
    }

    fn guards<S: Real>(&self, mode: BouncingMode, t: S, y: &[S; 2], g: &mut [S; 1]) {
        self.n.set(self.n.get() + 1);
        self.ball.guards(mode, t, y, g);
    }

    fn guard_bounds(&self, mode: BouncingMode, t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        self.n_bounds.set(self.n_bounds.get() + 1);
        self.ball.guard_bounds(mode, t, y, bounds);
    }

    fn transition<S: Real>(
        &self,
        mode: BouncingMode,
        guard: usize,
        t: S,
        y: &mut [S; 2],
    ) -> Next<BouncingMode> {
        self.ball.transition(mode, guard, t, y)
    }

    fn accumulation(
        &self,
        mode: BouncingMode,
        guard: usize,
        t: f64,
        y: &mut [f64; 2],
    ) -> Option<BouncingMode> {
        self.ball.accumulation(mode, guard, t, y)
    }
}

// Steps are of the size of the first flights throughout: the root that is looked for lies in a part of them down to 1e-15.
#[test]
fn a_fall_in_a_small_part_of_a_step_is_found_in_few_looks() {
    for method in
        METHODS.iter().filter(|method| ["rk45", "dop853", "vern98"].contains(&method.name))
    {
        let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
        let looked = Looked { ball, n: Cell::new(0), n_bounds: Cell::new(0) };
        let mut solver = method.solver(&looked, tolerance(1e-6)).unwrap();
        let mut run = Integration::new(&looked, 0.0, looked.ball.start());
        assert_eq!(run.run(20.0, &mut *solver, &mut ()), Ok(Outcome::Finished));
        let Stats { n_retaken, n_events, .. } = run.stats;
        // Two at each retaken step, of the guard and its rate.
        let looks =
            looked.n.get() as f64 / n_events as f64 - 2.0 * n_retaken as f64 / n_events as f64;
        // Measured: 25 to 28; half as many again with a search that begins by halving the step.
        assert!(n_events > 150 && looks < 32.0, "{}: {looks}", method.name);
        // Where the mode is entered, at the end of the step, and mostly once where it is retaken.
        let n_bounds = looked.n_bounds.get() as f64 / n_events as f64;
        // Measured: 3.45 to 3.56; 3.9 to 4.2 where each retaken step has its own.
        assert!(n_bounds < 3.8, "{}: {n_bounds}", method.name);
    }
}

/// `ẏ = 1`, with another mode after one unit of time.
struct Alarm;

impl System for Alarm {
    type Mode = bool;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, _y: &[f64; 1]) -> bool {
        t.abs() >= 1.0
    }

    fn rhs<S: Real>(&self, _rings: bool, _t: S, _y: &[S; 1], dydt: &mut [S; 1]) {
        *dydt = [S::cst(1.0)];
    }

    fn guards<S: Real>(&self, rings: bool, t: S, _y: &[S; 1], g: &mut [S; 1]) {
        *g = [if rings { S::cst(1.0) } else { -(t * t) + 1.0 }];
    }

    fn transition<S: Real>(&self, _: bool, _: usize, _t: S, _y: &mut [S; 1]) -> Next<bool> {
        Next::Mode(true)
    }
}

/// Sizes of the steps.
#[derive(Default)]
struct Sizes {
    taken: Vec<f64>,
    /// How many were taken up to the event.
    before: usize,
}

impl Record<Alarm> for Sizes {
    fn step(&mut self, accepted: &Accepted<'_, Alarm>) -> ControlFlow<()> {
        self.taken.push((accepted.step.t1() - accepted.step.t0()).abs());
        ControlFlow::Continue(())
    }

    fn event(&mut self, _event: &Event<'_, Alarm>) -> ControlFlow<()> {
        self.before = self.taken.len();
        ControlFlow::Continue(())
    }
}

#[test]
fn no_step_grows_over_an_event() {
    for (method, t_end) in [("rk45", 1e6), ("rk45", -1e6), ("bs32", 1e6)] {
        let method = Method::named(method).unwrap();
        let control = Control::Adaptive(Tolerance { rtol: 1e-6, atol: vec![1e-6] });
        let mut solver = method.solver(&Alarm, control).unwrap();
        let mut sizes = Sizes::default();
        let mut run = Integration::new(&Alarm, 0.0, [0.0]);
        assert_eq!(run.run(t_end, &mut *solver, &mut sizes), Ok(Outcome::Finished));
        let (taken, after) = (sizes.taken, sizes.before);
        // All steps grow as the second did, and the one that the event cut would have.
        let growth = taken[1] / taken[0];
        let tried = growth * taken[after - 2];
        assert!(growth > 2.0 && (taken[after] / tried - 1.0).abs() < 1e-9, "{}", method.name);
        assert!((taken[after + 1] / tried / growth - 1.0).abs() < 1e-9, "{}", method.name);
    }
}

#[test]
fn restarts_and_location_have_their_share() {
    let belt = belt();
    for method in METHODS {
        let control = if method.is_fixed_step() { Control::Fixed(0.01) } else { tolerance(1e-7) };
        let mut solver = method.solver(&belt, control).unwrap();
        let mut run = Integration::new(&belt, 0.0, belt.start);
        run.run(10.5 * belt.period(), &mut *solver, &mut ()).unwrap();
        let Stats { work, restart, location, .. } = run.stats;
        assert_eq!(work, run.stats.stepping() + restart + location);
        match method.name {
            "taylor" => assert_eq!(work.n_series, work.n_rhs),
            "auto" => assert!(work.n_series > 0 && work.n_series <= work.n_rhs),
            _ => assert_eq!(work.n_series, 0, "{}", method.name),
        }
        let n_phases = run.stats.n_events + 1;
        if steps_itself(method, &belt) {
            // The slope at the start and one to choose the first step, for each phase; an event on the
            // interpolant costs no evaluation.
            assert_eq!(restart.n_rhs, 2 * n_phases, "{}", method.name);
            assert_eq!(location, Work::default(), "{}", method.name);
        } else {
            // One to choose the very first step, of each half for `auto`, but for methods that propose their own.
            let halves = if method.name == "auto" { 2 } else { 1 };
            let begun = n_phases..=n_phases + halves * u64::from(!method.is_fixed_step());
            assert!(begun.contains(&restart.n_rhs), "{}: {}", method.name, restart.n_rhs);
            assert!(run.stats.n_retaken >= run.stats.n_events, "{}", method.name);
            // A Taylor series, the explicit method of `auto` here, is evaluated anywhere on its step for nothing.
            let is_series = ["taylor", "auto"].contains(&method.name);
            assert!(is_series || location.n_rhs >= run.stats.n_retaken, "{}", method.name);
        }
    }
}
