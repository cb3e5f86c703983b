//! The paper's Figs. 7 to 14 from runs of our own: one figure each, the readings that reach 90° overlaid.
//!
//! A pale area goes from the least to the largest value in a bin of time, so that nothing is lost that
//! oscillates faster than a figure can show; a line is the mean over the bin, drawn where the
//! curve swings little about it, and of forces everywhere.

use deltazero_plots::{
    Axis, Figure, Legend, Level, LineChart, Panel, Ribbon, Series, Size, Stroke,
};

use super::Drawing;
use crate::keys::ReadingName;
use crate::paper::audit::Audit;
use crate::paper::claims::{ClaimRow, Verdict};
use crate::paper::course::{Bin, Quantity, Range, coarser};
use crate::paper::deployment::{Course, TRANSIENT_S};
use crate::paper::ideal::RIGHT_ANGLE;

/// Bins over the width of a panel: of a smooth curve, and of one that oscillates, each some periods long.
const FINE: usize = 350;
const COARSE: usize = 68;
/// The colour of the joint without clearance: black.
const IDEAL: usize = 6;
/// A panel shows values up to this many times the largest without clearance, or the clearance.
const ROOM: f64 = 1.4;
/// Where a curve swings by more than this part of the panel it has no line.
const WIDE: f64 = 0.06;
/// Least force on a logarithmic axis [N].
const LEAST_FORCE: f64 = 0.03;

/// Names of their files.
pub(super) const NAMES: [&str; 8] = [
    "fig07_ab_ideal",
    "fig08_af_ideal",
    "fig09_ab",
    "fig10_x01",
    "fig11_y01",
    "fig12_f_n1",
    "fig13_af",
    "fig14_f_n2",
];

/// All of them.
pub fn drawings(audit: &Audit) -> Vec<Drawing> {
    let [ab_ideal, af_ideal, ab, x01, y01, f_n1, af, f_n2] = NAMES;
    vec![
        ideal(audit, 1, ab_ideal),
        ideal(audit, 2, af_ideal),
        strut(audit, 1, ab),
        displacement(audit, Quantity::D1, x01),
        displacement(audit, Quantity::D2, y01),
        force(audit, 1, f_n1),
        strut(audit, 2, af),
        force(audit, 2, f_n2),
    ]
}

/// A curve of a chart.
struct Curve<'a> {
    course: &'a Course,
    label: &'static str,
    color: usize,
}

/// The joint without clearance.
fn ideal_curve(audit: &Audit, joint: usize) -> Option<Curve<'_>> {
    let course = audit.course(None, joint)?;
    Some(Curve { course, label: "no clearance", color: IDEAL })
}

/// The readings under which `joint` reaches 90°.
fn curves(audit: &Audit, joint: usize) -> Vec<Curve<'_>> {
    let curve = |(color, reading): (usize, &ReadingName)| {
        let course = audit.course(Some(*reading), joint)?;
        course.run.reached_90_s?;
        Some(Curve { course, label: reading.name(), color })
    };
    ReadingName::ALL.iter().enumerate().filter_map(curve).collect()
}

/// The readings under which it does not, which have no curve.
fn not_drawn(audit: &Audit, joint: usize) -> String {
    let is_short = |course: &Course| course.run.reached_90_s.is_none();
    let left_out =
        |reading: &&ReadingName| audit.course(Some(**reading), joint).is_some_and(is_short);
    let names: Vec<&str> =
        ReadingName::ALL.iter().filter(left_out).map(|reading| reading.name()).collect();
    match names[..] {
        [] => String::new(),
        _ => format!(" Not drawn, as it did not come to 90°: {}.", names.join(", ")),
    }
}

/// What a panel shows.
struct Show {
    quantity: Quantity,
    label: String,
    /// Units of the axis in one of SI.
    factor: f64,
    /// Until when [s].
    until: f64,
    /// Values beyond are cut off.
    limit: f64,
    is_log: bool,
}

/// A bin, in units of the axis.
struct Point {
    t: f64,
    least: f64,
    most: f64,
    mean: f64,
    /// From least to most, less what the trend alone would cover.
    swing: f64,
}

