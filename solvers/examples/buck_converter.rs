//! Modes that carry data, guards of time, and a check against a closed form: a buck converter in discontinuous conduction.
//!
//! A switch connects a coil to a source for a part `D` of every period `T`. Its current then runs down through a diode, and
//! rests. Where the ripple is small, the mean voltage of the load settles at `V = 2 V_in/(1 + √(1 + 4 K/D²))`,
//! `K = 2 L/(R T)`: R. W. Erickson, D. Maksimović, *Fundamentals of Power Electronics*, 2nd ed., Kluwer (2001), chapter 5.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{Grid, Next, Real, Run, System, Trajectory};

const SOURCE: f64 = 24.0; // V
const COIL: f64 = 2e-5; // H
const CAPACITOR: f64 = 1e-4; // F
const LOAD: f64 = 20.0; // Ω
const PERIOD: f64 = 1e-5; // s
const DUTY: f64 = 0.4;

/// Which way the current of the coil takes, with the number of the period.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Way {
    Source(u32),
    Diode(u32),
    None(u32),
}

/// The current of the coil [A] and the voltage of the load [V].
struct Buck;

#[rustfmt::skip]
impl System for Buck {
    type Mode = Way;
    type State<S: Real> = [S; 2];
    /// The current, and the time to the next change of the switch.
    type Guards<S: Real> = [S; 2];
    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Way { Way::Source(0) }
    fn rhs<S: Real>(&self, way: Way, _t: S, &[i, v]: &[S; 2], dydt: &mut [S; 2]) {
        let didt = match way {
            Way::Source(_) => (-v + SOURCE) * (1.0 / COIL),
            Way::Diode(_) => -v * (1.0 / COIL),
            Way::None(_) => S::cst(0.0),
        };
        *dydt = [didt, (i - v * (1.0 / LOAD)) * (1.0 / CAPACITOR)];
    }
    fn guards<S: Real>(&self, way: Way, t: S, &[i, _]: &[S; 2], g: &mut [S; 2]) {
        *g = match way {
            Way::Source(k) => [S::cst(1.0), -t + (f64::from(k) + DUTY) * PERIOD],
            Way::Diode(k) => [i, -t + f64::from(k + 1) * PERIOD],
            Way::None(k) => [S::cst(1.0), -t + f64::from(k + 1) * PERIOD],
        };
    }
    fn transition<S: Real>(&self, way: Way, guard: usize, _t: S, [i, _]: &mut [S; 2]) -> Next<Way> {
        Next::Mode(match (way, guard) {
            (Way::Source(k), _) => Way::Diode(k),
            (Way::Diode(k), 0) => { *i = S::cst(0.0); Way::None(k) }
            (Way::Diode(k) | Way::None(k), _) => Way::Source(k + 1),
        })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let samples = Trajectory::on(Grid::uniform(PERIOD / 16.0, 0.04));
    let run = Run::of(&Buck, [0.0, 0.0]).method("dop853").tolerance(1e-9, 1e-9);
    let Trajectory { samples, events, .. } = run.keep(samples).to(0.04)?.trajectory;

    let settled = &samples[samples.len() / 2..];
    let mean = settled.iter().map(|sample| sample.y[1]).sum::<f64>() / settled.len() as f64;
    let k = 2.0 * COIL / (LOAD * PERIOD);
    let expected = 2.0 * SOURCE / (1.0 + (1.0 + 4.0 * k / (DUTY * DUTY)).sqrt());
    println!("{} changes of the way, mean of {mean:.3} V, expected {expected:.3} V", events.len());
    if (mean / expected - 1.0).abs() > 0.01 {
        return Err("the mean voltage is not that of discontinuous conduction".into());
    }
    Ok(())
}

#[test]
fn agrees_with_its_closed_form() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
