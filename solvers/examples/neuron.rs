//! Impulses with a rest after each: a leaky integrate-and-fire neuron against its closed form.
//!
//! `τ V̇ = E − V + R I` fires at `V = ϑ`, is set to `V_r` and held for `t_r`. Its period is
//! `t_r + τ ln((E + R I − V_r)/(E + R I − ϑ))`: W. Gerstner, W. M. Kistler, R. Naud, L. Paninski, *Neuronal Dynamics*, Cambridge
//! University Press (2014), section 1.3.
#![allow(clippy::print_stdout)]

use deltazero_solvers::{METHODS, Next, Real, Run, System, Trajectory};

const TIME: f64 = 10.0; // τ [ms]
const DRIVEN: f64 = -50.0; // E + R I [mV]
const THRESHOLD: f64 = -54.0; // ϑ [mV]
const RESET: f64 = -80.0; // V_r [mV]
const HELD: f64 = 2.0; // t_r [ms]

/// Charging, or held since a time.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Mode {
    Charging,
    HeldSince(f64),
}

/// The potential [mV].
struct Neuron;

#[rustfmt::skip]
impl System for Neuron {
    type Mode = Mode;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];
    fn initial_mode(&self, _t: f64, _: &[f64; 1]) -> Mode { Mode::Charging }
    fn rhs<S: Real>(&self, mode: Mode, _t: S, &[v]: &[S; 1], dydt: &mut [S; 1]) {
        *dydt = [if mode == Mode::Charging { (-v + DRIVEN) * (1.0 / TIME) } else { S::cst(0.0) }];
    }
    fn guards<S: Real>(&self, mode: Mode, t: S, &[v]: &[S; 1], g: &mut [S; 1]) {
        *g = [match mode { Mode::Charging => -v + THRESHOLD, Mode::HeldSince(fired) => -t + (fired + HELD) }];
    }
    fn transition<S: Real>(&self, mode: Mode, _: usize, t: S, y: &mut [S; 1]) -> Next<Mode> {
        Next::Mode(match mode {
            Mode::Charging => { *y = [S::cst(RESET)]; Mode::HeldSince(t.value()) }
            Mode::HeldSince(_) => Mode::Charging,
        })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let period = HELD + TIME * ((DRIVEN - RESET) / (DRIVEN - THRESHOLD)).ln();
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let run = Run::of(&Neuron, [RESET]).method(method.name).tolerance(1e-10, 1e-10);
        let run = run.keep(Trajectory::of_events()).to(500.0)?;
        let spikes = run.trajectory.events.iter().filter(|event| event.before == Mode::Charging);
        let error = (0_u32..)
            .zip(spikes)
            .map(|(number, spike)| (spike.t - (period - HELD) - f64::from(number) * period).abs());
        let (count, worst) = error.fold((0, 0.0), |(n, worst), error| (n + 1, error.max(worst)));
        println!("{:9} {count} spikes, at most {worst:.1e} ms off", method.name);
        if count != 22 || worst > 1e-4 {
            return Err(format!("{} does not fire in time", method.name).into());
        }
    }
    Ok(())
}

#[test]
fn agrees_with_its_closed_form() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
