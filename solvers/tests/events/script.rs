//! A hybrid system written as data, so that a rule's case is one line.

use std::fmt::Debug;

use deltazero_solvers::{Alike, Next, Outcome, Over, Real, System};

use crate::common::at_most;
use crate::log::{ROUNDING, run, settings};

/// A system of modes written as data: `ẋ = 1`, `ż = q_mode(x)`, guards `p(x) + a z`.
pub(crate) struct Script {
    /// Coefficients of each mode's `q`, of 1, x, x², …
    pub(crate) rate: Vec<Vec<f64>>,
    pub(crate) guards: Vec<Vec<Guard>>,
}

/// One guard of a [`Script`], and what follows it.
#[derive(Clone)]
pub(crate) struct Guard {
    /// Coefficients of `p`, of 1, x, x², …
    pub(crate) p: Vec<f64>,
    /// Coefficient of z.
    pub(crate) a: f64,
    /// Mode that follows.
    pub(crate) next: Next<usize>,
    /// What z is set to, if it is.
    pub(crate) z: Option<f64>,
}

/// `p(x) + a z`, followed by mode `next`.
pub(crate) fn guard(p: &[f64], a: f64, next: usize) -> Guard {
    Guard { p: p.to_vec(), a, next: Next::Mode(next), z: None }
}

/// `z` itself, followed by mode `next` with z set to `z`.
pub(crate) fn floor(next: usize, z: f64) -> Guard {
    Guard { z: Some(z), ..guard(&[0.0], 1.0, next) }
}

/// A guard that a mode does not use.
pub(crate) fn unused() -> Guard {
    guard(&[1.0], 0.0, 0)
}

/// A script without z, one guard a mode, mode `i` followed by `i + 1`, the last one unguarded.
pub(crate) fn chain(guards: &[&[f64]]) -> Script {
    let mut all: Vec<Vec<Guard>> = Vec::new();
    for (i, p) in guards.iter().enumerate() {
        all.push(vec![guard(p, 0.0, i + 1)]);
    }
    all.push(vec![unused()]);
    Script { rate: vec![vec![]; all.len()], guards: all }
}

/// The polynomial with the coefficients `c` of 1, x, x², …
fn polynomial<S: Over<C>, C: Copy>(c: &[C], x: S) -> S {
    c.iter().rev().fold(S::cst(0.0), |p, c| p * x + *c)
}

impl System for Script {
    type Mode = usize;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = Vec<S>;

    fn n_guards(&self) -> usize {
        self.guards[0].len()
    }

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> usize {
        0
    }

    fn rhs<S: Real>(&self, mode: usize, _t: S, &[x, _]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(1.0), polynomial(&self.rate[mode], x)];
    }

    fn guards<S: Real>(&self, mode: usize, _t: S, &[x, z]: &[S; 2], g: &mut Vec<S>) {
        for (g, guard) in g.iter_mut().zip(&self.guards[mode]) {
            *g = polynomial(&guard.p, x) + z * guard.a;
        }
    }

    fn guard_bounds(&self, mode: usize, _t: f64, &[x, z]: &[f64; 2], bounds: &mut Vec<f64>) {
        for (bound, guard) in bounds.iter_mut().zip(&self.guards[mode]) {
            let size = guard.p.iter().rev().fold(0.0, |p, c| p * x.abs() + c.abs());
            *bound = 8.0 * f64::EPSILON * (size + (guard.a * z).abs()) + f64::MIN_POSITIVE;
        }
    }

    fn transition<S: Real>(&self, mode: usize, guard: usize, _t: S, y: &mut [S; 2]) -> Next<usize> {
        let guard = &self.guards[mode][guard];
        if let Some(z) = guard.z {
            y[1] = S::cst(z);
        }
        guard.next
    }
}

/// Numbers of a guard among the parameters, of which the first two guards are the first: two coefficients of `p`, and
/// `a`. The rate follows.
const OF_GUARD: usize = 3;

/// Scripts differ in coefficients alone in modes of up to two guards that are linear in x.
impl Alike for Script {
    type Parameters<C: Copy + Debug> = Vec<C>;

    fn parameters(&self, mode: &usize) -> Option<Vec<f64>> {
        let guards = &self.guards[*mode];
        if guards.len() > 2 || guards.iter().any(|guard| guard.p.len() > 2) {
            return None;
        }
        let of_guard = |i: usize| {
            let (p, a) = guards.get(i).map_or((&[][..], 0.0), |guard| (&guard.p, guard.a));
            [p.first().copied().unwrap_or(0.0), p.get(1).copied().unwrap_or(0.0), a]
        };
        let mut parameters = [of_guard(0), of_guard(1)].concat();
        let longest = self.rate.iter().map(Vec::len).max()?;
        parameters.extend(&self.rate[*mode]);
        parameters.resize(2 * OF_GUARD + longest, 0.0);
        Some(parameters)
    }

    fn rhs_of<S: Over<C>, C: Copy + Debug>(
        of: &Vec<C>,
        _t: S,
        &[x, _]: &[S; 2],
        dydt: &mut [S; 2],
    ) {
        *dydt = [S::cst(1.0), polynomial(&of[2 * OF_GUARD..], x)];
    }

    fn guards_of<S: Over<C>, C: Copy + Debug>(
        of: &Vec<C>,
        _t: S,
        &[x, z]: &[S; 2],
        g: &mut Vec<S>,
    ) {
        for (g, guard) in g.iter_mut().zip(of.chunks(OF_GUARD)) {
            *g = polynomial(&guard[..2], x) + z * guard[2];
        }
    }
}

/// The event times of `script` from x = t = 0 with every method must be `expected`.
pub(crate) fn expect_events(script: &Script, t_end: f64, expected: &[f64]) {
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, t, [x, _]) = run(script, &setting, (0.0, [0.0, 0.0]), t_end);
        assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
        assert_eq!(t, t_end, "{name}");
        // Measured: 1.1e-15 for ours, 2.5e-14 for those of diffsol, which add up their steps.
        at_most("state at the end", (x - t).abs(), ROUNDING);
        let times = log.times();
        assert_eq!(times.len(), expected.len(), "{name}: {times:?}");
        for (t, expected) in times.iter().zip(expected) {
            // Measured: 2.9e-15, and 1.4e-14 for a dip.
            at_most("event time", (t - expected).abs(), 1e-13);
        }
    }
}
