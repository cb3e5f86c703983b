//! Whether the runs of a configuration agree, and what to call it where they do not.

use std::fmt;

use deltazero::config::Config;
use deltazero::keys::ReadingName;
use deltazero::model::{Block, Jointed, Joints, Part};
use deltazero_solvers::Method;
use deltazero_study::Problem as _;
use deltazero_study::horizon::parting;
use deltazero_study::part::Start;
use deltazero_study::reference::HORIZON_ERROR;
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;

use super::audit::Budget;
use super::ran::{Apart, End, Growth, Ran, energy_of};

/// Methods of different kind: an explicit one, whose runs the horizon is of, an implicit one, and series.
pub(super) const METHODS: [&str; 3] = ["vern98", "radau5", "taylor"];
/// Tolerance of the runs.
pub(super) const RTOL: f64 = 1e-12;
/// Two runs agree whose samples differ by no more than this in `e`, and this many times what a change in the last bit
/// has grown to: a step at `RTOL` makes errors of ten thousand times the last bit, and there are thousands of steps. Of
/// 1160 draws four differ by more than a million times that growth, by 5.2 million at most.
pub(super) const MOST_E: f64 = 1e-6;
pub(super) const MOST_OF_GROWTH: f64 = 1e7;
/// Modes and ends are compared as long as no more has grown, and differ for no longer than this, in units of the
/// mechanism's time: a pin that grazes its bush is in it by one run and not by the other. Of 1160 draws six are longer
/// apart than 1e-4, by 5.3e-4 at most, all at impacts of some µm/s.
pub(super) const STEADY: f64 = 1e-11;
const MOST_MODES: f64 = 1e-3;
/// A balance holds to this part of the energy; at most 2.3e-8 of 100 draws, by `radau5`.
const MOST_RESIDUAL: f64 = 1e-6;
/// What a run may go astray, as a part of what is usual in it; see `Audit`.
const MOST_ASTRAY: f64 = 1e-6;

/// A run that did not come this far of its time within its budget of work is stuck.
pub(super) const LEAST_SHARE: f64 = 0.02;

/// And is bound by stability where an implicit one came this many times as far.
pub(super) const FARTHER: f64 = 2.0;

/// What came of a draw, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Class {
    /// To the end.
    Agree,
    /// As far as it is predictable.
    Past,
    /// The configuration, or a run where the model ends.
    Refused,
    /// An explicit run is stuck where an implicit one goes on: its steps are bound by stability.
    Stiff,
    /// Two runs differ where they should not, and `simulate` warns: of other events, or of a contact too deep for its
    /// law.
    Warned,
    /// A run took too long.
    Timeout,
    /// A run ended by an error.
    Failed,
    /// Two runs differ where they should not, or one is wrong by its own account.
    Disagree,
}

impl Class {
    pub(crate) const ALL: [Self; 8] = [
        Self::Agree,
        Self::Past,
        Self::Refused,
        Self::Stiff,
        Self::Warned,
        Self::Timeout,
        Self::Failed,
        Self::Disagree,
    ];

    /// Whether there is something to look at.
    pub(crate) fn is_found(self) -> bool {
        self >= Self::Warned
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Agree => "agree",
            Self::Past => "past",
            Self::Refused => "refused",
            Self::Stiff => "stiff",
            Self::Warned => "warned",
            Self::Timeout => "timeout",
            Self::Failed => "failed",
            Self::Disagree => "disagree",
        })
    }
}

/// What came of a draw.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    pub(crate) class: Class,
    /// What happened, a line each.
    pub(crate) lines: Vec<String>,
    /// Largest `e` within the horizon.
    pub(crate) e: f64,
    /// The same of what is allowed where it grows.
    pub(crate) of_allowed: f64,
    /// Longest time in different modes, in units of the mechanism's time.
    pub(crate) modes_s: f64,
    /// Largest energy residual, of the energy, where the reading has a balance.
    pub(crate) residual: f64,
    /// What it cost, in right-hand sides.
    pub(crate) work: f64,
}

impl Verdict {
    fn new() -> Self {
        let (class, lines) = (Class::Agree, Vec::new());
        Self { class, lines, e: 0.0, of_allowed: 0.0, modes_s: 0.0, residual: 0.0, work: 0.0 }
    }

