//! Writes one figure of each kind, and some hard cases, into a directory:
//! `cargo run --example gallery -- DIRECTORY`.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::PathBuf;

use deltazero_plots::{
    Axis, Band, Cells, Circle, Figure, Group, Guide, Heatmap, Histogram, Level, LineChart, Marker,
    Note, Orbit, Panel, Series, Size, StepHistory, Upright,
};

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).ok_or("which directory?")?);
    std::fs::create_dir_all(&directory)?;
    for (name, figure) in [
        ("work_precision", work_precision(10)),
        ("work_precision_short", work_precision(2)),
        ("time_series", time_series()),
        ("step_history", step_history()),
        ("histogram", histogram()),
        ("orbit", orbit()),
        ("heatmaps", heatmaps()),
        ("ranges", ranges()),
        ("long_labels", long_labels()),
    ] {
        std::fs::write(directory.join(name).with_extension("svg"), figure.svg()?)?;
        std::fs::write(directory.join(name).with_extension("png"), figure.png()?)?;
        println!("{name}");
    }
    Ok(())
}

/// Numbers that look random, the same at every run.
fn noise(seed: u32) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(seed), |x| {
        Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
    })
    .map(|x| f64::from(x >> 8) / f64::from(1 << 24))
}

fn work_precision(methods: usize) -> Figure {
    let names = [
        "Bogacki–Shampine 3(2)",
        "Dormand–Prince 5(4)",
        "Tsitouras 5(4)",
        "Verner 6(5)",
        "Dormand–Prince 8(5,3)",
        "Rosenbrock 3(2)",
        "Radau IIA 5",
        "Taylor, order 12",
        "BDF",
        "ESDIRK 3(4)",
    ];
    let orders = [3.0, 5.0, 5.2, 6.0, 8.0, 3.0, 5.0, 12.0, 2.5, 4.0];
    let series = (0..methods).flat_map(|m| {
        let points = |order: f64, offset: f64| -> Vec<(f64, f64)> {
            let sizes = (0..10).zip(noise(m as u32 + 7).skip(3));
            sizes
                .map(|(i, r)| {
                    let work = 300.0 * 10f64.powf(0.3 * f64::from(i)) * (1.0 + 0.15 * m as f64);
                    let error = offset * (0.7 + 0.6 * r) * (work / 300.0).powf(-order);
                    (work, error.max(2e-15))
                })
                .collect()
        };
        let marker = Marker::cycle(m);
        [
            Series::filled(format!("{}, aware", names[m]), m, marker, points(orders[m], 1e-3)),
            Series::hollow(
                format!("{}, blind", names[m]),
                m,
                marker,
                points(1.0 + 0.05 * m as f64, 2e-3),
            ),
        ]
    });
    let chart = LineChart {
        x: Axis::log("right-hand sides evaluated n_rhs"),
        y: Axis::log("largest error of δ over all impacts [m]"),
        series: series.collect(),
        guides: vec![
            Guide { slope: -1.0, through: (1e3, 1e-5), span: None, label: "order 1".into() },
            Guide { slope: -5.0, through: (1e3, 1e-6), span: None, label: "order 5".into() },
        ],
        levels: vec![Level { y: 1e-12, label: "rounding of the reference".into() }],
        uprights: vec![Upright { x: 2e4, label: "what a peer takes".into() }],
        ..LineChart::default()
    };
    let size = if methods > 2 { Size::WIDE } else { Size::SINGLE };
    Figure { size, ..Figure::single("Work and precision through impacts", chart) }
}

