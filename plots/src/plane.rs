//! Draws everything that has two numeric axes.

use std::borrow::Cow;

use crate::axis::{Axis, ROOM, Scale, Span};
use crate::canvas::{Align, Canvas};
use crate::color_bar::ColorBar;
use crate::content::{Content, Ruler};
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::{Frame, Side};
use crate::geometry::{Point, Rect};
use crate::legend::{Entry, Sample};
use crate::line::{Bars, Cloud, LineChart};
use crate::marker::Once;
use crate::reference::{self, tint};
use crate::series::Series;
use crate::style::{LABEL, MARK, MUTED, NOTE, PANEL, TEXT, TICK, palette};
use crate::ticks::Ticks;
use crate::view::View;

/// Length of the ticks that mark events.
const EVENT_TICK: f64 = 6.0;

/// A chart with the spans of its axes.
pub(crate) struct Plane<'a> {
    chart: Cow<'a, LineChart>,
    rulers: [Ruler; 2],
    empty: bool,
}

impl<'a> Plane<'a> {
    pub(crate) fn new(chart: Cow<'a, LineChart>) -> Result<Self, Error> {
        let (x, y) = (&chart.x, &chart.y);
        let points = || {
            let all = chart.series.iter().flat_map(|series| series.points.iter().copied());
            let bars = chart.bars.iter().flat_map(|bars| &bars.bars);
            let tops = bars.flat_map(|&((left, right), top)| [(left, top), (right, top)]);
            let cloud = chart.cloud.iter().flat_map(|cloud| &cloud.points);
            let cloud = cloud.map(|&(x, y, _)| (x, y));
            all.chain(tops).chain(cloud).filter(|&point| shown(point, x, y))
        };
        let stands_on_zero = !chart.bars.is_empty() && y.scale == Scale::Linear;
        let zero = stands_on_zero.then_some(0.0);
        let levels = chart.levels.iter().map(|level| level.y).chain(zero);
        let uprights = chart.uprights.iter().map(|upright| upright.x);
        let empty = points().next().is_none();
        // Ticks of events at the upper border are not to cover data.
        let above = if chart.ticks.is_empty() { ROOM } else { 3.0 * ROOM };
        let ruler = |axis: &Axis, span| Ruler {
            label: axis.label.clone(),
            span,
            settled: !empty || axis.range.is_some(),
            silent: false,
        };
        if let Some(cloud) = &chart.cloud {
            // What does not do is told here, before anything is drawn.
            ColorBar::new(&cloud.bar, cloud.points.iter().map(|point| point.2))?;
        }
        let rulers = [
            ruler(x, x.span(points().map(|point| point.0).chain(uprights), ROOM)?),
            ruler(y, y.span(points().map(|point| point.1).chain(levels), above)?),
        ];
        Ok(Self { chart, rulers, empty })
    }

    /// What both axes cover, x first; in equal aspect the narrower one is widened.
    fn spans(&self) -> [Span; 2] {
        let spans = self.rulers.each_ref().map(|ruler| ruler.span);
        let width = spans.map(|span| span.hi - span.lo).into_iter().fold(0.0, f64::max);
        if self.chart.equal_aspect { spans.map(|span| span.with_width(width)) } else { spans }
    }

    fn bar(&self) -> Option<ColorBar<'_>> {
        let cloud = self.chart.cloud.as_ref()?;
        ColorBar::new(&cloud.bar, cloud.points.iter().map(|point| point.2)).ok()
    }

    fn view(&self, plot: Rect) -> View {
        let [x, y] = self.spans();
        View { plot, x, y }
    }
}

impl Cloud {
    fn draw(&self, bar: &ColorBar<'_>, view: &View, canvas: &mut Canvas) {
        let placed = self.points.iter().filter_map(|&(x, y, z)| Some((view.place((x, y))?, z)));
        let mut once = Once::new(self.marker);
        for (at, z) in placed.filter(|(at, _)| view.plot.contains(*at)) {
            if once.is_first(at) {
                self.marker.draw(at, bar.color(z).unwrap_or(MARK), false, canvas);
            }
        }
    }
}

