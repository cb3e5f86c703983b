//! Studies of problems with a known answer, or with a known fault. One program: what it compiles of a problem serves all of them.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod broken;
mod closed_forms;
mod common;
mod contradictions;
mod jumps;
mod known_contacts;
