//! What breaks a run off: too much work, too much time, a wish from outside.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use deltazero_solvers::{Accepted, Event, Method, Needs, Record, Stats, System, Work};

use super::{Ran, Setting};

/// A series costs this many right-hand sides for each of its orders: 2.2 at order 8, 1.9 at 11, 2.1 at 15, 2.3
/// at 19 (Table 1, located).
const SERIES: f64 = 2.0;
/// An attempt of the Taylor method that is rejected sums its series and begins another: this part of what a series
/// costs. Of blind runs of reading `full` at rtol 1e-8 to 1e-12, which reject 27 to 45 attempts for each
/// series, a rejected one takes 0.7 µs.
const REJECTED: f64 = 0.25;
/// Accepted steps between two looks at the clock.
const STEPS_A_LOOK: u64 = 64;

/// How much a run may take.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Work in [right-hand sides](Price) beyond which it is cut.
    pub max_rhs: u64,
    /// Time beyond which it is cut [s]; infinite for none.
    pub max_seconds: f64,
    /// Set from outside to interrupt it.
    pub stop: &'a AtomicBool,
}

impl<'a> Limits<'a> {
    /// No limit but the flag that interrupts it.
    pub fn none(stop: &'a AtomicBool) -> Self {
        Self { max_rhs: u64::MAX, max_seconds: f64::INFINITY, stop }
    }

    /// Whether it was interrupted from outside.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The limits that are left for the further parts of a run after `part`, whose work has this price. Of a part that was
    /// computed at once with others the time of all of them counts, which is more than it takes alone.
    pub fn after<Y, M>(self, part: &Ran<Y, M>, price: Price) -> Self {
        Self {
            max_rhs: self.max_rhs.saturating_sub(price.of(&part.stats) as u64),
            max_seconds: self.max_seconds - part.batch as f64 * part.took.wall.as_secs_f64(),
            ..self
        }
    }

    /// A recorder that breaks off a run whose work has this price. Its time begins with its first step.
    pub fn watch(self, price: Price) -> Watch<'a> {
        Watch { limits: self, price, clock: None, cut: None }
    }

    /// The message that `limit` was reached, with its value.
    pub fn told(&self, limit: Limit) -> String {
        match limit {
            Limit::Work => format!("more than study.max_rhs = {} right-hand sides", self.max_rhs),
            Limit::Time => format!("more than study.max_seconds = {} s", self.max_seconds),
        }
    }
}

/// A limit that a run has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The limit of work.
    Work,
    /// The limit of time.
    Time,
}

/// What counts of work are worth in evaluations of the right-hand side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// A Taylor series, which is counted as one.
    pub series: f64,
    /// A rejected attempt, beyond what it is counted as already.
    pub rejected: f64,
}

impl Price {
    /// The price of the methods whose evaluations are all counted.
    pub const PLAIN: Self = Self { series: 1.0, rejected: 0.0 };

    /// The price of the method of a setting; see [`of_series_at`](Self::of_series_at).
    pub fn of_setting(setting: &Setting) -> Self {
        Self::of_series_at(setting.method, setting.rtol())
    }

    /// The price of a method at a tolerance: a series of order p is worth 2 p, a rejected one a quarter of it. Of a method that
    /// chooses a rejected attempt is worth what is counted: which ones were series is not known.
    pub fn of_series_at(method: &Method, rtol: Option<f64>) -> Self {
        let Some(order) = method.series_order(rtol) else { return Self::PLAIN };
        let price = Self::of_series(SERIES * order as f64);
        if method.chooses() { Self { rejected: 0.0, ..price } } else { price }
    }

    /// The price of a method of series, each of them worth `series` right-hand sides.
    pub fn of_series(series: f64) -> Self {
        Self { series, rejected: REJECTED * series }
    }

    /// The worth of all that `stats` counts, in right-hand sides.
    pub fn of(&self, stats: &Stats) -> f64 {
        self.of_counted(&stats.work) + self.rejected(stats)
    }

    /// The worth of what is counted as work, without rejected attempts.
    pub fn of_counted(&self, work: &Work) -> f64 {
        work.n_rhs as f64 + (self.series - 1.0) * work.n_series as f64
    }

    /// The worth of the rejected attempts in `stats` beyond what is counted as work.
    pub fn rejected(&self, stats: &Stats) -> f64 {
        self.rejected * stats.n_rejected as f64
    }
}

