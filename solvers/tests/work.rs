//! Where the work of a run goes: steps in each kind of mode, restarts, location.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use common::{steps_itself, tolerance};
use deltazero_solvers::problems::{BeltMode, BeltOscillator};
use deltazero_solvers::{Control, Integration, METHODS, Stats, Work, WorkByKind};

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
fn restarts_and_location_have_their_share() {
    let belt = belt();
    for method in METHODS {
        let control = if method.is_fixed_step() { Control::Fixed(0.01) } else { tolerance(1e-7) };
        let mut solver = method.solver(&belt, control).unwrap();
        let mut run = Integration::new(&belt, 0.0, belt.start);
        run.run(10.5 * belt.period(), &mut *solver, &mut ()).unwrap();
        let Stats { work, restart, location, .. } = run.stats;
        assert_eq!(work, run.stats.stepping() + restart + location);
        let n_phases = run.stats.n_events + 1;
        if steps_itself(method, &belt) {
            // The slope at the start and one to choose the first step, for each phase; an event on the
            // interpolant costs no evaluation.
            assert_eq!(restart.n_rhs, 2 * n_phases, "{}", method.name);
            assert_eq!(location, Work::default(), "{}", method.name);
        } else {
            // One to choose the very first step, but for methods that propose their own.
            let begun = n_phases..=n_phases + u64::from(!method.is_fixed_step());
            assert!(begun.contains(&restart.n_rhs), "{}: {}", method.name, restart.n_rhs);
            assert!(run.stats.n_retaken >= run.stats.n_events, "{}", method.name);
            // A Taylor series is evaluated anywhere on its step for nothing.
            let is_series = method.name == "taylor";
            assert!(is_series || location.n_rhs >= run.stats.n_retaken, "{}", method.name);
        }
    }
}
