//! The switching rule. It is a recorder between the method in use and the recorder of the run.

use std::ops::ControlFlow;

use super::explicit::Pace;
use super::spectrum::Spectrum;
use crate::point::Point;
use crate::record::{Accepted, Event, Grazing, Needs, Record};
use crate::system::System;
use crate::work::Stats;

/// Cost of an attempt of an implicit step in right-hand sides. On contacts of six states it takes 2 to 4 times as long as
/// a series of order 13, whose [cost](Pace::cost) is 9: so it is 20 to 40. Of 15 to 40, 20 gave the least time on 24
/// mechanisms of stiffness from 1e7 to 1e12 N/m.
const IMPLICIT_COST: f64 = 20.0;
/// A trial begins with this fraction of the step that pays. The first implicit step has a poor starting guess for its
/// iteration; from a small step the size grows by large factors, but one that failed is reached again only by steps that
/// are each a tenth longer.
const TRIAL: f64 = 0.02;
/// Right-hand sides in explicit steps held back, one after the other, before a trial: at first and after implicit steps
/// that paid, and at most after failed trials.
const WAIT: u64 = 128;
const LONGEST_WAIT: u64 = 8_192;
/// Right-hand sides in explicit steps between two evaluations of the Jacobian.
const LOOK: u64 = 2_048;
/// A phase after an implicit turn begins implicit where ρ is at least this fraction of its value in that turn. The bound
/// of explicit steps is set anew where ρ has changed by this factor.
const AS_STIFF: f64 = 0.5;
/// Number of attempts over which implicit steps must pay, over which those of a trial may grow until they do, and
/// between two evaluations of the Jacobian.
const PAYING: u64 = 12;

/// The method whose turn is next, and the step size that it begins with.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Turn {
    Explicit { h: Option<f64> },
    Implicit { h: Option<f64> },
}

/// The progress of the explicit method where stability limited it.
#[derive(Clone, Copy, Debug)]
struct Bound {
    /// Time covered per right-hand side.
    rate: f64,
    /// Mean step size.
    h: f64,
    /// Spectral radius at that time.
    radius: f64,
}

impl Bound {
    /// The progress to expect where the spectral radius is `radius`: a step limited by stability is proportional to
    /// 1/ρ.
    fn at(self, radius: f64) -> Self {
        let longer = self.radius / radius;
        Self { rate: self.rate * longer, h: self.h * longer, radius }
    }
}

/// Where explicit steps stood when a measurement of them began.
#[derive(Clone, Copy, Debug)]
struct Since {
    t: f64,
    n_rhs: u64,
    n_accepted: u64,
}

/// State of the implicit method while it is tried or pays, kept across phases.
#[derive(Clone, Copy, Debug)]
struct Stiff {
    /// The explicit progress that it is compared with.
    bound: Bound,
    /// True until its steps have paid for the first time.
    is_trial: bool,
    /// Time covered since the last judgement, and number of attempts.
    forward: f64,
    n_attempts: u64,
}

/// State of the switching rule between turns.
pub(super) struct Pilot {
    spectrum: Spectrum,
    pace: Pace,
    /// ρ that bounds explicit steps, and the longest step of the run.
    radius: f64,
    limit: f64,
    /// Right-hand sides in steps held back before the next trial.
    wait: u64,
    /// Where steps held back began, and the last evaluation of the Jacobian or the first step of the phase.
    since: Option<Since>,
    looked: Option<Since>,
    stiff: Option<Stiff>,
}

impl Pilot {
    /// The rule for a system of `n` states and an explicit method of this `pace`, with steps of at most `limit`.
    pub(super) fn new(n: usize, pace: Pace, limit: f64) -> Self {
        Self {
            spectrum: Spectrum::new(n),
            pace,
            radius: 0.0,
            limit,
            wait: WAIT,
            since: None,
            looked: None,
            stiff: None,
        }
    }

    /// The longest explicit step.
    pub(super) fn longest(&self) -> f64 {
        self.pace.reach / self.radius
    }

    /// The method that begins a phase at `point`. It is the implicit one where that ended the phase before, and this
    /// one is about as stiff.
    pub(super) fn begin_phase<P: System>(
        &mut self,
        problem: &P,
        point: &Point<P>,
        stats: &mut Stats,
    ) -> Turn {
        stats.work.n_jac += 1;
        self.radius = self.spectrum.radius(problem, point.mode.clone(), point.t, &point.y);
        (self.since, self.looked) = (None, None);
        match &mut self.stiff {
            Some(stiff) if self.radius >= AS_STIFF * stiff.bound.radius => {
                stiff.bound = stiff.bound.at(self.radius);
                Turn::Implicit { h: None }
            }
            _ => {
                self.stiff = None;
                Turn::Explicit { h: None }
            }
        }
    }

