//! A hybrid system from a text file.

mod bounds;
mod compile;
mod declarations;
mod derivative;
mod document;
mod evaluate;
mod expand;
mod expression;
mod extended;
mod file;
mod functions;
mod graph;
mod layout;
mod mode;
pub mod models;
mod names;
mod problem;
mod report;
mod sparsity;
mod system;
mod tape;
mod token;
mod vector;

pub use file::{ModelFile, Parameter, Range};
pub use mode::Mode;
pub use report::Report;
pub use system::TextModel;
pub use vector::{Any, Family, Few};
