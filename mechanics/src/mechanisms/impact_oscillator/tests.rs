use deltazero_solvers::{Grid, Trajectory};

use deltazero_study::energy_balance::Balance;

use super::super::runs::{Run, balance, by_every_method, distance};
use super::*;
use crate::config::Config;

/// Twenty periods of the force [s].
const DEFAULT_END: f64 = 21.0;

/// Impacts by the closed form, each found by bisection: time [s] and speed before it [m/s]; and the state at `t_end`.
fn closed_form(oscillator: &ImpactOscillator, t_end: f64) -> (Vec<(f64, f64)>, [f64; 2]) {
    let (mut t, mut y, mut impacts) = (0.0, oscillator.start(), Vec::new());
    let step = 1e-3 * oscillator.period();
    loop {
        let at = |s: f64| oscillator.free_motion(t, y, s);
        let is_past = |k: &u64| at(step * *k as f64)[0] > 0.0 || t + step * *k as f64 > t_end;
        let k = (1..).find(is_past).unwrap();
        let [mut low, mut high] = [k - 1, k].map(|k| step * k as f64);
        if at(high)[0] <= 0.0 || t + high > t_end && at(t_end - t)[0] <= 0.0 {
            return (impacts, at(t_end - t));
        }
        while 0.5 * (low + high) != low && 0.5 * (low + high) != high {
            let middle = 0.5 * (low + high);
            if at(middle)[0] > 0.0 { high = middle } else { low = middle }
        }
        let speed = at(high)[1];
        (t, y) = (t + high, [0.0, -oscillator.restitution * speed]);
        impacts.push((t, speed));
    }
}

/// Speeds before the impacts of a run, from the state after each.
fn impacts(run: &Run<ImpactOscillator>, oscillator: &ImpactOscillator) -> Vec<(f64, f64)> {
    let samples = &run.trajectory.samples;
    let after = |t: f64| samples.iter().rev().find(|sample| sample.t == t).unwrap().y[1];
    let speed = |t: f64| -after(t) / oscillator.restitution;
    run.events().iter().map(|event| (event.t, speed(event.t))).collect()
}

#[test]
fn every_method_follows_the_closed_form_from_impact_to_impact() {
    let oscillator = ImpactOscillator::default();
    let (expected, end) = closed_form(&oscillator, DEFAULT_END);
    assert_eq!(expected.len(), 34);
    for (name, run) in by_every_method(&oscillator, DEFAULT_END) {
        assert_eq!(run.events().len(), expected.len(), "{name}");
        let off = distance(&oscillator, &run.end.y, &end);
        let times = run.events().iter().zip(&expected).map(|(event, (t, _))| (event.t - t).abs());
        let late = times.fold(0.0, f64::max);
        // Measured: 2.0e-9 and 5.4e-9 s (bs32); diffsol's implicit ones 1.6e-7 (tr_bdf2) and 1.1e-7 s (esdirk34).
        let [state, time] = match name {
            "bdf" | "tr_bdf2" | "esdirk34" => [1.6e-6, 1.1e-6],
            "taylor" => [9e-12, 2e-11],
            _ => [2e-8, 5e-8],
        };
        assert!(off < state && late < time, "{name}: {off:e}, {late:e} s");
    }
}

#[test]
fn the_extended_run_follows_the_closed_form_too() {
    let oscillator = ImpactOscillator::default();
    let (expected, end) = closed_form(&oscillator, DEFAULT_END);
    let mut trajectory = Trajectory::on(Grid::Steps);
    let start = oscillator.start();
    let run = oscillator.integrate_extended(1e-20, start, DEFAULT_END, &mut trajectory);
    let off = distance(&oscillator, &run.y, &end);
    // Measured: 5.4e-15, the rounding of the closed form.
    assert!(off < 5e-14 && trajectory.events.len() == expected.len(), "{off:e}");
}

