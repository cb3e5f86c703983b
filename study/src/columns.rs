//! The columns of `study.csv`: their names, units and meaning, and what a row has in each.

use crate::errors::work::PhaseWork;
use crate::work_precision::Row;

/// What a row has in a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A word or a message.
    Text(String),
    /// A number, if there is one.
    Number(Option<f64>),
    /// A count, if there is one.
    Count(Option<u64>),
}

impl Value {
    /// Whether there is a value.
    fn is_known(&self) -> bool {
        match self {
            Self::Text(text) => !text.is_empty(),
            Self::Number(x) => x.is_some(),
            Self::Count(n) => n.is_some(),
        }
    }

    /// The value as a number, if it is one.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Text(_) => None,
            Self::Number(x) => x,
            Self::Count(n) => n.map(|n| n as f64),
        }
    }
}

/// A column.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name in the header.
    pub name: &'static str,
    /// Unit; empty for what has none.
    pub unit: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Which tables have it.
    pub given: Given,
    /// What a row has there.
    pub value: fn(&Row) -> Value,
}

/// Which tables have a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// All: what reads a table relies on them.
    Always,
    /// Those in which a row has a value.
    Known,
    /// Those of problems that tell of contact, in which a row has steps of this phase.
    Phase,
    /// Those in which parts were computed at once.
    Batch,
}

/// The columns of a table of these rows: what the problem does not tell has none.
pub fn shown(rows: &[Row]) -> Vec<&'static Column> {
    COLUMNS.iter().filter(|column| column.is_of(rows)).collect()
}

impl Column {
    /// Whether a table of these rows has it.
    fn is_of(&self, rows: &[Row]) -> bool {
        let any = |has: &dyn Fn(&Row) -> bool| rows.iter().any(has);
        match self.given {
            Given::Always => true,
            Given::Known => any(&|row| (self.value)(row).is_known()),
            Given::Phase => {
                any(&|row| row.work_by_phase.tells_of_contact())
                    && any(&|row| (self.value)(row) != count(0))
            }
            Given::Batch => any(&|row| row.batch > 1),
        }
    }

    /// The column called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        COLUMNS.iter().find(|column| column.name == name)
    }

    /// Name and unit, for an axis.
    pub fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.to_owned()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

use Value::{Number, Text};

fn count(n: u64) -> Value {
    Value::Count(Some(n))
}

fn size(n: Option<usize>) -> Value {
    Value::Count(n.map(|n| n as u64))
}

fn steps(phase: Option<PhaseWork>) -> Value {
    count(phase.map_or(0, |phase| phase.n_accepted))
}

fn evaluations(phase: Option<PhaseWork>) -> Value {
    count(phase.map_or(0, |phase| phase.counts.n_rhs))
}

/// A line of the table, of a column that every table has.
const fn always(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    value: fn(&Row) -> Value,
) -> Column {
    column(name, unit, about, value).of(Given::Always)
}

/// A line of the table.
const fn column(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    value: fn(&Row) -> Value,
) -> Column {
    Column { name, unit, about, given: Given::Known, value }
}

impl Column {
    /// The column, of these tables instead.
    const fn of(self, given: Given) -> Self {
        Self { given, ..self }
    }
}

