//! The paper's deployment: what it claims, and what comes out of its equations.

pub mod audit;
pub mod claims;
pub mod course;
pub mod deployment;
pub mod ideal;
pub mod torque_ratio;
