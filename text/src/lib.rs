//! A hybrid system from a text file.
#![allow(dead_code, reason = "what is told of a model comes next")]

mod bounds;
mod compile;
mod declarations;
mod document;
mod evaluate;
mod expand;
mod expression;
mod file;
mod functions;
mod graph;
mod layout;
mod mode;
pub mod models;
mod names;
mod problem;
mod report;
mod system;
mod tape;
mod token;
mod vector;

pub use file::{ModelFile, Parameter, Range};
pub use mode::Mode;
pub use report::Report;
pub use system::TextModel;
pub use vector::Numbers;
