//! The line of a series.

use crate::canvas::Canvas;
use crate::geometry::{Point, dash};
use crate::style::{DASH, Rgb, STROKE};

/// How a series' line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stroke {
    /// Without interruption.
    #[default]
    Solid,
    /// In dashes.
    Dashed,
    /// Not at all: only markers.
    None,
}

impl Stroke {
    pub(crate) fn draw(self, path: &[Point], color: Rgb, canvas: &mut Canvas) {
        match self {
            Self::Solid => canvas.stroke(path.to_vec(), STROKE, color),
            Self::Dashed => {
                dash(path, DASH).into_iter().for_each(|part| canvas.stroke(part, STROKE, color));
            }
            Self::None => {}
        }
    }
}
