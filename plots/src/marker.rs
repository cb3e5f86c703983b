//! The signs that mark single points.

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
    /// An oblique cross.
    Cross,
}

impl Marker {
    /// The outlined signs in a fixed order, for series that have none chosen; an index wraps around.
    pub fn cycle(index: usize) -> Self {
        [Self::Circle, Self::Square, Self::Triangle, Self::Diamond, Self::Cross][index % 5]
    }

    /// Corners of the polygons, in radii of a circle of like weight.
    fn corners(self) -> &'static [Point] {
        match self {
            Self::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Self::Triangle => &[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)],
            Self::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
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
            Self::Square | Self::Triangle | Self::Diamond => {
                canvas.fill(polygon(RADIUS), color);
                if hollow {
                    // The distance from the centre to a side is the least of the polygon's radii.
                    let inradius = if self == Self::Triangle { 0.72 } else { 0.9 };
                    canvas.fill(polygon(RADIUS - RIM / inradius), WHITE);
                }
            }
        }
    }
}

/// Radius of a circle, width of a hollow sign's rim, radius of a dot [px].
const RADIUS: f64 = 3.5;
const RIM: f64 = 1.3;
const DOT: f64 = 1.2;
