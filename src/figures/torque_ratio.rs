//! Arrival of both struts over the ratio of their torques.

use deltazero_plots::{
    Axis, Figure, Legend, LineChart, Marker, Panel, Series, Size, Stroke, Upright,
};

use super::Drawing;
use crate::keys::{Inertia, ReadingName};
use crate::paper::torque_ratio::{RatioCurve, TorqueRatio};

/// Name of its files.
pub(super) const NAME: &str = "torque_ratio";

/// The colour of the joint without clearance: black.
const IDEAL: usize = 6;

/// When AB and AF reach 90°, with axial and transverse inertia; below, by how much clearance delays AF.
pub fn drawing(table: &TorqueRatio) -> Drawing {
    let columns = [(Inertia::Axial, "axial inertia"), (Inertia::Transverse, "transverse inertia")];
    let above = columns.map(|(inertia, title)| arrivals(table, inertia, title));
    let below = columns.map(|(inertia, _)| delays(table, inertia));
    let found = columns.map(|(inertia, title)| {
        let list: Vec<String> = of(table, inertia).filter_map(found).collect();
        format!("{title}: {}", list.join(", "))
    });
    let caption = format!(
        "When AB (level) and AF (rising) reach 90° over M1 : M4, with M1 = {} N m. They arrive together at \
         M1 : M4 of, {}. Below: what clearance adds to the time of AF in the consistent readings.",
        table.m1,
        found.join("; ")
    );
    let figure = Figure {
        title: "Torque ratio that brings both struts to 90° together".into(),
        rows: 2,
        cols: 2,
        panels: above.into_iter().chain(below).collect(),
        size: Size { width: 1050, height: 760 },
        legend: Legend::Below,
        share_x: true,
        share_y: false,
    };
    Drawing { name: NAME, caption, figure }
}

fn of(table: &TorqueRatio, inertia: Inertia) -> impl Iterator<Item = &RatioCurve> {
    table.curves.iter().filter(move |curve| curve.inertia == inertia && !curve.theta2_90.is_empty())
}

fn name(reading: Option<ReadingName>) -> &'static str {
    reading.map_or("no clearance", ReadingName::name)
}

fn color(reading: Option<ReadingName>) -> usize {
    let place = |reading| ReadingName::ALL.iter().position(|known| *known == reading);
    reading.and_then(place).unwrap_or(IDEAL)
}

fn found(curve: &RatioCurve) -> Option<String> {
    Some(format!("{} {:.4}", name(curve.reading), curve.ratio?))
}

fn arrivals(table: &TorqueRatio, inertia: Inertia, title: &str) -> Panel {
    let mut series = Vec::new();
    for curve in of(table, inertia) {
        let color = color(curve.reading);
        let points: Vec<(f64, f64)> =
            curve.theta2_90.iter().filter_map(|&(ratio, t)| Some((ratio, t?))).collect();
        let ends = points.first().zip(points.last());
        if let (Some(t), Some((first, last))) = (curve.theta1_90_s, ends) {
            let level = Series::line("", color, vec![(first.0, t), (last.0, t)]);
            series.push(Series { stroke: Stroke::Dashed, ..level });
        }
        // Curves that coincide are told apart by their markers.
        series.push(match curve.reading {
            None => Series::line(name(None), color, points),
            Some(reading) => {
                let marks = Series::scatter(reading.name(), color, Marker::cycle(color), points);
                Series { stroke: Stroke::Solid, hollow: true, ..marks }
            }
        });
    }
    let ideal = table.curve(None, inertia).and_then(|curve| curve.ratio);
    let upright = |x: f64| Upright { x, label: format!("{x:.3}") };
    LineChart {
        title: title.into(),
        x: Axis::log("M1 : M4"),
        y: Axis::linear("time of 90° [s]"),
        series,
        uprights: ideal.map(upright).into_iter().collect(),
        ..LineChart::default()
    }
    .into()
}

fn delays(table: &TorqueRatio, inertia: Inertia) -> Panel {
    let ideal = table.curve(None, inertia);
    let delay = |curve: &RatioCurve| -> Vec<(f64, f64)> {
        let ideal = ideal.into_iter().flat_map(|curve| &curve.theta2_90);
        let pairs = curve.theta2_90.iter().zip(ideal);
        pairs.filter_map(|(own, ideal)| Some((own.0, 1e3 * (own.1? - ideal.1?)))).collect()
    };
    let consistent =
        |curve: &&RatioCurve| matches!(curve.reading, Some(ReadingName::Pin | ReadingName::Full));
    let series = of(table, inertia).filter(consistent).map(|curve| {
        let color = color(curve.reading);
        let line = Series::filled("", color, Marker::cycle(color), delay(curve));
        Series { hollow: true, ..line }
    });
    LineChart {
        x: Axis::log("M1 : M4"),
        y: Axis::linear("AF later by [ms]"),
        series: series.collect(),
        ..LineChart::default()
    }
    .into()
}
