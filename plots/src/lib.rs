//! Charts as plain values, drawn to SVG and PNG with one look.
//!
//! A [`Figure`] is a grid of [`Panel`]s. It is described completely, then drawn: [`Figure::svg`] and
//! [`Figure::png`] render the same shapes, text is set in an embedded font (a machine needs none),
//! and the same value gives the same bytes. Nothing here knows where the numbers come from.
//!
//! ```
//! use deltazero_plots::{Axis, Figure, Guide, LineChart, Marker, Series};
//!
//! let error = |order: i32| (3..10).map(|k| (2f64.powi(k), 2f64.powi(-order * k))).collect();
//! let chart = LineChart {
//!     x: Axis::log("right-hand sides"),
//!     y: Axis::log("error of x at the end [m]"),
//!     series: vec![
//!         Series::filled("RK4, event-aware", 0, Marker::Circle, error(4)),
//!         Series::hollow("RK4, event-blind", 0, Marker::Circle, error(1)),
//!     ],
//!     guides: vec![Guide { slope: -4.0, through: (64.0, 1e-6), span: None, label: "order 4".into() }],
//!     ..LineChart::default()
//! };
//! let figure = Figure::single("Work and precision", chart);
//! assert!(figure.svg()?.contains("event-blind"));
//! assert!(figure.png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), deltazero_plots::Error>(())
//! ```
//!
//! # Modules, in the direction of the data
//!
//! | module | what it holds |
//! |---|---|
//! | `axis`, `series`, `stroke`, `marker` | what charts are described with |
//! | `line`, `steps`, `histogram`, `orbit`, `heatmap` | one kind of chart each, as a value |
//! | `content`, `plane`, `tiles` | a chart made ready: what its axes cover, how it is drawn |
//! | `panel` | a chart of any kind |
//! | `view`, `reference`, `ticks` | values to places; lines to compare with; where ticks stand |
//! | `color_bar` | which colour stands for which number |
//! | `frame`, `legend`, `layout`, `size`, `figure` | what surrounds the data, and where everything goes |
//! | `canvas`, `geometry`, `font`, `style` | shapes in logical pixels, text measures, palette and sizes |
//! | `svg`, `raster`, `glyphs` | shapes and text to SVG and PNG, through the backends of plotters |

mod axis;
mod canvas;
mod color_bar;
mod content;
mod error;
mod figure;
mod font;
mod frame;
mod geometry;
mod glyphs;
mod heatmap;
mod histogram;
mod layout;
mod legend;
mod line;
mod marker;
mod orbit;
mod panel;
mod plane;
mod raster;
mod reference;
mod series;
mod size;
mod steps;
mod stroke;
mod style;
mod svg;
mod ticks;
mod tiles;
mod view;

pub use axis::{Axis, Scale};
pub use error::Error;
pub use figure::Figure;
pub use heatmap::{Cells, Heatmap};
pub use histogram::{Group, Histogram};
pub use legend::Legend;
pub use line::{Band, Bars, Cloud, Guide, Level, LineChart, Note, Ribbon, Upright};
pub use marker::Marker;
pub use orbit::{Circle, Orbit};
pub use panel::Panel;
pub use series::Series;
pub use size::Size;
pub use steps::{StepHistory, StepLook};
pub use stroke::Stroke;
pub use style::PALETTE_LEN;
