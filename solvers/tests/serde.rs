//! Results written and read.
#![cfg(feature = "serde")]
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_solvers::{
    Control, Integration, Method, Next, Real, Stats, Steps, System, Tolerance, Trajectory,
};

/// A tank that fills to 2 and empties to 1; the mode is whether it empties.
struct Tank;

impl System for Tank {
    type Mode = bool;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _h: &[f64; 1]) -> bool {
        false
    }

    fn rhs<S: Real>(&self, empties: bool, _t: S, h: &[S; 1], dhdt: &mut [S; 1]) {
        *dhdt = [if empties { -h[0] } else { S::cst(0.5) }];
    }

    fn guards<S: Real>(&self, empties: bool, _t: S, h: &[S; 1], g: &mut [S; 1]) {
        *g = [if empties { h[0] - 1.0 } else { -h[0] + 2.0 }];
    }

    fn guard_bounds(&self, _: bool, _t: f64, _h: &[f64; 1], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, empties: bool, _: usize, _t: S, _h: &mut [S; 1]) -> Next<bool> {
        Next::Mode(!empties)
    }
}

#[test]
fn a_trajectory_and_its_settings_are_read_as_they_were_written() {
    let control = Control::Adaptive(Tolerance { rtol: 1e-8, atol: vec![1e-10] });
    let again = |steps: &Steps| -> Steps {
        serde_json::from_str(&serde_json::to_string(steps).unwrap()).unwrap()
    };
    // By default the longest step is infinite, which JSON cannot say.
    let by_default = Steps::from(control.clone());
    assert_eq!(again(&by_default), by_default);
    let steps = Steps { first: Some(1e-3), longest: 0.5, control };
    let read = again(&steps);
    assert_eq!(read, steps);

    let mut solver = Method::named("rk45").unwrap().solver(&Tank, read).unwrap();
    let mut trajectory = Trajectory::dense();
    let mut run = Integration::new(&Tank, 0.0, [1.5]);
    run.run(10.0, &mut *solver, &mut trajectory).unwrap();
    let text = serde_json::to_string(&(&trajectory, run.stats)).unwrap();
    let (read, stats): (Trajectory<[f64; 1], bool>, Stats) = serde_json::from_str(&text).unwrap();
    assert_eq!(stats, run.stats);
    assert_eq!((read.start, read.samples), (trajectory.start.clone(), trajectory.samples.clone()));
    assert_eq!((read.events, read.sides), (trajectory.events.clone(), trajectory.sides.clone()));
    assert!(trajectory.events.len() > 5);
    let (read, _): (Trajectory<[f64; 1], bool>, Stats) = serde_json::from_str(&text).unwrap();
    assert_eq!(read.at(4.321), trajectory.at(4.321));
    assert!(read.at(4.321).is_some());
}
