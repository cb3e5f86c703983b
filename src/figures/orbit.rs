//! The pin's orbit inside the clearance circle.

use deltazero_plots::{Axis, Circle, Figure, Orbit, Panel, Series, Size};

use super::Drawing;
use crate::study::motion::Motion;

/// The orbit of each pin in its bush, scaled to µm.
pub(super) fn drawing(motion: &Motion) -> Drawing {
    let panel = |(i, clearance): (usize, &f64)| -> Panel {
        let joint = i + 1;
        let of_joint = motion.rows.iter().filter(|row| row.joint == joint);
        let points = of_joint.map(|row| (1e6 * row.d1_m, 1e6 * row.d2_m)).collect();
        let (title, x, y) = match joint {
            1 if !motion.slider.is_empty() => ("rod and slider", "X [µm]", "Y [µm]"),
            1 => ("joint 1 (AB)", "x01 [µm]", "y01 [µm]"),
            _ => ("joint 2 (AF)", "y02 [µm]", "z02 [µm]"),
        };
        let (center, label) = ((0.0, 0.0), "clearance circle".to_owned());
        Orbit {
            title: title.into(),
            x: Axis::linear(x),
            y: Axis::linear(y),
            curves: vec![Series::line("pin centre", 0, points)],
            circle: (*clearance > 0.0).then_some(Circle { center, radius: 1e6 * clearance, label }),
        }
        .into()
    };
    let panels: Vec<Panel> = motion.clearance_m.iter().enumerate().map(panel).collect();
    let share = |joint: usize| -> String {
        let rows: Vec<_> = motion.rows.iter().filter(|row| row.joint == joint).collect();
        let free = rows.iter().filter(|row| row.mode == 0).count();
        let share = 100.0 * free as f64 / rows.len().max(1) as f64;
        format!("{share:.1} % of the time in joint {joint}")
    };
    let caption = format!(
        "Orbit of the pin centres in their bushes, {}. The pin is free {}; else it rolls and slips along \
         the bush.",
        motion.method,
        (1..=panels.len()).map(share).collect::<Vec<_>>().join(" and ")
    );
    let figure = Figure {
        title: "Pin orbits".into(),
        rows: 1,
        cols: panels.len().max(1),
        panels,
        size: Size { width: 1100, height: 600 },
        ..Figure::default()
    };
    Drawing { name: "orbit", caption, figure }
}
