//! The audit of the paper as text: the claims, the runs behind them, the torque ratios.

use std::fmt::Write as _;

use deltazero_study::digits::rounded_to;

use crate::config::Config;
use crate::csv::exact;
use crate::figures::Drawing;
use crate::keys::{Inertia, ReadingName};
use crate::paper::audit::Audit;
use crate::paper::claims::{CLAIMS, ClaimRow, PAPER_FORCE, PAPER_X01, Verdict, contact_at, digits};
use crate::paper::course::{Quantity, coarser};
use crate::paper::deployment::{PATIENCE, RunRow};
use crate::paper::ideal::{IdealRow, RIGHT_ANGLE};

/// Claims that the README lists.
const HEADLINE: [&str; 9] = [
    "ideal_theta1_90",
    "ideal_theta2_90",
    "clearance_theta2_90",
    "theta1_ddot_settled",
    "separations",
    "x01_max",
    "f_n1_settled",
    "f_n2_settled",
    "torque_ratio_clearance",
];
/// Bins of `courses.csv` are this many of those of the recorder: 0.05 s.
const BINS_A_ROW: usize = 5;

/// `audit.csv`: one row a claim and reading.
pub fn csv(rows: &[ClaimRow]) -> String {
    let mut csv =
        String::from("claim,paper,reading,measured,unit,verdict,horizon_s,moved,beyond_horizon\n");
    for row in rows {
        let ClaimRow { claim, reading, unit, .. } = row;
        let (paper, measured) = (exact(row.paper), exact(row.measured));
        let (verdict, horizon) = (row.verdict.name(), exact(row.horizon_s));
        let (moved, beyond) = (exact(row.moved), row.beyond_horizon);
        let _ = writeln!(
            csv,
            "{claim},{paper},{reading},{measured},{unit},{verdict},{horizon},{moved},{beyond}"
        );
    }
    csv
}

/// `courses.csv`: what the figures show; least, largest and mean value of each quantity in each 0.05 s.
pub fn courses_csv(audit: &Audit) -> String {
    let mut csv = String::from("reading,joint,begin_s,length_s");
    for quantity in Quantity::ALL {
        let name = quantity.column();
        let _ = write!(csv, ",{name}_least,{name}_most,{name}_mean");
    }
    csv.push('\n');
    for course in &audit.courses {
        for bin in coarser(&course.bins, BINS_A_ROW) {
            let (reading, joint) = (name(course.run.reading), course.run.joint);
            let _ = write!(csv, "{reading},{joint},{:.2},{:.4}", bin.begin_s, bin.length_s);
            for range in bin.ranges {
                let _ = write!(csv, ",{:.6e},{:.6e},{:.6e}", range.least, range.most, range.mean);
            }
            csv.push('\n');
        }
    }
    csv
}

/// Digits of a table.
pub(super) const DIGITS: usize = 4;

/// A number to four digits.
fn short(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 || (1e-2..1e5).contains(&size) {
        let decimals = if size >= 1000.0 {
            0
        } else if size >= 10.0 {
            2
        } else {
            3
        };
        let text = format!("{x:.decimals$}");
        if x == x.round() && size < 1000.0 { format!("{x:.0}") } else { text }
    } else {
        format!("{x:.3e}")
    }
}

fn maybe(x: Option<f64>, none: &str) -> String {
    x.map_or_else(|| none.to_owned(), short)
}

fn name(reading: Option<ReadingName>) -> &'static str {
    reading.map_or("ideal", ReadingName::name)
}

/// A number that is known to so many digits only: `~870`, `~8.7e-4`.
fn vague(x: f64, digits: usize) -> String {
    let rounded = rounded_to(x, digits);
    if !(1e-2..1e5).contains(&rounded.abs()) {
        return format!("~{x:.0$e}", digits - 1);
    }
    let decimals = digits as i32 - 1 - libm::floor(libm::log10(rounded.abs())) as i32;
    format!("~{rounded:.0$}", usize::try_from(decimals).unwrap_or(0))
}

/// What `~` says.
pub(super) const VAGUE: &str = "beyond the horizon, where the motion cannot be predicted: a change of the \
    start's last bit moves it, and no more digits are shown than two such changes leave";

