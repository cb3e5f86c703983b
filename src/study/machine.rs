//! What a study was measured on.

use std::env::consts::{ARCH, OS};

use deltazero_study::parallel::cores;
use serde::{Deserialize, Serialize};

/// A machine and the build of the program on it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of its processor, where the system tells (Linux).
    pub cpu: Option<String>,
    /// Cores that the program may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub os: String,
    /// Compiler, target, optimisation level, further flags.
    pub built_by: String,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        Self {
            cpu: cpu(),
            cores: cores(),
            os: format!("{OS} {ARCH}"),
            built_by: env!("DELTAZERO_BUILT_BY").to_owned(),
        }
    }

    /// What times hang on: all but the cores, of which a run takes one.
    pub fn identity(&self) -> [&str; 3] {
        [self.cpu.as_deref().unwrap_or_default(), &self.os, &self.built_by]
    }

    /// Whether a record was written on this machine, and by this build.
    pub fn wrote(&self, record: &serde_json::Value) -> bool {
        let machine = serde_json::from_value::<Self>(record["machine"].clone());
        machine.is_ok_and(|other| other.identity() == self.identity())
    }
}

fn cpu() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}
