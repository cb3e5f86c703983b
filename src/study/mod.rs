//! The experiments, each a function from a configuration to a table.

pub mod audit;
pub mod claims;
pub mod columns;
pub mod course;
pub mod forecast;
pub mod friction;
pub mod horizon;
pub mod ideal;
pub mod machine;
pub mod measured;
pub mod motion;
mod parallel;
pub mod proportionality;
pub mod recommend;
pub mod record;
pub mod regimes;
pub mod restarts;
pub mod restitution;
pub mod stability;
pub mod stays;
pub mod step_histogram;
pub mod step_size;
pub mod step_tables;
pub mod torque_ratio;
pub mod work_precision;
