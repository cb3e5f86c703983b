//! Rectangles and what is done to a path before it is drawn: thinning, clipping, dashing.

/// A position in logical pixels, y downward.
pub(crate) type Point = (f64, f64);

/// An upright rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn center(&self) -> Point {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }

    pub(crate) fn corners(&self) -> [Point; 4] {
        [
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
        ]
    }

    /// The place of fractions of width and height, y upward.
    pub(crate) fn at(&self, (x, y): Point) -> Point {
        (self.left + x * self.width(), self.bottom - y * self.height())
    }

    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    pub(crate) fn touches(&self, other: &Self) -> bool {
        let across = self.left <= other.right && other.left <= self.right;
        across && self.top <= other.bottom && other.top <= self.bottom
    }

    /// The largest square inside, in the middle of the width and at the top.
    pub(crate) fn square(&self) -> Self {
        let side = self.width().min(self.height());
        let left = self.left + (self.width() - side) / 2.0;
        Self { left, top: self.top, right: left + side, bottom: self.top + side }
    }
}

/// Columns in a pixel when a path is thinned.
const COLUMNS: f64 = 8.0;

/// Keeps of each run of points within one column the first, the extremes and the last: what is drawn stays
/// the same, thousands of points become hundreds.
pub(crate) fn thin(path: &[Point]) -> Vec<Point> {
    let column = |p: &Point| (COLUMNS * p.0).floor();
    let mut kept = Vec::new();
    for run in path.chunk_by(|a, b| column(a) == column(b)) {
        let mut keep = [0, run.len() - 1, 0, 0];
        for (i, point) in run.iter().enumerate() {
            if point.1 < run[keep[2]].1 {
                keep[2] = i;
            }
            if point.1 > run[keep[3]].1 {
                keep[3] = i;
            }
        }
        keep.sort_unstable();
        kept.extend(keep.into_iter().map(|i| run[i]));
    }
    kept.dedup();
    kept
}

/// The parts of a path inside a rectangle (Y.-D. Liang, B. Barsky, ACM Trans. Graph. 3(1), 1984).
pub(crate) fn clip(path: &[Point], rect: &Rect) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut joined = false;
    for pair in path.windows(2) {
        let Some((enter, leave)) = visible(pair[0], pair[1], rect) else {
            joined = false;
            continue;
        };
        let [(ax, ay), (bx, by)] = [pair[0], pair[1]];
        let at = |s: f64| ((1.0 - s) * ax + s * bx, (1.0 - s) * ay + s * by);
        match parts.last_mut() {
            Some(part) if joined && enter == 0.0 => part.push(at(leave)),
            _ => parts.push(vec![at(enter), at(leave)]),
        }
        joined = leave == 1.0;
    }
    parts
}

/// Where, from 0 to 1, a segment enters and leaves a rectangle.
fn visible(a: Point, b: Point, rect: &Rect) -> Option<(f64, f64)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let sides = [
        (-dx, a.0 - rect.left),
        (dx, rect.right - a.0),
        (-dy, a.1 - rect.top),
        (dy, rect.bottom - a.1),
    ];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (toward, room) in sides {
        if toward == 0.0 && room < 0.0 {
            return None;
        } else if toward < 0.0 {
            enter = enter.max(room / toward);
        } else if toward > 0.0 {
            leave = leave.min(room / toward);
        }
    }
    (enter <= leave).then_some((enter, leave))
}

/// Cuts a path into dashes of length `on` with gaps of length `off` between them.
pub(crate) fn dash(path: &[Point], (on, off): (f64, f64)) -> Vec<Vec<Point>> {
    let mut dashes = Vec::new();
    let mut current: Vec<Point> = path.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, on);
    for pair in path.windows(2) {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        let length = (dx * dx + dy * dy).sqrt();
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let cut = (pair[0].0 + dx * done / length, pair[0].1 + dy * done / length);
            if drawing {
                current.push(cut);
                dashes.push(std::mem::take(&mut current));
            } else {
                current = vec![cut];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        left -= length - done;
        if drawing {
            current.push(pair[1]);
        }
    }
    if drawing && current.len() > 1 {
        dashes.push(current);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };

    #[test]
    fn a_path_that_leaves_and_returns_is_cut_in_two() {
        let path = [(0.5, 0.5), (0.5, 2.0), (0.75, 2.0), (0.75, 0.5)];
        let parts = clip(&path, &UNIT);
        assert_eq!(parts, [vec![(0.5, 0.5), (0.5, 1.0)], vec![(0.75, 1.0), (0.75, 0.5)]]);
    }

    #[test]
    fn a_path_inside_stays_one_piece() {
        let path = [(0.1, 0.1), (0.2, 0.9), (0.3, 0.1)];
        assert_eq!(clip(&path, &UNIT), [path.to_vec()]);
    }

    #[test]
    fn dashes_continue_around_a_corner() {
        let dashes = dash(&[(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)], (4.0, 1.0));
        assert_eq!(dashes[0], [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0)]);
        assert_eq!(dashes[1], [(3.0, 2.0), (3.0, 4.0)]);
    }

    #[test]
    fn thinning_keeps_the_extremes_of_a_column() {
        let path: Vec<Point> = (0..1000).map(|i| (0.1, f64::from((i * 7919) % 1000))).collect();
        let kept = thin(&path);
        assert!(kept.len() <= 4);
        assert!(kept.contains(&(0.1, 0.0)) && kept.contains(&(0.1, 999.0)));
    }
}
