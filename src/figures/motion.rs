//! States and observables over time, a panel each, with the modes as background.

use deltazero_plots::{Axis, Band, Figure, Legend, LineChart, Panel, Series, Size};
use deltazero_study::motion::Motion;
use deltazero_study::simulation::SiteMotion;

use super::modes::{MOST, look_of, quoted};
use super::{Drawing, duration};

/// Name of its files.
pub(super) const NAME: &str = "motion";

/// Panels, at most.
const MOST_PANELS: usize = 8;
/// Lines of a vector, at most; they are spread over its indices.
const MOST_LINES: usize = 4;
/// Stays that can be told apart over the whole run, at most.
const MOST_STAYS: usize = 60;
/// Beyond that a stay is narrow that takes less than this part of the run, and modes are seen where narrow stays take less
/// than that part.
const NARROW: f64 = 1.0 / 300.0;
const MOST_NARROW: f64 = 0.05;
/// Names that a caption tells, at most.
const MOST_NAMES: usize = 12;
/// Colours of the lines of a panel.
const LINES: [usize; MOST_LINES] = [6, 0, 1, 2];

/// States or observables that one panel shows: one, or the elements of a vector.
struct Quantities {
    /// Name, without an index.
    name: String,
    unit: String,
    /// Their columns, each with its index in the vector; empty for what is none.
    columns: Vec<(usize, String)>,
}

/// The first part over the whole run; beside it what is zoomed in on, where modes change too often or too shortly to be
/// seen. None of a mechanism, which has figures of its own.
pub(super) fn drawing(motion: &Motion) -> Option<Drawing> {
    let site = motion.sites.first()?;
    let is_shown_elsewhere = motion.modes.is_empty() && !site.touches.is_empty();
    if is_shown_elsewhere || site.times.is_empty() {
        return None;
    }
    let all = quantities(site);
    let (shown, left_out) = all.split_at(all.len().min(MOST_PANELS));
    let stays = site.stays();
    let shows_modes = stays.len() <= MOST_STAYS || is_readable(&stays);
    let modes = shows_modes.then(|| bands(motion, &stays));
    let mut columns = vec![Column { site, from: Some(0.0), modes, title: "" }];
    if let Some((close, title)) = close(motion, stays.len()) {
        columns[0].title = "whole run";
        columns.push(Column {
            site: close,
            from: None,
            modes: Some(bands(motion, &close.stays())),
            title,
        });
    }
    let last = shown.len().saturating_sub(1);
    let row = |(i, own): (usize, &Quantities)| {
        let places = (i == 0, i == last || columns.len() > 1);
        columns.iter().map(|column| panel(column, own, places)).collect::<Vec<_>>()
    };
    let panels: Vec<Panel> = shown.iter().enumerate().flat_map(row).collect();
    let caption = caption(motion, &columns, &stays, left_out);
    Some(Drawing { name: NAME, caption, figure: figure(panels, shown.len(), columns.len()) })
}

/// What is shown beside the whole run, if anything is.
fn close(motion: &Motion, n_stays: usize) -> Option<(&SiteMotion, &'static str)> {
    if n_stays > MOST_STAYS {
        let title = match (motion.flight, &motion.stay) {
            (Some(_), _) => "one flight and what follows",
            (None, Some(_)) => "one stay and what follows",
            (None, None) => "the start",
        };
        return Some((&motion.zoom, title));
    }
    motion.detail.as_ref().map(|detail| (detail, "where modes are short"))
}

fn figure(panels: Vec<Panel>, rows: usize, cols: usize) -> Figure {
    let each = match rows {
        1 => 300,
        2 => 210,
        3 | 4 => 170,
        _ => 130,
    };
    let ticks = if cols > 1 { 45 } else { 0 };
    let height = rows as u32 * (each + ticks) + 130;
    Figure {
        title: "States and observables".into(),
        rows,
        cols,
        panels,
        size: Size { width: if cols > 1 { 1100 } else { 900 }, height },
        legend: Legend::Below,
        share_x: cols == 1,
        ..Figure::default()
    }
}

