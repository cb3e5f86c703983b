//! Guards that move faster than the states.

use deltazero_solvers::{Control, Next, Outcome, Real, System, Tolerance};

use crate::log::{Setting, run, settings_with};

/// `ẋ = 1, ż = 0` with the guard `level + sin(ω t + φ)` where that is above zero, and with its negative where it is below.
struct Hum {
    omega: f64,
    phase: f64,
    level: f64,
}

impl System for Hum {
    /// Whether the sum is above zero, and the number of events.
    type Mode = (bool, u32);
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, _y: &[f64; 2]) -> (bool, u32) {
        ((t * self.omega + self.phase).sin() + self.level >= 0.0, 0)
    }

    fn rhs<S: Real>(&self, _: (bool, u32), _t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(1.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, (is_high, _): (bool, u32), t: S, _y: &[S; 2], g: &mut [S; 1]) {
        let value = (t * self.omega + self.phase).sin() + self.level;
        *g = [if is_high { value } else { -value }];
    }

    fn guard_bounds(&self, _: (bool, u32), t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [4.0 * f64::EPSILON * (2.0 + (self.omega * t).abs())];
    }

    fn transition<S: Real>(
        &self,
        (is_high, n): (bool, u32),
        _guard: usize,
        _t: S,
        _y: &mut [S; 2],
    ) -> Next<(bool, u32)> {
        Next::Mode((!is_high, n + 1))
    }
}

impl Hum {
    /// The times in `0 < t < t_end` at which the sum is zero.
    fn events(&self, t_end: f64) -> Vec<f64> {
        let a = self.level.asin();
        let (tau, pi) = (std::f64::consts::TAU, std::f64::consts::PI);
        let mut times = Vec::new();
        let mut n = -2.0;
        while tau * n - pi < self.omega * t_end + tau {
            // sin(s) = −level at s = π + a, falling, and at s = 2π − a, rising.
            times.push((pi + a + tau * n - self.phase) / self.omega);
            times.push((tau - a + tau * n - self.phase) / self.omega);
            n += 1.0;
        }
        times.retain(|t| *t > 0.0 && *t < t_end);
        times
    }
}

/// Asserts that a run to `t_end` has the events of `hum`.
fn expect(hum: &Hum, setting: &Setting, t_end: f64) {
    let (log, outcome, ..) = run(hum, setting, (0.0, [0.0; 2]), t_end);
    let Hum { omega, phase, level } = hum;
    let what =
        format!("{} {:?}: ω = {omega}, φ = {phase}, level {level}", setting.0.name, setting.1);
    assert_eq!(outcome, Ok(Outcome::Finished), "{what}");
    let (times, expected) = (log.times(), hum.events(t_end));
    assert_eq!(times.len(), expected.len(), "{what}");
    for (t, expected) in times.iter().zip(expected) {
        assert!((t - expected).abs() < 1e-6 / omega, "{what}: {t} for {expected}");
    }
}

/// Every method, with fixed steps of a quarter and with tolerances.
fn all_settings() -> Vec<Setting> {
    let mut settings = settings_with(0.25);
    for rtol in [1e-6, 1e-10] {
        let control = Control::Adaptive(Tolerance { rtol, atol: vec![rtol; 2] });
        settings.extend(
            settings_with(1.0)
                .into_iter()
                .filter(|(_, with)| matches!(with, Control::Adaptive(_)))
                .map(|(method, _)| (method, control.clone())),
        );
    }
    settings
}

#[test]
fn a_guard_that_turns_while_the_states_rest_is_followed() {
    let hum = Hum { omega: 1000.0, phase: 0.0, level: 0.0 };
    assert_eq!(hum.events(2.0).len(), 636);
    for setting in all_settings() {
        expect(&hum, &setting, 2.0);
    }
}

#[test]
fn dips_of_a_guard_that_turns_while_the_states_rest_are_found() {
    for k in 0..200_u32 {
        let fraction = |ratio: f64| (f64::from(k) * ratio).fract();
        let hum = Hum {
            // From 1 to 1000, the dips from one down to 1e-9 deep.
            omega: 1000.0_f64.powf(fraction(0.618_034)),
            phase: std::f64::consts::TAU * fraction(0.754_878),
            level: 1.0 - 1e-9_f64.powf(fraction(0.569_840)),
        };
        for setting in all_settings() {
            expect(&hum, &setting, 1.0);
        }
    }
}

/// `ẋ = 1, ż = 0` with the guard `1/2 − 1/(1 + ((t − 5)/w)²)`, far from its surface but for a time of 2 w about 5.
struct Peak {
    w: f64,
}

impl System for Peak {
    type Mode = bool;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> bool {
        false
    }

    fn rhs<S: Real>(&self, _: bool, _t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(1.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, is_high: bool, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        let s = (y[0] - 5.0) / self.w;
        let below = -(S::cst(1.0) / (s * s + 1.0)) + 0.5;
        *g = [if is_high { -below } else { below }];
    }

    fn guard_bounds(&self, _: bool, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [4.0 * f64::EPSILON * (1.0 + 5.0 / self.w)];
    }

    fn transition<S: Real>(&self, is_high: bool, _: usize, _: S, _: &mut [S; 2]) -> Next<bool> {
        Next::Mode(!is_high)
    }
}

#[test]
fn a_series_that_ends_before_the_step_does_tells_nothing_of_its_guard() {
    for (method, control) in settings_with(0.25) {
        if method.name != "taylor" {
            continue;
        }
        for w in [1.0, 0.3, 0.1, 0.03, 0.01, 1e-3] {
            let setting = (method, control.clone());
            let (log, outcome, ..) = run(&Peak { w }, &setting, (0.0, [0.0; 2]), 10.0);
            assert_eq!(outcome, Ok(Outcome::Finished), "{w}");
            let times = log.times();
            assert_eq!(times.len(), 2, "{control:?}, {w}: {times:?}");
            let late = (times[0] - 5.0 + w).abs().max((times[1] - 5.0 - w).abs());
            assert!(late < 1e-12, "{control:?}, {w}: {late:e}");
        }
    }
}