/// The time that a run has, looked at now and then.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    end: Option<Instant>,
}

impl Clock {
    /// The clock of a run which begins now and has `seconds`; one of infinitely many has no end.
    pub fn of(seconds: f64) -> Self {
        let left = Duration::try_from_secs_f64(seconds.max(0.0)).ok();
        Self { end: left.and_then(|left| Instant::now().checked_add(left)) }
    }

    /// Whether it is over.
    pub fn is_over(&self) -> bool {
        self.end.is_some_and(|end| Instant::now() >= end)
    }

    /// Whether it is over, after an accepted step: most of them do not look.
    pub fn is_over_after(&self, stats: &Stats) -> bool {
        stats.n_accepted.is_multiple_of(STEPS_A_LOOK) && self.is_over()
    }
}

/// What may break a run off: asked after every accepted step, and while attempts are rejected.
pub trait Brake {
    /// A step was accepted that ends at `t` [s]; the work so far.
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()>;

    /// More attempts were rejected; see [`Record::rejected`].
    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()>;

    /// An event has happened, one that ends the run among them.
    fn event(&mut self) -> ControlFlow<()>;
}

impl<B: Brake + ?Sized> Brake for &mut B {
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        (**self).step(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        (**self).rejected(stats)
    }

    fn event(&mut self) -> ControlFlow<()> {
        (**self).event()
    }
}

/// A [`Brake`] as a recorder of whatever problem.
pub struct Braked<'a>(pub &'a mut dyn Brake);

impl<P: System> Record<P> for Braked<'_> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.0.step(accepted.step.t1(), accepted.stats)
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        self.0.event()
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.0.step(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.0.rejected(stats)
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

/// The brake of [`Limits`].
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    limits: Limits<'a>,
    price: Price,
    /// None before the first step.
    clock: Option<Clock>,
    /// The limit that it broke the run off at.
    pub cut: Option<Limit>,
}

impl Watch<'_> {
    fn clock(&mut self) -> &Clock {
        self.clock.get_or_insert_with(|| Clock::of(self.limits.max_seconds))
    }

    fn judge(&mut self, is_too_much: bool, is_late: bool) -> ControlFlow<()> {
        if is_too_much {
            self.cut = Some(Limit::Work);
        } else if is_late {
            self.cut = Some(Limit::Time);
        } else if !self.limits.is_stopped() {
            return ControlFlow::Continue(());
        }
        ControlFlow::Break(())
    }
}

impl Brake for Watch<'_> {
    fn step(&mut self, _t: f64, stats: &Stats) -> ControlFlow<()> {
        let is_late = self.clock().is_over_after(stats);
        let is_too_much = self.price.of_counted(&stats.work) > self.limits.max_rhs as f64;
        self.judge(is_too_much, is_late)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        let is_too_much = self.price.of(stats) > self.limits.max_rhs as f64;
        let is_late = self.clock().is_over();
        self.judge(is_too_much, is_late)
    }

    fn event(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Outcome;

    use super::*;
    use crate::run::Took;

    #[test]
    fn a_part_among_others_costs_the_time_of_all() {
        let stop = AtomicBool::new(false);
        let took = Took { wall: Duration::from_secs(2), cpu: Duration::from_secs(2) };
        let part = |batch| Ran {
            outcome: Ok(Outcome::Finished),
            t: 1.0,
            y: (),
            mode: (),
            stats: Stats::default(),
            took,
            batch,
        };
        let limits = Limits { max_seconds: 60.0, ..Limits::none(&stop) };
        let left = |batch| limits.after(&part(batch), Price::PLAIN).max_seconds;
        assert_eq!([left(1), left(8)], [58.0, 44.0]);
    }

    #[test]
    fn a_rejected_series_is_worth_a_quarter_of_one() {
        let mut stats = Stats { n_rejected: 3, ..Stats::default() };
        (stats.work.n_rhs, stats.work.n_series) = (10, 4);
        let price = Price::of_series(20.0);
        assert_eq!((price.rejected(&stats), Price::PLAIN.rejected(&stats)), (15.0, 0.0));
        // Four of the ten evaluations are series.
        assert_eq!((price.of(&stats), Price::PLAIN.of(&stats)), (6.0 + 80.0 + 15.0, 10.0));
    }
}
