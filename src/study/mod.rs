//! The experiments on the mechanisms, each a function from a configuration to a table.

pub mod audit;
pub mod claims;
pub mod contests;
pub mod course;
pub mod deployment;
pub mod friction;
pub mod ideal;
pub mod machine;
pub mod plan;
pub mod record;
pub mod regimes;
pub mod restitution;
pub mod stability;
pub mod torque_ratio;
