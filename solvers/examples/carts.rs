//! Many states and guards: twenty equal carts on a track that collide without loss.
//!
//! Equal carts exchange their velocities, so their places are those of carts that pass through each other, in order: after
//! t they are the sorted `x_i + v_i t`, and there was a collision for each pair that has changed its order.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{METHODS, Next, Real, Run, System, Trajectory};

const N: usize = 20;
const END: f64 = 30.0;

/// Places [m], then velocities [m/s]; guard i is the gap between carts i and i + 1.
struct Carts;

#[rustfmt::skip]
impl System for Carts {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = Vec<S>;
    fn dim(&self) -> usize { 2 * N }
    fn n_guards(&self) -> usize { N - 1 }
    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}
    fn rhs<S: Real>(&self, (): (), _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        dydt[..N].copy_from_slice(&y[N..]);
        dydt[N..].fill(S::cst(0.0));
    }
    fn guards<S: Real>(&self, (): (), _t: S, y: &Vec<S>, g: &mut Vec<S>) {
        for (g, pair) in g.iter_mut().zip(y[..N].windows(2)) { *g = pair[1] - pair[0]; }
    }
    fn transition<S: Real>(&self, (): (), i: usize, _t: S, y: &mut Vec<S>) -> Next<()> {
        y[i + 1] = y[i];
        y.swap(N + i, N + i + 1);
        Next::Mode(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cart = |i: usize| (i as f64, (7.0 * i as f64).sin());
    let carts: Vec<(f64, f64)> = (0..N).map(cart).collect();
    let mut expected: Vec<f64> = carts.iter().map(|(x, v)| x + v * END).collect();
    let passes = |i: usize| expected[i + 1..].iter().filter(|x| **x < expected[i]).count();
    let n_collisions: usize = (0..N).map(passes).sum();
    expected.sort_by(f64::total_cmp);

    let start: Vec<f64> =
        carts.iter().map(|(x, _)| *x).chain(carts.iter().map(|(_, v)| *v)).collect();
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let run = Run::of(&Carts, start.clone()).method(method.name).tolerance(1e-8, 1e-8);
        let run = run.keep(Trajectory::of_events()).to(END)?;
        let n = run.trajectory.events.len();
        let errors = run.end.y[..N].iter().zip(&expected).map(|(x, expected)| (x - expected).abs());
        let worst = errors.fold(0.0, f64::max);
        println!("{:9} {n} of {n_collisions} collisions, at most {worst:.1e} m off", method.name);
        if n != n_collisions || worst > 1e-6 {
            return Err(format!("{} loses a collision or its place", method.name).into());
        }
    }
    Ok(())
}

#[test]
fn agrees_with_its_closed_form() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
