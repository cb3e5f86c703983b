//! How every figure looks: palette, type sizes, line widths. Lengths are logical pixels (SVG user units).

/// An opaque colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rgb(pub(crate) u8, pub(crate) u8, pub(crate) u8);

impl Rgb {
    /// This colour laid over white with the given opacity (0 gives white, 1 the colour itself).
    pub(crate) fn over_white(self, opacity: f64) -> Self {
        WHITE.toward(self, opacity)
    }

    /// Linear blend: `part` = 0 gives `self`, 1 gives `other`.
    pub(crate) fn toward(self, other: Self, part: f64) -> Self {
        let blend =
            |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
        Self(blend(self.0, other.0), blend(self.1, other.1), blend(self.2, other.2))
    }

    /// Black or white, whichever is easier to read on this colour.
    pub(crate) fn ink(self) -> Self {
        let luma =
            0.299 * f64::from(self.0) + 0.587 * f64::from(self.1) + 0.114 * f64::from(self.2);
        if luma < 120.0 { WHITE } else { TEXT }
    }
}

/// Number of distinct palette colours; a colour index wraps around.
pub const PALETTE_LEN: usize = PALETTE.len();

/// Okabe and Ito's palette ("Color Universal Design", 2008) without its yellow, which is too pale for
/// thin lines on white, then three of Paul Tol's muted colours and his vibrant magenta ("Colour schemes",
/// SRON/EPS/TN/09-002, 2021), and three that are far from all of these.
const PALETTE: [Rgb; 14] = [
    Rgb(0x00, 0x72, 0xB2), // blue
    Rgb(0xD5, 0x5E, 0x00), // vermilion
    Rgb(0x00, 0x9E, 0x73), // bluish green
    Rgb(0xCC, 0x79, 0xA7), // reddish purple
    Rgb(0xE6, 0x9F, 0x00), // orange
    Rgb(0x56, 0xB4, 0xE9), // sky blue
    Rgb(0x00, 0x00, 0x00), // black
    Rgb(0x88, 0x22, 0x55), // wine
    Rgb(0x33, 0x22, 0x88), // indigo
    Rgb(0x99, 0x99, 0x33), // olive
    Rgb(0xEE, 0x33, 0x77), // magenta
    Rgb(0x8C, 0x51, 0x0A), // brown
    Rgb(0x7F, 0x7F, 0x7F), // grey
    Rgb(0x7A, 0xC9, 0x43), // light green
];

/// The palette's colour of that index.
pub(crate) fn palette(index: usize) -> Rgb {
    PALETTE[index % PALETTE_LEN]
}

/// Viridis (S. van der Walt, N. Smith, 2015) at nine equidistant points.
const VIRIDIS: [Rgb; 9] = [
    Rgb(0x44, 0x01, 0x54),
    Rgb(0x47, 0x2D, 0x7B),
    Rgb(0x3B, 0x52, 0x8B),
    Rgb(0x2C, 0x72, 0x8E),
    Rgb(0x21, 0x91, 0x8C),
    Rgb(0x28, 0xAE, 0x80),
    Rgb(0x5E, 0xC9, 0x62),
    Rgb(0xAD, 0xDC, 0x30),
    Rgb(0xFD, 0xE7, 0x25),
];

/// Colour of a continuous quantity, `at` from 0 to 1.
pub(crate) fn gradient(at: f64) -> Rgb {
    let place = at.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    VIRIDIS[below].toward(VIRIDIS[below + 1], place - below as f64)
}

pub(crate) const WHITE: Rgb = Rgb(0xFF, 0xFF, 0xFF);
pub(crate) const TEXT: Rgb = Rgb(0x22, 0x22, 0x22);
pub(crate) const MUTED: Rgb = Rgb(0x66, 0x66, 0x66);
pub(crate) const BORDER: Rgb = Rgb(0x66, 0x66, 0x66);
pub(crate) const GRID: Rgb = Rgb(0xD9, 0xD9, 0xD9);
pub(crate) const GRID_MINOR: Rgb = Rgb(0xF0, 0xF0, 0xF0);
pub(crate) const GUIDE: Rgb = Rgb(0x80, 0x80, 0x80);
pub(crate) const MARK: Rgb = Rgb(0xB4, 0xB4, 0xB4);
/// Opacity of the colour of a band.
pub(crate) const BAND: f64 = 0.16;
/// Opacity of the colour of a ribbon, and of its edges.
pub(crate) const RIBBON: f64 = 0.25;
pub(crate) const RIBBON_EDGE: f64 = 0.6;

/// Opacity of the colour of a category's cell.
pub(crate) const CELL: f64 = 0.45;

/// Size [px] and weight of a text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub(crate) size: f64,
    pub(crate) bold: bool,
}

impl Face {
    /// Distance between two baselines.
    pub(crate) fn line_height(self) -> f64 {
        1.3 * self.size
    }
}

pub(crate) const TITLE: Face = Face { size: 16.0, bold: true };
pub(crate) const PANEL: Face = Face { size: 13.0, bold: true };
pub(crate) const LABEL: Face = Face { size: 13.0, bold: false };
pub(crate) const TICK: Face = Face { size: 11.5, bold: false };
pub(crate) const LEGEND: Face = Face { size: 12.0, bold: false };
pub(crate) const NOTE: Face = Face { size: 11.0, bold: false };

/// Width of a series' line.
pub(crate) const STROKE: f64 = 1.7;
/// Width of the frame, of ticks and of reference lines.
pub(crate) const THIN: f64 = 1.0;
/// Lengths of a dash and of the gap after it, of a series and of a reference line.
pub(crate) const DASH: (f64, f64) = (6.0, 4.0);
/// Length of a tick outside the frame.
pub(crate) const TICK_LENGTH: f64 = 4.0;
/// Free border around the whole figure.
pub(crate) const BORDER_ROOM: f64 = 12.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_colours_of_the_palette_are_alike() {
        let apart = |a: Rgb, b: Rgb| {
            let each = [(a.0, b.0), (a.1, b.1), (a.2, b.2)];
            each.iter().map(|(a, b)| i32::from(a.abs_diff(*b))).sum::<i32>()
        };
        for (i, a) in PALETTE.iter().enumerate() {
            for b in &PALETTE[..i] {
                // Measured: at least 82, of orange and vermilion.
                assert!(apart(*a, *b) > 60, "{a:?} {b:?}");
            }
        }
    }
}
