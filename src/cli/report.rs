//! `deltazero report`.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Args;
use deltazero::figures::sweep::PlotError;
use deltazero::report::html::sweep_page;
use deltazero::report::sweep::Findings;
use deltazero::study::record::StudyRecord;
use deltazero::sweep::origin::Origin;
use deltazero::sweep::results::Results;
use deltazero::sweep::{RECORD, default_columns};
use deltazero_study::digits::count_of;
use serde_json::Value;

use super::output::Output;
use super::{Failure, say, study};

/// The report of a sweep.
pub(super) const PAGE: &str = "sweep.html";

#[derive(Args)]
pub(super) struct ReportArgs {
    /// Directory of a finished study or sweep
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Column of a sweep's runs.csv that its report is of; a wrong name lists them (repeatable)
    #[arg(long, value_name = "COL")]
    y: Vec<String>,
    /// No messages but errors
    #[arg(long)]
    quiet: bool,
}

pub(super) fn run(args: &ReportArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let output = Output::existing(&args.dir)?;
    let (study, is_sweep) = (output.read("study.json"), args.dir.join(RECORD).is_file());
    if study.is_none() && !is_sweep {
        let why = "holds no study.json and no sweep.json that can be read; name the DIR of a study or of a sweep";
        return Err(refuse(args, why));
    }
    if !is_sweep && !args.y.is_empty() {
        return Err(refuse(args, "--y names columns of a sweep, and this is a study"));
    }
    if let Some(study) = study {
        report_study(args, &output, study, stop)?;
    }
    if is_sweep { report_sweep(args, &output) } else { Ok(()) }
}

fn refuse(args: &ReportArgs, why: &str) -> Failure {
    Failure::Usage(format!("{}: {why}", args.dir.display()))
}

/// Makes everything but `study.json` anew. The contest is not run again; the single runs behind the
/// figures of steps and motion are, to the same bits.
fn report_study(
    args: &ReportArgs,
    output: &Output,
    study: Value,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    let study: StudyRecord = serde_json::from_value(study)
        .map_err(|error| refuse(args, &format!("study.json is not that of a study: {error}")))?;
    if !study.finished {
        return Err(refuse(
            args,
            "the study is not finished; its command goes on where it stopped",
        ));
    }
    study::write_report(output, &study, stop)?;
    if !args.quiet {
        say(&format!("rewritten in {}: report.html and all that study.json tells", output.path()));
    }
    Ok(())
}

/// Makes `sweep.html` and its figures; no run is made again.
fn report_sweep(args: &ReportArgs, output: &Output) -> Result<(), Failure> {
    let results = Results::open(&args.dir).map_err(PlotError::from)?;
    let origin = Origin::of(&results, &args.dir).map_err(PlotError::from)?;
    let mut columns: Vec<&str> = Vec::new();
    for column in &args.y {
        if !columns.contains(&column.as_str()) {
            columns.push(column);
        }
    }
    let asked: String = columns.iter().map(|column| format!(" --y {column}")).collect();
    if columns.is_empty() {
        columns = default_columns(&results);
    }
    let findings = Findings::of(&results, &columns)?;
    let drawings = findings.drawings.iter();
    let pictures = drawings.map(|(name, drawing)| output.draw_as(name, drawing));
    let pictures = pictures.collect::<Result<Vec<_>, _>>()?;
    let command = format!("deltazero report DIR{asked}");
    let page = sweep_page(&results, &origin, &findings, pictures, &command);
    output.write(PAGE, page.html().as_bytes())?;
    if !args.quiet {
        let figures = count_of(findings.drawings.len(), "figure");
        say(&format!("written to {}: {PAGE}, {figures} in figures/", output.path()));
    }
    Ok(())
}