impl Bars {
    fn draw(&self, view: &View, canvas: &mut Canvas) {
        for &((left, right), top) in &self.bars {
            if let Some(rect) = view.bar((left, right), top) {
                canvas.rect(rect, palette(self.color));
            }
        }
    }
}

fn shown((x, y): Point, x_axis: &Axis, y_axis: &Axis) -> bool {
    x_axis.scale.coordinate(x).is_some() && y_axis.scale.coordinate(y).is_some()
}

impl Content for Plane<'_> {
    fn frame(&self, width: f64, height: f64, fonts: &Fonts) -> Frame {
        let side = width.min(height);
        let (width, height) = if self.chart.equal_aspect { (side, side) } else { (width, height) };
        let ([x, y], [x_span, y_span]) = (&self.rulers, self.spans());
        let x_ticks = Ticks::across(x_span, width, fonts);
        let factor = fonts.width(&x_ticks.factor, TICK);
        let side = |ruler: &Ruler, ticks: Ticks, room: f64| {
            let mut side =
                Side { label: fonts.wrap(&ruler.label, LABEL, room), ticks, upright: false };
            if ruler.silent {
                side.silence();
            }
            side
        };
        let names = [&self.chart.x.names, &self.chart.y.names];
        let y_ticks = match names[1].len() {
            0 => Ticks::up(y_span, height),
            _ => {
                let names = fonts.names(names[1], width);
                Ticks::middles(&names, height / TICK.line_height(), false)
            }
        };
        Frame {
            title: fonts.wrap(&self.chart.title, PANEL, width),
            x: match names[0].len() {
                0 => side(x, x_ticks, width - 2.0 * factor),
                _ => Side::across(&x.label, names[0], (width, height), fonts),
            },
            y: side(y, y_ticks, height),
            right: self.bar().map_or(0.0, |bar| bar.room(height, fonts)),
            square: self.chart.equal_aspect,
        }
    }

    fn draw(&self, plot: Rect, frame: &Frame, canvas: &mut Canvas, fonts: &Fonts) {
        let (chart, view) = (&self.chart, self.view(plot));
        let labels = reference::labels(chart, &view, fonts);
        reference::draw_bands(chart, &view, canvas);
        reference::draw_ribbons(chart, &view, canvas);
        frame.draw_grid(plot, canvas);
        reference::draw_lines(chart, &view, canvas);
        reference::draw_grounds(&labels, canvas);
        for bars in &chart.bars {
            bars.draw(&view, canvas);
        }
        if let (Some(cloud), Some(bar)) = (&chart.cloud, self.bar()) {
            cloud.draw(&bar, &view, canvas);
            bar.draw(plot, canvas, fonts);
        }
        for series in &chart.series {
            series.draw(&view, canvas);
        }
        for x in view.columns(&chart.ticks) {
            canvas.rule(vec![(x, plot.top), (x, plot.top + EVENT_TICK)], TEXT);
        }
        frame.draw(plot, canvas, fonts);
        for label in labels {
            canvas.text(label.text, label.start(), NOTE, MUTED, Align::Start);
        }
        if self.empty {
            let (x, y) = plot.center();
            canvas.text("no data", (x, y + LABEL.size / 3.0), LABEL, MUTED, Align::Middle);
        }
    }

    fn legend(&self) -> Vec<Entry> {
        let chart = &self.chart;
        let is_drawn =
            |series: &&Series| series.points.iter().any(|&at| shown(at, &chart.x, &chart.y));
        let series = chart.series.iter().filter(is_drawn).map(Series::entry);
        let bands = chart
            .bands
            .iter()
            .map(|band| Entry { label: band.label.clone(), sample: Sample::Swatch(tint(band)) });
        let ticks = (!chart.ticks.is_empty())
            .then(|| Entry { label: chart.ticks_label.clone(), sample: Sample::Tick(TEXT) });
        let bars = chart.bars.iter().map(|bars| Entry {
            label: bars.label.clone(),
            sample: Sample::Swatch(palette(bars.color)),
        });
        series.chain(bars).chain(bands).chain(ticks).collect()
    }

    fn is_empty(&self) -> bool {
        self.empty
    }

    fn rulers(&mut self) -> Option<&mut [Ruler; 2]> {
        Some(&mut self.rulers)
    }
}