    /// A configuration that is none.
    pub(crate) fn refused(why: String) -> Self {
        let mut verdict = Self::new();
        verdict.add(Class::Refused, why);
        verdict
    }

    /// At least as bad as `class`, for this reason.
    pub(super) fn add(&mut self, class: Class, line: String) {
        self.class = self.class.max(class);
        self.lines.push(line);
    }

    /// Judges a configuration by runs that cost no more than `budget` each.
    pub(crate) fn of(config: &Config, budget: Budget) -> Self {
        let mut verdict = Self::new();
        let joints = Joints::from(config);
        if joints.parts.is_empty() {
            let span = (config.run.t_end, config.run.sample);
            for part in &config.mechanism.subject(config).parts {
                verdict.judge_whatever(part, span, budget);
            }
        }
        for part in &joints.parts {
            match part {
                Part::Block(block) => verdict.judge(block, config, budget),
                Part::Chain(chain) => verdict.judge(chain, config, budget),
            }
        }
        verdict
    }

    /// Judges one part.
    fn judge<P: Jointed>(&mut self, part: &P, config: &Config, budget: Budget) {
        let (block, joint) = (part.block(), part.block().joint);
        let span = (config.run.t_end, config.run.sample);
        let run = |name, start| {
            let method = Method::named(name)?;
            let (events, accuracy) = (Events::Located, Accuracy::Rtol(RTOL, None));
            Some(Ran::new(part, &Setting { method, events, accuracy }, start, span, budget))
        };
        let all: Vec<Ran> = METHODS.iter().filter_map(|name| run(name, Start::Exact)).collect();
        let Some(base) = all.iter().find(|ran| ran.is_complete()).or(all.first()) else {
            return self.add(Class::Failed, format!("no method of {METHODS:?}"));
        };
        let nudged = run(base.method, Start::Up);
        let growth = Growth::new(base, nudged.as_ref().unwrap_or(base), block);
        let has_balance = matches!(config.reading, ReadingName::Pin | ReadingName::Full);
        let implicit = all.iter().filter(|ran| ran.method == METHODS[1]).map(|ran| ran.t);
        let implicit = implicit.fold(0.0, f64::max);
        let before = std::mem::replace(&mut self.class, Class::Agree);
        for ran in &all {
            self.alone(ran, joint, [config.run.t_end, implicit], has_balance);
            self.work += ran.work;
        }
        for ran in all.iter().filter(|ran| ran.method != base.method) {
            self.together((base, ran), block, &growth);
        }
        let is_buried = |ran: &Ran| ran.audit.deepest * block.clearance > block.pin_radius;
        let is_told = |ran: &Ran| ran.audit.deepest > 1.0;
        if self.class.is_found() && all.iter().any(is_buried) {
            self.class = Class::Refused;
            self.lines
                .push(format!("joint {joint}: deeper than the pin's radius, of which a run warns"));
        } else if self.class == Class::Disagree && all.iter().any(is_told) {
            self.class = Class::Warned;
            self.lines
                .push(format!("joint {joint}: deeper than the clearance, of which a run warns"));
        }
        if self.class.is_found() {
            let until = growth.until(HORIZON_ERROR);
            self.lines.push(format!("joint {joint}: predictable up to {until:.6e} s"));
            self.lines.extend(all.iter().map(|ran| told(ran, joint)));
        }
        self.class = self.class.max(before);
    }