/// Every column, in order.
pub const COLUMNS: &[Column] = &[
    always("method", "", "method", |row| Text(row.method.clone())),
    always("events", "", "what it does with events", |row| Text(row.events.to_string())),
    always("rtol", "", "relative tolerance, if it has one", |row| Number(row.rtol)),
    always("step", "s", "fixed step, if it has one", |row| Number(row.step)),
    always(
        "status",
        "",
        "ok, failed, cut (by study.max_rhs or study.max_seconds) or interrupted",
        |row| Text(row.status.name().to_owned()),
    ),
    always("e", "", "worst sample's largest error of a group of states over its scale", |row| {
        Number(row.e)
    }),
    always("event_time_error_s", "s", "worst time error of the paired events", |row| {
        Number(row.event_time_error_s)
    }),
    always("n_events", "", "events of the whole run, the start's own left out", |row| {
        size(row.n_events)
    }),
    always(
        "missed",
        "",
        "events of the reference that it lacks, up to the horizon, without those at the very end",
        |row| size(row.missed),
    ),
    always(
        "spurious",
        "",
        "events that the reference lacks, up to the horizon, without those at the very end",
        |row| size(row.spurious),
    ),
    always("horizon_s", "s", "time up to which errors are taken", |row| {
        Number(Some(row.horizon_s))
    }),
    always(
        "n_rhs",
        "",
        "evaluations of the right-hand side of a part, those of Jacobians apart",
        |row| count(row.n_rhs),
    ),
    always("n_accepted", "", "accepted steps", |row| count(row.n_accepted)),
    always("n_rejected", "", "rejected steps", |row| count(row.n_rejected)),
    always("n_jac", "", "Jacobians", |row| count(row.n_jac)),
    always("n_lin_solves", "", "linear systems solved", |row| count(row.n_lin_solves)),
    always("wall_s_min", "s", "shortest time of the repeats", |row| Number(row.wall_s_min)),
    always("wall_s_median", "s", "median time of the repeats", |row| Number(row.wall_s_median)),
    column("wall_s_max", "s", "longest time of the repeats", |row| Number(row.wall_s_max)),
    column("cpu_s_min", "s", "shortest processor time of the repeats, which ranks", |row| {
        Number(row.cpu_s_min)
    }),
    column("cpu_s_median", "s", "median processor time of the repeats", |row| {
        Number(row.cpu_s_median)
    }),
    column("batch", "", "parts computed at once when it was timed", |row| count(row.batch))
        .of(Given::Batch),
    column("n_retaken", "", "steps retaken to land on events", |row| count(row.n_retaken)),
    column("n_factorisations", "", "factorisations of an iteration matrix", |row| {
        count(row.n_factorisations)
    }),
    column("n_rhs_flight", "", "of n_rhs, those of steps in flight", |row| {
        evaluations(row.work_by_phase.flight)
    })
    .of(Given::Phase),
    column("n_rhs_contact", "", "of n_rhs, those of steps slipping in contact", |row| {
        evaluations(row.work_by_phase.contact)
    })
    .of(Given::Phase),
    column("n_rhs_stick", "", "of n_rhs, those of steps sticking", |row| {
        evaluations(row.work_by_phase.stick)
    })
    .of(Given::Phase),
    column("n_rhs_restart", "", "of n_rhs, those that began phases", |row| {
        count(row.n_rhs_restart)
    }),
    column("n_rhs_location", "", "of n_rhs, those that located events", |row| {
        count(row.n_rhs_location)
    }),
    column("n_rhs_per_event", "", "n_rhs_restart and n_rhs_location for each transition", |row| {
        Number(row.work_by_phase.n_rhs_per_event())
    }),
    column("n_accepted_flight", "", "of n_accepted, those in flight", |row| {
        steps(row.work_by_phase.flight)
    })
    .of(Given::Phase),
    column("n_accepted_contact", "", "of n_accepted, those slipping in contact", |row| {
        steps(row.work_by_phase.contact)
    })
    .of(Given::Phase),
    column("n_accepted_stick", "", "of n_accepted, those sticking", |row| {
        steps(row.work_by_phase.stick)
    })
    .of(Given::Phase),
    column("e_max", "", "largest e on the dense output, between the samples too", |row| {
        Number(row.errors.e_max)
    }),
    column("e_l2", "", "root mean square of e over time, on the dense output", |row| {
        Number(row.errors.e_l2)
    }),
    column(
        "e_final",
        "",
        "worst of the states at the end, each over the largest value that it takes; empty where one jumps there",
        |row| Number(row.errors.e_final),
    ),
    column(
        "peak_force_error",
        "",
        "worst error of a contact's peak force, over the largest peak",
        |row| Number(row.errors.peak_force_error),
    ),
    column(
        "contact_impulse_error",
        "",
        "worst error of a contact's impulse, over the largest one",
        |row| Number(row.errors.contact_impulse_error),
    ),
    column(
        "impulse_error",
        "",
        "error of the impulse of all contacts of the whole run, relative",
        |row| Number(row.errors.impulse_error),
    ),
    column(
        "dissipation_error",
        "",
        "error of the energy dissipated in the whole run, over the work of the drive",
        |row| Number(row.errors.dissipation_error),
    ),
    column(
        "energy_residual",
        "",
        "what the run's own energy balance lacks, over the work of the drive",
        |row| Number(row.errors.energy_residual),
    ),
    column("peak_force_n", "N", "largest normal force of the whole run", |row| {
        Number(row.errors.peak_force_n)
    }),
    column(
        "impulse_n_s",
        "N s",
        "impulse of all contacts of the whole run, impacts of no duration apart",
        |row| Number(row.errors.impulse_n_s),
    ),
    column("dissipated_j", "J", "energy dissipated in the whole run", |row| {
        Number(row.errors.dissipated_j)
    }),
    always("error", "", "why it failed, or what cut it", |row| {
        Text(row.error.clone().unwrap_or_default())
    }),
    column("warnings", "", "codes of what it tells of itself and the reference does not", |row| {
        let codes: Vec<_> = row.warnings.iter().map(|warning| warning.code.name()).collect();
        Text(codes.join(" "))
    }),
    column(
        "impact_speed_error",
        "",
        "worst error of the speed at which a contact begins, over the largest one",
        |row| Number(row.errors.impact_speed_error),
    ),
];
