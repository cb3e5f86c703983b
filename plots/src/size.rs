//! How large a figure is, and may be.

/// Least and greatest logical side of a figure [px].
pub(crate) const SMALLEST_SIDE: u32 = 100;
pub(crate) const LARGEST_SIDE: u32 = 4000;

/// Logical size of a figure in pixels; an SVG has this size, a PNG twice as many pixels each way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// From left to right.
    pub width: u32,
    /// From top to bottom.
    pub height: u32,
}

impl Size {
    /// One chart with a short legend.
    pub const SINGLE: Self = Self { width: 760, height: 480 };
    /// One chart with a long legend, or two beside each other.
    pub const WIDE: Self = Self { width: 1000, height: 520 };
    /// One chart in a square.
    pub const SQUARE: Self = Self { width: 560, height: 600 };
    /// Panels stacked on a whole page.
    pub const PAGE: Self = Self { width: 900, height: 1100 };
}
