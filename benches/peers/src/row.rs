//! A measured run, and its line in `peers.csv`.

use std::fmt::Write;

use crate::entry::Label;
use crate::problem::Verdict;

/// How the code was compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Build {
    /// For this machine: `-C target-cpu=native`, `-march=native`.
    Native,
    /// For any machine of its kind.
    Plain,
}

impl Build {
    /// As the tables write it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::Plain => "plain",
        }
    }

    /// How this program was compiled: whether it may use what only a native build may.
    pub(crate) fn own() -> Self {
        if cfg!(any(target_feature = "fma", target_feature = "neon")) {
            Self::Native
        } else {
            Self::Plain
        }
    }
}

/// A measured run.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// What it is called.
    pub(crate) label: Label,
    /// How it was compiled.
    pub(crate) build: Build,
    /// What it delivered, or why it did not.
    pub(crate) outcome: Result<Outcome, String>,
}

/// What a run took.
///
/// On a machine with nothing else to do both are the same, all runs being of one thread. With other
/// work beside it the time on the processor does not count what that work took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times {
    /// By the clock on the wall [ms].
    pub(crate) wall_ms: f64,
    /// Of this thread on the processor [ms].
    pub(crate) cpu_ms: f64,
}

impl Times {
    /// The shorter of each.
    pub(crate) fn least(self, other: Self) -> Self {
        let (wall_ms, cpu_ms) = (self.wall_ms.min(other.wall_ms), self.cpu_ms.min(other.cpu_ms));
        Self { wall_ms, cpu_ms }
    }
}

/// What a run delivered, and at what price.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    /// What the golden run says.
    pub(crate) verdict: Verdict,
    /// Right-hand sides of one joint, where counted.
    pub(crate) n_rhs: Option<u64>,
    /// Shortest times of the repeats.
    pub(crate) times: Times,
    /// Repeats.
    pub(crate) repeats: u32,
}

impl Row {
    /// The error, if it delivered.
    pub(crate) fn e(&self) -> Option<f64> {
        self.outcome.as_ref().ok().map(|outcome| outcome.verdict.e)
    }

    /// The time on the processor [ms], if it delivered.
    pub(crate) fn cpu_ms(&self) -> Option<f64> {
        self.outcome.as_ref().ok().map(|outcome| outcome.times.cpu_ms)
    }
}

/// `peers.csv`.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut csv = String::from(
        "tool,version,build,method,events,rtol,e,n_rhs,delta_found,delta_missed,delta_spurious,\
         slip_found,slip_missed,slip_spurious,wall_ms,cpu_ms,repeats,error\n",
    );
    for Row { label, build, outcome } in rows {
        let _ = write!(
            csv,
            "{},{},{},{},{},{:e},",
            label.tool,
            label.version,
            build.name(),
            label.method,
            label.handling.name(),
            label.rtol
        );
        let _ = match outcome {
            Ok(Outcome { verdict, n_rhs, times, repeats }) => {
                let (delta, slip) = (verdict.delta, verdict.slip);
                let n_rhs = n_rhs.map_or_else(String::new, |n| n.to_string());
                writeln!(
                    csv,
                    "{:.3e},{n_rhs},{},{},{},{},{},{},{:.4},{:.4},{repeats},",
                    verdict.e,
                    delta.paired,
                    delta.missed,
                    delta.spurious,
                    slip.paired,
                    slip.missed,
                    slip.spurious,
                    times.wall_ms,
                    times.cpu_ms
                )
            }
            Err(error) => writeln!(csv, ",,,,,,,,,,,{}", error.replace([',', '\n', '"'], ";")),
        };
    }
    csv
}
