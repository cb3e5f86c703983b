//! Which method, at which setting, for this contact?

use crate::digits::as_meant;
use crate::part::Subject;
use crate::reference::{ReferenceError, ReferenceSummary};
use crate::run::{Events, Limits};
use crate::selection::{Benchmark, CUT, Contest, Entry, Failure, FailureKind, Rules, Standings};
use crate::warning::{Code, Warning};
use crate::work_precision::{ENOUGH, Progress};

/// More events of a site than this in a unit of the subject's time are named chatter: a rattling joint has some 15 a second.
const CHATTER_RATE: f64 = 500.0;
/// An accuracy that all methods that locate events reach at some setting, where the reference is right.
const IN_REACH: f64 = 1e-6;
/// Steps that grow less than this for a tenth of the tolerance are not chosen for accuracy.
const HARDLY: f64 = 1.05;

/// The answer for one subject and accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// The error asked for.
    pub accuracy: f64,
    /// The end of the runs compared [s].
    pub t_end: f64,
    /// Events of the reference.
    pub n_events: usize,
    /// Who reaches the accuracy, and who does not.
    pub standings: Standings,
    /// Why the first is the first, or why there is none.
    pub reason: String,
    /// What to know before trusting it.
    pub warnings: Vec<Warning>,
}

impl Recommendation {
    /// The method to take, if any reaches the accuracy.
    pub fn first(&self) -> Option<&Entry> {
        self.standings.entries.first()
    }

    fn none(accuracy: f64, t_end: f64, reason: String, warnings: Vec<Warning>) -> Self {
        Self { accuracy, t_end, n_events: 0, standings: Standings::default(), reason, warnings }
    }
}

/// The contest on `subject` to `t_end` [s] at `accuracy`, states compared at `times`; `warnings` are known already.
pub fn recommend(
    subject: Subject,
    (t_end, times): (f64, Vec<f64>),
    accuracy: f64,
    rules: &Rules,
    limits: Limits<'_>,
    mut warnings: Vec<Warning>,
    progress: &dyn Fn(Progress),
) -> Recommendation {
    let benchmark = match Benchmark::new(subject, t_end, times, limits) {
        Ok(benchmark) => benchmark,
        Err(error) => {
            warnings.extend(storm(&error));
            return Recommendation::none(accuracy, t_end, error.to_string(), warnings);
        }
    };
    if let Some(horizon) = benchmark.horizon {
        let message = format!(
            "the last bit of the start is seen at {} s, the run is {t_end} s long: beyond that no \
             error means anything; compared over {} s",
            as_meant(horizon),
            as_meant(benchmark.t_end)
        );
        warnings.push(Warning { code: Code::Horizon, message });
    }
    warnings.extend_from_slice(&benchmark.reference.summary.warnings);
    if let Some(reason) = benchmark.ill_posed() {
        let reason = format!("ill-posed: {reason}");
        return Recommendation::none(accuracy, benchmark.t_end, reason, warnings);
    }
    warnings.extend(chatter(&benchmark));
    let contest = Contest { benchmark: &benchmark, accuracy, rules, stop: limits.stop };
    if !contest.is_decidable() {
        let reason = format!("not decidable: {}", benchmark.reference.summary.undecided());
        return Recommendation::none(accuracy, benchmark.t_end, reason, warnings);
    }
    progress(Progress::Runs(rules.candidates.len()));
    let standings = contest.run(&|name| progress(Progress::Done(name.to_owned())));
    warnings.extend(grazing(&benchmark, &standings));
    warnings.extend(alone(&benchmark.reference.summary, accuracy, &standings));
    let reason = reason(&standings, benchmark.n_events);
    let (t_end, n_events) = (benchmark.t_end, benchmark.n_events);
    Recommendation { accuracy, t_end, n_events, standings, reason, warnings }
}

/// The warning that there are very many events.
fn chatter(benchmark: &Benchmark) -> Option<Warning> {
    let n_sites = benchmark.subject.parts.iter().map(|part| part.sites.len()).sum::<usize>() as f64;
    let time = benchmark.t_end / benchmark.subject.unit_of_time();
    let rate = benchmark.n_events as f64 / n_sites / time;
    let message = format!("{} mode changes in {} s", benchmark.n_events, benchmark.t_end);
    (rate > CHATTER_RATE).then_some(Warning { code: Code::Chatter, message })
}

/// The warning that a reference broke down in events.
fn storm(error: &ReferenceError) -> Option<Warning> {
    use deltazero_solvers::Error::{Chatter, EventStorm};
    match error {
        ReferenceError::Failed { error: own, .. }
            if matches!(**own, Chatter { .. } | EventStorm { .. }) =>
        {
            Some(Warning { code: Code::Chatter, message: error.to_string() })
        }
        _ => None,
    }
}

