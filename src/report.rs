//! Tables to text: Markdown, CSV and the HTML page.

mod about;
pub mod audit;
pub mod contact;
mod files;
pub mod html;
pub mod laws;
pub mod recommend;
pub mod regimes;
mod runs;
mod slider_crank;
pub mod steps;

pub use about::{About, Provenance};
pub use files::{File, study_files};
pub use runs::study_csv;
pub use slider_crank::slider_csv;

use std::fmt::Write as _;
use std::io::{self, Write};

use deltazero_study::work_precision::{ACCURACIES, WorkPrecision, cheapest, doubt};

use crate::figures::Drawing;
use crate::model::Body;
use crate::run::JointHistory;

/// A number as it reads back to the same bits; empty for none.
fn exact(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| format!("{x:e}"))
}

fn count(n: Option<usize>) -> String {
    n.map_or_else(String::new, |n| n.to_string())
}

/// A number to `digits` significant digits; a dash for none.
fn rounded(x: Option<f64>, digits: usize) -> String {
    x.map_or_else(|| "–".to_owned(), |x| format!("{x:.0$e}", digits - 1))
}

/// Text as a field of a CSV file.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Columns of the answer.
const ANSWER: [&str; 7] = [
    "error e at most",
    "cheapest",
    "setting",
    "its e",
    "events missed, spurious",
    "time [ms]",
    "n_rhs",
];

/// The cheapest run at each accuracy, in the columns of [`ANSWER`].
fn answer_rows(table: &WorkPrecision) -> Vec<[String; 7]> {
    let row = |e: f64| {
        let mut row: [String; 7] = Default::default();
        row[0] = format!("{e:e}");
        if !table.can_decide(e) {
            row[1] = "not decidable".into();
            row[2] = table.reference.undecided();
        } else if let Some(best) = cheapest(&table.rows, e) {
            row[1] = format!("{} {}{}", best.method, best.events, doubt(&table.rows, e));
            row[2] = best.setting();
            row[3] = rounded(best.e, 2);
            row[4] = format!("{}, {}", count(best.missed), count(best.spurious));
            row[5] = format!("{:.2}", 1e3 * best.time_s().unwrap_or(f64::NAN));
            row[6] = best.n_rhs.to_string();
        } else {
            row[1] = "none reached it".into();
        }
        row
    };
    ACCURACIES.into_iter().map(row).collect()
}

/// The answer in one table: the cheapest run at each accuracy.
pub fn answer(table: &WorkPrecision) -> String {
    let mut text = format!("| {} |\n{}|\n", ANSWER.join(" | "), "|---".repeat(ANSWER.len()));
    for row in answer_rows(table) {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// `study.md`: the answer, the figures, every run.
pub fn study_markdown(about: &About, table: &WorkPrecision, drawings: &[Drawing]) -> String {
    let reference = &table.reference;
    let mut text = format!(
        "# Which integrator, at which setting, for this contact?\n\n{}.\n\n{}\n\
         e is the worst sample's {}, up to the horizon of {} s.\n\
         Reference: {}; a second run ({}) differs by e = {:.1e}{}, which is its error.\n",
        about.subject,
        answer(table),
        reference.measure(),
        reference.horizons(),
        reference.method,
        reference.check,
        reference.agreement,
        reference
            .event_time_agreement_s
            .map_or_else(String::new, |t| format!(" and {t:.1e} s in event times")),
    );
    for limit in reference.limits().iter().chain(&about.warnings) {
        let _ = writeln!(text, "\n- {limit}");
    }
    if !about.facts.is_empty() {
        text += "\n## Contact\n\n";
    }
    for (name, what) in &about.facts {
        let _ = writeln!(text, "- {name}: {what}.");
    }
    for drawing in drawings {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            drawing.figure.title, drawing.name, drawing.caption
        );
    }
    let rows = &table.rows;
    let _ = write!(text, "\n## All runs\n\n{}", runs::runs(rows));
    let _ = write!(text, "\n## Further errors\n\n{}", runs::errors(rows));
    let _ = write!(text, "\n## Where the work goes\n\n{}", runs::work(rows));
    let _ = write!(text, "\n## Columns of study.csv\n\n{}", runs::columns(about, rows));
    text
}

/// Writes `trajectory.csv`, sorted by joint, bay and time.
///
/// # Errors
/// Those of `out`.
pub fn trajectory_csv(out: &mut dyn Write, joints: &[&JointHistory<'_>]) -> io::Result<()> {
    if joints.iter().any(|joint| matches!(joint.block.body, Body::SliderCrank(_))) {
        return slider_crank::trajectory_csv(out, joints);
    }
    let header = "bay,joint,t_s,mode,d1_m,d2_m,theta_rad,v1_m_s,v2_m_s,omega_rad_s,f_n_n,f_t_n";
    writeln!(out, "{header}")?;
    for JointHistory { bay, block, samples, .. } in joints {
        for sample in samples {
            let [d1, d2, theta, v1, v2, omega] = sample.y;
            let (joint, t, mode) = (block.joint, sample.t, sample.mode.code());
            // A diverging state may be finite where its forces are not.
            let [f_n, f_t] = [sample.forces.normal, sample.forces.tangential]
                .map(|f| exact(f.is_finite().then_some(f)));
            writeln!(
                out,
                "{bay},{joint},{t:e},{mode},{d1:e},{d2:e},{theta:e},{v1:e},{v2:e},{omega:e},{f_n},{f_t}"
            )?;
        }
    }
    Ok(())
}

/// `events.csv`: the mode changes, sorted by time, then bay, then joint.
pub fn events_csv(joints: &[&JointHistory<'_>]) -> String {
    let changes_of = |joint: &&JointHistory<'_>| {
        let place = (joint.bay, joint.block.joint);
        joint.changes.iter().map(|change| (place, *change)).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = joints.iter().flat_map(changes_of).collect();
    rows.sort_by(|a, b| a.1.t.total_cmp(&b.1.t).then(a.0.cmp(&b.0)));
    let mut csv = String::from("bay,joint,t_s,mode_before,mode_after\n");
    for ((bay, joint), change) in rows {
        let _ = writeln!(csv, "{bay},{joint},{:e},{},{}", change.t, change.before, change.after);
    }
    csv
}

/// `motion.csv`: what the figures of the contact and the orbit show.
pub fn motion_csv(motion: &crate::study::motion::Motion) -> String {
    let mut csv = String::from("part,joint,t_s,mode,d1_m,d2_m,delta_m,f_n_n,f_t_n\n");
    for (part, rows) in [("whole", &motion.rows), ("zoom", &motion.zoom)] {
        for row in rows {
            let _ = writeln!(
                csv,
                "{part},{},{:e},{},{:e},{:e},{:e},{:e},{:e}",
                row.joint, row.t_s, row.mode, row.d1_m, row.d2_m, row.delta_m, row.f_n_n, row.f_t_n
            );
        }
    }
    csv
}