impl Show {
    fn points(&self, course: &Course) -> Vec<Point> {
        let bins = course.until(self.until);
        let is_smooth = course.run.reading.is_none() || self.quantity == Quantity::Theta;
        let columns = if is_smooth || self.until.is_finite() { FINE } else { COARSE };
        let point = |bin: &Bin| {
            let Range { least, most, mean } = bin.of(self.quantity);
            let [least, most, mean] = [least, most, mean].map(|value| self.factor * value);
            Point { t: bin.middle_s(), least, most, mean, swing: most - least }
        };
        let bins = coarser(bins, bins.len().div_ceil(columns));
        let mut points: Vec<Point> = bins.iter().map(point).collect();
        let means: Vec<f64> = points.iter().map(|point| point.mean).collect();
        for (i, point) in points.iter_mut().enumerate() {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(means.len() - 1));
            let trend = (means[after] - means[before]) / (after - before).max(1) as f64;
            point.swing -= trend.abs();
        }
        points
    }

    fn panel(&self, title: &str, curves: &[Curve<'_>]) -> Panel {
        let points: Vec<Vec<Point>> =
            curves.iter().map(|curve| self.points(curve.course)).collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in points.iter().flatten() {
            low = low.min(point.least.max(-self.limit));
            high = high.max(point.most.min(self.limit));
        }
        let is_followed = self.until.is_finite() || self.quantity == Quantity::Force;
        let narrow = if is_followed { f64::INFINITY } else { WIDE * (high - low) };
        let mut series = Vec::new();
        let mut ribbons = Vec::new();
        for (curve, points) in curves.iter().zip(&points) {
            let area = points.iter().map(|point| (point.t, point.least, point.most)).collect();
            let width = |point: &Point| (point.most - point.least).min(high - low);
            let widths = points.iter().map(width).sum::<f64>();
            ribbons.push((widths, Ribbon { color: curve.color, points: area }));
            let lost = curve.course.run.horizon_s.unwrap_or(f64::INFINITY);
            let part = |is_lost: bool| -> Vec<(f64, f64)> {
                let own = points.iter().filter(|point| (point.t > lost) == is_lost);
                let mean =
                    |point: &Point| if point.swing <= narrow { point.mean } else { f64::NAN };
                own.map(|point| (point.t, mean(point))).collect()
            };
            series.push(Series::line(curve.label, curve.color, part(false)));
            let beyond = Series::line("", curve.color, part(true));
            series.push(Series { stroke: Stroke::Dashed, ..beyond });
        }
        // Wide areas first: they would hide the others.
        ribbons.sort_by(|a, b| b.0.total_cmp(&a.0));
        let ribbons = ribbons.into_iter().map(|(_, ribbon)| ribbon).collect();
        let y = if self.is_log { Axis::log(&self.label) } else { Axis::linear(&self.label) };
        let room = 0.04 * (high - low);
        let (low, high) =
            if self.is_log { (LEAST_FORCE, 1.2 * high) } else { (low - room, high + room) };
        let y = if low < high { y.within(low, high) } else { y };
        let levels = match self.quantity {
            Quantity::Theta => vec![Level { y: 90.0, label: "90°".into() }],
            _ => Vec::new(),
        };
        let end = points.iter().flatten().map(|point| point.t).fold(0.0, f64::max);
        let x = Axis::linear("t [s]");
        let x = if end > 0.0 { x.within(0.0, 1.02 * end) } else { x };
        LineChart { title: title.into(), x, y, series, ribbons, levels, ..LineChart::default() }
            .into()
    }
}

/// θ, θ̇ or θ̈ of a joint, until `until` [s].
fn angle(audit: &Audit, joint: usize, quantity: Quantity, until: f64) -> Show {
    let ideal = audit.course(None, joint);
    let largest = ideal.map_or(f64::INFINITY, |course| {
        let all = course.bins.iter().map(|bin| bin.of(quantity).magnitude());
        all.fold(0.0, f64::max)
    });
    let (name, unit, factor) = match quantity {
        Quantity::Theta => (format!("θ{joint}"), "°", 90.0 / RIGHT_ANGLE),
        // The font has no dots above letters.
        Quantity::Omega => (format!("dθ{joint}/dt"), "rad/s", 1.0),
        _ => (format!("d²θ{joint}/dt²"), "rad/s²", 1.0),
    };
    let label = format!("{name} [{unit}]");
    Show { quantity, label, factor, until, limit: ROOM * largest * factor, is_log: false }
}

