//! Impacts that accumulate, with the mode that they tend to: a slender block that rocks on its two corners.
//!
//! `θ̈ = p² (θ ∓ α)` for θ above and below zero, where θ̇ keeps a part r of its size. Between two impacts the block swings to
//! `θ = α φ` and back in `2/p acosh(1/(1 − φ))`, and `1 − (1 − φ₊)² = r² (1 − (1 − φ)²)`: G. W. Housner, "The behavior of inverted
//! pendulum structures during earthquakes", Bull. Seismol. Soc. Am. 53(2), 403–417 (1963).
#![allow(clippy::print_stdout)]

use deltazero_solvers::{METHODS, Next, Real, Run, System, Trajectory};

const RATE: f64 = 2.0; // p [1/s]
const SLOPE: f64 = 0.2; // α [rad]
const KEPT: f64 = 0.9; // r

/// On which corner the block stands.
#[derive(Clone, Copy, PartialEq, Debug)]
enum On {
    Left,
    Right,
    Both,
}

/// The angle θ [rad] and its rate.
struct Block;

#[rustfmt::skip]
impl System for Block {
    type Mode = On;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];
    fn initial_mode(&self, _t: f64, y: &[f64; 2]) -> On { if y[0] < 0.0 { On::Left } else { On::Right } }
    fn rhs<S: Real>(&self, on: On, _t: S, &[angle, rate]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = match on {
            On::Right => [rate, (angle - SLOPE) * (RATE * RATE)],
            On::Left => [rate, (angle + SLOPE) * (RATE * RATE)],
            On::Both => [S::cst(0.0); 2],
        };
    }
    fn guards<S: Real>(&self, on: On, _t: S, &[angle, _]: &[S; 2], g: &mut [S; 1]) {
        *g = [match on { On::Right => angle, On::Left => -angle, On::Both => S::cst(1.0) }];
    }
    fn transition<S: Real>(&self, on: On, _: usize, _t: S, y: &mut [S; 2]) -> Next<On> {
        *y = [S::cst(0.0), y[1] * KEPT];
        Next::Mode(if on == On::Right { On::Left } else { On::Right })
    }
    fn accumulation(&self, _: On, _: usize, _t: f64, y: &mut [f64; 2]) -> Option<On> {
        *y = [0.0; 2];
        Some(On::Both)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = 0.9 * SLOPE;
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let run = Run::of(&Block, [start, 0.0]).method(method.name).tolerance(1e-10, 1e-10);
        let run = run.keep(Trajectory::of_events()).to(20.0)?;

        let (mut size, mut t, mut worst) = (start / SLOPE, 0.0, 0.0_f64);
        let quarter = |size: f64| (1.0 / (1.0 - size)).acosh() / RATE;
        t += quarter(size);
        for impact in run.trajectory.events.iter().take(30) {
            worst = worst.max((impact.t - t).abs());
            size = 1.0 - (1.0 - KEPT * KEPT * (1.0 - (1.0 - size) * (1.0 - size))).sqrt();
            t += 2.0 * quarter(size);
        }
        let (n, low) = (run.trajectory.events.len(), run.stats.n_grazing);
        println!(
            "{:9} {n} impacts, {low} too low to resolve, the first 30 at most {worst:.1e} s off",
            method.name
        );
        // A method of diffsol may rest early, where swings are below its tolerance, and tells so.
        let is_early = n < 290 && low == 0;
        if n < 30 || is_early || run.end.mode != On::Both || worst > 1e-5 {
            return Err(format!("{} does not rock to rest in time", method.name).into());
        }
    }
    Ok(())
}

#[test]
fn agrees_with_its_closed_form() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
