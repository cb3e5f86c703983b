//! What is drawn behind the data to compare it with, and where its texts hide the least.

use crate::canvas::Canvas;
use crate::font::Fonts;
use crate::geometry::{Point, Rect, clip, dash, thin};
use crate::line::{Band, Guide, LineChart};
use crate::style::{BAND, DASH, GUIDE, MARK, NOTE, RIBBON, RIBBON_EDGE, Rgb, THIN, WHITE, palette};
use crate::view::View;

/// Distance of a text from its line and from the frame.
const GAP: f64 = 5.0;

/// The pale colour of a band.
pub(crate) fn tint(band: &Band) -> Rgb {
    palette(band.color).over_white(BAND)
}

/// Bands, which stand behind the grid.
pub(crate) fn draw_bands(chart: &LineChart, view: &View, canvas: &mut Canvas) {
    for band in &chart.bands {
        if let Some(rect) = view.band(band.x) {
            canvas.rect(rect, tint(band));
        }
    }
}

/// Ribbons, which stand behind the grid: all areas, then their edges.
pub(crate) fn draw_ribbons(chart: &LineChart, view: &View, canvas: &mut Canvas) {
    let areas: Vec<(Rgb, [Vec<Point>; 2])> = chart
        .ribbons
        .iter()
        .map(|ribbon| (palette(ribbon.color), view.ribbon(&ribbon.points)))
        .filter(|(_, [lower, _])| lower.len() > 1)
        .collect();
    for (color, [lower, upper]) in &areas {
        let around = lower.iter().chain(upper.iter().rev()).copied().collect();
        canvas.fill(around, color.over_white(RIBBON));
    }
    for (color, edges) in areas {
        for edge in edges {
            canvas.stroke(edge, THIN / 2.0, color.over_white(RIBBON_EDGE));
        }
    }
}

/// Vertical marks, levels, uprights and guides.
pub(crate) fn draw_lines(chart: &LineChart, view: &View, canvas: &mut Canvas) {
    let plot = view.plot;
    for x in view.columns(&chart.marks) {
        canvas.rule(vec![(x, plot.top), (x, plot.bottom)], MARK);
    }
    for y in chart.levels.iter().filter_map(|level| view.up(level.y)) {
        canvas.rule(vec![(plot.left, y), (plot.right, y)], GUIDE);
    }
    for x in chart.uprights.iter().filter_map(|upright| view.across(upright.x)) {
        canvas.rule(vec![(x, plot.top), (x, plot.bottom)], GUIDE);
    }
    for ends in chart.guides.iter().filter_map(|guide| guide_ends(guide, view)) {
        for part in dash(&ends, DASH) {
            canvas.stroke(part, THIN, GUIDE);
        }
    }
}

/// Both ends of the visible part of a guide, from left to right.
fn guide_ends(guide: &Guide, view: &View) -> Option<[Point; 2]> {
    let (x, y) = (view.x, view.y);
    let (x0, y0) = (x.scale.coordinate(guide.through.0)?, y.scale.coordinate(guide.through.1)?);
    let end = |value: f64, otherwise: f64| x.scale.coordinate(value).unwrap_or(otherwise);
    let (from, to) = guide.span.map_or((x.lo, x.hi), |(from, to)| (end(from, x.lo), end(to, x.hi)));
    let at = |c: f64| {
        let height = y0 + guide.slope * (c - x0);
        view.plot.at(((c - x.lo) / (x.hi - x.lo), (height - y.lo) / (y.hi - y.lo)))
    };
    let part = clip(&[at(from.min(to)), at(from.max(to))], &view.plot).pop()?;
    part.try_into().ok()
}

/// A text and the area it takes.
pub(crate) struct Label<'a> {
    pub(crate) text: &'a str,
    pub(crate) area: Rect,
}

impl Label<'_> {
    /// Where the text's baseline begins.
    pub(crate) fn start(&self) -> Point {
        (self.area.left + 2.0, self.area.bottom - 2.5)
    }
}

