//! Shapes to SVG.

use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingBackend};
use plotters_svg::SVGBackend;

use crate::canvas::Shape;
use crate::error::Error;
use crate::font::Fonts;
use crate::geometry::Point;
use crate::glyphs::{Glyphs, opaque};
use crate::style::{Rgb, WHITE};

/// Device units in a logical pixel: the backend works in whole units, the `viewBox` scales them back.
const SCALE: u32 = 10;
/// How far the backend puts the baseline below a text's position [em].
const BASELINE: f64 = 0.76;

/// Colour and width of a line [device units].
struct Pen(Rgb, u32);

impl BackendStyle for Pen {
    fn color(&self) -> BackendColor {
        opaque(self.0)
    }

    fn stroke_width(&self) -> u32 {
        self.1
    }
}

/// The shapes as an SVG document of that logical size.
pub(crate) fn render(
    shapes: &[Shape],
    (width, height): (u32, u32),
    fonts: &Fonts,
) -> Result<String, Error> {
    let raster = (width * SCALE, height * SCALE);
    let mut document = String::new();
    let mut backend = SVGBackend::with_string(&mut document, raster);
    backend.draw_rect((0, 0), (raster.0 as i32, raster.1 as i32), &opaque(WHITE), true)?;
    for shape in shapes {
        draw(&mut backend, shape, fonts)?;
    }
    backend.present()?;
    drop(backend);
    // The backend writes the raster as the size of the image, knows no joins, and repeats defaults;
    // the embedded font has no kerning, so the browser's is not to have any.
    let size = format!("width=\"{}\" height=\"{}\"", raster.0, raster.1);
    let logical = format!(
        "width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\" style=\"font-kerning:none\""
    );
    let mut document = document.replacen(&size, &logical, 1);
    for default in [" opacity=\"1\"", " stroke=\"none\"", " stroke-width=\"1\""] {
        document = document.replace(default, "");
    }
    Ok(document)
}

fn device(length: f64) -> i32 {
    (length * f64::from(SCALE)).round() as i32
}

fn place(&(x, y): &Point) -> BackendCoord {
    (device(x), device(y))
}

fn draw(backend: &mut SVGBackend<'_>, shape: &Shape, fonts: &Fonts) -> Result<(), Error> {
    match shape {
        Shape::Stroke { path, width, color } => {
            backend.draw_path(path.iter().map(place), &Pen(*color, device(*width) as u32))?;
        }
        Shape::Fill { path, color } => {
            backend.fill_polygon(path.iter().map(place), &opaque(*color))?;
        }
        Shape::Disc { center, radius, color } => {
            backend.draw_circle(place(center), device(*radius) as u32, &opaque(*color), true)?;
        }
        Shape::Text(text) => {
            let rise = BASELINE * text.face.size;
            let (x, y) = text.at;
            let at = if text.vertical { (x - rise, y) } else { (x, y - rise) };
            let glyphs = Glyphs { text, em: text.face.size * f64::from(SCALE), fonts };
            backend.draw_text(&text.content, &glyphs, place(&at))?;
        }
    }
    Ok(())
}