/// `oscillator` begun on its fastest orbit with one impact in `n` periods, and that orbit.
fn on_orbit(oscillator: ImpactOscillator, n: u32) -> (ImpactOscillator, PeriodicOrbit) {
    let orbit = oscillator.periodic_orbits(n)[0];
    let [start_position, start_velocity] = orbit.start;
    (ImpactOscillator { start_position, start_velocity, ..oscillator }, orbit)
}

#[test]
fn a_start_on_the_orbit_of_shaw_and_holmes_stays_on_it() {
    let at = |frequency| ImpactOscillator { frequency, ..ImpactOscillator::default() };
    let wide = ImpactOscillator { gap: 0.0, ..at(45.0) };
    for (oscillator, n) in [(at(8.0), 1), (at(13.0), 1), (wide, 2)] {
        let (oscillator, orbit) = on_orbit(oscillator, n);
        let span = oscillator.period() * f64::from(n);
        let run = Run::by(&oscillator, "taylor", 1e-13, 10.0 * span);
        assert_eq!(run.events().len(), 10, "{orbit:?}");
        for (k, (t, speed)) in impacts(&run, &oscillator).into_iter().enumerate() {
            let late = (t - orbit.impact_time - span * k as f64).rem_euclid(oscillator.period());
            let late = late.min(oscillator.period() - late);
            let faster = (speed / orbit.impact_speed - 1.0).abs();
            // Measured: 8.9e-16 s and 2.4e-14.
            assert!(late < 8e-15 && faster < 2e-13, "{late:e} s, {faster:e}");
        }
    }
}

#[test]
fn the_stop_is_reached_above_the_grazing_amplitude_alone() {
    for frequency in [6.0, 10.0, 14.0] {
        let at = ImpactOscillator { frequency, ..ImpactOscillator::default() };
        for (factor, hits) in [(1.0 - 1e-9, false), (1.0 + 1e-9, true)] {
            let oscillator = ImpactOscillator { amplitude: factor * at.grazing_amplitude(), ..at };
            let [x, start_velocity] = oscillator.steady(0.0);
            let start_position = x - oscillator.gap;
            let oscillator = ImpactOscillator { start_position, start_velocity, ..oscillator };
            let run = Run::by(&oscillator, "taylor", 1e-13, 3.0 * oscillator.period());
            assert_eq!(!run.events().is_empty(), hits, "{frequency}: {factor}");
        }
    }
}

#[test]
fn two_speeds_of_impact_alternate_where_the_period_has_doubled() {
    let at = |frequency| ImpactOscillator { gap: 0.0, frequency, ..ImpactOscillator::default() };
    let last = |oscillator: &ImpactOscillator| {
        let run = Run::by(oscillator, "taylor", 1e-12, 200.0 * oscillator.period());
        let speeds: Vec<f64> = impacts(&run, oscillator).into_iter().map(|(_, v)| v).collect();
        [4, 3, 2, 1].map(|k| speeds[speeds.len() - k])
    };
    let [a, b, c, d] = last(&at(24.0));
    let orbit = at(24.0).periodic_orbits(1)[0];
    for speed in [a, b, c, d] {
        // Measured: 6.5e-14.
        assert!((speed / orbit.impact_speed - 1.0).abs() < 6e-13, "{speed}: {orbit:?}");
    }
    let [a, b, c, d] = last(&at(27.0));
    // Measured: 3.0e-13 m/s.
    assert!((a - c).abs().max((b - d).abs()) < 3e-12, "{a} {b} {c} {d}");
    assert!((a.max(b) - 0.49782).abs() < 1e-5 && (a.min(b) - 0.45054).abs() < 1e-5, "{a} {b}");
}