fn time_series() -> Figure {
    let times = || (0..20_000).map(|i| f64::from(i) * 1e-5);
    let gap = |t: f64| 2e-4 * (80.0 * t).sin() * (-3.0 * t).exp() + 2e-5 * (2000.0 * t).sin();
    let points: Vec<_> =
        times().map(|t| (t, if (0.11..0.115).contains(&t) { f64::NAN } else { gap(t) })).collect();
    let bands = [
        (0.0, 0.04, 0, "free"),
        (0.04, 0.08, 1, "slip"),
        (0.08, 0.12, 2, "stick"),
        (0.12, 0.2, 0, "free"),
    ];
    let chart = LineChart {
        title: "Penetration after release".into(),
        x: Axis::linear("t [s]"),
        y: Axis::linear("penetration δ [m]"),
        series: vec![
            Series::line("event-aware", 0, points),
            Series {
                stroke: deltazero_plots::Stroke::Dashed,
                ..Series::line(
                    "event-blind",
                    1,
                    times().map(|t| (t, 0.8 * gap(t + 1e-3))).collect(),
                )
            },
        ],
        bands: bands
            .map(|(a, b, color, label)| Band { x: (a, b), color, label: label.into() })
            .to_vec(),
        marks: vec![0.04, 0.08, 0.12],
        levels: vec![Level { y: 1.5e-4, label: "clearance".into() }],
        notes: vec![Note { at: (0.11, 0.0), text: "no value here".into() }],
        ..LineChart::default()
    };
    Figure { size: Size { width: 900, height: 420 }, ..Figure::single("", chart) }
}

fn step_history() -> Figure {
    let names =
        ["Bogacki–Shampine 3(2)", "Dormand–Prince 5(4)", "Radau IIA 5", "Taylor, order 12", "BDF"];
    let panel = |(m, name): (usize, &&str)| -> Panel {
        let mut t = 0.0_f64;
        let steps = noise(m as u32).take(20_000).map(|r| {
            let h = 10f64.powf(-6.0 + m as f64 * 0.3 + 1.5 * (20.0 * t).sin() + 0.4 * r);
            let start = t;
            t = (t + 1e-5) % 0.2;
            (start, h)
        });
        let accepted: Vec<_> = steps.collect();
        StepHistory {
            title: (*name).into(),
            t: Axis::linear("t [s]"),
            h: Axis::log("h [s]"),
            rejected: accepted.iter().copied().step_by(997).map(|(t, h)| (t, 3.0 * h)).collect(),
            accepted,
            events: (0..60).map(|i| 0.2 * (f64::from(i) / 60.0).powi(2)).collect(),
            color: m,
            ..StepHistory::default()
        }
        .into()
    };
    Figure::stacked("Step sizes through 60 impacts", names.iter().enumerate().map(panel).collect())
}

fn histogram() -> Figure {
    let bins: Vec<(f64, f64)> =
        (0..20).map(|i| 10f64.powf(-6.0 + 0.1 * f64::from(i))).map(|h| (h, 1.26 * h)).collect();
    let bell = |middle: f64, n: f64| {
        (0..20).map(|i| (n * (-0.1 * (f64::from(i) - middle).powi(2)).exp()).floor()).collect()
    };
    let groups = [("free", 5, 16.0, 40.0), ("slip", 2, 10.0, 4e3), ("stick", 4, 12.0, 300.0)];
    let panel = |(title, y): (&str, Axis)| -> Panel {
        let group = |(label, color, middle, n): (&str, usize, f64, f64)| Group {
            label: label.into(),
            color,
            counts: bell(middle, n),
        };
        Histogram {
            title: title.into(),
            x: Axis::log("h [s]"),
            y,
            bins: bins.clone(),
            groups: groups.map(group).to_vec(),
        }
        .into()
    };
    let panels = [("linear", Axis::linear("steps")), ("log", Axis::log("steps").within(0.5, 1e4))];
    Figure { cols: 2, panels: panels.map(panel).to_vec(), size: Size::WIDE, ..Figure::default() }
}

fn orbit() -> Figure {
    let angles = (0..4000).map(|i| f64::from(i) * 0.005);
    let curve: Vec<_> = angles
        .map(|a| (1e-4 * (a.cos() * (1.0 - 0.01 * a) + 0.05 * (7.0 * a).cos()), 0.9e-4 * a.sin()))
        .collect();
    let orbit = Orbit {
        title: "Pin centre in the bush".into(),
        x: Axis::linear("x [m]"),
        y: Axis::linear("y [m]"),
        curves: vec![Series::line("pin centre", 0, curve)],
        circle: Some(Circle { center: (0.0, 0.0), radius: 1e-4, label: "clearance".into() }),
    };
    Figure { size: Size::SQUARE, ..Figure::single("", orbit) }
}

