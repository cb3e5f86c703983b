//! The experiments, each a function from a configuration to a table.

pub mod columns;
pub mod machine;
pub mod measured;
pub mod motion;
pub mod proportionality;
pub mod recommend;
pub mod record;
pub mod regimes;
pub mod restarts;
pub mod stability;
pub mod stays;
pub mod step_histogram;
pub mod step_size;
pub mod step_tables;
pub mod work_precision;