fn name(joint: usize) -> &'static str {
    if joint == 1 { "AB" } else { "AF" }
}

/// Fig. 7 or 8.
fn ideal(audit: &Audit, joint: usize, file: &'static str) -> Drawing {
    let curves: Vec<Curve<'_>> = ideal_curve(audit, joint).into_iter().collect();
    let panel = |quantity| angle(audit, joint, quantity, f64::INFINITY).panel("", &curves);
    let panels = vec![panel(Quantity::Theta), panel(Quantity::Omega), panel(Quantity::Alpha)];
    let turn = curves.first().and_then(|Curve { course, .. }| {
        let alpha = |bin: &Bin| course.onward(bin, Quantity::Alpha);
        let by = |a: &&Bin, b: &&Bin| alpha(a).most.total_cmp(&alpha(b).most);
        let fastest = course.bins.iter().max_by(by)?;
        // It grows to the end.
        let falls = alpha(fastest).most > alpha(course.bins.last()?).most;
        falls.then_some(())?;
        Some(format!(
            " θ̈{joint} grows to {:.3} rad/s² at {:.2} s, θ{joint} = {:.0}°, and falls to {:.3} rad/s² at 90°: \
             the paper says that it increases.",
            alpha(fastest).most,
            fastest.middle_s(),
            course.onward(fastest, Quantity::Theta).mean.to_degrees(),
            alpha(course.bins.last()?).least
        ))
    });
    let caption = format!(
        "{} without clearance (the paper's Fig. {}), {}: 90° after {} (paper: 13.5 s).{}",
        name(joint),
        6 + joint,
        audit.method,
        seconds(curves.first().and_then(|curve| curve.course.run.reached_90_s)),
        turn.unwrap_or_default()
    );
    let figure = Figure {
        title: format!("{} without clearance", name(joint)),
        rows: 1,
        cols: 3,
        panels,
        size: Size { width: 1050, height: 360 },
        legend: Legend::Hidden,
        ..Figure::default()
    };
    Drawing { name: file, caption, figure }
}

/// Fig. 9 or 13.
fn strut(audit: &Audit, joint: usize, file: &'static str) -> Drawing {
    let mut all: Vec<Curve<'_>> = ideal_curve(audit, joint).into_iter().collect();
    all.extend(curves(audit, joint));
    let panel = |title: &str, quantity, until| {
        let show = angle(audit, joint, quantity, until);
        // The first seconds are shown whole.
        let limit = if until.is_finite() { f64::INFINITY } else { show.limit };
        Show { limit, ..show }.panel(title, &all)
    };
    let whole = f64::INFINITY;
    let panels = vec![
        panel("", Quantity::Theta, whole),
        panel("", Quantity::Omega, whole),
        panel("", Quantity::Alpha, whole),
        panel("the first two seconds", Quantity::Alpha, TRANSIENT_S),
    ];
    let [theta, alpha] = match joint {
        1 => ["theta1_deviation", "theta1_ddot_deviation"],
        _ => ["theta2_deviation", "theta2_ddot_deviation"],
    };
    let caption = format!(
        "{} with clearance (the paper's Fig. {}), {}. θ = 90° at {}; without clearance at {}. Largest deviation \
         from the course without clearance, over its largest value: of θ {}; of θ̈ in the first 2 s {}. Where θ \
         deviates little the curves coincide.{} {}",
        name(joint),
        if joint == 1 { 9 } else { 13 },
        audit.method,
        arrivals(audit, joint),
        seconds(audit.course(None, joint).and_then(|course| course.run.reached_90_s)),
        measured(audit, theta),
        measured(audit, alpha),
        not_drawn(audit, joint),
        how(),
    );
    let figure = Figure {
        title: format!("{} with clearance", name(joint)),
        rows: 2,
        cols: 2,
        panels,
        size: Size { width: 1050, height: 760 },
        legend: Legend::Below,
        ..Figure::default()
    };
    Drawing { name: file, caption, figure }
}

