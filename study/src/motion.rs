//! The motion of a subject as a figure shows it: the whole run, and one flight with the impact after it, or one stay in a
//! mode and what follows.

use std::collections::{HashMap, HashSet};

use deltazero_solvers::Method;

use crate::part::{Part, Subject};
use crate::run::{Accuracy, Limits, ModeChange, Price, Setting};
use crate::setting::Events;
use crate::simulation::SiteMotion;

/// Tolerance of the run that is shown: beyond what a picture can tell.
const RTOL: f64 = 1e-10;
/// Points over the whole run, and over the zoom.
const POINTS: u32 = 4000;
const ZOOM_POINTS: u32 = 1000;
/// Times that a run which ends before its first point is run again, at most: each to a 4000th of the time before.
const ROUNDS: u32 = 8;
/// Time shown before and after the flight that is zoomed in on, in flights.
const MARGIN: f64 = 0.6;
/// Zoom of a run without a flight, as a fraction of it.
const FIRST_PART: f64 = 0.02;
/// Events after the stay that is zoomed in on, at most.
const EVENTS_AFTER: usize = 6;
/// A mode is frequent that at least one in so many events lead into.
const FREQUENT: usize = 20;
/// A mode that is never stayed in for longer than this part of the run cannot be seen in it.
const UNSEEN: f64 = 1.0 / 400.0;
/// Stays around such a mode that are shown with it last no longer than this part of the run, and are so many on each side.
const SHORT: (f64, usize) = (1.0 / 50.0, 2);

/// The motion of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The whole run: the first site of each part, without the event of a start on a surface.
    pub sites: Vec<SiteMotion>,
    /// The first of them around its first flight: the end of a contact, the flight, and the contact after it; around a
    /// stay in a mode that has a name, and some events more, if there is no flight; else the first part of the run.
    pub zoom: SiteMotion,
    /// When that flight begins and ends [s], if there is one.
    pub flight: Option<(f64, f64)>,
    /// That flight or stay by the names of its modes, where modes have names.
    pub stay: Option<Stay>,
    /// The same site where it first is in modes with names that cannot be seen over the whole run, if there are any: with as
    /// much time before and after.
    pub detail: Option<SiteMotion>,
    /// [Names](crate::Problem::named_modes) of the modes of the first part.
    pub modes: Vec<String>,
    /// How it was computed.
    pub method: String,
}

/// A time in modes that have names.
#[derive(Clone, Debug, PartialEq)]
pub struct Stay {
    /// When it begins and ends [s].
    pub span: (f64, f64),
    /// Its modes.
    pub modes: Vec<String>,
}

impl Motion {
    /// The motion of `subject` to `t_end` by `rk45` located at rtol 1e-10; none of a subject without parts.
    pub fn new(subject: &Subject, t_end: f64, limits: Limits<'_>) -> Option<Self> {
        let method = Method::named("rk45")?;
        let setting =
            Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(RTOL, None) };
        let run = |part: &Part, times: &[f64], t_end: f64| {
            let mut watch = limits.watch(Price::of_setting(&setting));
            let mut site = part.motion(&setting, times, t_end, &mut watch)?;
            site.changes.retain(|change| !change.is_of_start);
            Some(site)
        };
        let over = |t_end: f64| -> Vec<SiteMotion> {
            let spacing = t_end / f64::from(POINTS);
            let times: Vec<f64> =
                (1..=POINTS).map(|k| (spacing * f64::from(k)).min(t_end)).collect();
            subject.parts.iter().filter_map(|part| run(part, &times, t_end)).collect()
        };
        let (mut t_end, mut sites) = (t_end, over(t_end));
        // All of them may come to an event that ends them long before.
        for _ in 0..ROUNDS {
            let ends = sites.iter().filter_map(|site| site.times.last().copied());
            let reached = ends.fold(0.0, f64::max) + t_end / f64::from(POINTS);
            if reached >= 0.5 * t_end {
                break;
            }
            t_end = reached;
            sites = over(t_end);
        }
        let (part, first) = (subject.parts.first()?, sites.first()?);
        let changes: Vec<ModeChange> = first.changes.iter().map(|change| change.by_code).collect();
        let is_named = !part.modes.is_empty();
        let flight = if is_named {
            flight_of_named(&changes)
        } else {
            first_flight(&changes).or_else(|| first_flight(&sampled(first)))
        };
        let span = flight.or_else(|| typical_stay(&changes)).filter(|_| is_named);
        let (from, to) = match (flight, span) {
            (Some(flight), _) => around(flight, t_end),
            (None, Some(stay)) => with_more(stay, &changes, t_end),
            (None, None) => (0.0, FIRST_PART * t_end),
        };
        let stay = span.map(|span| Stay { span, modes: modes_in(first, span) });
        let close = |(from, to): (f64, f64)| {
            let spacing = (to - from) / f64::from(ZOOM_POINTS);
            let time = |k: u32| from + spacing * f64::from(k);
            let mut site = run(part, &(0..=ZOOM_POINTS).map(time).collect::<Vec<_>>(), to)?;
            site.changes.retain(|change| from <= change.t && change.t <= to);
            Some(site)
        };
        let zoom = close((from, to))?;
        let detail = unseen(first, t_end).filter(|_| is_named).and_then(close);
        let (modes, method) = (part.modes.clone(), setting.to_string());
        Some(Self { zoom, flight, stay, detail, modes, method, sites })
    }
}