/// The warning that an event hardly is one, so that a change of the tolerance changes the sequence: the
/// reference and its check disagree about it, or a tighter setting of the winner has it wrong, or every
/// located run of a small enough error has.
fn grazing(benchmark: &Benchmark, standings: &Standings) -> Option<Warning> {
    let is_wrong = |failure: &Failure| {
        failure.events == Events::Located && failure.kind == FailureKind::EventsWrong
    };
    let is_located = |entry: &Entry| entry.events == Events::Located;
    let what = if benchmark.reference.summary.event_time_agreement_s.is_none() {
        "the reference and its check differ in their events"
    } else if standings.entries.first().is_some_and(|first| first.grazes) {
        "a tighter setting than the one found has the events wrong"
    } else if !standings.entries.iter().any(is_located) && standings.failures.iter().any(is_wrong) {
        "no located run of a small enough error has the events right"
    } else {
        return None;
    };
    let message = format!("{what}: one of them hardly is one");
    Some(Warning { code: Code::Grazing, message })
}

/// The warning that only the method of the reference comes near it, while [`ENOUGH`] others do not at any setting: two
/// runs of one method may miss the same event.
fn alone(reference: &ReferenceSummary, accuracy: f64, standings: &Standings) -> Option<Warning> {
    let is_far = |own: &&Failure| {
        use FailureKind::{EventStorm, EventsWrong, OutOfReach};
        own.events == Events::Located
            && matches!(own.kind, OutOfReach | EventsWrong | EventStorm)
            && reference.is_made_without(&own.method)
    };
    let far: Vec<&Failure> = standings.failures.iter().filter(is_far).collect();
    let is_near = standings.entries.iter().any(|entry| reference.is_made_without(&entry.method));
    if accuracy < IN_REACH || far.len() < ENOUGH || is_near {
        return None;
    }
    let far: Vec<String> =
        far.iter().map(|own| format!("{} ({})", own.method, own.kind.name())).collect();
    let message = format!(
        "no method other than that of the reference comes near it: {}; if they agree, the reference is wrong",
        far.join(", ")
    );
    Some(Warning { code: Code::Reference, message })
}

/// One plain sentence, from the measured numbers.
fn reason(standings: &Standings, n_events: usize) -> String {
    let Some(first) = standings.entries.first() else {
        return "no method reaches it".to_owned();
    };
    let mut reason = format!("{} {}", name(first), bound(first, n_events));
    reason += &beside(standings, first);
    if first.events == Events::Blind && first.missed + first.spurious > 0 {
        reason += &format!(
            "; blind, it has {} of {n_events} events missed and {} spurious",
            first.missed, first.spurious
        );
    }
    let rivals = standings.entries.iter().skip(1);
    let near: Vec<String> =
        rivals.filter(|rival| rival.is_within_noise_of(first)).map(name).collect();
    if !near.is_empty() {
        reason += &format!("; within the noise of the times: also {}", near.join(", "));
    }
    reason
}

/// How the best of the other kind does beside the first, or why there is none. `auto` is of no kind, being of both: it
/// stands for none, and beside it stands the best that is the same throughout.
fn beside(standings: &Standings, first: &Entry) -> String {
    let (is_auto, first_implicit) = (first.is_auto(), first.implicit);
    let is_other =
        |of_auto: bool, implicit: bool| !of_auto && (is_auto || implicit != first_implicit);
    let kind = match (is_auto, first_implicit) {
        (true, _) => "other",
        (false, true) => "explicit",
        (false, false) => "implicit",
    };
    let mut entries = standings.entries.iter();
    if let Some(other) = entries.find(|entry| is_other(entry.is_auto(), entry.implicit)) {
        let a_step = |entry: &Entry| entry.time_s() / entry.n_accepted as f64;
        let held = if other.bound_by_stability { " (held by stability)" } else { "" };
        return format!(
            "; the best {kind} one, {} {}, takes {} steps{held} against {}, each at {} times the price",
            name(other),
            other.setting(),
            other.n_accepted,
            first.n_accepted,
            factor(a_step(other) / a_step(first)),
        );
    }
    let kinds = [false, true].into_iter().filter(|implicit| is_other(false, *implicit));
    let lost: Vec<&Failure> = kinds.flat_map(|implicit| standings.lost(implicit)).collect();
    if lost.is_empty() {
        return String::new();
    }
    let none = format!("; no {kind} method that locates events");
    if lost.iter().any(|failure| failure.kind != FailureKind::Cut) {
        let why = |own: &&Failure| format!("{} ({})", own.method, own.kind.name());
        let all: Vec<String> = lost.iter().map(why).collect();
        return format!("{none} reaches it: {}", all.join(", "));
    }
    let step = lost.iter().filter_map(|failure| failure.mean_step_s).fold(0.0, f64::max);
    format!(
        "{none} comes within {CUT} times its work (mean steps of at most {step:.1e} s against {:.1e} s)",
        first.mean_step_s
    )
}

