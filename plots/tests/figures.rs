//! What every figure keeps to, seen from outside.

use deltazero_plots::{
    Axis, Band, Bars, Cells, Cloud, Error, Figure, Group, Guide, Heatmap, Histogram, Level,
    LineChart, Marker, Note, Orbit, Panel, Ribbon, Series, Size, StepHistory, StepLook, Upright,
};

fn chart(points: Vec<(f64, f64)>) -> LineChart {
    LineChart {
        title: "panel".into(),
        x: Axis::log("work [1]"),
        y: Axis::log("error [m]"),
        series: vec![Series::filled("one method", 0, Marker::Circle, points)],
        ..LineChart::default()
    }
}

fn history(points: Vec<(f64, f64)>) -> StepHistory {
    StepHistory {
        title: "a method".into(),
        t: Axis::linear("t [s]"),
        h: Axis::log("h [s]"),
        accepted: points.clone(),
        rejected: points,
        events: vec![0.1, 0.5, f64::NAN],
        ..StepHistory::default()
    }
}

fn table(values: Vec<f64>) -> Heatmap {
    Heatmap {
        columns: vec!["a".into(), "b".into()],
        rows: vec!["c".into(), "d".into()],
        cells: Cells::Values { bar: Axis::linear("value"), values },
        ..Heatmap::default()
    }
}

fn counts(counts: Vec<f64>) -> Histogram {
    let bins = (0..counts.len()).map(|i| (i as f64, i as f64 + 1.0)).collect();
    let groups = [0, 1].map(|color| Group {
        label: format!("group {color}"),
        color,
        counts: counts.clone(),
    });
    Histogram { bins, groups: groups.to_vec(), ..Histogram::default() }
}

fn every_kind() -> Figure {
    let points: Vec<_> = (1..200).map(|i| (f64::from(i), 1.0 / f64::from(i * i))).collect();
    let orbit =
        Orbit { curves: vec![Series::line("curve", 1, points.clone())], ..Orbit::default() };
    let panels: Vec<Panel> = vec![
        chart(points.clone()).into(),
        history(points).into(),
        orbit.into(),
        counts(vec![3.0, 0.0, 1.0]).into(),
        table(vec![1.0, 2.0, 3.0, f64::NAN]).into(),
    ];
    Figure { rows: 3, cols: 2, panels, size: Size::PAGE, ..Figure::default() }
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    assert_eq!(every_kind().svg().unwrap(), every_kind().svg().unwrap());
    assert_eq!(every_kind().png().unwrap(), every_kind().png().unwrap());
}

#[test]
fn an_svg_says_what_the_axes_and_series_are() {
    let svg = Figure::single("the title", chart(vec![(1.0, 1e-3), (10.0, 1e-9)])).svg().unwrap();
    for text in ["the title", "panel", "work [1]", "error [m]", "one method", "10⁻⁶", "sans-serif"]
    {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.starts_with("<svg width=\"760\" height=\"480\""));
    assert!(svg.trim_end().ends_with("</svg>"));
}

#[test]
fn a_png_has_twice_the_logical_size() {
    let png = Figure::single("", chart(vec![])).png().unwrap();
    let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (1520, 960));
}

#[test]
fn a_figure_without_data_says_so() {
    let nothing = vec![(f64::NAN, 1.0), (-1.0, 1.0), (0.0, 2.0)];
    for figure in [
        Figure::default(),
        Figure::single("", chart(vec![])),
        Figure::single("", chart(nothing)),
        Figure::single("", history(vec![])),
        Figure::single("", Orbit::default()),
        Figure::single("", counts(vec![0.0, f64::NAN])),
        Figure::single("", Heatmap::default()),
    ] {
        assert!(figure.svg().unwrap().contains("no data"));
        assert!(figure.is_empty());
        figure.png().unwrap();
    }
    assert!(!every_kind().is_empty());
}

#[test]
fn degenerate_data_is_drawn_without_an_error() {
    let extremes =
        [f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, f64::INFINITY, f64::NAN, -0.0, 1.0];
    for points in [
        vec![(1.0, 1.0)],
        vec![(2.0, 5.0); 100],
        vec![(1e15, 1e-15), (1e15 + 0.125, 2e-15)],
        vec![(1e300, 1e-300), (1e-300, 1e300)],
        extremes.iter().flat_map(|&x| extremes.map(|y| (x, y))).collect(),
    ] {
        for axes in [Axis::linear, Axis::log] {
            let line = LineChart { x: axes(""), y: axes(""), ..chart(points.clone()) };
            let equal = LineChart { equal_aspect: true, ..line.clone() };
            Figure::stacked("", vec![line.into(), equal.into()]).png().unwrap();
        }
    }
}