/// The texts of levels, uprights, guides and notes, each where it crosses the fewest lines of data and earlier texts.
pub(crate) fn labels<'a>(chart: &'a LineChart, view: &View, fonts: &Fonts) -> Vec<Label<'a>> {
    let texts = texts(chart, view, fonts);
    if texts.is_empty() {
        return Vec::new();
    }
    let paths = paths(chart, view);
    let mut labels: Vec<Label<'a>> = Vec::new();
    for (text, places) in texts {
        let areas = places.into_iter().map(|at| area(text, at, &view.plot, fonts));
        let crossed = |area: &Rect| -> usize {
            let data: usize = paths.iter().map(|path| clip(path, area).len()).sum();
            data + labels.iter().filter(|label| label.area.touches(area)).count()
        };
        if let Some(area) = areas.min_by_key(crossed) {
            labels.push(Label { text, area });
        }
    }
    labels
}

/// The texts, each with places where its baseline may begin, the best first.
fn texts<'a>(chart: &'a LineChart, view: &View, fonts: &Fonts) -> Vec<(&'a str, Vec<Point>)> {
    let mut texts: Vec<(&str, Vec<Point>)> = Vec::new();
    let plot = view.plot;
    for level in &chart.levels {
        if let Some(y) = view.up(level.y) {
            let room = plot.width() - fonts.width(&level.label, NOTE) - 2.0 * GAP;
            let along = [1.0, 0.0, 0.75, 0.5, 0.25].map(|part| plot.left + GAP + part * room);
            let heights = [y - GAP, y + NOTE.size + 2.0];
            texts.push((
                &level.label,
                heights.into_iter().flat_map(|y| along.map(|x| (x, y))).collect(),
            ));
        }
    }
    for upright in &chart.uprights {
        if let Some(x) = view.across(upright.x) {
            let width = fonts.width(&upright.label, NOTE);
            let room = plot.height() - NOTE.size - 2.0 * GAP;
            let down = [0.0, 1.0, 0.25, 0.5, 0.75].map(|part| plot.top + NOTE.size + part * room);
            let sides = [x - GAP - width, x + GAP];
            texts.push((
                &upright.label,
                down.into_iter().flat_map(|y| sides.map(|x| (x, y + GAP))).collect(),
            ));
        }
    }
    for guide in &chart.guides {
        if let Some([a, b]) = guide_ends(guide, view) {
            let width = fonts.width(&guide.label, NOTE);
            // Both sides of the line: right above and left below it if it falls, else the others.
            let sides = if b.1 > a.1 {
                [(GAP, -GAP), (-GAP - width, GAP + NOTE.size)]
            } else {
                [(-GAP - width, -GAP), (GAP, GAP + NOTE.size)]
            };
            let along = [0.94, 0.85, 0.75, 0.65, 0.5, 0.35, 0.25, 0.15, 0.06];
            let places = along.map(|s| ((1.0 - s) * a.0 + s * b.0, (1.0 - s) * a.1 + s * b.1));
            let beside = |(x, y): Point| sides.map(|(dx, dy)| (x + dx, y + dy));
            texts.push((&guide.label, places.into_iter().flat_map(beside).collect()));
        }
    }
    for note in &chart.notes {
        if let Some((x, y)) = view.place(note.at).filter(|&at| plot.contains(at)) {
            texts.push((&note.text, vec![(x + GAP, y - GAP)]));
        }
    }
    texts.retain(|(text, _)| !text.is_empty());
    texts
}

/// The area of a text whose baseline begins there, moved into the plot area.
fn area(text: &str, (x, y): Point, plot: &Rect, fonts: &Fonts) -> Rect {
    let width = fonts.width(text, NOTE);
    let left = x.min(plot.right - width - GAP).max(plot.left + GAP);
    let baseline = y.min(plot.bottom - GAP).max(plot.top + NOTE.size + 1.0);
    Rect {
        left: left - 2.0,
        top: baseline - NOTE.size,
        right: left + width + 2.0,
        bottom: baseline + 2.5,
    }
}

/// The lines of all series, as they are drawn.
fn paths(chart: &LineChart, view: &View) -> Vec<Vec<Point>> {
    let run =
        |points: &[Option<Point>]| thin(&points.iter().copied().flatten().collect::<Vec<_>>());
    let series = chart.series.iter().flat_map(|series| {
        let placed: Vec<_> = series.points.iter().map(|&point| view.place(point)).collect();
        placed.split(Option::is_none).map(run).collect::<Vec<_>>()
    });
    series.collect()
}

/// The ground under the texts: it covers other references, but not the data, which is drawn later.
pub(crate) fn draw_grounds(labels: &[Label<'_>], canvas: &mut Canvas) {
    for label in labels {
        canvas.rect(label.area, WHITE);
    }
}
