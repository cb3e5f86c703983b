//! A text as the backends of plotters ask for it.

use std::convert::Infallible;

use ab_glyph::{Font, point};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendTextStyle, FontFamily, FontStyle, FontTransform,
};

use crate::canvas::{Align, Text};
use crate::font::{FAMILY, Fonts};
use crate::style::Rgb;

/// The SVG backend reads its attributes; the bitmap backend has it drawn, and puts it on the baseline.
pub(crate) struct Glyphs<'a> {
    pub(crate) text: &'a Text,
    /// Size [device units].
    pub(crate) em: f64,
    pub(crate) fonts: &'a Fonts,
}

pub(crate) fn opaque(Rgb(r, g, b): Rgb) -> BackendColor {
    BackendColor { alpha: 1.0, rgb: (r, g, b) }
}

impl BackendTextStyle for Glyphs<'_> {
    type FontError = Infallible;

    fn color(&self) -> BackendColor {
        opaque(self.text.color)
    }

    /// The SVG backend divides by 1.24 to get the size of an em.
    fn size(&self) -> f64 {
        1.24 * self.em
    }

    fn transform(&self) -> FontTransform {
        if self.text.vertical { FontTransform::Rotate270 } else { FontTransform::None }
    }

    fn style(&self) -> FontStyle {
        if self.text.face.bold { FontStyle::Bold } else { FontStyle::Normal }
    }

    fn anchor(&self) -> Pos {
        let horizontal = match self.text.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        Pos::new(horizontal, VPos::Top)
    }

    fn family(&self) -> FontFamily<'_> {
        FontFamily::Name(FAMILY)
    }

    /// The width; no height, so that the anchor stays on the baseline.
    fn layout_box(&self, text: &str) -> Result<((i32, i32), (i32, i32)), Infallible> {
        let width = self.fonts.width(text, self.text.face) * self.em / self.text.face.size;
        Ok(((0, 0), (width.round() as i32, 0)))
    }

    fn draw<E, DrawFunc: FnMut(i32, i32, BackendColor) -> Result<(), E>>(
        &self,
        text: &str,
        (left, baseline): BackendCoord,
        mut draw: DrawFunc,
    ) -> Result<Result<(), E>, Infallible> {
        let font = self.fonts.weight(self.text.face.bold);
        let units = font.units_per_em().unwrap_or(2048.0);
        let scale = self.em as f32 * font.height_unscaled() / units;
        let mut pen = 0.0;
        let mut outcome = Ok(());
        for c in text.chars() {
            let id = font.glyph_id(c);
            let glyph = id.with_scale_and_position(scale, point(pen, 0.0));
            pen += font.h_advance_unscaled(id) * self.em as f32 / units;
            let Some(outline) = font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let (x0, y0) = (left + corner.x as i32, baseline + corner.y as i32);
            outline.draw(|x, y, coverage| {
                if outcome.is_ok() && coverage > 0.0 {
                    let color = self.color().mix(f64::from(coverage.min(1.0)));
                    outcome = draw(x0 + x as i32, y0 + y as i32, color);
                }
            });
        }
        Ok(outcome)
    }
}
