//! The signs that mark single points.

use std::collections::HashSet;

use crate::canvas::Canvas;
use crate::geometry::Point;
use crate::style::{Rgb, WHITE};

/// The sign at each point of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marker {
    /// None: only the line.
    #[default]
    None,
    /// A small dot, for thousands of points.
    Dot,
    /// A circle.
    Circle,
    /// A square.
    Square,
    /// A triangle, its tip up.
    Triangle,
    /// A square on its tip.
    Diamond,
    /// A triangle, its tip down.
    TriangleDown,
    /// A triangle, its tip to the left.
    TriangleLeft,
    /// A triangle, its tip to the right.
    TriangleRight,
    /// An oblique cross.
    Cross,
}

impl Marker {
    /// The signs that can be hollow in a fixed order, for series that have none chosen; an index wraps around.
    pub fn cycle(index: usize) -> Self {
        const SIGNS: [Marker; 7] = [
            Marker::Circle,
            Marker::Square,
            Marker::Triangle,
            Marker::Diamond,
            Marker::TriangleDown,
            Marker::TriangleLeft,
            Marker::TriangleRight,
        ];
        SIGNS[index % SIGNS.len()]
    }

    /// Corners of the polygons, in radii of a circle of like weight.
    fn corners(self) -> &'static [Point] {
        match self {
            Self::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Self::Triangle => &[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)],
            Self::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            Self::TriangleDown => &[(0.0, 1.25), (1.15, -0.85), (-1.15, -0.85)],
            Self::TriangleLeft => &[(-1.25, 0.0), (0.85, 1.15), (0.85, -1.15)],
            Self::TriangleRight => &[(1.25, 0.0), (-0.85, 1.15), (-0.85, -1.15)],
            _ => &[],
        }
    }

    pub(crate) fn draw(self, center: Point, color: Rgb, hollow: bool, canvas: &mut Canvas) {
        let polygon = |radius: f64| -> Vec<Point> {
            self.corners()
                .iter()
                .map(|(x, y)| (center.0 + radius * x, center.1 + radius * y))
                .collect()
        };
        match self {
            Self::None => {}
            Self::Dot => canvas.disc(center, DOT, color),
            Self::Circle => {
                canvas.disc(center, RADIUS, color);
                if hollow {
                    canvas.disc(center, RADIUS - RIM, WHITE);
                }
            }
            Self::Cross => {
                for way in [-1.0, 1.0] {
                    let (dx, dy) = (RADIUS * 0.9, RADIUS * 0.9 * way);
                    canvas.stroke(
                        vec![(center.0 - dx, center.1 - dy), (center.0 + dx, center.1 + dy)],
                        RIM,
                        color,
                    );
                }
            }
            Self::Square
            | Self::Diamond
            | Self::Triangle
            | Self::TriangleDown
            | Self::TriangleLeft
            | Self::TriangleRight => {
                canvas.fill(polygon(RADIUS), color);
                if hollow {
                    // The distance from the centre to a side is the least of the polygon's radii.
                    let has_four = matches!(self, Self::Square | Self::Diamond);
                    let inradius = if has_four { 0.9 } else { 0.72 };
                    canvas.fill(polygon(RADIUS - RIM / inradius), WHITE);
                }
            }
        }
    }
}

/// Of signs that fall on the same half pixel, or of dots on the same pixel, the first: one is enough.
pub(crate) struct Once {
    fine: f64,
    taken: HashSet<(i64, i64)>,
}

impl Once {
    pub(crate) fn new(marker: Marker) -> Self {
        let fine = if marker == Marker::Dot { 1.0 } else { 2.0 };
        Self { fine, taken: HashSet::new() }
    }

    pub(crate) fn is_first(&mut self, (x, y): Point) -> bool {
        self.taken.insert(((self.fine * x).round() as i64, (self.fine * y).round() as i64))
    }
}

/// Radius of a circle, width of a hollow sign's rim, radius of a dot [px].
const RADIUS: f64 = 3.5;
const RIM: f64 = 1.3;
const DOT: f64 = 1.2;
