//! Sharing of axes between panels, and the sizes of their plot areas.

use crate::content::Content;
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::{Frame, Margins};
use crate::geometry::Rect;

/// Least sides of a plot area [px].
const LEAST: (f64, f64) = (60.0, 40.0);
/// Rounds of measuring: the ticks depend on the plot area, its size on the widths of their labels.
const ROUNDS: usize = 3;

type Contents<'a> = [Box<dyn Content + 'a>];

/// Gives the axes that are shared, of x and of y, one span each, and silences all but the outermost.
pub(crate) fn share(
    contents: &mut Contents<'_>,
    cols: usize,
    shared: [bool; 2],
) -> Result<(), Error> {
    let panels = contents.len();
    for (direction, shared) in shared.into_iter().enumerate() {
        if !shared {
            continue;
        }
        let mut rulers: Vec<_> = contents
            .iter_mut()
            .enumerate()
            .filter_map(|(i, content)| Some((i, &mut content.rulers()?[direction])))
            .collect();
        let Some(scale) = rulers.first().map(|(_, ruler)| ruler.span.scale) else {
            continue;
        };
        if let Some((_, other)) = rulers.iter().find(|(_, ruler)| ruler.span.scale != scale) {
            return Err(Error::SharedScale { axis: other.label.clone() });
        }
        let settled = rulers.iter().filter(|(_, ruler)| ruler.settled).map(|(_, ruler)| ruler.span);
        let common = settled.reduce(|a, b| a.union(b));
        for (i, ruler) in &mut rulers {
            ruler.span = common.unwrap_or(ruler.span);
            ruler.silent = if direction == 0 { *i + cols < panels } else { *i % cols > 0 };
        }
    }
    Ok(())
}

/// A plot area for each panel of a grid of rows and columns, all of one size, with what is drawn around it.
pub(crate) fn arrange(
    area: Rect,
    (rows, cols): (usize, usize),
    contents: &Contents<'_>,
    fonts: &Fonts,
) -> Result<Vec<(Rect, Frame)>, Error> {
    let (rows, cols) = (rows.max(1), cols.max(1));
    let mut size = (0.8 * area.width() / cols as f64, 0.8 * area.height() / rows as f64);
    let mut frames: Vec<Frame> = Vec::new();
    let (mut across, mut down) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        frames = contents.iter().map(|content| content.frame(size.0, size.1, fonts)).collect();
        let margins: Vec<Margins> = frames.iter().map(|frame| frame.margins(fonts)).collect();
        across = largest(&margins, cols, |i| i % cols, |m| (m.left, m.right));
        down = largest(&margins, rows, |i| i / cols, |m| (m.top, m.bottom));
        let taken = |both: &[(f64, f64)]| both.iter().map(|(a, b)| a + b).sum::<f64>();
        size = (
            (area.width() - taken(&across)) / cols as f64,
            (area.height() - taken(&down)) / rows as f64,
        );
        if size.0 < LEAST.0 || size.1 < LEAST.1 {
            return Err(Error::Crowded { width: size.0, height: size.1 });
        }
    }
    let lefts = starts(area.left, size.0, &across);
    let tops = starts(area.top, size.1, &down);
    let place = |(i, frame): (usize, Frame)| {
        let (left, top) = (lefts[i % cols], tops[i / cols]);
        let plot = Rect { left, top, right: left + size.0, bottom: top + size.1 };
        (if frame.square { plot.square() } else { plot }, frame)
    };
    Ok(frames.into_iter().enumerate().map(place).collect())
}

/// The largest margins before and after each of `n` tracks, `track` being that of a panel.
fn largest(
    margins: &[Margins],
    n: usize,
    track: impl Fn(usize) -> usize,
    sides: impl Fn(&Margins) -> (f64, f64),
) -> Vec<(f64, f64)> {
    let mut tracks = vec![(0.0_f64, 0.0_f64); n];
    for (i, margin) in margins.iter().enumerate() {
        let (before, after) = sides(margin);
        let both = &mut tracks[track(i)];
        *both = (both.0.max(before), both.1.max(after));
    }
    tracks
}

/// Where the plot areas begin whose tracks have these margins.
fn starts(from: f64, size: f64, margins: &[(f64, f64)]) -> Vec<f64> {
    let mut end = from;
    let start = |&(before, after): &(f64, f64)| {
        let start = end + before;
        end = start + size + after;
        start
    };
    margins.iter().map(start).collect()
}