/// Fig. 10 or 11.
fn displacement(audit: &Audit, quantity: Quantity, file: &'static str) -> Drawing {
    let all = curves(audit, 1);
    let is_x = quantity == Quantity::D1;
    let coordinate = if is_x { "x01" } else { "y01" };
    let show = |until| Show {
        quantity,
        label: format!("{coordinate} [µm]"),
        factor: 1e6,
        until,
        limit: ROOM * 1e6 * audit.clearance_m,
        is_log: false,
    };
    let panels = vec![
        show(f64::INFINITY).panel("", &all),
        show(TRANSIENT_S).panel("the first two seconds", &all),
    ];
    let claim = if is_x { "x01_max" } else { "y01_max" };
    let says = if is_x {
        let is_impossible = |row: &ClaimRow| row.verdict == Verdict::Impossible;
        let why = match audit.rows.iter().any(|row| row.claim == claim && is_impossible(row)) {
            true => ", which takes a contact force of kilonewtons",
            false => "",
        };
        format!("0.00054 m{why}")
    } else {
        format!(
            "0.0001 m, a sine; the best sine explains {} of the variance",
            measured(audit, "y01_sinusoidal")
        )
    };
    let caption = format!(
        "{coordinate} of the pin of AB (the paper's Fig. {}), {}. Largest |{coordinate}| in m: {} (paper: {says}). \
         The clearance is {:e} m; what lies beyond {ROOM} of it is cut off.{} {}",
        if is_x { 10 } else { 11 },
        audit.method,
        measured(audit, claim),
        audit.clearance_m,
        not_drawn(audit, 1),
        how(),
    );
    two_panels(file, format!("{coordinate} of the pin of AB"), caption, panels)
}

/// Fig. 12 or 14.
fn force(audit: &Audit, joint: usize, file: &'static str) -> Drawing {
    let all = curves(audit, joint);
    let show = |until, is_log| Show {
        quantity: Quantity::Force,
        label: format!("F_N{joint} [N]"),
        factor: 1.0,
        until,
        limit: f64::INFINITY,
        is_log,
    };
    let panels = vec![
        show(f64::INFINITY, true).panel("", &all),
        show(TRANSIENT_S, false).panel("the first two seconds", &all),
    ];
    let (settled, stays, paper) = match joint {
        1 => ("f_n1_settled", "f_n1_stays_settled", "0.48 N, 0.45 N in its conclusions"),
        _ => ("f_n2_settled", "f_n2_stays_settled", "0.4 N"),
    };
    let caption = format!(
        "Normal force of {} (the paper's Fig. {}), {}. Mean from 2 to 3 s in N: {} (paper: {paper}). In the last 0.5 s before \
         90° its mean is that times {}.{} {}",
        name(joint),
        if joint == 1 { 12 } else { 14 },
        audit.method,
        measured(audit, settled),
        measured(audit, stays),
        not_drawn(audit, joint),
        how(),
    );
    two_panels(file, format!("Normal force of {}", name(joint)), caption, panels)
}

fn two_panels(name: &'static str, title: String, caption: String, panels: Vec<Panel>) -> Drawing {
    let figure = Figure {
        title,
        rows: 1,
        cols: 2,
        panels,
        size: Size { width: 1050, height: 460 },
        legend: Legend::Below,
        ..Figure::default()
    };
    Drawing { name, caption, figure }
}

fn how() -> &'static str {
    "Area: from the least to the largest value in a bin of time; line: the mean, where the curve can be \
     followed, and of forces; dashed: digits lost, as a last-bit change of the start exceeds e = 1e-9."
}

fn seconds(t: Option<f64>) -> String {
    t.map_or_else(|| "never".into(), |t| format!("{t:.4} s"))
}

/// When `joint` reaches 90° under each reading.
fn arrivals(audit: &Audit, joint: usize) -> String {
    let arrival = |reading: &ReadingName| {
        let course = audit.course(Some(*reading), joint)?;
        Some(match (course.run.reached_90_s, &course.run.error) {
            (None, Some(_)) => format!("{reading} not known"),
            (t, _) => format!("{reading} {}", seconds(t)),
        })
    };
    ReadingName::ALL.iter().filter_map(arrival).collect::<Vec<_>>().join(", ")
}

/// What is measured of a claim under each reading.
fn measured(audit: &Audit, claim: &str) -> String {
    let rows = audit.rows.iter().filter(|row| row.claim == claim);
    let value = |x: f64| {
        if (1e-2..1e4).contains(&x.abs()) { format!("{x:.2}") } else { format!("{x:.2e}") }
    };
    let text = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), value);
    rows.map(|row| format!("{} {}", row.reading, text(row.measured))).collect::<Vec<_>>().join(", ")
}
