//! A run that is observed without a change of it: the periods of a pendulum against their closed form.
//!
//! `θ̈ = −sin θ` from rest at θ₀ has the period `2π/M(1, cos(θ₀/2))`, M the arithmetic-geometric mean.
#![allow(clippy::print_stdout)]

use deltazero_solvers::observe::Observations;
use deltazero_solvers::{Control, Integration, Method, Next, Real, System, Tolerance};

/// Angle [rad] and its rate; lengths and times are such that g/l = 1.
struct Pendulum;

#[rustfmt::skip]
impl System for Pendulum {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];
    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}
    fn rhs<S: Real>(&self, _: (), _t: S, &[angle, rate]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [rate, -angle.sin()];
    }
    fn guards<S: Real>(&self, _: (), _t: S, _: &[S; 2], _: &mut [S; 0]) {}
    fn transition<S: Real>(&self, _: (), _: usize, _t: S, _: &mut [S; 2]) -> Next<()> { Next::Mode(()) }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start: f64 = 2.0;
    let (mut a, mut b) = (1.0, (0.5 * start).cos());
    for _ in 0..6 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let period = std::f64::consts::TAU / a;

    let method = Method::named("taylor").ok_or("no such method")?;
    let tolerance = Tolerance { rtol: 1e-12, atol: vec![1e-12; 2] };
    let mut solver = method.solver(&Pendulum, Control::Adaptive(tolerance))?;
    // The rate turns from falling to rising once in a period.
    let mut observed = Observations::default().of(1e-15, |(), _t, y: &[f64; 2]| y[1]);
    Integration::new(&Pendulum, 0.0, [start, 0.0]).run(
        10.5 * period,
        &mut *solver,
        &mut observed,
    )?;

    let turns = observed.zeros.iter().filter(|zero| !zero.rises);
    for (number, turn) in (1_u32..).zip(turns) {
        let error = turn.t - f64::from(number) * period;
        println!("turn {number} at t = {:.12}, {error:+.1e} off", turn.t);
        if error.abs() > 1e-9 {
            return Err("a turn is not where the closed form has it".into());
        }
    }
    Ok(())
}

#[test]
fn agrees_with_its_closed_form() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
