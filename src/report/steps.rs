//! The data behind the figures of step sizes.

use deltazero_study::steps::StepTables;

use crate::csv::{self, exact, field, number};
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
    let histories = tables.histories.iter();
    csv::table(
        histories.flat_map(|history| history.steps.iter().map(move |step| (history, step))),
        &[
            ("method", |(history, _)| history.method.clone()),
            ("setting", |(history, _)| history.setting.clone()),
            ("joint", |(history, _)| history.part.to_string()),
            ("t_s", |(_, step)| number(step.t_s)),
            ("h_s", |(_, step)| number(step.h_s)),
            ("mode", |(_, step)| step.mode.to_string()),
            ("since_restart", |(_, step)| step.since_restart.to_string()),
            ("n_rejected", |(_, step)| step.n_rejected.to_string()),
            ("lands", |(_, step)| step.lands.to_string()),
            ("mode_name", |(history, step)| field(history.mode_name(step))),
        ],
    )
}

fn histogram(tables: &StepTables) -> String {
    csv::table(
        &tables.histogram,
        &[
            ("method", |row| row.method.clone()),
            ("setting", |row| row.setting.clone()),
            ("mode", |row| field(&row.mode)),
            ("h_from_s", |row| number(row.h_s.0)),
            ("h_to_s", |row| number(row.h_s.1)),
            ("n_steps", |row| row.n_steps.to_string()),
        ],
    )
}

fn stays(tables: &StepTables) -> String {
    csv::table(
        &tables.stays,
        &[
            ("method", |row| row.method.clone()),
            ("setting", |row| row.setting.clone()),
            ("joint", |row| row.part.to_string()),
            ("contact", |row| row.is_contact.to_string()),
            ("t_s", |row| number(row.t_s)),
            ("duration_s", |row| number(row.duration_s)),
            ("whole", |row| row.is_whole.to_string()),
            ("n_steps", |row| row.n_steps.to_string()),
            ("n_rejected", |row| row.n_rejected.to_string()),
            ("mode", |row| field(&row.mode)),
        ],
    )
}

fn restarts(tables: &StepTables) -> String {
    csv::table(
        &tables.restarts,
        &[
            ("method", |row| row.method.clone()),
            ("setting", |row| row.setting.clone()),
            ("into_contact", |row| row.into_contact.to_string()),
            ("step", |row| row.step.to_string()),
            ("n", |row| row.n.to_string()),
            ("h_q1_s", |row| number(row.h_s[0])),
            ("h_median_s", |row| number(row.h_s[1])),
            ("h_q3_s", |row| number(row.h_s[2])),
            ("ratio_q1", |row| number(row.h_over_settled[0])),
            ("ratio_median", |row| number(row.h_over_settled[1])),
            ("ratio_q3", |row| number(row.h_over_settled[2])),
            ("n_rejected", |row| row.n_rejected.to_string()),
            ("mode", |row| field(&row.mode)),
        ],
    )
}

fn restart_costs(tables: &StepTables) -> String {
    csv::table(
        &tables.restart_costs,
        &[
            ("method", |row| row.method.clone()),
            ("setting", |row| row.setting.clone()),
            ("n_events", |row| row.n_events.to_string()),
            ("settled_1_s", |row| exact(row.settled_s.first().copied().flatten())),
            ("settled_2_s", |row| exact(row.settled_s.get(1).copied().flatten())),
            ("recovery_steps", |row| exact(row.recovery_steps)),
            ("lost_steps", |row| exact(row.lost_steps)),
            ("rejected", |row| number(row.rejected)),
            ("rhs_restart", |row| number(row.rhs_restart)),
            ("rhs_location", |row| number(row.rhs_location)),
            ("rhs_step", |row| number(row.rhs_step)),
            ("rhs_event", |row| number(row.rhs_event())),
        ],
    )
}

fn rk4_stability(stability: &Stability) -> String {
    let joint = |number| stability.stiffness.iter().find(|row| row.joint == number);
    csv::table(
        stability.runs.iter().filter_map(|run| Some((run, joint(run.joint)?))),
        &[
            ("joint", |(run, _)| run.joint.to_string()),
            ("h_s", |(run, _)| number(run.h_s)),
            ("e", |(run, _)| exact(run.e)),
            ("n_events", |(run, _)| run.n_events.to_string()),
            ("limit_s", |(_, joint)| number(joint.limit_s)),
            ("time_scale_s", |(_, joint)| number(joint.time_scale_s)),
            ("omega_least_rad_s", |(_, joint)| number(joint.omega_rad_s.0)),
            ("omega_largest_rad_s", |(_, joint)| number(joint.omega_rad_s.1)),
        ],
    )
}

fn tolerance(tables: &StepTables) -> String {
    csv::table(
        &tables.proportionality,
        &[
            ("method", |row| row.method.clone()),
            ("events", |row| row.events.to_string()),
            ("n_fitted", |row| row.n_fitted.to_string()),
            ("slope", |row| exact(row.slope)),
            ("e_over_rtol", |row| exact(row.e_over_rtol)),
            ("scatter_decades", |row| exact(row.scatter_decades)),
            ("floor_rtol", |row| exact(row.floor.map(|floor| floor.rtol))),
            ("floor_e", |row| exact(row.floor.map(|floor| floor.e))),
        ],
    )
}