#[test]
fn references_that_cannot_be_shown_are_left_out() {
    let nowhere = f64::NAN;
    let line = LineChart {
        bands: vec![
            Band { x: (nowhere, 1.0), ..Band::default() },
            Band { x: (1e9, 1e8), ..Band::default() },
        ],
        marks: vec![nowhere, -1.0, 1e99],
        ticks: vec![nowhere],
        guides: vec![
            Guide { slope: nowhere, through: (2.0, 2.0), ..Guide::default() },
            Guide { slope: 1.0, through: (0.0, 2.0), label: "invisible".into(), span: None },
        ],
        levels: vec![Level { y: -1.0, label: "invisible".into() }],
        uprights: vec![
            Upright { x: -1.0, label: "invisible".into() },
            Upright { x: nowhere, label: "invisible".into() },
        ],
        notes: vec![Note { at: (1e9, 1.0), text: "invisible".into() }],
        ..chart(vec![(1.0, 1.0), (2.0, 3.0)])
    };
    assert!(!Figure::single("", line).svg().unwrap().contains("invisible"));
}

#[test]
fn panels_that_share_x_show_its_labels_once() {
    let panels = vec![history(vec![(0.0, 1e-3)]).into(), history(vec![(1.0, 1e-3)]).into()];
    let svg = Figure::stacked("", panels).svg().unwrap();
    assert_eq!(svg.matches("t [s]").count(), 1);
    assert_eq!(svg.matches("h [s]").count(), 2);
    assert_eq!(svg.matches("rejected step").count(), 1);
}

#[test]
fn a_stack_of_many_panels_is_higher_than_a_page() {
    let stack = |n: i32| {
        let panel = |i: i32| Panel::from(history(vec![(f64::from(i), 1e-3)]));
        Figure::stacked("many", (0..n).map(panel).collect())
    };
    assert_eq!(stack(7).size, Size::PAGE);
    for n in [9, 14, 30] {
        assert!(stack(n).size.height > Size::PAGE.height);
        stack(n).svg().unwrap();
    }
}

#[test]
fn stairs_are_as_long_as_the_steps() {
    let (t, h) = (Axis::linear("").within(0.0, 1.0), Axis::log("").within(0.1, 1.0));
    let last_x = |chart: Panel| {
        let svg = Figure::single("", chart).svg().unwrap();
        // The first colour of the palette.
        let (_, path) = svg.split_once("<polyline fill=\"none\" stroke=\"#0072B2\"").unwrap();
        let (_, points) = path.split_once("points=\"").unwrap();
        let last = points.split_once('"').unwrap().0.split_whitespace().next_back().unwrap();
        last.split_once(',').unwrap().0.to_owned()
    };
    let stairs = |accepted: Vec<(f64, f64)>| {
        let (t, h) = (t.clone(), h.clone());
        last_x(
            StepHistory { t, h, look: StepLook::Stairs, accepted, ..StepHistory::default() }.into(),
        )
    };
    let line = |points: Vec<(f64, f64)>| {
        let series = vec![Series::line("", 0, points)];
        last_x(LineChart { x: t.clone(), y: h.clone(), series, ..LineChart::default() }.into())
    };
    // Two steps of half a second, and of a quarter.
    assert_eq!(stairs(vec![(0.0, 0.5), (0.5, 0.5)]), line(vec![(0.0, 0.5), (1.0, 0.5)]));
    assert_eq!(stairs(vec![(0.0, 0.25), (0.25, 0.25)]), line(vec![(0.0, 0.25), (0.5, 0.25)]));
}

#[test]
fn a_histogram_has_a_bar_for_each_count_above_zero() {
    let svg = |values: Vec<f64>| Figure::single("", counts(values)).svg().unwrap();
    let fills = |values| svg(values).matches("<polygon").count();
    // Of each of the two groups.
    assert_eq!(fills(vec![1.0, 2.0, 3.0]) - fills(vec![1.0, 0.0, 3.0]), 2);
    assert!(svg(vec![1.0]).contains("group 1"));
}

#[test]
fn a_bar_below_zero_hangs_from_it() {
    let fills = |value: f64| {
        let bars = vec![Bars { bars: vec![((0.0, 1.0), value)], ..Bars::default() }];
        let y = Axis::linear("index").within(-2.0, 2.0);
        let svg = Figure::single("", LineChart { bars, y, ..LineChart::default() }).svg().unwrap();
        svg.matches("<polygon").count()
    };
    assert_eq!([1.6, -1.6].map(|value| fills(value) - fills(0.0)), [1, 1]);
}

#[test]
fn a_ribbon_is_one_area_with_two_edges_cut_at_the_frame() {
    let svg = |points: Vec<(f64, f64, f64)>| {
        let ribbons = vec![Ribbon { color: 1, points }];
        let line = LineChart { ribbons, ..chart(vec![(1.0, 1e-3), (9.0, 1.0)]) };
        Figure::single("", line).svg().unwrap()
    };
    let count = |points, shape| svg(points).matches(shape).count();
    let whole = vec![(2.0, 1e-2, 1e-1), (3.0, 0.0, 1e99), (4.0, f64::NAN, 0.5), (1e9, 1.0, 2.0)];
    for (shape, n) in [("<polygon", 1), ("<polyline", 2)] {
        assert_eq!(count(whole.clone(), shape) - count(vec![], shape), n, "{shape}");
    }
    assert_eq!(svg(vec![(2.0, 1.0, 2.0)]), svg(vec![]), "one point is no area");
}