/// What was measured; bold where it reproduces the paper.
fn cell(row: &ClaimRow) -> String {
    // A time that does not come; what else there is not is not defined.
    let none = if row.unit == "s" { "never" } else { "none" };
    let value = match row.measured {
        Some(value) if row.beyond_horizon => vague(value, row.digits(DIGITS)),
        None if row.beyond_horizon => format!("~{none}"),
        measured => maybe(measured, none),
    };
    match row.verdict {
        Verdict::Reproduced => format!("**{value}**"),
        Verdict::NotReproduced => value,
        Verdict::Impossible => format!("{value} (impossible)"),
        Verdict::Undecided => "undecided".to_owned(),
    }
}

/// Columns of the table of claims.
fn columns() -> Vec<String> {
    let readings = ReadingName::ALL.iter().map(|reading| reading.name());
    ["claim", "unit", "paper", "ideal"].into_iter().chain(readings).map(str::to_owned).collect()
}

/// One line for each of the claims in `names`: claim, unit, the paper's figure, what each reading gives.
fn lines(rows: &[ClaimRow], names: &[&str]) -> Vec<Vec<String>> {
    let line = |claim: &&str| {
        let own: Vec<&ClaimRow> = rows.iter().filter(|row| row.claim == *claim).collect();
        let first = own.first()?;
        let mut line =
            vec![format!("`{claim}`"), first.unit.clone(), maybe(first.paper, "in words")];
        for column in &columns()[3..] {
            let of = own.iter().find(|row| row.reading == *column);
            line.push(of.map_or_else(String::new, |row| cell(row)));
        }
        Some(line)
    };
    names.iter().filter_map(line).collect()
}

fn table(columns: &[String], lines: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n{}|\n", columns.join(" | "), "|---".repeat(columns.len()));
    for line in lines {
        let _ = writeln!(text, "| {} |", line.join(" | "));
    }
    text
}

/// The claims that matter most; bold where a reading reproduces the paper.
pub fn answer(rows: &[ClaimRow]) -> String {
    table(&columns(), &lines(rows, &HEADLINE))
}

/// All claims in the terminal.
pub fn text(audit: &Audit) -> String {
    let count = |verdict| audit.rows.iter().filter(|row| row.verdict == verdict).count();
    format!(
        "{}\nBold: reproduced, within 2 % or in the digits printed, or by the rule of the claim. ~: {VAGUE}. Of {} rows {} \
         are reproduced, {} not, {} impossible{}.\n",
        all(&audit.rows),
        audit.rows.len(),
        count(Verdict::Reproduced),
        count(Verdict::NotReproduced),
        count(Verdict::Impossible),
        match count(Verdict::Undecided) {
            0 => String::new(),
            n => format!(", {n} undecided"),
        }
    )
}

fn all(rows: &[ClaimRow]) -> String {
    let names: Vec<&str> = CLAIMS.iter().map(|claim| claim.name).collect();
    table(&columns(), &lines(rows, &names))
}

/// What the verdicts come to, in sentences with their numbers.
pub fn findings(config: &Config, audit: &Audit) -> Vec<String> {
    let mut findings = Vec::new();
    let under = |claim: &str| -> Vec<&str> {
        let rows = audit.rows.iter().filter(|row| row.claim == claim);
        let held = rows.filter(|row| row.verdict == Verdict::Reproduced);
        held.map(|row| row.reading.as_str()).collect()
    };
    let list = |readings: &[&str]| match readings {
        [] => "no reading".to_owned(),
        _ => readings.join(", "),
    };
    findings.extend(cut_short(audit));
    let ideal = audit.row("ideal_theta2_90", "ideal").and_then(|row| row.measured);
    let [late, alike] = [under("clearance_theta2_90"), under("theta2_deviation")];
    let of_both =
        |row: &&ClaimRow| ["clearance_theta2_90", "theta2_deviation"].contains(&&*row.claim);
    let is_decided = |row: &ClaimRow| row.verdict != Verdict::Undecided;
    let has_both = late.iter().any(|reading| alike.contains(reading));
    let contradicts = match ideal {
        Some(t) if !has_both && audit.rows.iter().filter(of_both).all(is_decided) => format!(
            " Both cannot be, for without clearance AF takes {} s: the paper's (1) and (4) contradict each other.",
            short(t)
        ),
        _ => String::new(),
    };
    findings.push(format!(
        "AF at 90° after 9 s: {}. That clearance hardly influences θ2: {}.{contradicts}",
        list(&late),
        list(&alike),
    ));
    let settled = [under("theta1_ddot_settled"), under("theta2_ddot_settled")];
    let both: Vec<&str> =
        settled[0].iter().copied().filter(|name| settled[1].contains(name)).collect();
    findings.push(format!(
        "Pin and bush separate in the first 2 s under: {}. The fluctuation of θ̈ of both struts settles by \
         2 s under: {}.",
        list(&under("separations")),
        list(&both),
    ));
    let x01 = audit.rows.iter().find(|row| row.claim == "x01_max");
    if x01.is_some_and(|row| row.verdict == Verdict::Impossible) {
        let (force, elastic) = contact_at(PAPER_X01, config);
        let what = format!("|x01| = {PAPER_X01} m with a clearance of {:e} m", audit.clearance_m);
        findings.push(match force.is_finite() {
            false => format!("{what} is a penetration that {} does not have.", config.joints[0].contact.law),
            true => format!(
                "{what} is a penetration that takes {} N, where the paper has {PAPER_FORCE} N; its elastic energy alone \
                 would be {} J, and M1 does {} J in all until 90°.",
                short(force),
                short(elastic),
                short(config.drive.m1.abs() * RIGHT_ANGLE),
            ),
        });
    }
    findings.extend(audit.runs.iter().filter_map(beyond));
    findings.extend(audit.runs.iter().filter_map(fed));
    findings
}

