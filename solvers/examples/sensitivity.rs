//! How the bounces of a ball depend on its restitution: derivatives through events.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{Control, Integration, Method, Next, Real, Sensitive, System, Tolerance};

/// A ball with the state height [m], velocity [m/s] and restitution, which is a parameter: a state with the rate zero.
struct Ball;

#[rustfmt::skip]
impl System for Ball {
    type Mode = ();
    type State<S: Real> = [S; 3];
    type Guards<S: Real> = [S; 1];
    fn initial_mode(&self, _t: f64, _y: &[f64; 3]) {}
    fn rhs<S: Real>(&self, (): (), _t: S, [_, v, _]: &[S; 3], dydt: &mut [S; 3]) {
        *dydt = [*v, S::cst(-9.8), S::cst(0.0)];
    }
    fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 3], g: &mut [S; 1]) { *g = [y[0]]; }
    fn transition<S: Real>(&self, (): (), _: usize, _t: S, [y, v, e]: &mut [S; 3]) -> Next<()> {
        (*y, *v) = (S::cst(0.0), -*v * *e);
        Next::Mode(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tolerance = Tolerance { rtol: 1e-10, atol: vec![1e-10; 3] };
    let ball = Sensitive::new(&Ball, vec![[0.0, 0.0, 1.0]], tolerance)?;
    let method = Method::named("rk45").ok_or("no such method")?;
    let mut solver = method.solver(&ball, Control::Adaptive(ball.tolerance()))?;
    let start = ball.start(0.0, &[1.0, 0.0, 0.5])?;
    let mut run = Integration::new(&ball, 0.0, start);
    run.run(1.2, &mut *solver, &mut ())?;
    // Bounce 2 is the last one before 1.2 s: t₂ = t₀ (1 + 2e + 2e²), dt₂/de = t₀ (2 + 4e).
    let found = ball.event_time(0, &run.point.y);
    let expected = (2.0_f64 / 9.8).sqrt() * (2.0 + 4.0 * 0.5);
    assert!((found - expected).abs() < 1e-8);
    println!("dt₂/de = {found:.9} s, dy/de = {:.6?}", ball.derivative(0, &run.point.y));
    Ok(())
}
