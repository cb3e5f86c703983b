//! The embedded font: measuring and breaking text.

use ab_glyph::{Font, FontRef};

use crate::error::Error;
use crate::style::{Face, TICK};

/// What an SVG names; the first is the embedded font, the second has nearly its widths.
pub(crate) const FAMILY: &str = "DejaVu Sans, Verdana, Geneva, sans-serif";

/// Both weights of the embedded font.
pub(crate) struct Fonts {
    regular: FontRef<'static>,
    bold: FontRef<'static>,
}

impl Fonts {
    pub(crate) fn load() -> Result<Self, Error> {
        Ok(Self {
            regular: FontRef::try_from_slice(include_bytes!("../fonts/DejaVuSans-subset.ttf"))?,
            bold: FontRef::try_from_slice(include_bytes!("../fonts/DejaVuSans-Bold-subset.ttf"))?,
        })
    }

    pub(crate) fn weight(&self, bold: bool) -> &FontRef<'static> {
        if bold { &self.bold } else { &self.regular }
    }

    /// Advance width of one line of text [px].
    pub(crate) fn width(&self, text: &str, face: Face) -> f64 {
        let font = self.weight(face.bold);
        let advance = |c| f64::from(font.h_advance_unscaled(font.glyph_id(c)));
        let em = f64::from(font.units_per_em().unwrap_or(2048.0));
        text.chars().map(advance).sum::<f64>() * face.size / em
    }

    /// Breaks text into lines no wider than `room` [px]: at line feeds, at spaces, and inside a word that is too long
    /// by itself. Empty text has no line.
    pub(crate) fn wrap(&self, text: &str, face: Face, room: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for paragraph in text.lines() {
            let mut line = String::new();
            for word in paragraph.split(' ') {
                let longer =
                    if line.is_empty() { word.to_string() } else { format!("{line} {word}") };
                if self.width(&longer, face) <= room {
                    line = longer;
                    continue;
                }
                if !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
                for c in word.chars() {
                    line.push(c);
                    if self.width(&line, face) > room && line.chars().count() > 1 {
                        line.pop();
                        lines.push(std::mem::replace(&mut line, c.to_string()));
                    }
                }
            }
            lines.push(line);
        }
        lines
    }

    /// Names of places along an axis, each at most half as long as the plot area is deep, so that it takes a third of both together.
    pub(crate) fn names(&self, names: &[String], depth: f64) -> Vec<String> {
        names.iter().map(|name| self.cut(name, TICK, depth / 2.0)).collect()
    }

    /// A text that is too wide for `room` [px] without its middle.
    fn cut(&self, text: &str, face: Face, room: f64) -> String {
        if self.width(text, face) <= room {
            return text.to_owned();
        }
        let chars: Vec<char> = text.chars().collect();
        let without_middle = |n: usize| -> String {
            let (start, end) = (&chars[..n.div_ceil(2)], &chars[chars.len() - n / 2..]);
            start.iter().chain(&['…']).chain(end).collect()
        };
        let mut cuts = (0..chars.len()).rev().map(without_middle);
        cuts.find(|cut| self.width(cut, face) <= room).unwrap_or_default()
    }

    /// Width of the widest line [px].
    pub(crate) fn widest<'t>(
        &self,
        lines: impl IntoIterator<Item = &'t String>,
        face: Face,
    ) -> f64 {
        lines.into_iter().map(|line| self.width(line, face)).fold(0.0, f64::max)
    }
}
