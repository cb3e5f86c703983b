//! A hammer falls on a pad, `ẍ = −g` in flight and `ẍ = −g − (K x + D ẋ)/m` on the pad until its force is zero: a contact of
//! one's own, studied as the paper's mechanism is. `cargo run --release --example drop_hammer` writes `study.csv`,
//! `study.md`, `report.html`, a map and figures into `drop-hammer-out`, and prints the cheapest method at each error, what is
//! recommended for 1e-6, and which method wins at other stiffnesses and dampings.
#![allow(clippy::print_stdout, reason = "an example shows its answer")]

use deltazero::report::{About, recommend::text};
use deltazero::studied::{Studied, map_table, recommended, write_map};
use deltazero_solvers::{Next, Real, System};
use deltazero_study::map::{Map, MapAxis, MapPlan};
use deltazero_study::problem::{Problem, Quantity, Role, Touch};
use deltazero_study::{Plan, Subject};

/// Mass [kg], stiffness [N/m] and damping [N s/m] of the pad.
struct Hammer {
    m: f64,
    k: f64,
    d: f64,
}

impl Hammer {
    fn push<S: Real>(&self, on_pad: bool, &[x, v]: &[S; 2]) -> S {
        if on_pad { -x * self.k - v * self.d } else { S::cst(0.0) }
    }
}

impl System for Hammer {
    type Mode = bool; // whether it is on the pad
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];
    fn initial_mode(&self, _t: f64, y: &[f64; 2]) -> bool {
        y[0] < 0.0
    }
    fn rhs<S: Real>(&self, on_pad: bool, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [y[1], self.push(on_pad, y) / self.m - 9.81];
    }
    fn guards<S: Real>(&self, on_pad: bool, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = [if on_pad { self.push(true, y) } else { y[0] }];
    }
    fn transition<S: Real>(&self, on_pad: bool, _: usize, _t: S, _y: &mut [S; 2]) -> Next<bool> {
        Next::Mode(!on_pad)
    }
}

impl Problem for Hammer {
    fn start(&self) -> [f64; 2] {
        [0.05, 0.0]
    }
    fn states(&self) -> Vec<Quantity> {
        vec![Quantity::new("x", "m", 0.05), Quantity::new("v", "m/s", 1.0)]
    }
    fn role(&self, on_pad: &bool, _site: usize) -> Role {
        if *on_pad { Role::Contact } else { Role::Free }
    }
    fn touch<S: Real>(&self, on_pad: &bool, _t: S, y: &[S; 2], _site: usize) -> Option<Touch<S>> {
        Some(Touch { depth: -y[0], rate: -y[1], force: self.push(*on_pad, y) })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let hammer = |[k, d]: [f64; 2]| Subject::of(Hammer { m: 2.0, k, d });
    let about = About::new("A hammer on a pad");
    let studied = Studied::new(about, &hammer([1e6, 200.0]), Plan::new(1.0))?;
    studied.write("drop-hammer-out")?;
    println!("{}", studied.answer());
    println!("{}", text(&recommended(hammer([1e6, 200.0]), 1.0, 1e-6)));

    let stiffness = MapAxis::new("stiffness K", "N/m", &[1e5, 1e7, 1e9]);
    let damping = MapAxis::new("damping D", "N s/m", &[0.0, 2e2, 2e4]);
    let map = Map::new([stiffness, damping], &MapPlan::new(1.0), 1, hammer);
    write_map(&map, "drop-hammer-out")?;
    println!("{}", map_table(&map));
    Ok(())
}
