//! The bouncing ball, against the closed form of its bounces.

use deltazero_solvers::problems::BouncingBall;

use super::runs::{METHODS, Run, balance, below, distance, latest, model, parameter, t_end};

const NAME: &str = "bouncing_ball";

#[test]
fn a_ball_bounces_as_in_closed_form_and_comes_to_rest() {
    let [restitution, gravity, height] = ["e", "g", "h"].map(|name| parameter(NAME, name));
    let ball = BouncingBall { restitution, gravity, height };
    for method in METHODS {
        let run = Run::by(&model(NAME, &[]), method, 1e-10, t_end(NAME));
        let bounces = run.times_of("flight");
        let exact: Vec<f64> = (0..bounces.len()).map(|n| ball.bounce_time(n)).collect();
        let late = latest(&bounces, &exact);
        let rests = run.times_of("rest");
        let rest = (rests[0] - ball.accumulation_time()).abs();
        // Measured: 4.6e-11 s, all of it in the last bounces, which are lower than rounding.
        below(&format!("{method} bounces [s]"), late, 4e-10);
        below(&format!("{method} rest [s]"), rest, 4e-10);
        assert!(bounces.len() > 30 && rests.len() == 1 && run.y == [0.0, 0.0], "{method}");
    }
}

#[test]
fn the_ball_flies_as_in_closed_form_between_the_bounces() {
    let [restitution, gravity, height] = ["e", "g", "h"].map(|name| parameter(NAME, name));
    let ball = BouncingBall { restitution, gravity, height };
    let model = model(NAME, &[]);
    let run = Run::by(&model, "taylor", 1e-13, 3.5);
    let mut worst = 0.0_f64;
    for (t, y) in run.samples.iter().filter(|(t, _)| run.changes.iter().all(|own| own.t != *t)) {
        let off = distance(&model, y, &ball.state(*t));
        worst = worst.max(off);
    }
    // Measured: 1.1e-14.
    below("flights", worst, 1e-13);
}

#[test]
fn bounces_take_all_of_the_energy() {
    let own = balance(&model(NAME, &[]), "rk45", 1e-10, t_end(NAME));
    let energy = ["m", "g", "h"].map(|name| parameter(NAME, name)).iter().product::<f64>();
    // Measured: 1.7e-15.
    below("energy", (own.dissipated / energy - 1.0).abs(), 1e-14);
    assert_eq!(own.kinetic, 0.0);
}

#[test]
fn a_ball_that_starts_a_hair_above_the_floor_comes_to_rest() {
    for method in METHODS {
        let run = Run::by(&model(NAME, &[("h", 1e-20)]), method, 1e-10, t_end(NAME));
        assert!(run.times_of("rest").len() == 1 && run.y == [0.0, 0.0], "{method}");
        assert!(run.changes.len() < 1000, "{method}: {}", run.changes.len());
    }
}
