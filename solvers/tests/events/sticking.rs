//! Modes that keep the state on a surface: sticking, sliding, and leaving both.

use deltazero_solvers::problems::{FrictionMode, FrictionOscillator};
use deltazero_solvers::{Control, Next, Outcome, Real, System};

use crate::common::{at_most, steps_itself};
use crate::log::{ROUNDING, run, settings};
use crate::script::{Script, floor, guard, unused};

#[test]
fn a_mass_that_sticks_stays() {
    // From 1 m it would come to rest just where friction holds it, to rounding.
    let oscillator = FrictionOscillator { mass: 1.0, stiffness: 9.0, friction: 1.0, release: 0.95 };
    for setting in settings() {
        let name = setting.0.name;
        let start = (0.0, oscillator.start());
        let (log, outcome, t, y) = run(&oscillator, &setting, start, 20.0);
        assert_eq!((outcome, t), (Ok(Outcome::Finished), 20.0), "{name}");
        assert_eq!(log.events.len(), oscillator.n_half_periods(), "{name}");
        assert_eq!(log.events.last().unwrap().3, Next::Mode(FrictionMode::Stick));
        let exact = oscillator.state(20.0);
        // Measured: 7.9e-2 m for bs32, 9.2e-3 m for rk4 and 1.6e-4 m for rk45 at ω h = 0.75; with rtol = 1e-8
        // 2.2e-8 m for rk45, 5.0e-7 m for bdf and 3.5e-6 m for esdirk34.
        let is_fixed = matches!(setting.1, Control::Fixed(_));
        let bound = if is_fixed { 0.5 } else { 2e-5 };
        at_most(name, (y[0] - exact[0]).abs(), bound);
        assert_eq!(y[1], 0.0, "{name}");
    }
}

#[test]
fn a_state_slides_on_a_surface_until_it_is_let_go() {
    // Down to z = 0 at x = 0.5, along it until x = 1.25, then away.
    let script = Script {
        rate: vec![vec![-1.0], vec![], vec![1.0]],
        guards: vec![
            vec![floor(1, 0.0), unused()],
            vec![floor(1, 0.0), guard(&[1.25, -1.0], 0.0, 2)],
            vec![floor(1, 0.0), unused()],
        ],
    };
    for setting in settings() {
        let (log, outcome, _, [_, z]) = run(&script, &setting, (0.0, [0.0, 0.5]), 2.0);
        assert_eq!(outcome, Ok(Outcome::Finished));
        let times = log.times();
        assert!(
            times.len() == 2
                && (times[0] - 0.5).abs() < ROUNDING
                && (times[1] - 1.25).abs() < ROUNDING,
            "{}: {times:?}",
            setting.0.name
        );
        assert!((z - 0.75).abs() < ROUNDING);
    }
}

/// Amplitude of the force on a [`Driven`] mass; its friction is 1.
const DRIVE: f64 = 1.25;

/// A unit mass on a rough surface under the force `A sin t`: `v̇ = A sin t − 1` while it slides with
/// `v ≥ 0`, and `v = 0` while the force is below the friction of 1. The states are v and the force's impulse, without
/// which no step would resolve the force while the mass sticks.
struct Driven;

impl System for Driven {
    type Mode = FrictionMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> FrictionMode {
        FrictionMode::Stick
    }

    fn rhs<S: Real>(&self, mode: FrictionMode, t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        let force = t.sin_cos().0 * DRIVE;
        let slips = mode == FrictionMode::SlipPlus;
        *dydt = [if slips { force - 1.0 } else { S::cst(0.0) }, force];
    }

    fn guards<S: Real>(&self, mode: FrictionMode, t: S, &[v, _]: &[S; 2], g: &mut [S; 1]) {
        let slips = mode == FrictionMode::SlipPlus;
        *g = [if slips { v } else { -(t.sin_cos().0 * DRIVE) + 1.0 }];
    }

    fn guard_bounds(&self, _: FrictionMode, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(
        &self,
        mode: FrictionMode,
        _guard: usize,
        _t: S,
        y: &mut [S; 2],
    ) -> Next<FrictionMode> {
        y[0] = S::cst(0.0);
        Next::Mode(match mode {
            FrictionMode::Stick => FrictionMode::SlipPlus,
            _ => FrictionMode::Stick,
        })
    }
}

#[test]
fn a_mass_that_sticks_is_let_go_and_sticks_again() {
    // It is let go at t₁, A sin t₁ = 1, with v and v̇ both zero: v = A (cos t₁ − cos t) − (t − t₁).
    let released = (1.0 / DRIVE).asin();
    let velocity = |t: f64| DRIVE * (released.cos() - t.cos()) - (t - released);
    let (mut a, mut b) = (released + 1.0, released + 3.0);
    while b - a > 1e-15 {
        let middle = 0.5 * (a + b);
        if velocity(middle) > 0.0 { a = middle } else { b = middle }
    }
    let period = 2.0 * std::f64::consts::PI;
    let expected = [released, a, released + period, a + period];
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, _, [v, _]) = run(&Driven, &setting, (0.0, [0.0, 0.0]), 12.0);
        assert_eq!((outcome, v), (Ok(Outcome::Finished), 0.0), "{name}");
        let times = log.times();
        assert_eq!(times.len(), 4, "{name}: {times:?}");
        // Measured: 4.5e-5 for bs32 with fixed steps; with rtol = 1e-8 2.8e-9 for bs32, 2.2e-6 for tr_bdf2.
        let bound = match setting.1 {
            Control::Fixed(_) => 4e-4,
            _ if steps_itself(setting.0, &Driven) => 2e-5,
            _ => 2e-8,
        };
        for (t, expected) in times.iter().zip(expected) {
            at_most(name, (t - expected).abs(), bound);
        }
    }
}
