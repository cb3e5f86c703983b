//! A stiff equation without events: van der Pol's with μ = 1000, by implicit methods.
//!
//! `ẍ = μ (1 − x²) ẋ − x` from (2, 0). At t = 2000 a reference run of the problem VDPOL has x = 1.706167732170483 and
//! ẋ = −8.928097010247975e-4: F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers*, release 2.4 (2008).
#![allow(clippy::print_stdout)]

use deltazero_solvers::{METHODS, Next, Real, Run, System};

const MU: f64 = 1000.0;
const END: [f64; 2] = [1.706_167_732_170_483, -8.928_097_010_247_975e-4];

/// x and its rate.
struct VanDerPol;

#[rustfmt::skip]
impl System for VanDerPol {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];
    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}
    fn rhs<S: Real>(&self, (): (), _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, (-(x * x) + 1.0) * v * MU - x];
    }
    fn guards<S: Real>(&self, (): (), _t: S, _: &[S; 2], _: &mut [S; 0]) {}
    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _: &mut [S; 2]) -> Next<()> { Next::Mode(()) }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for method in METHODS.iter().filter(|method| method.is_implicit() || method.chooses()) {
        let run = Run::of(&VanDerPol, [2.0, 0.0]).method(method.name).tolerance(1e-8, 1e-10);
        let run = run.to(2000.0)?;
        let error = (run.end.y[0] - END[0]).abs();
        let n_rhs = run.stats.work.n_rhs;
        println!("{:9} {n_rhs:7} right-hand sides, {error:.1e} off", method.name);
        if error > 1e-4 {
            return Err(format!("{} is off by {error:e}", method.name).into());
        }
    }
    Ok(())
}

#[test]
fn agrees_with_the_reference_of_the_test_set() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