/// Where a site is in contact and where not, from its samples alone: events of other sites change that too.
fn sampled(site: &SiteMotion) -> Vec<ModeChange> {
    let contact = |i: usize| i8::from(site.touches[i].0);
    let change = |i: usize| ModeChange::new(site.times[i], contact(i - 1), contact(i));
    let all = (1..site.touches.len()).map(change);
    all.filter(|change| change.before != change.after).collect()
}

/// The first flight from one event to the next, if there is one.
fn first_flight(events: &[ModeChange]) -> Option<(f64, f64)> {
    let flight = events.windows(2).find(|pair| pair[0].after == 0 && pair[1].before == 0)?;
    Some((flight[0].t, flight[1].t))
}

/// The first flight where modes have names: it may go through several of them, as after a contact that ends dented. None
/// where no mode is a contact.
fn flight_of_named(changes: &[ModeChange]) -> Option<(f64, f64)> {
    let is_free = |change: &ModeChange| change.before == 0 && change.after == 0;
    if changes.iter().all(is_free) {
        return None;
    }
    let goes_on = |change: &ModeChange| is_free(change) && change.numbers[0] != change.numbers[1];
    let ends: Vec<ModeChange> = changes.iter().copied().filter(|change| !goes_on(change)).collect();
    // An impact after which it lies there is no flight.
    first_flight(&ends).filter(|(from, to)| from < to)
}

/// The time between two events, if there is one: the first such that it and what is shown after it go through as many of
/// the frequent modes as any.
fn typical_stay(changes: &[ModeChange]) -> Option<(f64, f64)> {
    let mut entered: HashMap<u16, usize> = HashMap::new();
    for change in changes {
        *entered.entry(change.numbers[1]).or_default() += 1;
    }
    let n_modes = |begin: usize| {
        let shown = changes[begin..].iter().take(1 + EVENTS_AFTER).map(|change| change.numbers[1]);
        let frequent = shown.filter(|mode| entered[mode] * FREQUENT >= changes.len());
        frequent.collect::<HashSet<_>>().len()
    };
    let lasts = |begin: &usize| changes[*begin].t < changes[begin + 1].t;
    let begins = (0..changes.len().saturating_sub(1)).filter(lasts);
    let begin =
        begins.reduce(|best, begin| if n_modes(begin) > n_modes(best) { begin } else { best })?;
    Some((changes[begin].t, changes[begin + 1].t))
}

/// The names of the modes in which `site` is during `span`, each once.
fn modes_in(site: &SiteMotion, (from, to): (f64, f64)) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for pair in site.changes.windows(2) {
        let is_inside = from <= pair[0].t && pair[0].t < pair[1].t && pair[1].t <= to;
        if is_inside && !names.contains(&pair[0].after) {
            names.push(pair[0].after.clone());
        }
    }
    names
}

/// A time around the first mode that cannot be seen over the whole run, with short stays before and after it.
fn unseen(site: &SiteMotion, t_end: f64) -> Option<(f64, f64)> {
    let stays = site.stays();
    let mut longest: HashMap<&str, f64> = HashMap::new();
    for (name, (from, to)) in &stays {
        let known = longest.entry(name).or_default();
        *known = known.max(to - from);
    }
    let at = stays.iter().position(|(name, _)| longest[name] < UNSEEN * t_end)?;
    let is_short = |(_, (from, to)): &&(&str, (f64, f64))| to - from < SHORT.0 * t_end;
    let before = stays[..at].iter().rev().take(SHORT.1).take_while(is_short).last();
    let after = stays[at..].iter().take(1 + SHORT.1).take_while(is_short).last();
    let (from, to) = (before.unwrap_or(&stays[at]).1.0, after.unwrap_or(&stays[at]).1.1);
    let margin = to - from;
    Some(((from - margin).max(0.0), (to + margin).min(t_end)))
}

/// From before a stay to some events after it.
fn with_more((from, to): (f64, f64), changes: &[ModeChange], t_end: f64) -> (f64, f64) {
    let after = changes.iter().filter(|change| change.t > to).take(EVENTS_AFTER);
    let last = after.last().map_or(to, |change| change.t);
    let margin = MARGIN * (to - from);
    ((from - margin).max(0.0), (last + margin).min(t_end))
}

