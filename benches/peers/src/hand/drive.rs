//! The loop over time: step, control, events, samples.

use deltazero_solvers::root::{Bracket, find_root, minimum};
use deltazero_study::run::ModeChange;

use super::joint::{Joint, Mode, Y};
use crate::problem::Track;

/// Constants of the controller, DOPRI5's: safety, β, least and greatest change, floor of ln err.
const SAFETY: f32 = 0.9;
const BETA: f32 = 0.04;
const SHRINK: f32 = 0.2;
const GROWTH: f32 = 10.0;
const LOG_ERROR_FLOOR: f32 = -9.210_340_4;
/// A last step is stretched by up to this factor.
const STRETCH: f64 = 1.01;
/// First step [s].
const FIRST_STEP: f64 = 1e-6;
/// A run with more events than this chatters.
const MAX_EVENTS: usize = 10_000;
/// See `deltazero_solvers::event_location`.
const NEAR: f64 = 0.25;
/// Fraction of a step to which dense output predicts an event.
const PREDICTION: f64 = 1e-9;

/// A pair: one attempted step from `y0` with `k[0]` its slope.
pub(crate) trait Pair {
    /// Order of the error estimate, for the controller.
    const ERROR_ORDER: f32;
    /// Right-hand sides of an attempt, of its completion, and of dense output.
    const COST: [u64; 3];

    /// The memory of a step from `y0` with `slope0`.
    fn new(y0: Y, slope0: Y) -> Self;
    /// Starts anew.
    fn restart(&mut self, y0: Y, slope0: Y);
    /// Takes a step `h` to [`y1`](Self::y1).
    fn attempt(&mut self, joint: &Joint, mode: Mode, h: f64);
    /// Square of the weighted norm of its local error.
    fn error_sq(&self, rtol: f64, atol: &Y) -> f64;
    /// Makes [`slope1`](Self::slope1) valid.
    fn complete(&mut self, joint: &Joint, mode: Mode);
    /// Makes [`interpolate`](Self::interpolate) valid.
    fn densify(&mut self, joint: &Joint, mode: Mode);
    /// State at `θ` in the step.
    fn interpolate(&self, theta: f64) -> Y;
    /// State at the end.
    fn y1(&self) -> &Y;
    /// Slope at the end.
    fn slope1(&self) -> &Y;
}

