//! Guards that come so near their surface that the error of the method may decide whether they fall.

use num_dual::Dual64;

use super::shape::cubic_top;
use super::{GuardWatch, along_flow, is_far, turns_above};
use crate::real::Real;
use crate::record::Grazing;
use crate::root::minimum;
use crate::step::Step;
use crate::system::{System, Vector};

/// Errors add up along a run: a state is taken to be wrong by up to this many times what is allowed in one step. The
/// error of methods that extrapolate was 65 times that at most (bs32), over 12 units of time of the guards of
/// `tests/grazing`.
pub(crate) const STEPS: f64 = 100.0;
/// The dip after an event is looked at where its least value would come within this many steps. A step of order one may
/// be as short as the square root of the tolerance, and a dip within [that many](STEPS) tolerances lasts 28 of them.
const SOON: f64 = 20.0;
/// A turn within a step is looked at where the guard is below this many times its error as found last: that error may
/// grow along a run.
const LOW: f64 = 10.0;
/// Fraction of the step within which a minimum may be that of an end.
const BESIDE: f64 = 1.0 / 16.0;
/// Turns of a guard that are looked at in a step; one that is held near its surface may have very many in its rounding.
const MOST_TURNS: usize = 100;
/// Steps shorter than this fraction of the time are not looked at: their inside is rounded.
const RESOLVED: f64 = 1e3 * f64::EPSILON;
/// The lowest point of a dip is looked for in strides that begin with this fraction of the step.
const NEXT: f64 = 1e-6;
/// The curvature at an event is the change of the rate over this fraction of a full step, or less.
const LOCAL: f64 = 1e-4;

/// A guard within the error of the method of its surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Graze {
    pub(crate) guard: usize,
    /// Where it is least, or the time of the event.
    pub(crate) t: f64,
    /// How far it falls below zero.
    pub(crate) depth: f64,
    /// What the error of the method may change it by.
    pub(crate) error: f64,
    pub(crate) is_event: bool,
}

impl Graze {
    /// As a recorder is told of it.
    pub(crate) fn in_mode<M>(self, mode: M) -> Grazing<M> {
        let Self { guard, t, depth, error, is_event } = self;
        Grazing { t, mode, guard, depth, error, is_event }
    }
}

impl<P: System> GuardWatch<P> {
    /// Notes that the guards of the present step are searched by other means than their cubics.
    pub(crate) fn note_searched(&mut self) {
        (self.is_near, self.knows_strays) = (true, false);
    }

    /// Whether guards were searched on the step that is accepted, because they are not far from their surfaces.
    #[inline(always)]
    pub(crate) fn came_near(&mut self) -> bool {
        std::mem::take(&mut self.is_near)
    }

    /// Whether a guard may graze in the accepted `step`, which landed on the given guard or on none: one may turn near its
    /// surface, or falls by so little that it would rise soon. A full step has the size `h`.
    pub(crate) fn may_graze(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &(impl Step<P::State<f64>> + ?Sized),
        landed_on: Option<usize>,
        h: f64,
    ) -> bool {
        self.forget_dips();
        self.start_at(problem, mode.clone(), step.t0(), step.y0(), step.slope0());
        self.rates(problem, mode.clone(), step.t1(), step.y1(), step.slope1());
        if !self.knows_strays {
            self.find_strays(problem, mode.clone(), step);
        }
        let length = step.t1() - step.t0();
        if length.abs() < RESOLVED * step.t1().abs() {
            return false;
        }
        (0..self.end.as_ref().len()).any(|guard| self.turns_near(guard, length))
            || landed_on.is_some_and(|guard| {
                self.strays[guard]
                    || self.rises_soon(problem, mode, (step.t1(), step.y1()), guard, h)
            })
    }

    /// Whether guard `i` may turn near its surface within a step of size `h`, the one that was searched or a part of it.
    fn turns_near(&self, i: usize, h: f64) -> bool {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let (from, to) = ([g0.re, g0.eps], [g1.re, g1.eps]);
        self.strays[i]
            || !is_far(from, to, h) && !self.holds(i, h)
            || g0.eps * h < 0.0 && !turns_above(from, to, h, self.lows.as_ref()[i])
    }

    /// Has the heights below which a guard turns low found anew.
    pub(crate) fn forget_lows(&mut self) {
        self.lows.as_mut().fill(f64::INFINITY);
    }

    /// Heights below which a guard that turns on a step is near its surface.
    pub(crate) fn lows(&self) -> &P::Guards<f64> {
        &self.lows
    }

    /// Whether guard `i`, which falls at `(t, y)`, rises again within [some steps](SOON) of size `h` by its curvature
    /// there. False where a rate is not finite.
    fn rises_soon(
        &mut self,
        problem: &P,
        mode: P::Mode,
        at: (f64, &P::State<f64>),
        i: usize,
        h: f64,
    ) -> bool {
        let [rate, curvature] = self.bent(problem, mode, at, i, LOCAL * h);
        curvature > 0.0 && rate.abs() < curvature * SOON * h.abs()
    }

