//! A figure: panels on a grid, a title above, a legend beside.

use crate::canvas::{Align, Canvas};
use crate::error::Error;
use crate::font::Fonts;
use crate::geometry::Rect;
use crate::layout;
use crate::legend::{self, Legend};
use crate::panel::Panel;
use crate::size::{LARGEST_SIDE, SMALLEST_SIDE, Size};
use crate::style::{BORDER_ROOM, LABEL, MUTED, TEXT, TITLE};
use crate::{raster, svg};

/// Height that a stack of panels has for each, and for what surrounds them [px].
const STACKED: (u32, u32) = (120, 130);

/// Panels on a grid, drawn the same as SVG and as PNG.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Written above all panels; may be empty.
    pub title: String,
    /// Rows of the grid.
    pub rows: usize,
    /// Columns of the grid.
    pub cols: usize,
    /// The panels, row by row; cells may stay free at the end.
    pub panels: Vec<Panel>,
    /// Logical size.
    pub size: Size,
    /// Where the legend stands.
    pub legend: Legend,
    /// All panels with numeric axes cover the same x; only the lowest of each column says what.
    pub share_x: bool,
    /// All panels with numeric axes cover the same y; only the first of each row says what.
    pub share_y: bool,
}

impl Default for Figure {
    /// One cell of the size [`Size::SINGLE`], without a panel.
    fn default() -> Self {
        Self {
            title: String::new(),
            rows: 1,
            cols: 1,
            panels: Vec::new(),
            size: Size::SINGLE,
            legend: Legend::Auto,
            share_x: false,
            share_y: false,
        }
    }
}

impl Figure {
    /// A figure of one panel.
    pub fn single(title: impl Into<String>, panel: impl Into<Panel>) -> Self {
        Self { title: title.into(), panels: vec![panel.into()], ..Self::default() }
    }

    /// Panels on top of each other that share the x axis: a page of them, higher where they are many.
    pub fn stacked(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        let (each, around) = STACKED;
        let n = u32::try_from(panels.len()).unwrap_or(u32::MAX);
        let least = n.saturating_mul(each).saturating_add(around);
        Self {
            title: title.into(),
            rows: panels.len().max(1),
            panels,
            size: Size { height: Size::PAGE.height.max(least), ..Size::PAGE },
            share_x: true,
            ..Self::default()
        }
    }

    /// Whether no panel has data; a figure that cannot be drawn is not empty.
    pub fn is_empty(&self) -> bool {
        let is_empty = |panel: &Panel| panel.content().is_ok_and(|content| content.is_empty());
        self.panels.iter().all(is_empty)
    }

    /// The figure as an SVG document.
    ///
    /// # Errors
    /// If the figure cannot be laid out ([`Error::Size`], [`Error::Grid`], [`Error::Crowded`],
    /// [`Error::SharedScale`]), or a panel is not consistent ([`Error::Range`], [`Error::Cells`],
    /// [`Error::Category`]).
    pub fn svg(&self) -> Result<String, Error> {
        let fonts = Fonts::load()?;
        svg::render(&self.canvas(&fonts)?.shapes, (self.size.width, self.size.height), &fonts)
    }

    /// The figure as a PNG file of twice the logical size.
    ///
    /// # Errors
    /// As [`svg`](Self::svg), and [`Error::Png`].
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        let fonts = Fonts::load()?;
        raster::render(&self.canvas(&fonts)?.shapes, (self.size.width, self.size.height), &fonts)
    }

    fn canvas(&self, fonts: &Fonts) -> Result<Canvas, Error> {
        self.check()?;
        let contents = self.panels.iter().map(Panel::content).collect::<Result<Vec<_>, _>>()?;
        let mut contents = contents;
        layout::share(&mut contents, self.cols, [self.share_x, self.share_y])?;
        let mut canvas = Canvas::default();
        let (width, height) = (f64::from(self.size.width), f64::from(self.size.height));
        let mut area = Rect {
            left: BORDER_ROOM,
            top: BORDER_ROOM,
            right: width - BORDER_ROOM,
            bottom: height - BORDER_ROOM,
        };
        for line in fonts.wrap(&self.title, TITLE, area.width()) {
            canvas.text(&line, (width / 2.0, area.top + TITLE.size), TITLE, TEXT, Align::Middle);
            area.top += TITLE.line_height();
        }
        let entries = contents.iter().flat_map(|content| content.legend()).collect();
        legend::draw(self.legend, entries, &mut area, &mut canvas, fonts);
        for (content, (plot, frame)) in
            contents.iter().zip(layout::arrange(area, (self.rows, self.cols), &contents, fonts)?)
        {
            content.draw(plot, &frame, &mut canvas, fonts);
        }
        if contents.is_empty() {
            canvas.text("no data", area.center(), LABEL, MUTED, Align::Middle);
        }
        Ok(canvas)
    }

    fn check(&self) -> Result<(), Error> {
        let Size { width, height } = self.size;
        let sides = SMALLEST_SIDE..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(Error::Size { width, height });
        }
        let (panels, rows, cols) = (self.panels.len(), self.rows, self.cols);
        if panels > rows.saturating_mul(cols) {
            return Err(Error::Grid { panels, rows, cols });
        }
        Ok(())
    }
}
