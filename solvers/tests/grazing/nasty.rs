//! Guards that a method is easily wrong about, by every method at a loose and a tight tolerance.

use std::f64::consts::{FRAC_PI_2, TAU};

use deltazero_solvers::{METHODS, Method, Next, Real, Run, System, Trajectory};

/// `ẍ = −x` with x = sin t; the mode is whether x is below a level, which it passes or touches at each of its peaks.
struct Peaks {
    level: f64,
}

impl System for Peaks {
    type Mode = bool;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> bool {
        true
    }

    fn rhs<S: Real>(&self, _: bool, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, -x];
    }

    fn guards<S: Real>(&self, is_below: bool, _t: S, &[x, _]: &[S; 2], g: &mut [S; 1]) {
        let room = -x + self.level;
        *g = [if is_below { room } else { -room }];
    }

    fn transition<S: Real>(&self, is_below: bool, _: usize, _t: S, _: &mut [S; 2]) -> Next<bool> {
        Next::Mode(!is_below)
    }
}

/// Number of peaks before the end.
const PEAKS: usize = 6;
const END: f64 = 38.0;

fn settings() -> impl Iterator<Item = (&'static Method, f64)> {
    let methods = METHODS.iter().filter(|method| !method.is_fixed_step());
    methods.flat_map(|method| [1e-6, 1e-10].map(|rtol| (method, rtol)))
}

/// What a run tells at each peak: its events, and whether it grazes.
fn told(level: f64, (method, rtol): (&Method, f64)) -> [(usize, bool); PEAKS] {
    let peaks = Peaks { level };
    let run = Run::of(&peaks, [0.0, 1.0]).method(method.name).tolerance(rtol, rtol);
    let Trajectory { events, grazings, .. } =
        run.keep(Trajectory::of_events()).to(END).unwrap().trajectory;
    let peak = |t: f64| ((t - FRAC_PI_2) / TAU).round();
    for t in events.iter().map(|event| event.t) {
        let off = t - FRAC_PI_2 - TAU * peak(t);
        assert!(off.abs() < 0.1, "{} at {rtol:e}: an event {off} from a peak", method.name);
    }
    std::array::from_fn(|k| {
        let is_here = |t: f64| peak(t) == k as f64;
        let n_events = events.iter().filter(|event| is_here(event.t)).count();
        (n_events, grazings.iter().any(|grazing| is_here(grazing.t)))
    })
}

#[test]
fn touches_are_told_and_have_two_events_at_most() {
    for setting in settings() {
        for (n_events, is_told) in told(1.0, setting) {
            let known = is_told && n_events <= 2;
            assert!(known, "{} at {:e}: {n_events} events", setting.0.name, setting.1);
        }
    }
}

#[test]
fn dips_are_found_or_told() {
    for depth in [1e-5, 1e-9] {
        for setting in settings() {
            for (n_events, is_told) in told(1.0 - depth, setting) {
                let (name, rtol) = (setting.0.name, setting.1);
                let known = n_events == 2 || is_told;
                assert!(known, "{name} at {rtol:e}, {depth:e} deep: {n_events} events in silence");
            }
        }
    }
}