    /// The rate of guard `i` at `(t, y)`, and its curvature over a time `short` from there along the flow.
    fn bent(
        &mut self,
        problem: &P,
        mode: P::Mode,
        (t, y): (f64, &P::State<f64>),
        i: usize,
        short: f64,
    ) -> [f64; 2] {
        let ahead = t + short;
        let mut slope = y.clone();
        self.y.clone_from(y);
        let [rate, next] = [t, ahead].map(|time| {
            // The slopes of a step may be those of an interpolant.
            problem.rhs(mode.clone(), time, &self.y, &mut slope);
            let mut g = self.end.clone();
            along_flow(problem, mode.clone(), time, &self.y, &slope, &mut g);
            for (y, slope) in self.y.as_mut().iter_mut().zip(slope.as_ref()) {
                *y += (ahead - t) * slope;
            }
            g.as_ref()[i].eps
        });
        [rate, (next - rate) / (ahead - t)]
    }

    /// Tells `told` of the guards that graze in a step that [may have such](Self::may_graze), whose dense output is
    /// complete; a full step has the size `h`. `error` is the error that the run may have made in a state. A guard that
    /// stays near its surface, turning at most once in a step, is told once in a phase. Where the derivatives of a guard are
    /// not finite nothing is told of it.
    pub(crate) fn graze(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        (landed_on, h): (Option<usize>, f64),
        error: impl Fn(usize) -> f64,
        mut told: impl FnMut(Graze),
    ) {
        let (t0, t1) = (step.t0(), step.t1());
        let goes_on = std::mem::replace(&mut self.near_until, t1) == t0;
        self.doubt(problem, mode.clone(), step, error);
        self.look_at_quarters(problem, mode.clone(), step);
        self.evaluate(problem, mode.clone(), t1, step.y1());
        for guard in 0..self.end.as_ref().len() {
            let error = self.doubts.as_ref()[guard] + self.bounds.as_ref()[guard];
            if !error.is_finite() {
                continue;
            }
            self.lows.as_mut()[guard] = LOW * error;
            if landed_on == Some(guard) {
                let dip = self.depth_after(problem, mode.clone(), step, guard, (error, h));
                if let Some((t, depth)) = dip {
                    told(Graze { guard, t, depth, error, is_event: true });
                }
            }
            let mut stays = goes_on && self.grazes[guard] && self.start.as_ref()[guard].re <= error;
            self.grazes[guard] = stays;
            for _ in 0..MOST_TURNS {
                let turn = self.turn(problem, mode.clone(), step, guard, error);
                let Some((t, depth)) = turn else { break };
                if !std::mem::take(&mut stays) && depth.abs() <= error {
                    told(Graze { guard, t, depth, error, is_event: false });
                    self.grazes[guard] = true;
                }
                self.discard_dip(guard);
            }
        }
        self.forget_dips();
    }

    /// The time of the event of guard `i` at the end of `step`, and how far the guard would fall below zero by its curvature
    /// there, where that is at most `most`. A full step has the size `h`.
    fn depth_after(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        (most, h): (f64, f64),
    ) -> Option<(f64, f64)> {
        let t1 = step.t1();
        let Dual64 { re: g, eps, .. } = self.end.as_ref()[i];
        // A dip of that depth lasts twice as long.
        let short = (2.0 * most / eps.abs()).min(LOCAL * h.abs()).copysign(h);
        let [rate, curvature] = self.bent(problem, mode, (t1, step.y1()), i, short);
        let depth = 0.5 * rate * rate / curvature - g;
        // False where the time or a rate is not resolved.
        (curvature > 0.0 && depth <= most).then_some((t1, depth))
    }

    /// Begins the arcs of guards that rise at the start of a phase, in the direction of `span`.
    pub(crate) fn begin_arcs(&mut self, span: f64) {
        for (top, start) in self.tops.as_mut().iter_mut().zip(self.start.as_ref()) {
            *top = if start.eps * span > 0.0 { start.re } else { f64::INFINITY };
        }
    }

    /// Goes on with the arcs at the start of the next step.
    pub(crate) fn follow_arcs(&mut self) {
        for (top, start) in self.tops.as_mut().iter_mut().zip(self.start.as_ref()) {
            *top = top.max(start.re);
        }
    }

    /// How high guard `i` rose from the start of the phase to the end of a step that landed on it, by values at the ends
    /// of steps and the cubic on the last, and what an `error` of each state would change it by.
    pub(crate) fn arc(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        error: impl Fn(usize) -> f64,
    ) -> (f64, f64) {
        self.doubt(problem, mode, step, error);
        let h = step.t1() - step.t0();
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let top = cubic_top([g0.re, g1.re], [g0.eps * h, g1.eps * h]);
        (top.max(self.tops.as_ref()[i]), self.doubts.as_ref()[i])
    }

