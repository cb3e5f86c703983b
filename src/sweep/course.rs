//! Runs under way: parts of a kind are run at once, whatever run they are of.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Outcome, Stats};
use deltazero_study::brief::{Brief, briefs};
use deltazero_study::horizon::{Estimate, Span, estimate};
use deltazero_study::run::{Brake, Clock, Limit, Limits, Price, Setting, Watch};
use deltazero_study::selection::work;
use deltazero_study::{Part, Subject};

use crate::config::Config;
use crate::run::setting;

/// Runs are let end; what ends a sweep waits for them.
static NEVER: AtomicBool = AtomicBool::new(false);

/// A run of all parts of a subject, one after the other, within limits that they share.
pub(super) struct Course {
    setting: Setting,
    t_end: f64,
    limits: Limits<'static>,
    /// What the parts that are made leave of the limits.
    left: Limits<'static>,
    /// Parts that are not made, the last one first.
    parts: Vec<Part>,
    /// Whether they are to be made alone: because they are not computed at once, or because among others their time may
    /// have been over.
    is_alone: bool,
    /// What became of the others.
    pub(super) made: Vec<(Part, Brief)>,
    /// Why the run did not come to its end, if it did not.
    pub(super) status: Result<(), String>,
    /// What tight runs say of it, where they were asked for.
    pub(super) estimate: Option<Estimate>,
}

/// A part of a run that is to be made.
type Next<'a> = (&'a mut Course, Part);

/// The brake of a part among others.
struct Among {
    own: Watch<'static>,
    /// The time of all.
    clock: Clock,
    /// Whether that broke it off.
    is_late: bool,
}

impl Brake for Among {
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.is_late = self.clock.is_over_after(stats);
        if self.is_late { ControlFlow::Break(()) } else { self.own.step(t, stats) }
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.is_late = self.clock.is_over();
        if self.is_late { ControlFlow::Break(()) } else { self.own.rejected(stats) }
    }

    fn event(&mut self) -> ControlFlow<()> {
        self.own.event()
    }
}

impl Course {
    /// The run of this configuration, none of it made; or why there is none.
    pub(super) fn new(config: &Config) -> Result<Self, String> {
        let setting =
            setting(config).ok_or_else(|| format!("no method {}", config.solver.method))?;
        let (max_rhs, max_seconds) = (config.study.max_rhs, config.study.max_seconds);
        let limits = Limits { max_rhs, max_seconds, stop: &NEVER };
        let mut parts = config.mechanism.subject(config).parts;
        parts.reverse();
        let is_alone = !parts.iter().all(|part| part.runs_at_once(&setting));
        let (t_end, made, status) = (config.run.t_end, Vec::new(), Ok(()));
        let (left, estimate) = (limits, None);
        Ok(Self { setting, t_end, limits, left, parts, is_alone, made, status, estimate })
    }

    /// Whether all its parts are made.
    pub(super) fn is_made(&self) -> bool {
        self.parts.is_empty()
    }

    /// How far the run came [s].
    pub(super) fn reached(&self) -> f64 {
        self.made.iter().map(|(_, brief)| brief.run.t).fold(0.0, f64::max)
    }

    /// Makes what is left of it, with contacts and energy if it is to have an `audit`.
    pub(super) fn make(&mut self, audit: bool) {
        while let Some(part) = self.parts.pop() {
            let mut watch = [self.left.watch(Price::of_setting(&self.setting))];
            match caught(|| briefs(&[&part], &self.setting, self.t_end, audit, &mut watch)) {
                // Of one part there is one.
                Ok(mut made) => self.take(part, made.remove(0), watch[0].cut),
                Err(panic) => self.give_up(panic),
            }
        }
    }

    /// Has tight runs made beside a run that came to its end. Where one of them panics, nothing is said of its error: the
    /// run has its row.
    pub(super) fn check(&mut self) {
        if self.status.is_err() {
            return;
        }
        let Setting { method, .. } = self.setting;
        let span = |(_, Brief { run, .. }): &(Part, Brief)| Span {
            t_end: self.t_end,
            reached: run.t,
            is_stopped: run.stopped_at().is_some(),
            work: work(method, self.setting.rtol(), &run.stats.work),
        };
        let spans: Vec<Span> = self.made.iter().map(span).collect();
        let subject = Subject { parts: self.made.iter().map(|(part, _)| part.clone()).collect() };
        self.estimate = caught(|| estimate(&subject, &self.setting, &spans, &NEVER)).ok();
    }

    /// Takes what became of a part.
    fn take(&mut self, part: Part, brief: Brief, cut: Option<Limit>) {
        self.left = self.left.after(&brief.run, Price::of_setting(&self.setting));
        let of_part = self.status_of(&part, &brief, cut);
        self.status = std::mem::replace(&mut self.status, Ok(())).and(of_part);
        self.made.push((part, brief));
    }

