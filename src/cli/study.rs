//! `deltazero study`.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use deltazero::config::Config;
use deltazero::figures;
use deltazero::model::Joints;
use deltazero::report::simulation::motion_csv;
use deltazero::report::{self, About};
use deltazero::study::machine::Machine;
use deltazero::study::plan::{limits, plan};
use deltazero::study::record::{StudyRecord, name_reading};
use deltazero::study::stability::stability;
use deltazero_study::digits::count_of;
use deltazero_study::motion::Motion;
use deltazero_study::reference::RECIPE;
use deltazero_study::steps::StepTables;
use deltazero_study::work_precision::{Progress, Row, Status, WorkPrecision, against};
use humantime::format_rfc3339_seconds;
use serde_json::{Value, json};

use super::output::{Output, cannot_draw, hash, is_current};
use super::progress::Bar;
use super::reference::reference;
use super::resume::{Kept, RECORD, write_json};
use super::{Failure, RESUMED, RunArgs, note_left_out, print, say, warn};

/// What stands beside it, apart from the reference, which tells itself whose it is.
const FILES: [&str; 11] = [
    "report.html",
    "study.md",
    "study.csv",
    "motion.csv",
    "steps.csv",
    "step_histogram.csv",
    "stays.csv",
    "restarts.csv",
    "restart_costs.csv",
    "tolerance.csv",
    "rk4_stability.csv",
];

#[derive(Args)]
pub(super) struct StudyArgs {
    #[command(flatten)]
    pub(super) run: RunArgs,
    /// Runs timed at the same time, instead of study.threads; more than one disturbs the timings
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Numbers that the reference is computed in, instead of study.reference: double or extended
    #[arg(long, value_name = "DIGITS")]
    reference: Option<String>,
}

impl StudyArgs {
    /// The configuration, `--reference` being its key as `--set` would set it.
    fn load(&self) -> Result<Config, Failure> {
        let digits = self.reference.iter().map(|digits| format!("study.reference={digits}"));
        self.run.from.load_with(&digits.collect::<Vec<_>>())
    }
}

pub(super) fn run(args: &StudyArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let mut config = args.load()?;
    let dir = args.run.to.dir("deltazero-out");
    let hash = hash("study", &identity_of_runs(&config)?);
    let output = Output::open(&dir, hash, args.run.to.force)?;
    output.remove_of_another(RECORD, &FILES, &figures::OF_STUDIES)?;
    if let Some(threads) = args.threads {
        config.study.threads = usize::from(threads);
    }
    note_left_out(&config, &config.study.events, args.run.to.quiet);
    warn(&config.warnings(), args.run.to.quiet);
    let bar = Bar::new(args.run.to.quiet);
    let known = unfinished_rows(&output, args.run.to.quiet);
    let reference = match reference(&output, &config, stop, args.run.to.quiet) {
        Ok(reference) => reference,
        Err(_) if stop.load(Ordering::Relaxed) => {
            return Err(Failure::Interrupted(
                "the reference is not finished; the same command begins it anew",
            ));
        }
        Err(failure) => return Err(failure),
    };
    let begun = WorkPrecision { reference: reference.summary.clone(), rows: known.clone() };
    let kept = Kept::new(&output, unfinished(&output, &config, begun), stop);
    let subject = config.mechanism.subject(&config);
    let table =
        against(&subject, &reference, &plan(&config), &known, stop, &|progress| match progress {
            Progress::Row(row) => kept.take(*row),
            progress => bar.show(progress),
        });
    let mut study = StudyRecord { time: told(SystemTime::now()), table, ..kept.into_study()? };
    let about = About::of(&config);
    output.write("study.csv", report::study_csv(&about, &study.table).as_bytes())?;
    write_json(&output, &study)?;
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted(RESUMED));
    }
    bar.say("figures");
    write_report(&output, &study, stop)?;
    study.finished = true;
    write_json(&output, &study)?;
    drop(bar);

    let table = &study.table;
    if args.run.to.json {
        let mut json = json!(table);
        name_reading(&mut json, &config);
        print(&format!("{json:#}\n"))?;
    } else {
        print(&report::answer(table))?;
    }
    if !args.run.to.quiet {
        summarise(&output, table);
    }
    if table.rows.iter().any(|row| row.status == Status::Ok) {
        Ok(())
    } else {
        Err(Failure::Run("no run reached its end; study.csv says why".into()))
    }
}