#[test]
fn impacts_under_a_pressing_load_end_at_the_stop_until_the_load_changes_its_sign() {
    let default = ImpactOscillator::default();
    let pressed = ImpactOscillator { amplitude: 20.0, frequency: 2.0, ..default };
    // k d/F = 1/2.
    let first = PI / 3.0 / pressed.frequency + pressed.period();
    for (name, run) in by_every_method(&pressed, 4.0 * pressed.period()) {
        let rests = run.events().iter().filter(|event| event.after == Next::Mode(Mode::AtStop));
        assert_eq!(rests.count(), 4, "{name}");
        let leaves = run.events().iter().filter(|event| event.before == Mode::AtStop);
        let leaves: Vec<f64> = leaves.map(|event| event.t).collect();
        assert_eq!(leaves.len(), 3, "{name}");
        for (k, t) in leaves.into_iter().enumerate() {
            // Measured: 1.8e-15 s.
            let late = (t - first - pressed.period() * k as f64).abs();
            assert!(late < 1.8e-14, "{name}: {late:e} s");
        }
    }
}

#[test]
fn a_plastic_stop_holds_the_mass_from_an_impact_until_the_load_changes_its_sign() {
    let plastic = ImpactOscillator {
        restitution: 0.0,
        amplitude: 20.0,
        frequency: 2.0,
        ..ImpactOscillator::default()
    };
    let run = Run::by(&plastic, "rk45", 1e-10, 4.0 * plastic.period());
    for pair in run.events().windows(2) {
        let is_pressed = plastic.load(pair[0].t) > 0.0;
        let held = pair[0].after == Next::Mode(Mode::AtStop);
        assert_eq!(held, pair[0].before == Mode::Free && is_pressed, "{pair:?}");
        if held {
            // Measured: 1.2e-13 N.
            let load = plastic.load(pair[1].t);
            assert!(load.abs() < 1e-12, "{load:e}");
        }
    }
}

#[test]
fn guard_bounds_are_above_zero_at_rest_in_every_mode() {
    let oscillator = ImpactOscillator { gap: 0.0, ..ImpactOscillator::default() };
    for mode in [Mode::Free, Mode::AtStop] {
        let mut bounds = [0.0];
        oscillator.guard_bounds(mode, 0.0, &[0.0, 0.0], &mut bounds);
        assert!(bounds[0] > 0.0, "{mode:?}");
    }
}

#[test]
fn the_energy_balances_with_what_the_impacts_take() {
    let oscillator = ImpactOscillator::default();
    let Balance { work, dissipated, residual, .. } =
        balance(&oscillator, "vern98", 1e-10, 20.0 * oscillator.period());
    assert!(residual.abs() < 1e-8 * work, "{residual:e} of {work} J");
    // Without damping the impacts alone take: all of the work but what is stored.
    let undamped = ImpactOscillator { damping: 0.0, ..oscillator };
    let own = balance(&undamped, "vern98", 1e-10, 20.0 * oscillator.period());
    assert!(own.residual.abs() < 1e-8 * own.dissipated, "{own:?}");
    assert!(own.dissipated > 0.0 && dissipated > 0.0);
}

#[test]
fn an_overdamped_mass_without_a_force_creeps_to_rest_as_in_closed_form() {
    let sets = ["mechanism=impact-oscillator", "impact_oscillator.damping=25"].map(str::to_owned);
    assert!(Config::load(None, &sets).is_ok());
    let creeping = ImpactOscillator {
        damping: 25.0,
        amplitude: 0.0,
        start_position: -0.2,
        ..ImpactOscillator::default()
    };
    // s² + 25 s + 100 = (s + 5)(s + 20).
    let t = 0.3;
    let (slow, fast) = (libm::exp(-5.0 * t), libm::exp(-20.0 * t));
    let x = -0.1 * (20.0 * slow - 5.0 * fast) / 15.0;
    let v = 10.0 * (slow - fast) / 15.0;
    for (name, run) in by_every_method(&creeping, t) {
        let off = distance(&creeping, &run.end.y, &[x - creeping.gap, v]);
        // Measured: 2.7e-8 (tr_bdf2).
        assert!(off < 2e-7, "{name}: {off:e}");
    }
}
