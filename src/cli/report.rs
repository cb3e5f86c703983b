//! `deltazero report`.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Args;
use deltazero::study::record::StudyRecord;

use super::output::Output;
use super::{Failure, say, study};

#[derive(Args)]
pub(super) struct ReportArgs {
    /// Directory of a finished study
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// No messages but errors
    #[arg(long)]
    quiet: bool,
}

/// Makes everything but `study.json` anew. The contest is not run again; the single runs behind the
/// figures of steps and motion are, to the same bits.
pub(super) fn run(args: &ReportArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let refuse = |why: &str| Failure::Usage(format!("{}: {why}", args.dir.display()));
    let output = Output::existing(&args.dir)?;
    let study = output
        .read("study.json")
        .ok_or_else(|| refuse("holds no study.json that can be read; name the DIR of a study"))?;
    let study: StudyRecord = serde_json::from_value(study)
        .map_err(|error| refuse(&format!("study.json is not that of a study: {error}")))?;
    if !study.finished {
        return Err(refuse("the study is not finished; its command goes on where it stopped"));
    }
    study::write_report(&output, &study, stop)?;
    if !args.quiet {
        say(&format!("rewritten in {}: report.html and all that study.json tells", output.path()));
    }
    Ok(())
}
