//! The exact run of a drawn system, by closed forms and bisection alone.
//!
//! Along an arc the extrema of a guard are known, so between two of them it is monotone and its
//! first root is found with certainty.

use std::f64::consts::{PI, TAU};

use crate::draw::{Drawn, Flow, Guard, Mode, T_END};

/// Most that a run may amplify an error of its start.
const AMPLIFICATION: f64 = 100.0;
/// Rounding of a guard at a state that is put on its surface.
const ON_SURFACE: f64 = 1e-12;
/// Most events of a run.
const MOST_EVENTS: usize = 60;
/// How far a run may go.
const FAR: f64 = 20.0;

/// Why a draw is set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Reason {
    /// A guard has an extremum within the margin of zero, or crosses at too small a rate.
    Grazes,
    /// Two guards fall within the margin of one another.
    Ties,
    /// A guard of the mode entered is within the margin of zero there, but not on its surface.
    EntersNear,
    /// A state is put on a surface and does not rise from it clearly.
    SlidesOrChatters,
    /// An event is within the margin of the end of the run.
    AtTheEnd,
    /// It goes farther than the guards were drawn for.
    RunsAway,
    /// More events than any run needs.
    TooMany,
    /// No event at all.
    Uneventful,
    /// Neighbouring starts give other events, or event times farther apart than the margin.
    IllConditioned,
}

/// An event of the exact run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact {
    pub(crate) t: f64,
    pub(crate) guard: usize,
    pub(crate) before: usize,
    pub(crate) after: usize,
    /// Time from here to where the guard would rise again if nothing switched.
    pub(crate) excursion: f64,
}

impl Flow {
    /// The state a time `t` after `y`.
    pub(crate) fn at(&self, t: f64, y: &[f64; 2]) -> [f64; 2] {
        match *self {
            Self::Spiral { centre, omega, zeta } => {
                let (sin, cos) = (omega * t).sin_cos();
                let (x, y, decay) = (y[0] - centre[0], y[1] - centre[1], (-zeta * t).exp());
                [centre[0] + decay * (cos * x - sin * y), centre[1] + decay * (sin * x + cos * y)]
            }
            Self::Node { centre, rates } => {
                std::array::from_fn(|i| centre[i] + (y[i] - centre[i]) * (-rates[i] * t).exp())
            }
            Self::Drift { slope } => std::array::from_fn(|i| y[i] + slope[i] * t),
        }
    }
}

/// A guard along the flow from a state.
pub(crate) struct Arc<'a> {
    pub(crate) flow: &'a Flow,
    pub(crate) guard: &'a Guard,
    pub(crate) start: [f64; 2],
}

impl Arc<'_> {
    /// The guard after a time `t`.
    pub(crate) fn value(&self, t: f64) -> f64 {
        self.guard.value(&self.flow.at(t, &self.start))
    }

    /// Its rate there.
    fn rate(&self, t: f64) -> f64 {
        let slope = self.flow.slope(&self.flow.at(t, &self.start));
        self.guard.normal[0] * slope[0] + self.guard.normal[1] * slope[1]
    }

    /// The times of its extrema in order, the last of them or `end` the first at or past `end`:
    /// between two of them, and from zero to the first, it is monotone.
    pub(crate) fn knots(&self, end: f64) -> impl Iterator<Item = f64> {
        let [n, m] = self.guard.normal;
        // The first extremum and the time between two.
        let (first, period) = match *self.flow {
            // g = C + A e^(−ζt) cos(ωt + φ) turns where tan(ωt + φ) = −ζ/ω.
            Flow::Spiral { centre, omega, zeta } => {
                let (x, y) = (self.start[0] - centre[0], self.start[1] - centre[1]);
                let phase = (n * y - m * x).atan2(n * x + m * y);
                let turn = (-(zeta / omega).atan() - phase).rem_euclid(PI);
                (turn / omega, PI / omega)
            }
            // g = C + p e^(−λt) + q e^(−μt) turns once, where λp e^(−λt) = −μq e^(−μt).
            Flow::Node { centre, rates: [a, b] } => {
                let p = a * n * (self.start[0] - centre[0]);
                let q = b * m * (self.start[1] - centre[1]);
                let turn = (-q / p).ln() / (b - a);
                (if turn > 0.0 { turn } else { f64::INFINITY }, f64::INFINITY)
            }
            Flow::Drift { .. } => (f64::INFINITY, f64::INFINITY),
        };
        let mut next = Some(first);
        std::iter::from_fn(move || {
            let knot = next?;
            next = (knot < end).then_some(knot + period);
            Some(if knot.is_finite() { knot } else { end })
        })
    }

    /// Where the guard falls from at or above zero below zero, between two knots.
    fn root(&self, mut above: f64, mut below: f64) -> f64 {
        loop {
            let middle = 0.5 * (above + below);
            if middle == above || middle == below {
                return below;
            }
            if (self.value(middle) >= 0.0) == (self.value(below) >= 0.0) {
                below = middle;
            } else {
                above = middle;
            }
        }
    }

    /// What the guard does until it falls or for a time `end`. One that starts on its surface is
    /// taken to rise from it.
    pub(crate) fn fall(&self, end: f64, margin: f64) -> Fall {
        let mut seen = Fall { at: None, grazes_at: f64::INFINITY, recovers_at: f64::INFINITY };
        let (mut t0, mut g0) = (0.0, self.value(0.0));
        for t1 in self.knots(end) {
            let g1 = self.value(t1);
            if seen.at.is_none() && g0 >= -ON_SURFACE && g1 < 0.0 && t1 > 0.0 {
                let at = self.root(t0, t1);
                if self.rate(at).abs() < margin.sqrt() {
                    seen.grazes_at = seen.grazes_at.min(at);
                }
                seen.at = Some(at);
            } else if seen.at.is_some() && g1 >= 0.0 {
                seen.recovers_at = self.root(t0, t1);
            }
            // A fall is as uncertain as the extremum that follows it.
            if g1.abs() < margin && t1 < end {
                seen.grazes_at = seen.grazes_at.min(seen.at.unwrap_or(t1));
            }
            if seen.recovers_at.is_finite() {
                break;
            }
            (t0, g0) = (t1, g1);
        }
        seen
    }
}

