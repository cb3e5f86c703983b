//! Modes with more operations than the explicit method of `auto` is for.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_solvers::{Grid, Integration, Method, Steps, Trajectory};

use crate::batch::{many_have_same_bits, script, starts};
use crate::common::tolerance;
use crate::script::{Script, floor, guard, unused};

/// The same motion, with the rate of the second mode as a polynomial of degree 60.
fn long_in_the_second_mode() -> Script {
    let mut script = script();
    script.rate[1].resize(61, 0.0);
    script
}

#[test]
fn a_pair_takes_over_from_series_where_a_mode_has_many_operations() {
    let method = Method::named("auto").unwrap();
    let work = |script: &Script| {
        let mut solver = method.solver(script, tolerance(1e-8)).unwrap();
        let mut run = Integration::new(script, 0.0, [0.0, 0.3]);
        run.run(3.0, &mut *solver, &mut ()).unwrap();
        assert!(run.stats.n_events > 1);
        (run.stats.work.n_rhs, run.stats.n_accepted + run.stats.n_rejected)
    };
    // A series counts as one right-hand side; a step of the pair takes a dozen.
    let (n_rhs, n_attempts) = work(&script());
    assert!(n_rhs <= 2 * n_attempts, "{n_rhs} in {n_attempts} steps");
    let (n_rhs, n_attempts) = work(&long_in_the_second_mode());
    assert!(n_rhs > 6 * n_attempts, "{n_rhs} in {n_attempts} steps");
}

#[test]
fn runs_that_change_the_method_have_the_bits_of_runs_alone() {
    let setting = (Method::named("auto").unwrap(), tolerance(1e-8));
    for n in [1, 2, 5, 23] {
        let starts = starts(n, [0.0, 0.3], [0.03, 0.05]);
        let ends = many_have_same_bits(&long_in_the_second_mode(), &setting, &starts, 3.0);
        assert!(ends.iter().all(Result::is_ok));
    }
}

#[test]
fn a_mode_that_comes_late_changes_the_method_of_no_run() {
    // Falls from 0.2 until x = 1.8: after seven to ten phases, by the start.
    let late = Script {
        rate: vec![vec![-1.0], vec![0.1; 61]],
        guards: vec![vec![floor(0, 0.2), guard(&[1.8, -1.0], 0.0, 1)], vec![unused(), unused()]],
    };
    let setting = (Method::named("auto").unwrap(), tolerance(1e-8));
    for n in [1, 23] {
        many_have_same_bits(&late, &setting, &starts(n, [0.0, 0.2], [0.03, 0.01]), 1.9);
    }
}

#[test]
fn the_given_first_step_is_that_of_the_run_and_not_of_the_pair() {
    let (script, steps) =
        (long_in_the_second_mode(), Steps { first: Some(1e-6), ..tolerance(1e-8).into() });
    let mut solver = Method::named("auto").unwrap().solver(&script, steps).unwrap();
    let mut trajectory = Trajectory::on(Grid::Steps);
    Integration::new(&script, 0.0, [0.0, 0.3]).run(3.0, &mut *solver, &mut trajectory).unwrap();
    assert_eq!(trajectory.samples[0].t, 1e-6);
    let lengths = trajectory.samples.windows(2).map(|pair| pair[1].t - pair[0].t);
    assert!(lengths.fold(f64::INFINITY, f64::min) > 1e-4);
}
