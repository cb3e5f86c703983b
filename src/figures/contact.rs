//! Penetration and normal force over time, with a zoom on one impact.

use deltazero_plots::{Axis, Band, Figure, Level, LineChart, Panel, Series, Size};

use super::Drawing;
use crate::study::motion::{Motion, MotionRow};

/// A unit of penetration, and how many of it are a metre.
type Unit = (&'static str, f64);

/// Colours of penetration, force and contact.
const DELTA: usize = 0;
const FORCE: usize = 1;
const CONTACT: usize = 2;

/// δ and F_N of joint 1: the whole run on the left, one impact on the right.
pub(super) fn drawing(motion: &Motion) -> Drawing {
    let whole: Vec<&MotionRow> = motion.rows.iter().filter(|row| row.joint == 1).collect();
    let zoom: Vec<&MotionRow> = motion.zoom.iter().collect();
    let (title, shown) = if motion.zooms_on_flight {
        ("one flight and impact", "one flight and the impact after it")
    } else {
        ("the start", "the start, for there is no flight")
    };
    let unit = if motion.slider.is_empty() { ("nm", 1e9) } else { ("µm", 1e6) };
    let panels = vec![
        delta_panel("whole run", unit, &whole, Vec::new()),
        delta_panel(title, unit, &zoom, contact_bands(motion)),
        force_panel(&whole, Vec::new()),
        force_panel(&zoom, contact_bands(motion)),
    ];
    let deepest = whole.iter().fold(0.0_f64, |most, row| most.max(row.delta_m));
    let widest = whole.iter().fold(0.0_f64, |most, row| most.max(-row.delta_m));
    let hardest = whole.iter().fold(0.0_f64, |most, row| most.max(row.f_n_n));
    let caption = format!(
        "Joint 1, {}: penetration δ (below zero the gap) and normal force F_N. Deepest {:.2e} m, \
         widest gap {:.2e} m, largest force {:.2} N among the points shown. Right: {shown}; \
         shaded: contact.",
        motion.method, deepest, widest, hardest
    );
    let figure = Figure {
        title: "Contact and separation of joint 1".into(),
        rows: 2,
        cols: 2,
        panels,
        size: Size { width: 1100, height: 720 },
        ..Figure::default()
    };
    Drawing { name: "gap_and_force", caption, figure }
}

fn delta_panel(
    title: &str,
    (unit, per_metre): Unit,
    rows: &[&MotionRow],
    bands: Vec<Band>,
) -> Panel {
    let points = rows.iter().map(|row| (row.t_s, per_metre * row.delta_m)).collect();
    LineChart {
        title: title.into(),
        x: Axis::linear("t [s]"),
        y: Axis::linear(format!("penetration δ [{unit}]")),
        series: vec![Series::line("", DELTA, points)],
        levels: vec![Level { y: 0.0, label: String::new() }],
        bands,
        ..LineChart::default()
    }
    .into()
}

fn force_panel(rows: &[&MotionRow], bands: Vec<Band>) -> Panel {
    let points = rows.iter().map(|row| (row.t_s, row.f_n_n)).collect();
    LineChart {
        x: Axis::linear("t [s]"),
        y: Axis::linear("normal force F_N [N]"),
        series: vec![Series::line("", FORCE, points)],
        bands,
        ..LineChart::default()
    }
    .into()
}

/// The parts of the zoom in contact.
fn contact_bands(motion: &Motion) -> Vec<Band> {
    let (Some(first), Some(last)) = (motion.zoom.first(), motion.zoom.last()) else {
        return Vec::new();
    };
    let mut bands = Vec::new();
    let (mut from, mut mode) = (first.t_s, first.mode);
    let end = (last.t_s, 0);
    for &(t, after) in motion.zoom_modes.iter().chain([&end]) {
        if mode != 0 && t > from {
            bands.push(Band { x: (from, t), color: CONTACT, label: "contact".into() });
        }
        (from, mode) = (t, after);
    }
    bands
}
