//! A model of one's own: a tank whose valve opens at 2 m and shuts at 1 m.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{Next, Real, Run, System};

/// `ḣ = 0.5 − (√h if the valve is open)`, in metres and seconds; the mode is whether it is.
struct Tank;

#[rustfmt::skip]
impl System for Tank {
    type Mode = bool;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];
    fn initial_mode(&self, _t: f64, h: &[f64; 1]) -> bool { h[0] > 2.0 }
    fn rhs<S: Real>(&self, open: bool, _t: S, h: &[S; 1], dhdt: &mut [S; 1]) {
        *dhdt = [if open { -h[0].sqrt() + 0.5 } else { S::cst(0.5) }];
    }
    fn guards<S: Real>(&self, open: bool, _t: S, h: &[S; 1], g: &mut [S; 1]) {
        *g = [if open { h[0] - 1.0 } else { -h[0] + 2.0 }];
    }
    fn transition<S: Real>(&self, open: bool, _: usize, _t: S, _: &mut [S; 1]) -> Next<bool> { Next::Mode(!open) }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let run = Run::of(&Tank, [1.5]).method("rk45").tolerance(1e-8, 1e-10).to(10.0)?;
    for switch in &run.trajectory.events {
        println!("t = {:.9} s: {:?}", switch.t, switch.after);
    }
    Ok(())
}