/// A run of one joint from `start` over `times`, the last of which ends it.
///
/// # Errors
/// Where events or rejections do not end, as happens at loose tolerances.
pub(crate) fn run<P: Pair>(
    joint: &Joint,
    start: Y,
    times: &[f64],
    rtol: f64,
    atol: &Y,
) -> Result<Track, String> {
    let mut mode = joint.first_mode(&start);
    let t_end = times[times.len() - 1];
    let slope = joint.rhs(mode, &start);
    let mut events = vec![ModeChange::new(0.0, 0, mode.code())];
    let mut samples = Vec::with_capacity(times.len());
    let mut drive = Drive {
        joint,
        pair: P::new(start, slope),
        n_rhs: 1,
        start: joint.guards(mode, &start, &slope),
        disproved: [false; 2],
    };
    let alpha = 1.0 / P::ERROR_ORDER - 0.75 * BETA;
    let (mut log_last, mut rejected) = (LOG_ERROR_FLOOR, false);
    let (mut t, mut h) = (0.0, FIRST_STEP);
    while t < t_end {
        let t1 = if t_end - t <= STRETCH * h { t_end } else { t + h };
        let mut taken = t1 - t;
        if taken.is_nan() || taken <= 0.0 || events.len() > MAX_EVENTS {
            return Err(format!("no progress at t = {t} s"));
        }
        drive.attempt(mode, taken);
        let error_sq = drive.pair.error_sq(rtol, atol);
        let log_error = 0.5 * (error_sq as f32).ln();
        if error_sq <= 1.0 {
            let factor = SAFETY * (BETA * log_last - alpha * log_error).exp();
            h = taken * f64::from(factor.clamp(SHRINK, if rejected { 1.0 } else { GROWTH }));
            (log_last, rejected) = (log_error.max(LOG_ERROR_FLOOR), false);
        } else {
            let factor = SAFETY * (-log_error / P::ERROR_ORDER).exp();
            // An error that is not a number shrinks the step too.
            h = taken * f64::from(if factor > SHRINK { factor.min(1.0) } else { SHRINK });
            rejected = true;
            continue;
        }
        drive.complete(mode);
        let mut is_dense = false;
        let end = joint.guards(mode, drive.pair.y1(), drive.pair.slope1());
        let landed_on = if drive.is_far(&end, 0, taken) && drive.is_far(&end, 1, taken) {
            None
        } else {
            is_dense = true;
            drive.locate(mode, &mut taken, &end)
        };
        let t1 = if landed_on.is_some() { t + taken } else { t1 };
        while let Some(&at) = times.get(samples.len()).filter(|&&at| at <= t1) {
            if at == t1 {
                samples.push(*drive.pair.y1());
                continue;
            }
            if !is_dense || landed_on.is_some() {
                // What sampling costs is no part of the work.
                drive.pair.densify(joint, mode);
                is_dense = true;
            }
            samples.push(drive.pair.interpolate((at - t) / taken));
        }
        t = t1;
        let y1 = *drive.pair.y1();
        match landed_on {
            None => {
                let slope1 = *drive.pair.slope1();
                drive.pair.restart(y1, slope1);
                drive.start = end;
            }
            Some(guard) => {
                let after = joint.after(mode, guard, &y1);
                events.push(ModeChange::new(t, mode.code(), after.code()));
                mode = after;
                let slope = joint.rhs(mode, &y1);
                drive.n_rhs += 1;
                drive.pair.restart(y1, slope);
                drive.start = joint.guards(mode, &y1, &slope);
            }
        }
    }
    Ok(Track { samples, events, n_rhs: Some(drive.n_rhs) })
}

struct Drive<'a, P> {
    joint: &'a Joint,
    pair: P,
    n_rhs: u64,
    /// Guards and their rates at the start of the step.
    start: [[f64; 2]; 2],
    /// Guards whose dip inside the step was the interpolant's alone.
    disproved: [bool; 2],
}

