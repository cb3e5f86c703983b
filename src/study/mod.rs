//! The experiments, each a function from a configuration to a table.

pub mod motion;
pub mod step_size;
pub mod work_precision;