/// A time of the run that the panels of a column show.
struct Column<'a> {
    site: &'a SiteMotion,
    /// Where the axis begins, where that is not the first sample.
    from: Option<f64>,
    /// The background; where there is none, no event is marked either.
    modes: Option<Vec<Band>>,
    title: &'static str,
}

fn panel(column: &Column<'_>, own: &Quantities, (is_first, is_last): (bool, bool)) -> Panel {
    let site = column.site;
    let n = own.columns.len();
    let lines = (0..n.min(MOST_LINES)).map(|i| match n {
        ..=MOST_LINES => i,
        // The first, the last, and those that divide what is between.
        _ => i * (n - 1) / (MOST_LINES - 1),
    });
    let series = lines.zip(LINES).map(|(i, color)| {
        let (place, index) = &own.columns[i];
        let points = site.samples().map(|(t, _, row)| (t, row[*place])).collect();
        let label = if index.is_empty() { String::new() } else { format!("index {index}") };
        Series::line(label, color, points)
    });
    let unit = if own.unit.is_empty() { String::new() } else { format!(" [{}]", own.unit) };
    let (from, to) = (column.from.or(site.times.first().copied()), site.times.last());
    let t = Axis::linear(if is_last { "t [s]" } else { "" });
    let events = site.changes.iter().map(|change| change.t);
    LineChart {
        title: if is_first { column.title.to_owned() } else { String::new() },
        x: match (from, to) {
            (Some(from), Some(to)) if from < *to => t.within(from, *to),
            _ => t,
        },
        y: Axis::linear(own.name.clone() + &unit),
        series: series.collect(),
        bands: column.modes.clone().unwrap_or_default(),
        ticks: if column.modes.is_some() { events.collect() } else { Vec::new() },
        ticks_label: "event".into(),
        ..LineChart::default()
    }
    .into()
}

/// The columns of a site, those of a vector together.
fn quantities(site: &SiteMotion) -> Vec<Quantities> {
    let mut all: Vec<Quantities> = Vec::new();
    for (place, column) in site.columns.iter().enumerate() {
        let (name, index) = match column.name.split_once('[') {
            Some((name, index)) => (name, index.trim_end_matches(']')),
            None => (&*column.name, ""),
        };
        let own = |known: &&mut Quantities| !index.is_empty() && known.name == name;
        match all.iter_mut().find(own) {
            Some(known) => known.columns.push((place, index.to_owned())),
            None => all.push(Quantities {
                name: name.to_owned(),
                unit: column.unit.replace("^2", "²").replace("^3", "³"),
                columns: vec![(place, index.to_owned())],
            }),
        }
    }
    all
}

/// A mode by its name, from one time to another [s].
type Stay<'a> = (&'a str, (f64, f64));