    /// The time at which guard `i` next turns below `height` in `step`, and how far it is below zero there.
    fn turn(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        height: f64,
    ) -> Option<(f64, f64)> {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        if !self.turns_near(i, h) {
            return None;
        }
        let bound = self.bounds.as_ref()[i];
        self.doubts.as_mut()[i] = -(height + bound);
        // A guard that cannot be followed was told by the search before.
        let strays = self.strays[i];
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let begins_below = self.disproved[i] == 0.0 && g0.re < height && g0.eps * h < 0.0;
        let dip = if strays && begins_below {
            // A march looks for falls from above.
            Some(0.0)
        } else if strays {
            self.march(problem, mode.clone(), step, i).ok()?.1
        } else {
            self.first_dip(problem, mode.clone(), step, i).ok()?.1
        };
        let dip = dip?;
        let mut clearance =
            |theta: f64| self.clearance_on(problem, mode.clone(), step, i, t0 + theta * h);
        let (theta, least) = if strays {
            // A march ends anywhere in the dip.
            lowest(clearance, dip, g1.eps * h >= 0.0)?
        } else {
            // A search between the ends does not reach them.
            let points = [dip, 0.0, 1.0].map(|theta| (theta, clearance(theta)));
            let is_beside = |point: &(f64, f64)| (point.0 - dip).abs() < BESIDE;
            points.into_iter().filter(is_beside).min_by(|a, b| a.1.total_cmp(&b.1))?
        };
        if strays {
            // The search goes on behind it, also where it is at the start.
            let from = if begins_below { f64::MIN_POSITIVE } else { self.deepest[i] };
            self.deepest[i] = from.max(theta);
        }
        Some((t0 + theta * h, 0.5 * bound - least))
    }

    /// Writes `Σ_j |∂g_i/∂y_j| error_j` at the end of `step` to `doubts`: a bound of the change of each guard by such
    /// errors of the states.
    pub(super) fn doubt(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        error: impl Fn(usize) -> f64,
    ) {
        let y = step.y1().as_ref();
        let mut g = self.end.clone();
        let span = problem.guard_span();
        self.doubts.as_mut().fill(0.0);
        for j in 0..span.min(y.len()) {
            let seeded = P::State::<Dual64>::from_fn(y.len(), |i| {
                Dual64::new(y[i], if i % span == j { error(i) } else { 0.0 })
            });
            problem.guards(mode.clone(), Dual64::cst(step.t1()), &seeded, &mut g);
            for (doubt, g) in self.doubts.as_mut().iter_mut().zip(g.as_ref()) {
                *doubt += g.eps.abs();
            }
        }
    }
}

/// The minimum of `f` and its value in the dip that contains `below`; `None` where it falls on to the start, or on to the
/// end of the step and does not rise there.
fn lowest(mut f: impl FnMut(f64) -> f64, below: f64, rises_at_end: bool) -> Option<(f64, f64)> {
    let (mut m, mut least, mut stride) = (below, f(below), NEXT);
    let [behind, ahead] = [(m - NEXT).max(0.0), (m + NEXT).min(1.0)];
    let (mut a, sign) = if f(ahead) < least {
        (behind, 1.0)
    } else if f(behind) < least {
        (ahead, -1.0)
    } else if m == ahead {
        return rises_at_end.then_some((m, least));
    } else {
        return Some((m, least));
    };
    while m != if sign > 0.0 { 1.0 } else { 0.0 } {
        let b = (m + sign * stride).clamp(0.0, 1.0);
        let next = f(b);
        if next >= least {
            return Some(minimum(f, if sign > 0.0 { [a, m, b] } else { [b, m, a] }));
        }
        (a, m, least, stride) = (m, b, next, 2.0 * stride);
    }
    // It may turn right beside the end.
    let inside = minimum(f, [a.min(m), 0.5 * (a + m), a.max(m)]);
    let at_end = (m == 1.0 && rises_at_end).then_some((m, least));
    if inside.1 < least { Some(inside) } else { at_end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_point_of_a_dip_is_found_and_no_other() {
        for turn in [0.001, 0.31, 0.4, 0.75, 0.99, 0.9999] {
            for below in [turn - 1e-4, turn, turn + 1e-4] {
                // It dips again at both ends, and deeper.
                let dips = |x: f64| (x - turn) * (x - turn) * (1.0 - 2.0 * (x - turn).abs());
                let found = lowest(dips, below, false);
                let (x, least) = found.unwrap_or((f64::NAN, f64::NAN));
                assert!((x - turn).abs() < 1e-4 && least < 1e-9, "{turn}: {found:?}");
            }
        }
        assert_eq!(lowest(|x| -x, 0.3, false), None);
        assert_eq!(lowest(|x| x, 0.3, false), None);
        assert_eq!(lowest(|x| (x - 2.0) * (x - 2.0), 0.3, false), None);
        assert_eq!(lowest(|x| (x - 1.0) * (x - 1.0), 0.3, true), Some((1.0, 0.0)));
    }
}
