//! Each problem of `deltazero_solvers::problems`, studied: its reference has the samples and the events of the closed form.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::problems::{
    BeltOscillator, BouncingBall, FrictionOscillator, Heater, HertzBall, SlidingStops, SpringStop,
    Thermostat, TwoBalls,
};
use deltazero_study::Subject;
use deltazero_study::columns::{Given, Value, shown};
use deltazero_study::problem::Problem;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::{Row, Status, against, reference};

use crate::common::{WALLS, plan};

const BALL: BouncingBall = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
const LOWER_BALL: BouncingBall = BouncingBall { restitution: 0.8, height: 0.25, ..BALL };
const STOP: SpringStop =
    SpringStop { mass: 1.0, stiffness: 50.0, stop_stiffness: 2000.0, gap: 0.0, start: [-0.2, 0.0] };
const RUBS: FrictionOscillator =
    FrictionOscillator { mass: 2.0, stiffness: 50.0, friction: 5.0, release: -0.95 };
const BELT: BeltOscillator = BeltOscillator {
    mass: 2.0,
    stiffness: 50.0,
    belt_speed: 0.3,
    static_friction: 8.0,
    kinetic_friction: 3.0,
    start: [0.9, 0.1],
};
const HERTZ: HertzBall = HertzBall { mass: 2.0, stiffness: 3e4, exponent: 1.5, start: [-0.3, 1.5] };
const STOPS: SlidingStops = SlidingStops {
    mass: 5.0,
    gap: 0.5,
    drive: 4.0,
    half_period: 2.0,
    friction: 2.0,
    start: [0.0; 2],
};
const ROOM: Thermostat = Thermostat {
    heat_capacity: 2e6,
    conductance: 200.0,
    power: 6e3,
    outside: 275.0,
    low: 292.0,
    high: 294.0,
    start: 292.0,
    heater: Heater::On,
};

/// What is known of a problem by its closed form.
struct Known {
    name: &'static str,
    subject: Subject,
    t_end: f64,
    /// Events up to then.
    n_events: usize,
    /// The state at a time; none where no formula gives it.
    state: Box<dyn Fn(f64) -> Option<Vec<f64>>>,
}

fn known<P: Problem + 'static, const N: usize>(
    name: &'static str,
    problem: P,
    (t_end, n_events): (f64, usize),
    state: impl Fn(f64) -> Option<[f64; N]> + 'static,
) -> Known {
    let state = Box::new(move |t| state(t).map(Vec::from));
    Known { name, subject: Subject::of(problem), t_end, n_events, state }
}

fn all() -> Vec<Known> {
    let two = TwoBalls { balls: [BALL, LOWER_BALL] };
    let n_bounces = (0..).take_while(|n| BALL.bounce_time(*n) < 1.2).count();
    vec![
        known("belt_oscillator", BELT, (6.0, BELT.pieces(6.0).len() - 1), |t| Some(BELT.state(t))),
        known("bouncing_ball", BALL, (1.2, n_bounces), |t| Some(BALL.state(t))),
        known("compliant_ball", WALLS, (0.4, WALLS.solution(0.4).1.len()), |t| {
            Some(WALLS.solution(t).0)
        }),
        known("friction_oscillator", RUBS, (4.0, RUBS.n_half_periods()), |t| Some(RUBS.state(t))),
        known("hertz_ball", HERTZ, (0.4, 2), |t| HERTZ.state(t)),
        known("sliding_stops", STOPS, (9.0, STOPS.pieces(9.0).len() - 1), |t| Some(STOPS.state(t))),
        known("spring_stop", STOP, (2.0, STOP.solution(2.0).1.len()), |t| Some(STOP.solution(t).0)),
        known("thermostat", ROOM, (6e3, ROOM.pieces(6e3).len() - 1), |t| Some(ROOM.state(t))),
        known("two_balls", two, (1.2, two.bounces(1.2).len()), move |t| Some(two.state(t))),
    ]
}

#[test]
fn every_problem_with_a_closed_form_is_in_the_list() {
    let files = include_str!("../../../solvers/src/problems/mod.rs").lines();
    let files: Vec<&str> =
        files.filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';')).collect();
    let names: Vec<&str> = all().iter().map(|known| known.name).collect();
    assert_eq!(names, files);
}

#[test]
fn the_study_of_each_problem_has_its_closed_form_and_its_events() {
    let stop = AtomicBool::new(false);
    for Known { name, subject, t_end, n_events, state } in all() {
        let plan = plan(&["rk45", "radau5"], &[Events::Located], &[1e-8], &[], t_end);
        let reference = reference(&subject, &plan, &stop).unwrap();
        assert_eq!(reference.n_events(), n_events, "{name}");
        let part = &reference.parts[0];
        let exact = part.times.iter().zip(&part.samples).filter_map(|(t, y)| Some((y, state(*t)?)));
        let errors: Vec<f64> = exact.map(|(y, exact)| part.scale.error(y, &exact)).collect();
        // No formula gives the state within a contact by Hertz.
        assert!(2 * errors.len() > part.times.len(), "{name}: {} samples", errors.len());
        // Measured: 4.7e-14 at most, of the ball that hits a wall by Hertz.
        assert!(errors.iter().all(|error| *error < 4e-13), "{name}: {errors:?}");
        let table = against(&subject, &reference, &plan, &[], &stop, &|_| {});
        for row in &table.rows {
            assert_eq!(row.status, Status::Ok, "{name}: {row:?}");
            // Measured: 4.2e-6 at most, of the mass between two walls.
            assert!(row.events_are_right() && row.e.unwrap() < 4e-5, "{name}: {row:?}");
            // Energies that are given balance.
            assert_eq!(row.warnings, [], "{name}");
        }
        assert_no_empty_column(name, &table.rows);
    }
}

#[test]
fn the_largest_magnitude_of_a_state_may_be_that_of_its_start() {
    let (subject, stop) = (Subject::of(BALL), AtomicBool::new(false));
    let plan = plan(&["rk45"], &[Events::Located], &[1e-8], &[], 1.2);
    let reference = reference(&subject, &plan, &stop).unwrap();
    assert_eq!(reference.parts[0].amplitude[0], BALL.height);
}

/// Fails where no row has a value in a column that is there for its values.
fn assert_no_empty_column(name: &str, rows: &[Row]) {
    for column in shown(rows).iter().filter(|column| column.given != Given::Always) {
        let nothing = [Value::Text(String::new()), Value::Number(None), Value::Count(None)];
        let is_empty = rows.iter().all(|row| nothing.contains(&(column.value)(row)));
        assert!(!is_empty, "{name}: no run has {}", column.name);
    }
}
