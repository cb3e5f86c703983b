//! Which method, at which setting, for this contact?

use std::sync::atomic::AtomicBool;

use super::restitution;
use super::work_precision::{Progress, sample_times};
use crate::config::{Config, Events};
use crate::contest::{Arena, CUT, Candidate, Contest, Entry, Failure, FailureKind, Standings};
use crate::reference::ReferenceError;
use crate::warning::{Code, Warning};

/// More mode changes of a joint than this a second are named chatter \[1/s\]: Table 1 has 15. Of a slider-crank a
/// turn counts as that second: the benchmark has 36.
const CHATTER_RATE: f64 = 500.0;

/// The answer for one configuration and accuracy.
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

/// The contest on the problem of `config` at `accuracy`.
pub fn recommend(
    config: &Config,
    accuracy: f64,
    stop: &AtomicBool,
    progress: &dyn Fn(Progress),
) -> Recommendation {
    let t_end = config.run.t_end;
    let mut warnings = restitution::warnings(config);
    let arena = match Arena::new(config, sample_times(config), stop) {
        Ok(arena) => arena,
        Err(error) => {
            warnings.extend(storm(&error));
            return Recommendation::none(accuracy, t_end, error.to_string(), warnings);
        }
    };
    if let Some(horizon) = arena.horizon {
        let message = format!(
            "the last bit of the start is seen at {horizon} s, the run is {t_end} s long: beyond that no \
             error means anything; compared over {} s",
            arena.t_end
        );
        warnings.push(Warning { code: Code::Horizon, message });
    }
    warnings.extend_from_slice(&arena.reference.summary.warnings);
    if let Some(reason) = arena.ill_posed() {
        let reason = format!("ill-posed: {reason}");
        return Recommendation::none(accuracy, arena.t_end, reason, warnings);
    }
    let n_joints = arena.reference.joints.len() as f64;
    let rate = arena.n_events as f64 / n_joints / (arena.t_end / arena.unit_s);
    if rate > CHATTER_RATE {
        let message = format!("{} mode changes in {} s", arena.n_events, arena.t_end);
        warnings.push(Warning { code: Code::Chatter, message });
    }
    let contest = Contest::of(config, &arena, accuracy, stop);
    if !contest.is_decidable() {
        let reason = format!("not decidable: {}", arena.reference.summary.undecided());
        return Recommendation::none(accuracy, arena.t_end, reason, warnings);
    }
    let candidates =
        Candidate::all(&config.contest.methods, &config.permitted(&config.contest.events));
    progress(Progress::Runs(candidates.len()));
    let standings = contest.run(&candidates, &|name| progress(Progress::Done(name.to_owned())));
    warnings.extend(grazing(&arena, &standings));
    let reason = reason(&standings, arena.n_events);
    let (t_end, n_events) = (arena.t_end, arena.n_events);
    Recommendation { accuracy, t_end, n_events, standings, reason, warnings }
}

/// The warning that a reference broke down in events.
fn storm(error: &ReferenceError) -> Option<Warning> {
    use deltazero_solvers::Error::{Chatter, EventStorm};
    match error {
        ReferenceError::Failed { error: Chatter { .. } | EventStorm { .. }, .. } => {
            Some(Warning { code: Code::Chatter, message: error.to_string() })
        }
        _ => None,
    }
}

/// The warning that an event hardly is one, so that a change of the tolerance changes the sequence: the
/// reference and its check disagree about it, or a tighter setting of the winner has it wrong, or every
/// located run has, however small its error.
fn grazing(arena: &Arena, standings: &Standings) -> Option<Warning> {
    let is_wrong = |failure: &Failure| failure.kind == FailureKind::EventsWrong;
    let is_located = |entry: &Entry| entry.events == Events::Located;
    let what = if arena.reference.summary.event_time_agreement_s.is_none() {
        "the reference and its check differ in their events"
    } else if standings.entries.first().is_some_and(|first| first.grazes) {
        "a tighter setting than the one found has the events wrong"
    } else if !standings.entries.iter().any(is_located) && standings.failures.iter().any(is_wrong) {
        "no located run has the events right, however small its error"
    } else {
        return None;
    };
    let message = format!("{what}: one of them hardly is one");
    Some(Warning { code: Code::Grazing, message })
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
    let failures = standings.failures.iter();
    let lost = failures.filter(|failure| is_other(failure.is_auto(), failure.implicit));
    let step = lost.filter_map(|failure| failure.mean_step_s).fold(0.0, f64::max);
    if step > 0.0 {
        format!(
            "; no {kind} method comes within {CUT} times its work (mean steps of at most {step:.1e} s \
             against {:.1e} s)",
            first.mean_step_s
        )
    } else {
        String::new()
    }
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
    use super::*;

    /// A contest of Table 1 up to 0.1 s at 1e-4.
    fn standings(methods: &str) -> Standings {
        let methods = format!("contest.methods={methods}");
        let sets = ["run.t_end=0.1".to_owned(), "contest.repeats=1".to_owned(), methods];
        let config = Config::load(None, &sets).unwrap();
        recommend(&config, 1e-4, &AtomicBool::new(false), &|_| ()).standings
    }

    #[test]
    fn auto_stands_for_no_kind_and_tells_its_implicit_steps() {
        let mut all = standings("[\"auto\", \"rk45\", \"radau5\"]");
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
    fn events_that_hang_on_the_tolerance_are_named_grazing() {
        let sets = ["run.t_end=0.1", "contest.methods=[\"rk45\"]", "contest.repeats=1"];
        let config = Config::load(None, &sets.map(str::to_owned)).unwrap();
        let stop = AtomicBool::new(false);
        let arena = Arena::new(&config, sample_times(&config), &stop).unwrap();
        let standings = recommend(&config, 1e-6, &stop, &|_| ()).standings;
        assert!(grazing(&arena, &standings).is_none());

        let mut tighter_differs = standings.clone();
        tighter_differs.entries[0].grazes = true;
        let warning = grazing(&arena, &tighter_differs).unwrap();
        assert!(warning.code == Code::Grazing && warning.message.contains("tighter"));

        let mut none_is_right = standings;
        none_is_right.entries.retain(|entry| entry.events == Events::Blind);
        none_is_right.failures.push(Failure {
            method: "rk45".to_owned(),
            events: Events::Located,
            implicit: false,
            kind: FailureKind::EventsWrong,
            message: String::new(),
            mean_step_s: None,
        });
        let warning = grazing(&arena, &none_is_right).unwrap();
        assert!(warning.code == Code::Grazing && warning.message.contains("no located run"));
    }
}