    /// Has all of it made anew, and alone, beginning with `part` after those that were made.
    fn begin_alone(&mut self, part: Part) {
        self.is_alone = true;
        self.parts.push(part);
        self.parts.extend(self.made.drain(..).rev().map(|(part, _)| part));
        (self.left, self.status) = (self.limits, Ok(()));
    }

    /// Why a part did not come to its end.
    fn status_of(&self, part: &Part, brief: &Brief, cut: Option<Limit>) -> Result<(), String> {
        let name = if part.name.is_empty() { String::new() } else { format!("{}: ", part.name) };
        match (&brief.run.outcome, cut) {
            (Err(error), _) => Err(format!("{name}{error}")),
            (Ok(Outcome::Interrupted), Some(limit)) => {
                let told = self.limits.told(limit);
                Err(format!("{name}cut at t = {:e} s: {told}", brief.run.t))
            }
            (Ok(Outcome::Interrupted), None) => Err(format!("{name}interrupted")),
            (Ok(_), _) => Ok(()),
        }
    }

    /// Gives it up, for what is wrong.
    fn give_up(&mut self, why: String) {
        self.parts.clear();
        self.made.clear();
        self.status = Err(why);
    }
}

/// Makes those parts of the runs that are computed at once, for at most so many `seconds`, with contacts and energy if they
/// are to have an `audit`. A run that needs longer is left to be made alone; so is one whose own limit of time may have been
/// reached, because its time among others is not the one it takes.
pub(super) fn make_at_once(courses: &mut [&mut Course], audit: bool, seconds: f64) {
    let clock = Clock::of(seconds);
    loop {
        let together = courses.iter_mut().filter(|own| !own.is_alone);
        let next = together.filter_map(|own| own.parts.pop().map(|part| (&mut **own, part)));
        let mut waiting: Vec<Next<'_>> = next.collect();
        if waiting.is_empty() {
            return;
        }
        while let Some((first, _)) = waiting.first() {
            let (setting, t_end) = (first.setting.clone(), first.t_end);
            let is_same = |(own, _): &Next<'_>| own.setting == setting && own.t_end == t_end;
            let (same, others) = waiting.into_iter().partition(is_same);
            waiting = others;
            make_parts(same, (&setting, t_end, audit), clock);
        }
    }
}

/// Makes parts of runs that have one setting, to one end.
fn make_parts(parts: Vec<Next<'_>>, (setting, t_end, audit): (&Setting, f64, bool), clock: Clock) {
    let brake = |(own, _): &Next<'_>| {
        let own = own.left.watch(Price::of_setting(setting));
        Among { own, clock, is_late: false }
    };
    let mut brakes: Vec<Among> = parts.iter().map(brake).collect();
    let list: Vec<&Part> = parts.iter().map(|(_, part)| part).collect();
    match caught(|| briefs(&list, setting, t_end, audit, &mut brakes)) {
        Ok(briefs) => {
            for (((own, part), brief), brake) in parts.into_iter().zip(briefs).zip(&brakes) {
                let left = own.left.after(&brief.run, Price::of_setting(setting));
                let cut = brake.own.cut;
                if brake.is_late || cut == Some(Limit::Time) || left.max_seconds <= 0.0 {
                    own.begin_alone(part);
                } else {
                    own.take(part, brief, cut);
                }
            }
        }
        // Which of them it was is found out one by one.
        Err(_) => parts.into_iter().for_each(|(own, part)| own.begin_alone(part)),
    }
}

/// What `work` returns, or that it panicked.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        format!("panic, a mistake in this program: {}", text.unwrap_or("no message"))
    })
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::{Next, Real, System};
    use deltazero_study::Problem;
    use deltazero_study::problem::Quantity;

    use super::*;

    /// A decay that does not bear to start anywhere but at one.
    struct Touchy;

    impl System for Touchy {
        type Mode = ();
        type State<S: Real> = [S; 1];
        type Guards<S: Real> = [S; 0];

        fn initial_mode(&self, _t: f64, y: &[f64; 1]) {
            assert_eq!(y[0], 1.0, "another start");
        }

        fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 1], dydt: &mut [S; 1]) {
            *dydt = [-y[0]];
        }

        fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 1], _g: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 1], _bounds: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 1]) -> Next<()> {
            Next::Mode(())
        }
    }

    impl Problem for Touchy {
        fn start(&self) -> [f64; 1] {
            [1.0]
        }

        fn states(&self) -> Vec<Quantity> {
            vec![Quantity::new("y", "m", 1.0)]
        }
    }

    #[test]
    fn a_panic_in_a_tight_run_leaves_the_run_its_row() {
        let mut course = Course::new(&Config::table1().unwrap()).unwrap();
        course.parts = vec![Part::new(Touchy)];
        course.make(true);
        course.check();
        assert_eq!((course.status, course.made.len()), (Ok(()), 1));
        assert_eq!(course.estimate, None);
    }
}
