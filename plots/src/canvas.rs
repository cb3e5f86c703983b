//! A drawing as a list of shapes in logical pixels, y downward; charts write it, `surface` renders it.

use crate::geometry::{Point, Rect};
use crate::style::{Face, Rgb, THIN};

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// One line of text; `at` lies on the baseline.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub(crate) content: String,
    pub(crate) at: Point,
    pub(crate) face: Face,
    pub(crate) color: Rgb,
    pub(crate) align: Align,
    /// Read from bottom to top.
    pub(crate) vertical: bool,
}

/// What a drawing is made of.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Stroke { path: Vec<Point>, width: f64, color: Rgb },
    Fill { path: Vec<Point>, color: Rgb },
    Disc { center: Point, radius: f64, color: Rgb },
    Text(Text),
}

/// The list of shapes, later ones above earlier ones.
#[derive(Default)]
pub(crate) struct Canvas {
    pub(crate) shapes: Vec<Shape>,
}

impl Canvas {
    pub(crate) fn stroke(&mut self, path: Vec<Point>, width: f64, color: Rgb) {
        self.shapes.push(Shape::Stroke { path, width, color });
    }

    pub(crate) fn fill(&mut self, path: Vec<Point>, color: Rgb) {
        self.shapes.push(Shape::Fill { path, color });
    }

    pub(crate) fn disc(&mut self, center: Point, radius: f64, color: Rgb) {
        self.shapes.push(Shape::Disc { center, radius, color });
    }

    pub(crate) fn rect(&mut self, rect: Rect, color: Rgb) {
        self.fill(rect.corners().to_vec(), color);
    }

    pub(crate) fn outline(&mut self, rect: Rect, color: Rgb) {
        let [a, b, c, d] = rect.corners();
        self.rule(vec![a, b, c, d, a, b], color);
    }

    /// A thin line of upright and level parts, moved to the nearest pixels of a PNG, which keeps it crisp.
    pub(crate) fn rule(&mut self, path: Vec<Point>, color: Rgb) {
        let snap = |at: f64| (2.0 * at).round() / 2.0;
        self.stroke(path.into_iter().map(|(x, y)| (snap(x), snap(y))).collect(), THIN, color);
    }

    pub(crate) fn text(&mut self, content: &str, at: Point, face: Face, color: Rgb, align: Align) {
        self.push_text(content, at, face, color, align, false);
    }

    pub(crate) fn vertical_text(
        &mut self,
        content: &str,
        at: Point,
        face: Face,
        color: Rgb,
        align: Align,
    ) {
        self.push_text(content, at, face, color, align, true);
    }

    fn push_text(
        &mut self,
        content: &str,
        at: Point,
        face: Face,
        color: Rgb,
        align: Align,
        vertical: bool,
    ) {
        if !content.is_empty() {
            let content = content.to_string();
            self.shapes.push(Shape::Text(Text { content, at, face, color, align, vertical }));
        }
    }
}
