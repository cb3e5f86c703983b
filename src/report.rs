//! Tables to text: Markdown and CSV.

pub mod steps;

use std::fmt::Write as _;

use crate::figures::Drawing;
use crate::model::Block;
use crate::run::{BlockTrajectory, mode_changes};
use crate::study::work_precision::{ACCURACIES, Row, WorkPrecision, cheapest};

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

/// `study.csv`.
pub fn study_csv(table: &WorkPrecision) -> String {
    let mut csv = String::from(
        "reading,method,events,rtol,step,status,e,event_time_error_s,n_events,missed,spurious,\
         horizon_s,n_rhs,n_accepted,n_rejected,n_jac,n_lin_solves,wall_s_min,wall_s_median,\
         n_retaken,n_factorisations,n_rhs_restart,n_rhs_location,error\n",
    );
    for row in &table.rows {
        let fields = [
            row.reading.to_string(),
            row.method.clone(),
            row.events.to_string(),
            exact(row.rtol),
            exact(row.step),
            row.status.name().to_owned(),
            exact(row.e),
            exact(row.event_time_error_s),
            count(row.n_events),
            count(row.missed),
            count(row.spurious),
            exact(Some(row.horizon_s)),
            row.n_rhs.to_string(),
            row.n_accepted.to_string(),
            row.n_rejected.to_string(),
            row.n_jac.to_string(),
            row.n_lin_solves.to_string(),
            exact(row.wall_s_min),
            exact(row.wall_s_median),
            row.n_retaken.to_string(),
            row.n_factorisations.to_string(),
            row.n_rhs_restart.to_string(),
            row.n_rhs_location.to_string(),
            field(row.error.as_deref().unwrap_or_default()),
        ];
        let _ = writeln!(csv, "{}", fields.join(","));
    }
    csv
}

/// The answer in one table: the cheapest run at each accuracy.
pub fn answer(table: &WorkPrecision) -> String {
    let mut text = String::from(
        "| error e at most | cheapest | setting | its e | events missed, spurious | time [ms] | n_rhs |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for e in ACCURACIES {
        if !table.can_decide(e) {
            let good = table.reference.agreement;
            let _ = writeln!(
                text,
                "| {e:e} | not decidable | the reference is good to {good:.1e} | | | | |"
            );
            continue;
        }
        let _ = match cheapest(&table.rows, e) {
            None => writeln!(text, "| {e:e} | none reached it | | | | | |"),
            Some(row) => writeln!(
                text,
                "| {e:e} | {} {} | {} | {} | {}, {} | {:.2} | {} |",
                row.method,
                row.events,
                row.setting(),
                rounded(row.e, 2),
                count(row.missed),
                count(row.spurious),
                1e3 * row.wall_s_min.unwrap_or(f64::NAN),
                row.n_rhs
            ),
        };
    }
    text
}

/// All runs as a table.
fn runs(rows: &[Row]) -> String {
    let mut text = String::from(
        "| method | events | setting | status | e | event time error [s] | missed | spurious | n_rhs | \
         of restarts | of location | steps | rejected | retaken | Jacobians | factorisations | \
         linear solves | time min [ms] | median [ms] |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let milliseconds = |wall: Option<f64>| {
        wall.map_or_else(|| "–".to_owned(), |wall| format!("{:.2}", 1e3 * wall))
    };
    for row in rows {
        let status = match &row.error {
            None => row.status.name().to_owned(),
            Some(error) => format!("{}: {error}", row.status.name()),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            row.method,
            row.events,
            row.setting(),
            status,
            rounded(row.e, 2),
            rounded(row.event_time_error_s, 2),
            count(row.missed),
            count(row.spurious),
            row.n_rhs,
            row.n_rhs_restart,
            row.n_rhs_location,
            row.n_accepted,
            row.n_rejected,
            row.n_retaken,
            row.n_jac,
            row.n_factorisations,
            row.n_lin_solves,
            milliseconds(row.wall_s_min),
            milliseconds(row.wall_s_median),
        );
    }
    text
}

/// `study.md`: the answer, the figures, every run.
pub fn study_markdown(reading: &str, table: &WorkPrecision, drawings: &[Drawing]) -> String {
    let reference = &table.reference;
    let mut text = format!(
        "# Which integrator, at which setting, for this contact?\n\nReading `{reading}`.\n\n{}\n\
         e is the worst sample's larger of |Δpin|/c and |Δθ|/{:.4} rad, up to the horizon of {} s.\n\
         Reference: {}; a second way ({}) agrees with it to e = {:.1e}{}.\n",
        answer(table),
        reference.theta_scale_rad,
        reference.horizon_s.iter().map(|t| format!("{t}")).collect::<Vec<_>>().join(" and "),
        reference.method,
        reference.check,
        reference.agreement,
        reference.event_time_agreement_s.map_or_else(
            || " but not in its events".to_owned(),
            |t| format!(", event times to {t:.1e} s")
        ),
    );
    for drawing in drawings {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            drawing.figure.title, drawing.name, drawing.caption
        );
    }
    let _ = write!(text, "\n## All runs\n\n{}", runs(&table.rows));
    text
}

/// `trajectory.csv`.
pub fn trajectory_csv<'a>(
    blocks: impl Iterator<Item = (&'a Block, &'a BlockTrajectory)>,
) -> String {
    let mut csv = String::from(
        "bay,joint,t_s,mode,d1_m,d2_m,theta_rad,v1_m_s,v2_m_s,omega_rad_s,f_n_n,f_t_n\n",
    );
    for (block, trajectory) in blocks {
        for sample in &trajectory.samples {
            let [d1, d2, theta, v1, v2, omega] = block.in_paper_order(&sample.y);
            let forces = block.forces(sample.mode, &sample.y, &block.pose(&sample.y));
            let (joint, t, mode) = (block.joint, sample.t, sample.mode.code());
            // A diverging state may be finite where its forces are not.
            let [f_n, f_t] =
                [forces.normal, forces.tangential].map(|f| exact(f.is_finite().then_some(f)));
            let _ = writeln!(
                csv,
                "1,{joint},{t:e},{mode},{d1:e},{d2:e},{theta:e},{v1:e},{v2:e},{omega:e},{f_n},{f_t}"
            );
        }
    }
    csv
}

/// `events.csv`: the mode changes, sorted by time, then joint.
pub fn events_csv<'a>(blocks: impl Iterator<Item = (&'a Block, &'a BlockTrajectory)>) -> String {
    let mut rows = Vec::new();
    for (block, trajectory) in blocks {
        rows.extend(mode_changes(trajectory).into_iter().map(|change| (block.joint, change)));
    }
    rows.sort_by(|a, b| a.1.t.total_cmp(&b.1.t).then(a.0.cmp(&b.0)));
    let mut csv = String::from("bay,joint,t_s,mode_before,mode_after\n");
    for (joint, change) in rows {
        let _ = writeln!(csv, "1,{joint},{:e},{},{}", change.t, change.before, change.after);
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