    /// What a run shows by itself.
    ///
    /// `implicit` is how far the implicit run came [s].
    fn alone(&mut self, ran: &Ran, joint: usize, [t_end, implicit]: [f64; 2], has_balance: bool) {
        let who = format!("joint {joint}, {} at {:.6e} s", ran.method, ran.t);
        match &ran.end {
            End::Finished | End::Stopped => {}
            End::Refused(why) => self.add(Class::Refused, format!("{who}: {why}")),
            End::Failed(why) => self.add(Class::Failed, format!("{who}: {why}")),
            // It comes on: what it did until then is judged.
            End::Cut("work") if ran.t > LEAST_SHARE * t_end => {}
            End::Cut(_) if implicit > FARTHER * ran.t => {
                let why = "its steps are bound by stability, radau5 came to";
                self.add(Class::Stiff, format!("{who}: {why} {implicit:.6e} s"));
            }
            End::Cut(by) => self.add(Class::Timeout, format!("{who}: more {by} than its budget")),
        }
        if !ran.is_finite() {
            self.add(Class::Disagree, format!("{who}: numbers that are not finite"));
        }
        for (what, astray) in ran.audit.all() {
            if astray.total_cmp(&MOST_ASTRAY).is_gt() {
                self.add(Class::Disagree, format!("{who}: {what}: {astray:.1e}"));
            }
        }
        if has_balance {
            let residual = ran.balance.residual.abs() / energy_of(&ran.balance);
            self.residual = self.residual.max(residual);
            if residual.total_cmp(&MOST_RESIDUAL).is_gt() {
                self.add(Class::Disagree, format!("{who}: energy residual {residual:.1e} of all"));
            }
        }
    }

    /// What two runs show beside each other, up to their horizon.
    fn together(&mut self, (a, b): (&Ran, &Ran), block: &Block, growth: &Growth) {
        let allowed = |grown: f64| MOST_E + MOST_OF_GROWTH * grown;
        let apart = Apart::new((a, b), block, growth, allowed, [HORIZON_ERROR, STEADY]);
        let (unit, joint, until) = (block.unit_of_time(), block.joint, growth.until(HORIZON_ERROR));
        self.e = self.e.max(apart.e);
        self.of_allowed = self.of_allowed.max(apart.of_allowed);
        self.modes_s = self.modes_s.max(apart.modes_s / unit);
        let short = until.min(a.t).min(b.t);
        if until < a.t.max(b.t) {
            self.class = self.class.max(Class::Past);
        }
        let who = format!("joint {joint}, {} and {} up to {short:.6e} s", a.method, b.method);
        let pairs = a.joints.iter().zip(&b.joints);
        let partings = pairs.filter_map(|(own, other)| parting(&own.events, &other.events));
        let parted = partings.reduce(f64::min).filter(|t| *t < growth.until(STEADY).min(short));
        let (class, why) = match parted {
            Some(t) => (Class::Warned, format!("; other events from {t:.6e} s on, which is told")),
            None => (Class::Disagree, String::new()),
        };
        if apart.of_allowed.total_cmp(&1.0).is_gt() {
            let (e, times) = (apart.e, apart.of_allowed);
            self.add(class, format!("{who}: e {e:.1e}, {times:.1e} of what is allowed{why}"));
        }
        let late = apart.modes_s.max(apart.end_s);
        // An error of the gap is one of the time of a contact, by the speed at which that begins.
        let slowest = a.audit.slowest.min(b.audit.slowest);
        let by_speed = if slowest > 0.0 { MOST_E * block.clearance / slowest } else { 0.0 };
        if late > MOST_MODES * unit + by_speed {
            self.add(class, format!("{who}: modes differ for {late:.1e} s{why}"));
        }
        let refused = |ran: &Ran| matches!(ran.end, End::Refused(_));
        let one_alone = (refused(a) && b.is_complete()) || (refused(b) && a.is_complete());
        if one_alone && a.t.min(b.t) < growth.until(STEADY) {
            self.add(Class::Disagree, format!("{who}: one alone is refused"));
        }
    }
}

/// A run in a line.
fn told(ran: &Ran, joint: usize) -> String {
    let events: usize = ran.joints.iter().map(|own| own.events.len()).sum();
    let (balance, audit) = (&ran.balance, &ran.audit);
    let end = match &ran.end {
        End::Finished => "finished".to_owned(),
        End::Stopped => "at 90 degrees".to_owned(),
        End::Refused(why) => format!("refused, {why}"),
        End::Failed(why) => format!("failed, {why}"),
        End::Cut(by) => format!("more {by} than its budget"),
    };
    format!(
        "joint {joint}, {}: {end}, t {:.6e} s, {events} events, work {:.2e} J, kinetic {:.2e}, elastic {:.2e}, \
         dissipated {:.2e}, residual {:.1e}, deepest {:.1e} c, {:.1e} N",
        ran.method,
        ran.t,
        balance.work,
        balance.kinetic,
        balance.elastic,
        balance.dissipated,
        balance.residual,
        audit.deepest,
        audit.force
    )
}
