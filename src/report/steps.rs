//! The data behind the figures of step sizes.

use std::fmt::Write as _;

use deltazero_study::steps::StepTables;

use crate::csv::{exact, field};
use crate::study::stability::Stability;

/// Each file's name and text.
pub fn files(
    tables: &StepTables,
    stability: Option<&Stability>,
) -> impl Iterator<Item = (&'static str, String)> {
    let of_every_subject = [
        ("steps.csv", steps(tables)),
        ("step_histogram.csv", histogram(tables)),
        ("stays.csv", stays(tables)),
        ("restarts.csv", restarts(tables)),
        ("restart_costs.csv", restart_costs(tables)),
        ("tolerance.csv", tolerance(tables)),
    ];
    let limit = stability.map(|stability| ("rk4_stability.csv", rk4_stability(stability)));
    of_every_subject.into_iter().chain(limit)
}

/// Every accepted step.
fn steps(tables: &StepTables) -> String {
    let mut csv = String::from(
        "method,setting,joint,t_s,h_s,mode,since_restart,n_rejected,lands,mode_name\n",
    );
    for history in &tables.histories {
        let (method, setting, joint) = (&history.method, &history.setting, history.part);
        for step in &history.steps {
            let _ = writeln!(
                csv,
                "{method},{setting},{joint},{:e},{:e},{},{},{},{},{}",
                step.t_s,
                step.h_s,
                step.mode,
                step.since_restart,
                step.n_rejected,
                step.lands,
                field(history.mode_name(step))
            );
        }
    }
    csv
}

fn histogram(tables: &StepTables) -> String {
    let mut csv = String::from("method,setting,mode,h_from_s,h_to_s,n_steps\n");
    for row in &tables.histogram {
        let (from, to) = row.h_s;
        let _ = writeln!(
            csv,
            "{},{},{},{from:e},{to:e},{}",
            row.method,
            row.setting,
            field(&row.mode),
            row.n_steps
        );
    }
    csv
}

fn stays(tables: &StepTables) -> String {
    let mut csv =
        String::from("method,setting,joint,contact,t_s,duration_s,whole,n_steps,n_rejected,mode\n");
    for row in &tables.stays {
        let _ = writeln!(
            csv,
            "{},{},{},{},{:e},{:e},{},{},{},{}",
            row.method,
            row.setting,
            row.part,
            row.is_contact,
            row.t_s,
            row.duration_s,
            row.is_whole,
            row.n_steps,
            row.n_rejected,
            field(&row.mode)
        );
    }
    csv
}

fn restarts(tables: &StepTables) -> String {
    let mut csv = String::from(
        "method,setting,into_contact,step,n,h_q1_s,h_median_s,h_q3_s,ratio_q1,ratio_median,\
         ratio_q3,n_rejected,mode\n",
    );
    for row in &tables.restarts {
        let [h1, h2, h3] = row.h_s;
        let [r1, r2, r3] = row.h_over_settled;
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{h1:e},{h2:e},{h3:e},{r1:e},{r2:e},{r3:e},{},{}",
            row.method,
            row.setting,
            row.into_contact,
            row.step,
            row.n,
            row.n_rejected,
            field(&row.mode)
        );
    }
    csv
}

fn restart_costs(tables: &StepTables) -> String {
    let mut csv = String::from(
        "method,setting,n_events,settled_1_s,settled_2_s,recovery_steps,lost_steps,rejected,rhs_restart,\
         rhs_location,rhs_step,rhs_event\n",
    );
    for row in &tables.restart_costs {
        let settled = |joint: usize| exact(row.settled_s.get(joint - 1).copied().flatten());
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{},{:e},{:e},{:e},{:e},{:e}",
            row.method,
            row.setting,
            row.n_events,
            settled(1),
            settled(2),
            exact(row.recovery_steps),
            exact(row.lost_steps),
            row.rejected,
            row.rhs_restart,
            row.rhs_location,
            row.rhs_step,
            row.rhs_event()
        );
    }
    csv
}

fn rk4_stability(stability: &Stability) -> String {
    let mut csv = String::from(
        "joint,h_s,e,n_events,limit_s,time_scale_s,omega_least_rad_s,omega_largest_rad_s\n",
    );
    for run in &stability.runs {
        let Some(joint) = stability.stiffness.iter().find(|row| row.joint == run.joint) else {
            continue;
        };
        let (least, largest) = joint.omega_rad_s;
        let _ = writeln!(
            csv,
            "{},{:e},{},{},{:e},{:e},{least:e},{largest:e}",
            run.joint,
            run.h_s,
            exact(run.e),
            run.n_events,
            joint.limit_s,
            joint.time_scale_s
        );
    }
    csv
}

fn tolerance(tables: &StepTables) -> String {
    let mut csv = String::from(
        "method,events,n_fitted,slope,e_over_rtol,scatter_decades,floor_rtol,floor_e\n",
    );
    for row in &tables.proportionality {
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{},{}",
            row.method,
            row.events,
            row.n_fitted,
            exact(row.slope),
            exact(row.e_over_rtol),
            exact(row.scatter_decades),
            exact(row.floor.map(|floor| floor.rtol)),
            exact(row.floor.map(|floor| floor.e))
        );
    }
    csv
}