impl<P: Pair> Drive<'_, P> {
    fn attempt(&mut self, mode: Mode, h: f64) {
        self.pair.attempt(self.joint, mode, h);
        self.n_rhs += P::COST[0];
    }

    fn complete(&mut self, mode: Mode) {
        self.pair.complete(self.joint, mode);
        self.n_rhs += P::COST[1];
    }

    /// Whether guard `i` is seen from both ends not to fall.
    fn is_far(&self, [g1, rate1]: &[[f64; 2]; 2], i: usize, h: f64) -> bool {
        let [g0, rate0] = &self.start;
        let rise = g1[i] - g0[i];
        let bend = (rate0[i] * h - rise).abs() + (rate1[i] * h - rise).abs();
        g0[i].min(g1[i]) > (1.0 + NEAR) * 4.0 / 27.0 * bend + NEAR * rise.abs()
    }

    /// Lands on the guard that falls first, if one does; `h` is then the step that ends there.
    fn locate(&mut self, mode: Mode, h: &mut f64, end: &[[f64; 2]; 2]) -> Option<usize> {
        self.disproved = [false; 2];
        let whole = *h;
        loop {
            self.pair.densify(self.joint, mode);
            self.n_rhs += P::COST[2];
            let (guard, at, violated_at) = self.first_to_fall(mode, whole, end)?;
            if violated_at != 1.0 && self.retake(mode, violated_at * whole).is_none() {
                self.retake(mode, whole);
                self.disproved[guard] = true;
                continue;
            }
            let bracket = Bracket { above: 0.0, below: violated_at * whole };
            let landed;
            (landed, *h) = self.land(mode, guard, at * whole, bracket);
            return Some(landed);
        }
    }

    /// The guard that falls first, where (as a part of the step), and where it is violated.
    fn first_to_fall(
        &self,
        mode: Mode,
        h: f64,
        [g1, rate1]: &[[f64; 2]; 2],
    ) -> Option<(usize, f64, f64)> {
        let [g0, rate0] = &self.start;
        let bounds = self.joint.bounds(self.pair.y1());
        let mut first: Option<(usize, f64, f64)> = None;
        for i in 0..2 {
            let clearance = |theta: f64| {
                let y = self.pair.interpolate(theta);
                self.joint.guards(mode, &y, &y)[0][i] + 0.5 * bounds[i]
            };
            let dip = || {
                let (theta, least) = cubic_minimum([g0[i], g1[i]], [rate0[i] * h, rate1[i] * h])?;
                let depth = g0[i].max(g1[i]) - least;
                if self.disproved[i] || least > NEAR * depth {
                    return None;
                }
                let (theta, least) =
                    minimum(|theta| clearance(theta) + 0.5 * bounds[i], [0.0, theta, 1.0]);
                (least < 0.0).then_some(theta)
            };
            let violated_at = match dip() {
                Some(theta) => theta,
                None if g1[i] < -bounds[i] => 1.0,
                None => continue,
            };
            let bracket = Bracket { above: 0.0, below: violated_at };
            let at = find_root(clearance, bracket, PREDICTION);
            if first.is_none_or(|(_, earliest, _)| at < earliest) {
                first = Some((i, at, violated_at));
            }
        }
        first
    }

    /// Retakes the step until it ends just past the surface.
    fn land(
        &mut self,
        mode: Mode,
        mut guard: usize,
        mut h: f64,
        mut bracket: Bracket,
    ) -> (usize, f64) {
        let mut n = 0;
        loop {
            h = bracket.inside(h);
            let closed = bracket.is_closed();
            if closed {
                h = bracket.below;
            }
            let violated = self.retake(mode, h);
            let [g, rates] = self.joint.guards(mode, self.pair.y1(), self.pair.slope1());
            if closed || (violated.is_none() && g[guard] <= 0.0) {
                return (violated.unwrap_or(guard), h);
            }
            bracket.narrow(h, if violated.is_some() { -1.0 } else { 1.0 });
            let bounds = self.joint.bounds(self.pair.y1());
            let change = |i: usize| -(g[i] + 0.5 * bounds[i]) / rates[i];
            guard = violated.unwrap_or(guard);
            let other = 1 - guard;
            if g[other] < -bounds[other] && change(other).abs() > change(guard).abs() {
                guard = other;
            }
            h += change(guard);
            n += 1;
            if n > 8 && n % 2 == 0 {
                h = bracket.middle();
            }
        }
    }

    /// Takes the step again with the size `h`; the first guard violated at its end.
    fn retake(&mut self, mode: Mode, h: f64) -> Option<usize> {
        self.attempt(mode, h);
        self.complete(mode);
        let y1 = self.pair.y1();
        let ([g, _], bounds) = (self.joint.guards(mode, y1, y1), self.joint.bounds(y1));
        (0..2).find(|&i| g[i] < -bounds[i])
    }
}

/// Where in (0, 1) the cubic with these values and slopes is least, and its value there.
fn cubic_minimum([g0, g1]: [f64; 2], [s0, s1]: [f64; 2]) -> Option<(f64, f64)> {
    let rise = g1 - g0;
    let (c2, c3) = (3.0 * rise - 2.0 * s0 - s1, s0 + s1 - 2.0 * rise);
    let discriminant = c2 * c2 - 3.0 * c3 * s0;
    if discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let theta = if c2 > 0.0 { -s0 / (c2 + root) } else { (root - c2) / (3.0 * c3) };
    let inside = theta > 0.0 && theta < 1.0;
    inside.then_some((theta, g0 + theta * (s0 + theta * (c2 + theta * c3))))
}