    /// After an explicit step to `t`, with the size that was last `proposed` for a step, starts a trial of implicit steps
    /// where they may pay, and another explicit turn where stiffness has changed.
    fn consider(
        &mut self,
        (t, proposed): (f64, f64),
        stats: &Stats,
        radius: impl FnOnce(&mut Spectrum) -> f64,
    ) -> Option<Turn> {
        let now = Since { t, n_rhs: stats.work.n_rhs, n_accepted: stats.n_accepted };
        let cost = self.pace.cost;
        let work = |since: Since| cost * (now.n_rhs - since.n_rhs);
        let is_held_back = |bound: f64| proposed >= bound && bound < self.limit;
        if !is_held_back(self.longest()) {
            self.since = Some(now);
        }
        let since = *self.since.get_or_insert(now);
        let looked = *self.looked.get_or_insert(now);
        let is_due = work(since) >= self.wait;
        if !is_due && work(looked) < LOOK {
            return None;
        }
        self.looked = Some(now);
        let radius = radius(&mut self.spectrum);
        let bounds = (self.longest(), self.pace.reach / radius);
        let has_changed = bounds.0 < AS_STIFF * bounds.1 || bounds.1 < AS_STIFF * bounds.0;
        if has_changed && is_held_back(bounds.0.min(bounds.1)) {
            (self.radius, self.since) = (radius, None);
            return Some(Turn::Explicit { h: None });
        }
        if !is_due {
            return None;
        }
        self.radius = radius;
        let forward = (t - since.t).abs();
        let h = forward / (now.n_accepted - since.n_accepted) as f64;
        let rate = forward / work(since) as f64;
        let bound = Bound { rate, h, radius };
        self.stiff = Some(Stiff { bound, is_trial: true, forward: 0.0, n_attempts: 0 });
        Some(Turn::Implicit { h: Some(TRIAL * IMPLICIT_COST * rate) })
    }

    /// Ends the turn of the implicit method. The wait until the next trial is twice as long as the last one.
    pub(super) fn give_up(&mut self) {
        self.wait = (2 * self.wait).min(LONGEST_WAIT);
        (self.since, self.looked, self.stiff) = (None, None, None);
    }
}

/// One turn of one method.
pub(crate) struct Leg<'a, P: System> {
    pilot: &'a mut Pilot,
    problem: &'a P,
    record: &'a mut dyn Record<P>,
    is_implicit: bool,
    /// Attempts counted up to the last accepted step.
    n_attempts: u64,
    n_jac: u64,
    n_implicit: u64,
    next: Option<Turn>,
}

impl<'a, P: System> Leg<'a, P> {
    /// A turn that begins at the work counted in `stats`, and whose steps are shown to `record`.
    pub(super) fn new(
        pilot: &'a mut Pilot,
        problem: &'a P,
        record: &'a mut dyn Record<P>,
        is_implicit: bool,
        stats: &Stats,
    ) -> Self {
        Self {
            pilot,
            problem,
            record,
            is_implicit,
            n_attempts: attempts(stats),
            n_jac: 0,
            n_implicit: 0,
            next: None,
        }
    }

    /// Ends the turn and returns the next one, if this turn ended by the rule. The work of the rule itself is added
    /// to `stats`.
    pub(crate) fn over(self, stats: &mut Stats) -> Option<Turn> {
        self.book(stats);
        self.next
    }

    fn book(&self, stats: &mut Stats) {
        stats.work.n_jac += self.n_jac;
        stats.n_implicit += self.n_implicit;
    }

    /// Applies the rule after an explicit step.
    fn explicit(&mut self, accepted: &Accepted<'_, P>) -> Option<Turn> {
        let (step, n_jac) = (accepted.step, &mut self.n_jac);
        let at = (step.t1(), accepted.proposed?);
        self.pilot.consider(at, accepted.stats, |spectrum| {
            *n_jac += 1;
            spectrum.radius(self.problem, accepted.mode.clone(), step.t1(), step.y1())
        })
    }

    /// Applies the rule after an implicit step: ends the turn where the steps do not pay.
    fn implicit(&mut self, accepted: &Accepted<'_, P>) -> Option<Turn> {
        let pilot = &mut *self.pilot;
        let stiff = pilot.stiff.as_mut()?;
        let (step, so_far) = (accepted.step, attempts(accepted.stats));
        let h = (step.t1() - step.t0()).abs();
        stiff.forward += h;
        stiff.n_attempts += so_far - self.n_attempts;
        self.n_attempts = so_far;
        if stiff.n_attempts < PAYING || accepted.landed_on.is_some() {
            return None;
        }
        let mean = stiff.forward / stiff.n_attempts as f64;
        let pays =
            if stiff.is_trial { h.max(mean) } else { mean } >= IMPLICIT_COST * stiff.bound.rate;
        if !pays {
            let h = stiff.bound.h.min(h);
            pilot.give_up();
            return Some(Turn::Explicit { h: Some(h.copysign(step.t1() - step.t0())) });
        }
        self.n_jac += 1;
        let radius =
            pilot.spectrum.radius(self.problem, accepted.mode.clone(), step.t1(), step.y1());
        pilot.radius = radius;
        let bound = stiff.bound.at(radius);
        *stiff = Stiff { bound, is_trial: false, forward: 0.0, n_attempts: 0 };
        pilot.wait = WAIT;
        None
    }
}

impl<P: System> Record<P> for Leg<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.n_implicit += u64::from(self.is_implicit);
        self.next = if self.is_implicit {
            self.implicit(accepted)
        } else if accepted.landed_on.is_none() {
            self.explicit(accepted)
        } else {
            None
        };
        let go_on = if self.n_jac + self.n_implicit == 0 {
            self.record.step(accepted)
        } else {
            let mut stats = *accepted.stats;
            self.book(&mut stats);
            let mode = accepted.mode.clone();
            self.record.step(&Accepted { mode, stats: &stats, ..*accepted })
        };
        if go_on.is_break() {
            self.next = None;
        }
        if self.next.is_some() { ControlFlow::Break(()) } else { go_on }
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        self.record.event(event)
    }

    fn grazing(&mut self, grazing: &Grazing<P::Mode>) {
        self.record.grazing(grazing);
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        let mut stats = *stats;
        self.book(&mut stats);
        self.record.rejected(&stats)
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.record.needs(t0, t1).max(Needs::Ends)
    }
}

/// Steps attempted so far, including those retaken to locate events.
fn attempts(stats: &Stats) -> u64 {
    stats.n_accepted + stats.n_rejected + stats.n_retaken
}