#[test]
fn a_named_axis_has_a_tick_for_each_name_and_wide_names_stand_upright() {
    let svg = |names: &[&str]| {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        let points = vec![(0.0, 1.0), (1.0, 2.0)];
        let named = LineChart { x: Axis::named("law", names), ..chart(points) };
        Figure::single("", named).svg().unwrap()
    };
    let few = svg(&["coulomb", "stribeck"]);
    assert!(few.contains("coulomb") && few.contains("stribeck") && !few.contains("10⁰"));
    let long = "joint1.joint.clearance";
    let turned = |svg: &str| svg.matches("rotate").count();
    assert_eq!(turned(&svg(&[long; 12])) - turned(&few), 12);
}

#[test]
fn a_long_name_of_a_place_loses_its_middle() {
    let long = format!("first{}last", "_".repeat(300));
    let axis = || Axis::named("mode", vec![long.clone(), "free".into()]);
    let points = || vec![(0.0, 1.0), (1.0, 0.0)];
    let map = Heatmap { rows: vec![long.clone(), "d".into()], ..table(vec![1.0; 4]) };
    let panels: [Panel; 3] = [
        LineChart { x: axis(), ..chart(points()) }.into(),
        LineChart { y: axis(), ..chart(points()) }.into(),
        map.into(),
    ];
    for panel in panels {
        let svg = Figure::single("", panel).svg().unwrap();
        assert!(
            svg.contains("\nfirst_") && svg.contains("_…_") && svg.contains("_last\n"),
            "{svg}"
        );
    }
}

#[test]
fn a_cell_without_a_colour_is_crossed_out() {
    let lines = |last: Option<usize>| {
        let names = ["one", "other"].map(str::to_owned).to_vec();
        let cells = Cells::Categories { names, indices: vec![Some(0), Some(1), Some(0), last] };
        let map = Heatmap { cells, ..table(vec![]) };
        Figure::single("", map).svg().unwrap().matches("<polyline").count()
    };
    assert_eq!(lines(None) - lines(Some(1)), 2);
}

#[test]
fn a_cloud_has_a_colour_bar_and_what_has_no_colour_is_grey() {
    let svg = |z: f64| {
        let points = vec![(1.0, 1.0, 1.0), (2.0, 2.0, z), (3.0, 3.0, 3.0)];
        let cloud = Cloud { bar: Axis::linear("mass [kg]"), marker: Marker::Circle, points };
        let line = LineChart { cloud: Some(Box::new(cloud)), ..chart(vec![]) };
        Figure::single("", line).svg().unwrap()
    };
    assert!(svg(2.0).contains("mass [kg]"));
    let grey = |svg: &str| svg.matches("#B4B4B4").count();
    assert_eq!(grey(&svg(f64::NAN)) - grey(&svg(2.0)), 1);
}

#[test]
fn a_curve_of_which_nothing_is_drawn_has_no_legend() {
    let curve = |name: &str, y: f64| Series::line(name, 0, vec![(1.0, y), (2.0, y)]);
    let series = vec![curve("of one", 1.0), curve("of zero", 0.0)];
    let svg = Figure::single("", LineChart { series, ..chart(vec![]) }).svg().unwrap();
    assert!(svg.contains("of one") && !svg.contains("of zero"));
}

#[test]
fn thousands_of_points_do_not_make_a_large_svg() {
    let points: Vec<_> = (1..100_000).map(|i| (f64::from(i), 2.0 + f64::from(i).sin())).collect();
    let line = LineChart { series: vec![Series::line("", 0, points)], ..chart(vec![]) };
    let svg = Figure::single("", line).svg().unwrap();
    // Measured: 0.26 MB.
    assert!(svg.len() < 500_000, "{} bytes", svg.len());
}

#[test]
fn impossible_figures_are_errors() {
    let one = || Figure::single("", chart(vec![(1.0, 1.0)]));
    let of = |figure: Figure| figure.svg().unwrap_err();
    let tiny = Size { width: 10, height: 10_000 };
    assert!(matches!(of(Figure { size: tiny, ..one() }), Error::Size { .. }));
    assert!(matches!(of(Figure { rows: 0, ..one() }), Error::Grid { panels: 1, .. }));
    let small = Size { width: 100, height: 100 };
    assert!(matches!(of(Figure { size: small, ..one() }), Error::Crowded { .. }));
    let range = LineChart { x: Axis::log("x").within(0.0, 1.0), ..chart(vec![]) };
    assert!(matches!(of(Figure::single("", range)), Error::Range { .. }));
    let linear = LineChart { x: Axis::linear("x"), ..chart(vec![]) };
    let mixed = Figure::stacked("", vec![chart(vec![]).into(), linear.into()]);
    assert!(matches!(of(mixed), Error::SharedScale { .. }));
    assert!(matches!(of(Figure::single("", table(vec![1.0]))), Error::Cells { cells: 1, .. }));
    let names = Cells::Categories { names: vec![], indices: vec![Some(0); 4] };
    let unnamed = Heatmap { cells: names, ..table(vec![]) };
    assert!(matches!(of(Figure::single("", unnamed)), Error::Category { .. }));
}