/// The runs that ended early, and why.
pub fn cut_short(audit: &Audit) -> impl Iterator<Item = String> + '_ {
    let told = |run: &RunRow| {
        let error = run.error.as_ref()?;
        let (reading, joint, end) = (name(run.reading), run.joint, run.end_s);
        Some(format!("{reading}, joint {joint}: the run ends at {end:.4} s: {error}"))
    };
    audit.runs.iter().filter_map(told)
}

/// What is left of a run after its digits are lost.
fn beyond(run: &RunRow) -> Option<String> {
    let horizon = run.horizon_s.filter(|_| run.error.is_none())?;
    let end = match (run.reached_90_s, run.moved_s) {
        (Some(t), Some(moved)) => format!(
            "it reaches 90° at {t:.4} s, which a last-bit change of the start moves by {moved:.1e} s"
        ),
        (Some(t), None) => format!(
            "it reaches 90° at {t:.4} s, and not at all after a last-bit change of the start"
        ),
        (None, _) => format!(
            "it never reaches 90° up to {:.1} s: θ is largest at {:.1} s, {:.1}°",
            run.end_s,
            run.theta_max_at_s,
            run.theta_max_rad.to_degrees()
        ),
    };
    Some(format!(
        "{}, joint {}: digits are lost from {horizon:.2} s on; {end}. The largest contact force is {} N before \
         the horizon, {} N in all.",
        name(run.reading),
        run.joint,
        short(run.force_before_horizon_n),
        run.force_moved_n.map_or_else(
            || short(run.force_n),
            |moved| vague(run.force_n, digits(run.force_n, moved, DIGITS))
        )
    ))
}

/// Where a reading feeds energy in.
fn fed(run: &RunRow) -> Option<String> {
    (run.fed_in_j.abs() > 1e-3 * run.work_j.abs()).then(|| {
        format!(
            "{}, joint {}: {} J come from nowhere beside {} J of work; the reading is not consistent.",
            name(run.reading),
            run.joint,
            short(run.fed_in_j),
            short(run.work_j)
        )
    })
}

/// Columns of the table of runs.
pub(super) const RUN_COLUMNS: [&str; 11] = [
    "reading",
    "joint",
    "90° at [s]",
    "moved by a last bit [s]",
    "digits lost from [s]",
    "end [s]",
    "largest θ [°]",
    "mode changes",
    "largest F_N [N]",
    "work [J]",
    "energy from nowhere [J]",
];

/// What is to be known of their digits.
pub(super) const RUN_NOTE: &str = "Where digits are lost, all that is counted or summed up to the end is of this very \
    run: mode changes, largest F_N, energies. A last-bit change of the start has others.";

/// The runs in the columns of [`RUN_COLUMNS`].
pub(super) fn run_lines(audit: &Audit) -> Vec<Vec<String>> {
    let line = |run: &RunRow| {
        vec![
            name(run.reading).to_owned(),
            run.joint.to_string(),
            match (run.reached_90_s, &run.error) {
                (Some(t), _) => format!("{t:.4}"),
                (None, None) => "never".to_owned(),
                (None, Some(_)) => "not known".to_owned(),
            },
            run.moved_s.map_or_else(String::new, |t| format!("{t:.1e}")),
            run.horizon_s.map_or_else(String::new, |t| format!("{t:.2}")),
            format!("{:.2}", run.end_s),
            format!("{:.1}", run.theta_max_rad.to_degrees()),
            run.n_events.to_string(),
            short(run.force_n),
            short(run.work_j),
            format!("{:.1e}", run.fed_in_j),
        ]
    };
    audit.runs.iter().map(line).collect()
}