fn name(entry: &Entry) -> String {
    format!("{} {}", entry.method, entry.events)
}

/// What its steps are bound by; of `auto`, which half of it takes them.
fn bound(entry: &Entry, n_events: usize) -> String {
    let steps = match n_events {
        0 => format!("{} steps, no event", entry.n_accepted),
        n => format!("{} steps an event", factor(entry.n_accepted as f64 / n as f64)),
    };
    let growth = entry.growth.map_or_else(String::new, |growth| {
        format!(", {growth:.2} times as many for a tenth of the tolerance")
    });
    let by = match (entry.implicit_steps(), entry.bound_by_stability) {
        (Some(halves), _) => format!("takes {halves}"),
        (None, true) => "is bound by stability".to_owned(),
        (None, false) if entry.growth.is_some_and(|growth| growth < HARDLY) => match n_events {
            0 => "needs hardly more steps for a tighter tolerance".to_owned(),
            _ => "takes the steps that its events ask for".to_owned(),
        },
        (None, false) => "is bound by accuracy".to_owned(),
    };
    format!("{by}: {steps}{growth}")
}

/// A factor to two digits.
fn factor(x: f64) -> String {
    if x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::plan::sample_times;
    use crate::problems::balls::LIGHT_BALL;
    use crate::selection::Candidate;

    const T_END: f64 = 0.2;

    /// A mass between two damped walls, five contacts.
    fn subject() -> Subject {
        Subject::of(LIGHT_BALL)
    }

    fn standings(methods: &[&str], accuracy: f64) -> Standings {
        let methods: Vec<String> = methods.iter().map(|name| (*name).to_owned()).collect();
        let candidates = Candidate::all(&methods, Events::ALL);
        let rules = Rules { candidates, repeats: 1, ..Rules::default() };
        let (span, stop) = ((T_END, sample_times(None, T_END)), AtomicBool::new(false));
        let limits = Limits::none(&stop);
        recommend(subject(), span, accuracy, &rules, limits, Vec::new(), &|_| ()).standings
    }

    #[test]
    fn auto_stands_for_no_kind_and_tells_its_implicit_steps() {
        let mut all = standings(&["auto", "rk45", "radau5"], 1e-4);
        all.entries.sort_by_key(|entry| (!entry.implicit, !entry.is_auto()));
        // Out of the order of their times, of which nothing is to be said here.
        all.entries.iter_mut().for_each(|entry| entry.timed = false);
        for entry in all.entries.iter_mut().filter(|entry| entry.is_auto()) {
            (entry.n_accepted, entry.n_implicit) = (4704, Some(4007));
        }
        let names: Vec<&str> = all.entries.iter().map(|entry| entry.method.as_str()).collect();
        assert!(names.starts_with(&["radau5"]) && names.contains(&"auto"), "{names:?}");
        let beside_implicit = reason(&all, 2);
        assert!(beside_implicit.contains("the best explicit one, rk45 "), "{beside_implicit}");
        // Where auto alone stands beside it, no explicit one is named, nor among what was lost.
        all.entries.retain(|entry| entry.implicit || entry.is_auto());
        let alone = reason(&all, 2);
        assert!(!alone.contains("explicit one") && !alone.contains("auto"), "{alone}");
        all.failures.push(Failure {
            method: "auto".to_owned(),
            events: Events::Located,
            implicit: false,
            kind: FailureKind::Cut,
            message: String::new(),
            mean_step_s: Some(1e-3),
        });
        assert_eq!(reason(&all, 2), alone);
        let rk4 = Failure { method: "rk4".to_owned(), ..all.failures[0].clone() };
        let with = |kind, events| {
            let failures = vec![Failure { kind, events, ..rk4.clone() }];
            reason(&Standings { failures, ..all.clone() }, 2)
        };
        let cut = with(FailureKind::Cut, Events::Located);
        assert!(cut.contains("no explicit method that locates events comes within 10 "), "{cut}");
        let limit = with(FailureKind::Limit, Events::Located);
        assert!(limit.contains("no explicit method that locates events reaches it: rk4 (limit)"));
        assert_eq!(with(FailureKind::Cut, Events::Blind), alone);

        all.entries.sort_by_key(|entry| !entry.is_auto());
        let first = reason(&all, 2);
        assert!(
            first.contains("takes 4007 of its 4704 steps implicit: 2352 steps an event"),
            "{first}"
        );
        assert!(
            first.contains("; the best other one, radau5 ") && !first.contains("bound by"),
            "{first}"
        );
    }

    #[test]
    fn a_blind_run_is_told_with_the_events_that_it_has_wrong() {
        let mut all = standings(&["rk45"], 1e-4);
        all.entries.truncate(1);
        (all.entries[0].events, all.entries[0].missed, all.entries[0].spurious) =
            (Events::Blind, 1, 0);
        let own = reason(&all, 5);
        assert!(own.contains("; blind, it has 1 of 5 events missed and 0 spurious"), "{own}");
        (all.entries[0].missed, all.entries[0].spurious) = (0, 0);
        assert!(!reason(&all, 5).contains("blind, it has"));
    }

    #[test]
    fn what_bounds_the_steps_is_told() {
        let mut few = standings(&["dop853"], 1e-6);
        few.entries[0].growth = Some(1.0);
        let own = reason(&few, 6);
        assert!(own.contains("takes the steps that its events ask for: "), "{own}");
        let fine = standings(&["rk45"], 1e-6);
        assert!(reason(&fine, 6).contains("is bound by accuracy: "), "{}", reason(&fine, 6));
        // A fixed step is not held by stability where no longer one is tried.
        let coarsest = standings(&["rk4"], 1e-2);
        let entry = &coarsest.entries[0];
        assert!(entry.e < 1e-4 && !entry.bound_by_stability, "{entry:?}");
        let mut held = few;
        held.entries[0].bound_by_stability = true;
        assert!(reason(&held, 6).contains("is bound by stability: "));
    }

    #[test]
    fn what_needs_more_than_the_limits_is_not_told_as_slower_than_others() {
        let methods = ["rk45", "radau5"].map(str::to_owned);
        let candidates = Candidate::all(&methods, &[Events::Located]);
        let rules = Rules { candidates, max_work: 10.0, ..Rules::default() };
        let (span, stop) = ((T_END, sample_times(None, T_END)), AtomicBool::new(false));
        let limits = Limits::none(&stop);
        let answer = recommend(subject(), span, 1e-6, &rules, limits, Vec::new(), &|_| ());
        let failures = &answer.standings.failures;
        assert!(failures.iter().all(|own| own.kind == FailureKind::Limit), "{failures:?}");
        assert_eq!(failures.len(), 2);
        assert!(failures[0].message.contains("contest.max_work = 1e1"), "{failures:?}");
    }

    #[test]
    fn events_that_hang_on_the_tolerance_are_named_grazing() {
        let stop = AtomicBool::new(false);
        let (times, limits) = (sample_times(None, T_END), Limits::none(&stop));
        let benchmark = Benchmark::new(subject(), T_END, times, limits).unwrap();
        let standings = standings(&["rk45"], 1e-6);
        assert!(grazing(&benchmark, &standings).is_none());

        let mut tighter_differs = standings.clone();
        tighter_differs.entries[0].grazes = true;
        let warning = grazing(&benchmark, &tighter_differs).unwrap();
        assert!(warning.code == Code::Grazing && warning.message.contains("tighter"));

        let mut none_is_right = standings;
        none_is_right.entries.retain(|entry| entry.events == Events::Blind);
        let wrong = |events| Failure {
            method: "rk45".to_owned(),
            events,
            implicit: false,
            kind: FailureKind::EventsWrong,
            message: String::new(),
            mean_step_s: None,
        };
        none_is_right.failures.push(wrong(Events::Blind));
        assert!(grazing(&benchmark, &none_is_right).is_none());
        none_is_right.failures.push(wrong(Events::Located));
        let warning = grazing(&benchmark, &none_is_right).unwrap();
        assert!(warning.code == Code::Grazing && warning.message.contains("no located run"));
    }

    #[test]
    fn a_reference_that_only_its_own_method_comes_near_is_doubted() {
        let stop = AtomicBool::new(false);
        let (times, limits) = (sample_times(None, T_END), Limits::none(&stop));
        let benchmark = Benchmark::new(subject(), T_END, times, limits).unwrap();
        let reference = &benchmark.reference.summary;
        let mut standings = standings(&["taylor"], 1e-4);
        let far = |method: &str, kind| Failure {
            method: method.to_owned(),
            events: Events::Located,
            implicit: false,
            kind,
            message: String::new(),
            mean_step_s: None,
        };
        standings.failures = vec![
            far("rk45", FailureKind::OutOfReach),
            far("radau5", FailureKind::EventsWrong),
            far("dop853", FailureKind::Cut),
        ];
        assert!(alone(reference, 1e-4, &standings).is_none());
        standings.failures.push(far("rk4", FailureKind::OutOfReach));
        let warning = alone(reference, 1e-4, &standings).unwrap();
        assert!(warning.message.contains("rk45 (out_of_reach), radau5 (events_wrong), rk4 ("));
        assert!(alone(reference, 1e-12, &standings).is_none());
        // One that does, be it blind, is of the same opinion as the reference.
        standings.entries[0].method = "vern98".to_owned();
        standings.entries[0].events = Events::Blind;
        assert!(alone(reference, 1e-4, &standings).is_none());
    }
}