/// What a guard does along an arc.
pub(crate) struct Fall {
    pub(crate) at: Option<f64>,
    /// Where it first comes too near zero to tell whether it falls.
    pub(crate) grazes_at: f64,
    /// Where it rises again if nothing switches.
    pub(crate) recovers_at: f64,
}

impl Fall {
    /// When it falls; at infinity if it does not.
    pub(crate) fn time(&self) -> f64 {
        self.at.unwrap_or(f64::INFINITY)
    }
}

/// The guard of `mode` that falls first from `y` on, at the latest after `end`, and when.
pub(crate) fn first_fall<'m>(mode: &'m Mode, y: &[f64; 2], end: f64) -> Option<(f64, &'m Guard)> {
    let falls = mode.guards.iter().filter_map(|guard| {
        let arc = Arc { flow: &mode.flow, guard, start: *y };
        if arc.value(0.0) < -ON_SURFACE {
            return Some((0.0, guard));
        }
        Some((arc.fall(end, 0.0).at?, guard))
    });
    falls.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(t, _)| *t < end)
}

/// The events of the run from `y`, or why they cannot be told from those of its neighbours.
pub(crate) fn run(system: &Drawn, mut y: [f64; 2], margin: f64) -> Result<Vec<Exact>, Reason> {
    let (mut t, mut mode) = (0.0, 0);
    let mut entered_by: Option<&Guard> = None;
    let mut events: Vec<Exact> = Vec::new();
    loop {
        if events.len() > MOST_EVENTS {
            return Err(Reason::TooMany);
        }
        if y[0].abs().max(y[1].abs()) > FAR {
            return Err(Reason::RunsAway);
        }
        let end = T_END - t;
        let Mode { flow, guards } = &system.modes[mode];
        let arcs: Vec<Arc<'_>> = guards.iter().map(|guard| Arc { flow, guard, start: y }).collect();
        for arc in &arcs {
            let g = arc.value(0.0).abs();
            let is_put = entered_by.is_some_and(|guard| guard.puts_at_or_above(arc.guard));
            if g < ON_SURFACE && is_put && arc.rate(0.0) < margin.sqrt() {
                return Err(Reason::SlidesOrChatters);
            }
            if g < margin && !(is_put && g < ON_SURFACE) {
                return Err(Reason::EntersNear);
            }
        }
        let (dt, guard, excursion) =
            if let Some(i) = arcs.iter().position(|arc| arc.value(0.0) < -ON_SURFACE) {
                (0.0, i, f64::INFINITY)
            } else {
                let mut falls: Vec<(usize, Fall)> =
                    arcs.iter().map(|arc| arc.fall(end + margin, margin)).enumerate().collect();
                falls.sort_by(|a, b| a.1.time().total_cmp(&b.1.time()));
                let first = falls.first().map_or(f64::INFINITY, |(_, fall)| fall.time());
                if falls.iter().any(|(_, fall)| fall.grazes_at < first.min(end) + margin) {
                    return Err(Reason::Grazes);
                }
                if (first - end).abs() < margin {
                    return Err(Reason::AtTheEnd);
                }
                if first > end {
                    break;
                }
                if falls.get(1).is_some_and(|(_, second)| second.time() < first + margin) {
                    return Err(Reason::Ties);
                }
                (first, falls[0].0, falls[0].1.recovers_at - first)
            };
        (t, y) = (t + dt, flow.at(dt, &y));
        y = guards[guard].after(&y);
        entered_by = Some(&guards[guard]);
        let after = guards[guard].next;
        events.push(Exact { t, guard, before: mode, after, excursion });
        if events.len() > 16 && events[events.len() - 16].t == t {
            return Err(Reason::SlidesOrChatters);
        }
        mode = after;
    }
    if events.is_empty() { Err(Reason::Uneventful) } else { Ok(events) }
}

/// The events of `system`, where those of starts `error` off in four directions are the same
/// within the margin, and the most by which event times grow that error.
pub(crate) fn events(system: &Drawn, error: f64) -> Result<Vec<Exact>, Reason> {
    let margin = AMPLIFICATION * error;
    let exact = run(system, system.start, margin)?;
    let mut most = 0.0_f64;
    for k in 0..4 {
        let (sin, cos) = (TAU * (f64::from(k) + 0.5) / 4.0).sin_cos();
        let near =
            run(system, [system.start[0] + error * cos, system.start[1] + error * sin], margin)?;
        let key = |e: &Exact| (e.guard, e.before, e.after);
        if !near.iter().map(key).eq(exact.iter().map(key)) {
            return Err(Reason::IllConditioned);
        }
        for (near, exact) in near.iter().zip(&exact) {
            most = most.max((near.t - exact.t).abs() / error);
        }
    }
    if most > AMPLIFICATION { Err(Reason::IllConditioned) } else { Ok(exact) }
}