/// Columns of the table of joints without clearance.
pub(super) const IDEAL_COLUMNS: [&str; 5] =
    ["inertia", "joint", "quadrature [s]", "integrated [s]", "apart [s]"];

/// Joints without clearance in the columns of [`IDEAL_COLUMNS`].
pub(super) fn ideal_lines(audit: &Audit) -> Vec<Vec<String>> {
    let time = |t: Option<f64>| t.map_or_else(|| "never".to_owned(), |t| format!("{t:.10}"));
    let line = |row: &IdealRow| {
        let apart = row.quadrature_s.zip(row.integrated_s).map(|(a, b)| (a - b).abs());
        vec![
            inertia(row.inertia),
            row.joint.to_string(),
            time(row.quadrature_s),
            time(row.integrated_s),
            apart.map_or_else(String::new, |apart| format!("{apart:.0e}")),
        ]
    };
    audit.ideal.iter().map(line).collect()
}

/// Columns of the table of torque ratios.
pub(super) const RATIO_COLUMNS: [&str; 5] =
    ["reading", "inertia", "AB at 90° [s]", "M1 : M4 for AF at the same time", "M4 [N m]"];

/// Torque ratios in the columns of [`RATIO_COLUMNS`].
pub(super) fn ratio_lines(audit: &Audit) -> Vec<Vec<String>> {
    let m1 = audit.torque_ratio.m1;
    let digits =
        |x: Option<f64>, none: &str| x.map_or_else(|| none.to_owned(), |x| format!("{x:.4}"));
    let curves = audit.torque_ratio.curves.iter();
    curves
        .map(|curve| {
            vec![
                name(curve.reading).to_owned(),
                inertia(curve.inertia),
                digits(curve.theta1_90_s, "not reached"),
                digits(curve.ratio, "none"),
                digits(curve.ratio.map(|ratio| m1 / ratio), ""),
            ]
        })
        .collect()
}

fn inertia(inertia: Inertia) -> String {
    match inertia {
        Inertia::Axial => "axial".to_owned(),
        Inertia::Transverse => "transverse".to_owned(),
        Inertia::Value(value) => format!("{value:e} kg m²"),
    }
}

/// `audit.md`.
pub fn markdown(config: &Config, audit: &Audit, drawings: &[Drawing]) -> String {
    let own = |columns: &[&str]| columns.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let mut text = format!(
        "# The paper, claim by claim\n\nWhat \"Dynamic Analysis of Deployable Strut-Mechanism with Clearance \
         Root-Joints\" says of its deployment, and what comes out under each reading of its equations ({}, until \
         90° or {} times the ideal time). Bold: reproduced, that is within 2 % or equal in the digits printed, or \
         by the rule of the claim below. ~: {VAGUE}. `ideal`: without clearance.\n\n{}\n",
        audit.method,
        PATIENCE,
        all(&audit.rows)
    );
    text += "## What follows\n\n";
    for finding in findings(config, audit) {
        let _ = writeln!(text, "- {finding}");
    }
    let _ = write!(
        text,
        "\n## The runs\n\n{}\n{RUN_NOTE}\n",
        table(&own(&RUN_COLUMNS), &run_lines(audit))
    );
    let _ = write!(
        text,
        "\n## Without clearance, two ways\n\nBy quadrature of the energy integral, and by an integrator.\n\n{}",
        table(&own(&IDEAL_COLUMNS), &ideal_lines(audit))
    );
    let _ = write!(
        text,
        "\n## Torque ratio\n\nM1 stays {} N m; M4 is found so that both struts reach 90° at the same time.\n\n{}",
        audit.torque_ratio.m1,
        table(&own(&RATIO_COLUMNS), &ratio_lines(audit))
    );
    text += "\n## Figures\n";
    for drawing in drawings {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            drawing.figure.title, drawing.name, drawing.caption
        );
    }
    text +=
        "\n## The claims\n\n| claim | the paper says | measured, reproduced if |\n|---|---|---|\n";
    for claim in CLAIMS {
        let _ = writeln!(text, "| `{}` | {} | {} |", claim.name, claim.says, claim.measure);
    }
    text += "\nThe data behind the figures: `courses.csv`; the claims with all digits: `audit.csv`, `audit.json`.\n";
    text
}
