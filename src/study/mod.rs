//! The experiments on the mechanisms, each a function from a configuration to a table.

pub mod contests;
pub mod friction;
pub mod machine;
pub mod plan;
pub mod record;
pub mod regimes;
pub mod restitution;
pub mod stability;