/// From before a flight to after it.
fn around((from, to): (f64, f64), t_end: f64) -> (f64, f64) {
    let margin = MARGIN * (to - from);
    ((from - margin).max(0.0), (to + 2.0 * margin).min(t_end))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero_solvers::{Next, Real, System};

    use super::*;
    use crate::problem::{Problem, Quantity};
    use crate::simulation::NamedChange;

    /// `ẏ = −1`, ended where y is zero.
    struct Falling;

    impl System for Falling {
        type Mode = ();
        type State<S: Real> = [S; 1];
        type Guards<S: Real> = [S; 1];

        fn initial_mode(&self, _t: f64, _y: &[f64; 1]) {}

        fn rhs<S: Real>(&self, (): (), _t: S, _y: &[S; 1], dydt: &mut [S; 1]) {
            *dydt = [S::cst(-1.0)];
        }

        fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 1], g: &mut [S; 1]) {
            *g = *y;
        }

        fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut [S; 1]) -> Next<()> {
            Next::Stop
        }
    }

    impl Problem for Falling {
        fn start(&self) -> [f64; 1] {
            [1.0]
        }

        fn states(&self) -> Vec<Quantity> {
            vec![Quantity::new("y", "m", 1.0)]
        }
    }

    #[test]
    fn a_run_that_ends_long_before_its_time_is_shown_to_its_end() {
        let stop = AtomicBool::new(false);
        for (t_end, n_least) in [(1e7, 3000), (1000.0, 3000), (1.5, 2600)] {
            let motion = Motion::new(&Subject::of(Falling), t_end, Limits::none(&stop)).unwrap();
            let times = &motion.sites[0].times;
            assert!(times.len() >= n_least && *times.last().unwrap() > 0.99, "{}", times.len());
            assert!(*motion.zoom.times.last().unwrap() < 0.1);
        }
    }

    #[test]
    fn a_mode_too_short_to_be_seen_is_shown_with_short_ones_around_it() {
        // Flights with a contact that lasts 2 of 1000, and a moment of leaving after it.
        let ends = [300.0, 302.0, 303.0, 700.0, 702.0, 703.0];
        let name = |i: usize| ["flight", "contact", "leaving"][i % 3].to_owned();
        let named = |(i, t): (usize, &f64)| {
            let by_code = ModeChange::new(*t, 0, 0);
            NamedChange { by_code, t: *t, before: name(i), after: name(i + 1), is_of_start: false }
        };
        let site = |n: usize| SiteMotion {
            name: String::new(),
            labels: Vec::new(),
            columns: Vec::new(),
            times: vec![0.0, 1000.0],
            mode_of: vec![0, 0],
            modes: vec!["flight".to_owned()],
            values: Vec::new(),
            touches: Vec::new(),
            changes: ends[..n].iter().enumerate().map(named).collect(),
        };
        assert_eq!(unseen(&site(6), 1000.0), Some((297.0, 306.0)));
        assert_eq!(unseen(&site(1), 1000.0), None);
    }

    fn change(t: f64, [before, after]: [i8; 2], numbers: [u16; 2]) -> ModeChange {
        ModeChange { t, before, after, numbers }
    }

    #[test]
    fn a_flight_goes_on_through_modes_without_contact_and_ends_at_an_impact() {
        // Flight, contact, leaving, flight, contact.
        let dented = [
            change(1.0, [0, 1], [0, 1]),
            change(2.0, [1, 0], [1, 2]),
            change(3.0, [0, 0], [2, 0]),
            change(5.0, [0, 1], [0, 1]),
        ];
        assert_eq!(flight_of_named(&dented), Some((2.0, 5.0)));
        let landing = [change(1.0, [0, 0], [0, 0]), change(1.0, [0, 1], [0, 1])];
        assert_eq!(flight_of_named(&landing), None);
        // Two impacts, then rest.
        let bounces =
            [change(1.0, [0, 0], [0, 0]), change(2.0, [0, 0], [0, 0]), change(3.0, [0, 1], [0, 1])];
        assert_eq!(flight_of_named(&bounces), Some((1.0, 2.0)));
    }

    #[test]
    fn a_stay_is_chosen_after_which_all_frequent_modes_are_seen() {
        // A start in two modes, then three in turns, and one that is entered once.
        let mut modes: Vec<u16> = [1, 0].repeat(6);
        modes.extend([1, 2, 0].repeat(10));
        modes.extend([3, 0]);
        let changes: Vec<_> = (0..modes.len() - 1)
            .map(|i| change(i as f64, [0, 0], [modes[i], modes[i + 1]]))
            .collect();
        // The first of seven events of which the last leads into mode 2.
        assert_eq!(typical_stay(&changes), Some((6.0, 7.0)));
    }

    #[test]
    fn modes_none_of_which_is_a_contact_have_stays_and_no_flight() {
        let heater =
            [change(1.0, [0, 0], [0, 1]), change(1.0, [0, 0], [1, 2]), change(4.0, [0, 0], [2, 0])];
        assert_eq!(flight_of_named(&heater), None);
        assert_eq!(typical_stay(&heater), Some((1.0, 4.0)));
        assert_eq!(with_more((1.0, 4.0), &heater, 10.0), (0.0, 4.0 + MARGIN * 3.0));
    }
}
