//! Guards that come so near their surface that the error of the method may decide whether they fall.

use num_dual::Dual64;

use super::{GuardWatch, along_flow, is_far};
use crate::real::Real;
use crate::record::Grazing;
use crate::root::minimum;
use crate::step::Step;
use crate::system::{System, Vector};

/// Errors add up along a run: a state is taken to be wrong by up to this many times what is allowed in one step. The
/// error of methods that extrapolate was 65 times that at most (bs32), over 12 units of time of the guards of
/// `tests/grazing`.
pub(crate) const STEPS: f64 = 100.0;
/// The dip after an event is looked at where its least value would come within this many steps.
const SOON: f64 = 2.0;
/// The curvature at an event is the change of the rate over this fraction of the step, or less.
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
    /// Notes that the guards of the present step were searched, because they are not far from their surfaces.
    pub(crate) fn note_near(&mut self) {
        self.is_near = true;
    }

    /// Whether guards were searched since this was last asked.
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
        self.rates(problem, mode, step.t1(), step.y1(), step.slope1());
        let length = step.t1() - step.t0();
        let rises_soon = |guard: usize| self.strays[guard] || self.rises_in(guard, length, h);
        landed_on.is_some_and(rises_soon)
            || (0..self.end.as_ref().len()).any(|guard| self.turns_near(guard, length))
    }

    /// Whether guard `i` may turn near its surface within a step of size `h`, the one that was searched or a part of it.
    fn turns_near(&self, i: usize, h: f64) -> bool {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        self.strays[i] || !is_far([g0.re, g0.eps], [g1.re, g1.eps], h) && !self.holds(i, h)
    }

    /// Whether guard `i`, which falls at the end of a step of this `length`, rises again within [some steps](SOON) of size
    /// `h` by its mean curvature over the step. False where a rate is not finite.
    fn rises_in(&self, i: usize, length: f64, h: f64) -> bool {
        let (from, to) = (self.start.as_ref()[i].eps, self.end.as_ref()[i].eps);
        let curvature = (to - from) / length;
        curvature > 0.0 && to.abs() < curvature * SOON * h.abs()
    }

    /// Tells `told` of the guards that graze in a step that [may have such](Self::may_graze), whose dense output is
    /// complete. `error` is the error that the run may have made in a state. A guard that stays near its surface is told
    /// once in a phase.
    pub(crate) fn graze(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        landed_on: Option<usize>,
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
            if landed_on == Some(guard) {
                let dip = self.depth_after(problem, mode.clone(), step, guard, error);
                if let Some((t, depth)) = dip {
                    told(Graze { guard, t, depth, error, is_event: true });
                }
            }
            let mut stays = goes_on && self.grazes[guard] && self.start.as_ref()[guard].re <= error;
            self.grazes[guard] = stays;
            while let Some((t, depth)) = self.turn(problem, mode.clone(), step, guard, error) {
                if !std::mem::take(&mut stays) && depth.abs() <= error {
                    told(Graze { guard, t, depth, error, is_event: false });
                    self.grazes[guard] = true;
                }
                self.disprove_dip(guard);
            }
        }
        self.forget_dips();
    }

    /// The time of the event of guard `i` at the end of `step`, and how far the guard would fall below zero by its curvature
    /// there, where that is at most `most`.
    fn depth_after(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        most: f64,
    ) -> Option<(f64, f64)> {
        let (t1, length) = (step.t1(), step.t1() - step.t0());
        let Dual64 { re: g, eps, .. } = self.end.as_ref()[i];
        // A dip of that depth lasts twice as long.
        let short = (2.0 * most / eps.abs()).min(LOCAL * length.abs());
        let t = t1 - short.copysign(length);
        let [before, rate] = [t, t1].map(|t| {
            step.interpolate(t, &mut self.y);
            let (mut slope, mut g) = (self.y.clone(), self.end.clone());
            // The slopes of a step may be those of an interpolant.
            problem.rhs(mode.clone(), t, &self.y, &mut slope);
            along_flow(problem, mode.clone(), t, &self.y, &slope, &mut g);
            g.as_ref()[i].eps
        });
        let curvature = (rate - before) / (t1 - t);
        let depth = 0.5 * rate * rate / curvature - g;
        // False where the time or a rate is not resolved.
        (curvature > 0.0 && depth <= most).then_some((t1, depth))
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
        let (top, dip) = if strays {
            self.march(problem, mode.clone(), step, i).ok()?
        } else {
            self.first_dip(problem, mode.clone(), step, i).ok()?
        };
        let dip = dip?;
        let mut clearance =
            |theta: f64| self.clearance_on(problem, mode.clone(), step, i, t0 + theta * h);
        let (theta, least) = if strays {
            // A march ends anywhere in the dip.
            lowest(clearance, top, dip)?
        } else {
            (dip, clearance(dip))
        };
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

/// The minimum of `f` and its value, a function that falls from `top` to `below`; `None` where it falls on to 1.
fn lowest(mut f: impl FnMut(f64) -> f64, top: f64, below: f64) -> Option<(f64, f64)> {
    let (mut a, mut m) = (top, below);
    let mut least = f(m);
    while m < 1.0 {
        let b = (2.0 * m - a).min(1.0);
        let next = f(b);
        if next >= least {
            return Some(minimum(f, [a, m, b]));
        }
        (a, m, least) = (m, b, next);
    }
    None
}