/// Whether nearly all of the time is spent in stays that are wide enough to be seen.
fn is_readable(stays: &[Stay<'_>]) -> bool {
    let length = |(_, (from, to)): &Stay<'_>| to - from;
    let whole: f64 = stays.iter().map(length).sum();
    let narrow: f64 = stays.iter().map(length).filter(|own| *own < NARROW * whole).sum();
    narrow < MOST_NARROW * whole
}

/// Names of the modes in the order of their colours; none where they are too many to have colours.
fn named(motion: &Motion) -> &[String] {
    match motion.sites.first() {
        Some(site) if motion.modes.is_empty() && site.modes.len() <= MOST => &site.modes,
        _ => &motion.modes,
    }
}

/// The background; none where the mode is always the same.
fn bands(motion: &Motion, stays: &[Stay<'_>]) -> Vec<Band> {
    let names = named(motion);
    if stays.iter().all(|stay| stay.0 == stays[0].0) {
        return Vec::new();
    }
    let band = |(name, x): &Stay<'_>| {
        let place = names.iter().position(|own| own == name)?;
        let (label, color) = look_of(place, name);
        Some(Band { x: *x, color, label })
    };
    stays.iter().filter_map(band).collect()
}

fn caption(
    motion: &Motion,
    columns: &[Column<'_>],
    stays: &[Stay<'_>],
    left_out: &[Quantities],
) -> String {
    let site = &motion.sites[0];
    let of = if site.name.is_empty() { String::new() } else { format!(" of {}", site.name) };
    let mut text = format!(
        "States and observables{of} over time, by {}, at {} times; a peak between two of them is not seen.",
        motion.method,
        site.times.len()
    );
    text += &match site.changes.len() {
        0 => " There is no event.".to_owned(),
        n => format!(" Ticks: events, {n} in all."),
    };
    let has_bands = |column: &Column<'_>| column.modes.as_ref().is_some_and(|all| !all.is_empty());
    if columns.iter().any(has_bands) {
        text += " The background is the mode.";
    }
    if let Some(close) = columns.get(1) {
        text += &beside(motion, close, stays.len());
    }
    if columns[0].modes.is_none() {
        text += " On the left modes and events are not shown, for they are too many.";
    }
    text += &shares(motion, stays);
    let names: Vec<&str> = left_out.iter().map(|own| own.name.as_str()).collect();
    let told = names[..names.len().min(MOST_NAMES)].join(", ");
    let more = if names.len() > MOST_NAMES { ", …" } else { "" };
    let others: Vec<&str> = motion.sites[1..].iter().map(|site| site.name.as_str()).collect();
    for left_out in [told + more, others.join(", ")].iter().filter(|names| !names.is_empty()) {
        text += &format!(" Not shown: {left_out}.");
    }
    text
}

/// What stands on the right.
fn beside(motion: &Motion, close: &Column<'_>, n_stays: usize) -> String {
    let times = &close.site.times;
    let long = times.last().zip(times.first()).map_or(0.0, |(to, from)| to - from);
    let what = match &motion.stay {
        _ if n_stays <= MOST_STAYS => {
            " around a mode that is too short to be seen on the left".into()
        }
        Some(stay) => format!(" around a stay in {}", quoted(&stay.modes)),
        None => String::new(),
    };
    format!(" Right: {}{what}.", duration(long, 1))
}

/// How much of the time each mode takes.
fn shares(motion: &Motion, stays: &[Stay<'_>]) -> String {
    let length = |(_, (from, to)): &Stay<'_>| to - from;
    let whole: f64 = stays.iter().map(length).sum();
    let share = |name: &String| {
        let own: f64 = stays.iter().filter(|stay| stay.0 == name).map(length).sum();
        (own > 0.0).then(|| format!("{} {:.1} %", quoted([name]), 100.0 * own / whole))
    };
    let shares: Vec<String> = named(motion).iter().take(MOST).filter_map(share).collect();
    if shares.len() < 2 { String::new() } else { format!(" Time in {}.", shares.join(", ")) }
}

#[cfg(test)]
mod tests {
    use deltazero_study::problem::Quantity;
    use deltazero_study::run::ModeChange;
    use deltazero_study::simulation::NamedChange;

    use super::*;

    /// A run of a hundred samples in modes `a` and `b`, which take turns `n_changes` times.
    fn motion(columns: &[&str], n_changes: usize) -> Motion {
        let name = |i: usize| if i.is_multiple_of(2) { "a" } else { "b" };
        let change = |i: usize| {
            let t = (i + 1) as f64 / (n_changes + 1) as f64;
            let by_code = ModeChange::new(t, 0, 0);
            let (before, after) = (name(i).into(), name(i + 1).into());
            NamedChange { by_code, t, before, after, is_of_start: false }
        };
        let site = SiteMotion {
            name: String::new(),
            labels: Vec::new(),
            columns: columns
                .iter()
                .map(|name| Quantity::new((*name).to_owned(), "m/s^2", 1.0))
                .collect(),
            times: (0..100).map(|i| f64::from(i) / 99.0).collect(),
            mode_of: vec![0; 100],
            modes: vec!["a".into()],
            values: (0..100 * columns.len()).map(|i| i as f64).collect(),
            touches: Vec::new(),
            changes: (0..n_changes).map(change).collect(),
        };
        Motion {
            sites: vec![site.clone()],
            zoom: site,
            flight: None,
            stay: None,
            detail: None,
            modes: vec!["a".into(), "b".into()],
            method: "rk45".into(),
        }
    }

    fn charts(drawing: &Drawing) -> Vec<&LineChart> {
        let panels = drawing.figure.panels.iter();
        let charts = panels.map(|panel| match panel {
            Panel::Line(chart) => chart,
            other => panic!("{other:?}"),
        });
        charts.collect()
    }

    #[test]
    fn each_quantity_has_a_panel_and_the_modes_are_its_background() {
        let drawing = drawing(&motion(&["x", "v"], 3)).unwrap();
        let charts = charts(&drawing);
        let labels: Vec<&str> = charts.iter().map(|chart| chart.y.label.as_str()).collect();
        assert_eq!(labels, ["x [m/s²]", "v [m/s²]"]);
        for chart in charts {
            let bands: Vec<&str> = chart.bands.iter().map(|band| band.label.as_str()).collect();
            assert_eq!((bands, chart.ticks.len()), (vec!["a", "b", "a", "b"], 3));
        }
        assert!(drawing.caption.contains("events, 3 in all"), "{}", drawing.caption);
        assert!(drawing.caption.contains("“a” 50.0 %, “b” 50.0 %"), "{}", drawing.caption);
    }

    #[test]
    fn a_vector_has_one_panel_with_some_of_its_elements_and_what_is_left_out_is_said() {
        let vector: Vec<String> = (1..=50).map(|i| format!("x[{i}]")).collect();
        let scalars = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
        let columns: Vec<&str> = vector.iter().map(String::as_str).chain(scalars).collect();
        let drawing = drawing(&motion(&columns, 0)).unwrap();
        let charts = charts(&drawing);
        assert_eq!(charts.len(), MOST_PANELS);
        let lines: Vec<&str> = charts[0].series.iter().map(|line| line.label.as_str()).collect();
        assert_eq!(lines, ["index 1", "index 17", "index 33", "index 50"]);
        assert!(drawing.caption.contains("Not shown: h, i."), "{}", drawing.caption);
        assert!(charts.iter().all(|chart| chart.bands.is_empty()));
    }

    #[test]
    fn modes_that_change_too_often_are_shown_in_a_part_of_the_run() {
        let drawing = drawing(&motion(&["x"], 2 * 300)).unwrap();
        let [whole, zoom] = charts(&drawing)[..] else { panic!("{:?}", drawing.figure.cols) };
        assert!(whole.bands.is_empty() && whole.ticks.is_empty());
        assert_eq!(zoom.ticks.len(), 600);
        assert!(drawing.caption.contains("for they are too many"), "{}", drawing.caption);
    }

    #[test]
    fn modes_too_short_to_be_seen_are_shown_beside() {
        let mut motion = motion(&["x"], 3);
        motion.detail = Some(motion.zoom.clone());
        let drawing = drawing(&motion).unwrap();
        let charts = charts(&drawing);
        assert!(charts.len() == 2 && charts.iter().all(|chart| chart.bands.len() == 4));
        assert!(drawing.caption.contains("too short to be seen"), "{}", drawing.caption);
    }

    #[test]
    fn a_mechanism_has_figures_of_its_own_instead() {
        use deltazero_study::problem::Touch;
        let mut motion = motion(&["x"], 1);
        motion.modes.clear();
        assert!(drawing(&motion).is_some());
        motion.sites[0].touches = vec![(false, Touch { depth: 0.0, rate: 0.0, force: 0.0 }); 100];
        assert!(drawing(&motion).is_none());
    }
}