fn heatmaps() -> Figure {
    let columns: Vec<String> = (2..10).map(|k| format!("1e-{k}")).collect();
    let rows: Vec<String> = ["BS3", "DP5", "Tsit5", "Radau", "Taylor"].map(String::from).to_vec();
    let values: Vec<f64> = (0..40)
        .map(|i| if i == 17 { f64::NAN } else { 10f64.powf(f64::from(i % 8) - f64::from(i / 8)) })
        .collect();
    let numbers = Heatmap {
        title: "Error against tolerance".into(),
        x_label: "rtol".into(),
        y_label: "method".into(),
        columns: columns.clone(),
        rows: rows.clone(),
        texts: values.iter().map(|v| format!("{v:.0e}")).collect(),
        cells: Cells::Values { bar: Axis::log("error [m]"), values },
    };
    let names = ["reaches the end", "chatter", "step too small"].map(String::from).to_vec();
    let outcomes = Heatmap {
        title: "Outcome".into(),
        x_label: "rtol".into(),
        columns: columns.iter().map(|c| format!("a long name {c}")).collect(),
        rows,
        cells: Cells::Categories {
            names,
            indices: (0..40).map(|i| (i != 5).then_some((i * i) % 3)).collect(),
        },
        ..Heatmap::default()
    };
    Figure {
        cols: 2,
        panels: vec![numbers.into(), outcomes.into()],
        size: Size { width: 1100, height: 420 },
        ..Figure::default()
    }
}

/// Ranges that are hard to label.
fn ranges() -> Figure {
    let line = |title: &str, x: Axis, y: Axis, points: Vec<(f64, f64)>| -> Panel {
        let series = vec![Series::filled("", 0, Marker::Circle, points)];
        LineChart { title: title.into(), x, y, series, ..LineChart::default() }.into()
    };
    let (lin, log) = (|| Axis::linear("x"), || Axis::log("y"));
    let panels = vec![
        line("nothing", lin(), log(), vec![]),
        line("one point", lin(), log(), vec![(0.0, 3e-9)]),
        line("all equal", lin(), Axis::linear("y"), vec![(-5.0, 1e6); 9]),
        line("part of a decade", lin(), log(), vec![(0.3, 4.2e-6), (0.6, 4.7e-6)]),
        line("one decade", lin(), log(), vec![(-3.0, 2e-6), (4.0, 4e-5)]),
        line(
            "fifteen decades",
            log(),
            log(),
            vec![(1e-16, 1e-15), (1.0, 1.0), (f64::NAN, 1.0), (0.0, 1.0), (10.0, 9.0)],
        ),
        line("300 decades", log(), log(), vec![(1e-160, 1e-150), (1e140, 1e150)]),
        line(
            "large offset",
            lin(),
            Axis::linear("y"),
            vec![(1000.0, 12345.001), (1000.1, 12345.002)],
        ),
        line("large and negative", lin(), Axis::linear("y"), vec![(-3e7, -2e-5), (5e7, 3e-5)]),
    ];
    Figure {
        title: "Ranges that are hard to label".into(),
        rows: 3,
        cols: 3,
        panels,
        size: Size { width: 1100, height: 800 },
        ..Figure::default()
    }
}

fn long_labels() -> Figure {
    let long = "a quantity whose name goes on and on until it is far longer than the axis it belongs to [N·m·s/rad]";
    let chart = LineChart {
        title: format!("A panel title: {long}"),
        x: Axis::linear(long),
        y: Axis::linear(long),
        series: (0..6)
            .map(|i| {
                Series::filled(
                    format!("{i}: {long}"),
                    i,
                    Marker::cycle(i),
                    vec![(0.0, i as f64), (1.0, 1.2 * i as f64)],
                )
            })
            .collect(),
        levels: vec![Level { y: 3.0, label: "a level".into() }],
        notes: vec![Note {
            at: (0.95, 5.0), text: "a note near the border ẋ ≤ √2·ω₀".into()
        }],
        ..LineChart::default()
    };
    Figure::single(format!("A title: {long}"), chart)
}