/// A study that is under way.
fn unfinished(output: &Output, config: &Config, table: WorkPrecision) -> StudyRecord {
    StudyRecord {
        hash: output.hash.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        recipe: RECIPE,
        machine: Some(Machine::here()),
        time: told(SystemTime::now()),
        config: config.clone(),
        finished: false,
        table,
    }
}

/// A time as a record has it; none of a clock that is before 1970 or after 9999.
fn told(time: SystemTime) -> Option<String> {
    time.duration_since(UNIX_EPOCH).ok()?;
    let mut text = String::new();
    write!(text, "{}", format_rfc3339_seconds(time)).ok()?;
    Some(text)
}

/// What results are of, apart from the axes of a figure, which change no run.
fn identity_of_runs(config: &Config) -> Result<Value, Failure> {
    let (mut config, default) = (config.clone(), Config::table1()?.shared.study);
    (config.study.x, config.study.y) = (default.x, default.y);
    Ok(config.identity())
}

/// The rows of an earlier study of the same configuration that was interrupted, on this machine and by this build: times of
/// several are not compared. One that was finished is done anew, which measures its times again.
fn unfinished_rows(output: &Output, quiet: bool) -> Vec<Row> {
    let rows = output.own(RECORD).and_then(|mut study| {
        if study.get("finished")?.as_bool()? || !is_current(&study) {
            return None;
        }
        if !Machine::here().wrote(&study) {
            if !quiet {
                let why =
                    "was begun on another machine or by another build; all runs are made anew";
                say(&format!("{}/{RECORD}: {why}", output.path()));
            }
            return None;
        }
        serde_json::from_value::<Vec<Row>>(study.get_mut("rows")?.take()).ok()
    });
    rows.unwrap_or_default()
}

/// The figures with the data behind them, and the reports: all that follows from `study.json`.
pub(super) fn write_report(
    output: &Output,
    study: &StudyRecord,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    let StudyRecord { config, table, .. } = study;
    let (limits, plan) = (limits(config, stop), plan(config));
    let steps = StepTables::new(&config.mechanism.subject(config), &plan, table, limits);
    let (stability, motion) = (
        stability(config, table, limits),
        Motion::new(&config.mechanism.subject(config), config.run.t_end, limits),
    );
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted(RESUMED));
    }
    for (name, text) in report::steps::files(&steps, stability.as_ref()) {
        output.write(name, text.as_bytes())?;
    }
    if let Some(motion) = &motion {
        output.write("motion.csv", motion_csv(motion).as_bytes())?;
    }
    let joints = Joints::from(config);
    let clearances: Vec<f64> = joints.blocks().iter().map(|block| block.clearance).collect();
    let mut drawings =
        figures::of_study(table, &steps, motion.as_ref(), &clearances, stability.as_ref());
    drawings.extend(figures::chosen_axes(table, &config.study.x, &config.study.y));
    let about = About::of(config);
    let files = report::study_files(&about, &plan, table, &study.provenance(), &drawings)
        .map_err(|(name, error)| cannot_draw(name, &error))?;
    files.iter().try_for_each(|file| output.write(&file.name, &file.content))
}

fn summarise(output: &Output, table: &WorkPrecision) {
    let count = |status| table.rows.iter().filter(|row| row.status == status).count();
    let (ok, failed, cut) = (count(Status::Ok), count(Status::Failed), count(Status::Cut));
    say(&format!(
        "{}: {ok} ok, {failed} failed, {cut} cut; reference good to e = {}",
        count_of(table.rows.len(), "run"),
        table.reference.own_error()
    ));
    for limit in table.limits() {
        say(&format!("  {limit}"));
    }
    for row in table.rows.iter().filter(|row| row.status != Status::Ok) {
        let why = row.error.as_deref().unwrap_or("more than study.max_rhs right-hand sides");
        say(&format!("  {} {}, {}: {why}", row.method, row.events, row.setting()));
    }
    say(&format!(
        "written to {}: report.html, study.md, study.csv, study.json, figures/",
        output.path()
    ));
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_clock_that_is_far_off_tells_no_time() {
        let day = Duration::from_secs(86_400);
        assert_eq!(told(UNIX_EPOCH + day).as_deref(), Some("1970-01-02T00:00:00Z"));
        assert_eq!(told(UNIX_EPOCH - day), None);
        assert_eq!(told(UNIX_EPOCH + 4_000_000 * day), None);
    }
}
