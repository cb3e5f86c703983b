//! A model chosen at run time: an enumeration of models is a model, and its parameters are plain data.
//!
//! `cargo run --example chosen_model -- ball 0.5` lets a ball drop that keeps half its speed, `… -- heater 3` heats a room by
//! 3 K a minute between 18 and 22 °C.
//!
//! The first bounce is at `√(2/9.8)` s; the heater comes on after `10 ln(10/8)` min.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{Next, Real, Run, System};

/// The models, with the parameter of each.
enum Model {
    /// Height [m] and velocity [m/s] of a ball, and the part of its speed that it keeps.
    Ball { kept: f64 },
    /// Temperature [°C] of a room that loses a tenth of its excess over 10 °C a minute, and what the heater gives [K/min].
    Heater { power: f64 },
}

impl Model {
    /// The model of a name with this parameter, its start, and how long it is followed.
    fn named(name: &str, parameter: f64) -> Option<(Self, Vec<f64>, f64)> {
        match name {
            "ball" => Some((Self::Ball { kept: parameter }, vec![1.0, 0.0], 1.2)),
            "heater" => Some((Self::Heater { power: parameter }, vec![20.0], 30.0)),
            _ => None,
        }
    }
}

/// Numbers of states that differ are in a `Vec`, whose length `dim` tells. The mode is whether the heater is on.
#[rustfmt::skip]
impl System for Model {
    type Mode = bool;
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 1];
    fn dim(&self) -> usize { match self { Self::Ball { .. } => 2, Self::Heater { .. } => 1 } }
    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) -> bool { false }
    fn rhs<S: Real>(&self, on: bool, _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        match self {
            Self::Ball { .. } => { dydt[0] = y[1]; dydt[1] = S::cst(-9.8); }
            Self::Heater { power } => dydt[0] = (-y[0] + 10.0) * 0.1 + if on { *power } else { 0.0 },
        }
    }
    fn guards<S: Real>(&self, on: bool, _t: S, y: &Vec<S>, g: &mut [S; 1]) {
        *g = [match self {
            Self::Ball { .. } => y[0],
            Self::Heater { .. } => if on { -y[0] + 22.0 } else { y[0] - 18.0 },
        }];
    }
    fn transition<S: Real>(&self, on: bool, _: usize, _t: S, y: &mut Vec<S>) -> Next<bool> {
        match self {
            Self::Ball { kept } => { y[0] = S::cst(0.0); y[1] = -y[1] * *kept; Next::Mode(on) }
            Self::Heater { .. } => Next::Mode(!on),
        }
    }
}

/// The times of the events of a model.
fn events(name: &str, parameter: f64) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let named = Model::named(name, parameter);
    let (model, start, t_end) = named.ok_or("the models are ball and heater")?;
    let run = Run::of(&model, start).method("dop853").tolerance(1e-9, 1e-9).to(t_end)?;
    Ok(run.trajectory.events.iter().map(|event| event.t).collect())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let name = words.next().unwrap_or_else(|| "ball".to_owned());
    let parameter = words.next().map_or(Ok(0.5), |word| word.parse())?;
    println!("events at {:.9?}", events(&name, parameter)?);
    Ok(())
}

#[test]
fn each_model_has_its_events() -> Result<(), Box<dyn std::error::Error>> {
    let (ball, heater) = (events("ball", 0.5)?, events("heater", 3.0)?);
    assert!(ball.len() == 3 && (ball[0] - (2.0_f64 / 9.8).sqrt()).abs() < 1e-8);
    assert!(heater.len() > 5 && (heater[0] - 10.0 * (10.0_f64 / 8.0).ln()).abs() < 1e-7);
    Ok(())
}
