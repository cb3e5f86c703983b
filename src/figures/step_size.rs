//! Step size over time, a panel a method: the whole run, and around the first flight or stay, or at the start.

use deltazero_plots::{Axis, Band, Figure, Panel, StepHistory as Chart, StepLook};
use deltazero_study::digits::count_of;
use deltazero_study::motion::Motion;
use deltazero_study::quantile::quantile;
use deltazero_study::steps::step_size::{ACCURACY, StepHistory, StepRow};

use super::modes::{look, quoted};
use super::{Drawing, LANDING, duration, number, size_axis};

/// Joint that is shown.
const PART: usize = 1;
/// Time shown before and after the middle of the first flight, in flights.
const MARGIN: f64 = 3.0;
/// Zoom of a run without a flight, as a fraction of it.
const FIRST_PART: f64 = 0.02;

/// Step size of each method on joint 1 over the whole run.
pub(super) fn whole(histories: &[StepHistory]) -> Drawing {
    let shown: Vec<&StepHistory> = of_first_part(histories).collect();
    let ends = shown.iter().filter_map(|history| history.steps.last()).map(StepRow::end);
    let end = ends.fold(0.0, f64::max);
    let sizes = size_axis(histories);
    let draw = |own: &&StepHistory| panel(own, (0.0, end), (&sizes, StepLook::Dots));
    let panels = shown.iter().map(draw).collect();
    let spreads: Vec<String> = shown.iter().map(|history| spread(history)).collect();
    let caption = format!(
        "Accepted steps{}, events located (ticks), each method at the setting of least work with \
         e ≤ {ACCURACY:e} and all events, or its most accurate (work: n_rhs and 5 for each linear system, a series of order p \
         for 2 p); all on one scale, the smallest thousandth of the steps, and steps that land on an event \
         in less than {LANDING:e} of the run, may lie below. {}.",
        of_part(&shown),
        spreads.join("; ")
    );
    let figure = Figure { share_y: true, ..Figure::stacked("Step size over time", panels) };
    Drawing { name: "step_size", caption, figure }
}

/// ` on joint 1`, with the number of its sites where they are several.
fn of_part(shown: &[&StepHistory]) -> String {
    let Some(first) = shown.first() else { return String::new() };
    match (first.name.as_str(), first.n_sites) {
        ("", ..=1) => String::new(),
        ("", n) => format!(" of {n} sites together"),
        (name, ..=1) => format!(" on {name}"),
        (name, n) => format!(" on {name}, its {n} sites together"),
    }
}

/// The same around the flight or stay that the motion is shown at, or at the start where there is none.
pub(super) fn zoom(histories: &[StepHistory], motion: Option<&Motion>) -> Drawing {
    let stay = motion.and_then(|motion| motion.stay.as_ref());
    let flight = stay.map(|stay| stay.span).or(motion.and_then(|motion| motion.flight));
    let shown: Vec<&StepHistory> = of_first_part(histories).collect();
    let ends = shown.iter().filter_map(|history| history.steps.last()).map(StepRow::end);
    let end = ends.reduce(f64::max).unwrap_or(1.0);
    let window = flight.map_or((0.0, FIRST_PART * end), |(from, to)| {
        let (middle, margin) = (0.5 * (from + to), MARGIN * (to - from));
        ((middle - margin).max(0.0), (middle + margin).min(end))
    });
    let sizes = size_axis(histories);
    let draw = |own: &&StepHistory| panel(own, window, (&sizes, StepLook::Stairs));
    let panels = shown.iter().map(draw).collect();
    let counts: Vec<String> = shown
        .iter()
        .map(|history| {
            let begins = |step: &&StepRow| window.0 <= step.t_s && step.t_s < window.1;
            let inside = || history.steps.iter().filter(begins);
            let free = inside().filter(|step| !step.kind().is_contact()).count();
            // A step of several sites has the mode of the leading one, which need not be the one that flies.
            let free = match history.n_sites {
                1 if history.modes.is_empty() => format!(" ({free} in flight)"),
                _ => String::new(),
            };
            format!("{} {}{free}", history.method, inside().count())
        })
        .collect();
    let is_named = shown.first().is_some_and(|history| !history.modes.is_empty());
    let what = stay
        .map_or("the first flight".to_owned(), |stay| format!("a stay in {}", quoted(&stay.modes)));
    let shows = match flight {
        Some((from, to)) => {
            let long = duration(to - from, 2);
            format!("around {what}{}, {long} long", of_site(motion))
        }
        None if motion.is_none() || is_named => "at the start".to_owned(),
        None => "at the start, for there is no flight".to_owned(),
    };
    let caption = format!(
        "The same runs {shows}: each step as a line of its own length. Steps that begin in the \
         {} shown: {}.",
        duration(window.1 - window.0, 1),
        counts.join(", ")
    );
    let title = match (stay, flight) {
        (Some(stay), _) => format!("Step size around one stay in {}", quoted(&stay.modes)),
        (None, Some(_)) => "Step size around one flight".to_owned(),
        (None, None) => "Step size at the start".to_owned(),
    };
    let figure = Figure { share_y: true, ..Figure::stacked(title, panels) };
    Drawing { name: "step_size_zoom", caption, figure }
}

/// ` of joint 1`, the site that is shown.
fn of_site(motion: Option<&Motion>) -> String {
    let name = motion.map_or("", |motion| motion.zoom.name.as_str());
    if name.is_empty() { String::new() } else { format!(" of {name}") }
}

fn of_first_part(histories: &[StepHistory]) -> impl Iterator<Item = &StepHistory> {
    histories.iter().filter(|history| history.part == PART)
}

fn panel(history: &StepHistory, window: (f64, f64), (sizes, look): (&Axis, StepLook)) -> Panel {
    let overlaps = |step: &&StepRow| step.end() > window.0 && step.t_s < window.1;
    let steps: Vec<&StepRow> = history.steps.iter().filter(overlaps).collect();
    let e = if history.e.is_nan() { String::new() } else { format!(", e = {:.1e}", history.e) };
    Chart {
        title: history.title() + &e,
        t: Axis::linear("t [s]").within(window.0, window.1.max(window.0 + f64::MIN_POSITIVE)),
        h: sizes.clone(),
        accepted: steps.iter().map(|step| (step.t_s, step.h_s)).collect(),
        events: history.events.clone(),
        bands: bands(history, &steps),
        color: number(&history.method),
        look,
        ..Chart::default()
    }
    .into()
}

/// The times in flight, contact and stick, or in each mode that has a name.
fn bands(history: &StepHistory, steps: &[&StepRow]) -> Vec<Band> {
    let runs = steps.chunk_by(|a, b| history.is_same_mode(a, b));
    let band = |steps: &[&StepRow]| {
        let (first, last) = (steps.first()?, steps.last()?);
        let (label, color) = look(&history.modes, history.mode_name(first), first.kind());
        Some(Band { x: (first.t_s, last.end()), color, label })
    };
    runs.filter_map(band).collect()
}

fn spread(history: &StepHistory) -> String {
    let mut sizes: Vec<f64> = history.steps.iter().map(|step| step.h_s).collect();
    let n = sizes.len();
    let mut at = |fraction: f64| quantile(&mut sizes, fraction).unwrap_or(f64::NAN);
    let (least, most) = (at(0.05), at(0.95));
    let (title, steps) = (history.title(), count_of(n, "step"));
    format!("{title}: {steps}, nine in ten between {least:.1e} and {most:.1e} s")
}
