//! Runs under way: parts of a kind are run at once, whatever run they are of.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;

use deltazero_solvers::Outcome;
use deltazero_study::brief::{Brief, briefs};
use deltazero_study::horizon::{Estimate, Span, estimate};
use deltazero_study::run::{Limit, Limits, Price, Setting, Watch};
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
    /// What became of the others.
    pub(super) made: Vec<(Part, Brief)>,
    /// Why the run did not come to its end, if it did not.
    pub(super) status: Result<(), String>,
    /// What tight runs say of it, where they were asked for.
    pub(super) estimate: Option<Estimate>,
}

/// A part of a run that is to be made.
type Next<'a> = (&'a mut Course, Part);

impl Course {
    /// The run of this configuration, none of it made; or why there is none.
    pub(super) fn new(config: &Config) -> Result<Self, String> {
        let setting =
            setting(config).ok_or_else(|| format!("no method {}", config.solver.method))?;
        let (max_rhs, max_seconds) = (config.study.max_rhs, config.study.max_seconds);
        let limits = Limits { max_rhs, max_seconds, stop: &NEVER };
        let mut parts = caught(|| config.mechanism.subject(config).parts)?;
        parts.reverse();
        let (t_end, made, status) = (config.run.t_end, Vec::new(), Ok(()));
        let (left, estimate) = (limits, None);
        Ok(Self { setting, t_end, limits, left, parts, made, status, estimate })
    }

    /// How far the run came [s].
    pub(super) fn reached(&self) -> f64 {
        self.made.iter().map(|(_, brief)| brief.run.t).fold(0.0, f64::max)
    }

    /// Has tight runs made beside a run that came to its end.
    pub(super) fn check(&mut self) {
        if self.status.is_err() {
            return;
        }
        let Setting { method, .. } = self.setting;
        let span = |(_, Brief { run, .. }): &(Part, Brief)| Span {
            t_end: self.t_end,
            reached: run.t,
            work: work(method, self.setting.rtol(), &run.stats.work),
        };
        let spans: Vec<Span> = self.made.iter().map(span).collect();
        let subject = Subject { parts: self.made.iter().map(|(part, _)| part.clone()).collect() };
        match caught(|| estimate(&subject, &self.setting, &spans, &NEVER)) {
            Ok(estimate) => self.estimate = Some(estimate),
            Err(panic) => self.give_up(panic),
        }
    }

    /// Takes what became of a part.
    fn take(&mut self, part: Part, brief: Brief, cut: Option<Limit>) {
        self.left = self.left.after(&brief.run, Price::of_setting(&self.setting));
        let of_part = self.status_of(&part, &brief, cut);
        self.status = std::mem::replace(&mut self.status, Ok(())).and(of_part);
        self.made.push((part, brief));
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

/// Makes the runs to their ends, with contacts and energy if they are to have an `audit`.
pub(super) fn make(courses: &mut [&mut Course], audit: bool) {
    loop {
        let next =
            courses.iter_mut().filter_map(|own| own.parts.pop().map(|part| (&mut **own, part)));
        let mut waiting: Vec<Next<'_>> = next.collect();
        if waiting.is_empty() {
            return;
        }
        while let Some((first, _)) = waiting.first() {
            let (setting, t_end) = (first.setting.clone(), first.t_end);
            let is_same = |(own, _): &Next<'_>| own.setting == setting && own.t_end == t_end;
            let (same, others) = waiting.into_iter().partition(is_same);
            waiting = others;
            make_parts(same, &setting, t_end, audit);
        }
    }
}

/// Makes parts of runs that have one setting.
fn make_parts(parts: Vec<Next<'_>>, setting: &Setting, t_end: f64, audit: bool) {
    let price = Price::of_setting(setting);
    let mut watches: Vec<Watch<'_>> = parts.iter().map(|(own, _)| own.left.watch(price)).collect();
    let list: Vec<&Part> = parts.iter().map(|(_, part)| part).collect();
    let made = caught(|| briefs(&list, setting, t_end, audit, &mut watches));
    let are_several = parts.len() > 1;
    let alone = |part| make_parts(vec![part], setting, t_end, audit);
    match made {
        Ok(made) => {
            for (((own, part), brief), watch) in parts.into_iter().zip(made).zip(&watches) {
                // The time of a run among others is theirs too.
                if are_several && watch.cut == Some(Limit::Time) {
                    alone((own, part));
                } else {
                    own.take(part, brief, watch.cut);
                }
            }
        }
        Err(_) if are_several => parts.into_iter().for_each(alone),
        Err(panic) => parts.into_iter().for_each(|(own, _)| own.give_up(panic.clone())),
    }
}

/// What `work` returns, or that it panicked.
fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        format!("panic, a mistake in this program: {}", text.unwrap_or("no message"))
    })
}
