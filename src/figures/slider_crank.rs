//! The slider's acceleration over the crank's angle, beside that without clearance.

use std::f64::consts::TAU;

use deltazero_plots::{Axis, Figure, LineChart, Panel, Series, Size};

use super::Drawing;
use crate::config::Config;
use crate::study::motion::{Motion, SliderRow};

/// Colours of the slider with clearance and without.
const WITH: usize = 0;
const IDEAL: usize = 1;

/// The acceleration, whole above and cut to three times the ideal one below.
pub(super) fn drawing(config: &Config, motion: &Motion) -> Drawing {
    let rows = &motion.slider;
    let most =
        |of: fn(&SliderRow) -> f64| rows.iter().map(of).fold(0.0, |a: f64, b| a.max(b.abs()));
    let (own, ideal) = (most(|row| row.slider_m_s2), most(|row| row.ideal_m_s2));
    let free = motion.rows.iter().filter(|row| row.mode == 0).count();
    let joint = &config.joints[0];
    let caption = format!(
        "Acceleration of the slider over the angle of the crank, which turns at {:.0} rpm, clearance \
         {:.0} µm, contact law {}, coefficient of friction {}; {}. It reaches {:.3e} m/s² among the points \
         shown, {:.1} times the {:.3e} m/s² without clearance; the pin is free {:.1} % of the time, and the \
         slider then moves on at constant speed.",
        config.slider_crank.crank_speed * 60.0 / TAU,
        1e6 * joint.joint.clearance,
        joint.contact.law,
        joint.friction.coefficient,
        motion.method,
        own,
        own / ideal,
        ideal,
        100.0 * free as f64 / motion.rows.len().max(1) as f64
    );
    let figure = Figure {
        title: "Slider acceleration".into(),
        rows: 2,
        cols: 1,
        panels: vec![
            panel(rows, "whole", None),
            panel(rows, "cut to three times that without clearance", Some(3.0 * ideal)),
        ],
        size: Size { width: 1100, height: 720 },
        ..Figure::default()
    };
    Drawing { name: "slider_acceleration", caption, figure }
}

fn panel(rows: &[SliderRow], title: &str, most: Option<f64>) -> Panel {
    let points = |of: fn(&SliderRow) -> f64| {
        rows.iter().map(|row| (row.crank_rad.to_degrees(), 1e-3 * of(row))).collect()
    };
    let y = Axis::linear("slider acceleration [km/s²]");
    LineChart {
        title: title.into(),
        x: Axis::linear("crank angle θ [°]"),
        y: match most {
            Some(most) => y.within(-1e-3 * most, 1e-3 * most),
            None => y,
        },
        series: vec![
            Series::line("with clearance", WITH, points(|row| row.slider_m_s2)),
            Series::line("without", IDEAL, points(|row| row.ideal_m_s2)),
        ],
        ..LineChart::default()
    }
    .into()
}
