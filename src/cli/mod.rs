//! Commands, one a file: read a configuration, run one experiment, write its results.

mod audit;
mod axes;
mod completions;
mod config;
mod contests;
mod laws;
mod meter;
mod methods;
mod model;
mod output;
mod plot;
mod progress;
mod recommend;
mod reference;
mod regimes;
mod report;
mod resume;
mod rows;
mod simulate;
mod study;
mod sweep;

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, CommandFactory as _, Parser, Subcommand};
use deltazero::atomic_file::FileError;
use deltazero::config::{Config, ConfigError};
use deltazero::mechanisms::MECHANISMS;
use deltazero::study::machine::Machine;
use deltazero_study::setting::Events;
use deltazero_study::warning::Warning;

/// Which integrator, at which setting, for this contact?
///
/// Without a command: the study of the paper's Table 1, 0-2 s, into ./deltazero-out.
/// With --set mechanism=NAME, simulate, study and recommend are about another mechanism; `deltazero config` lists them.
/// With --model FILE they, regimes and sweep are about your own model, a text file; `deltazero model` has some to start from.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    study: study::StudyArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Methods x tolerances against the reference: tables, figures, report
    Study(study::StudyArgs),
    /// One run with one method: trajectory.csv, events.csv, run.json
    Simulate(simulate::SimulateArgs),
    /// The contest over a grid of contact stiffness x damping x accuracy: maps of who wins
    Regimes(regimes::RegimesArgs),
    /// Which method and setting for this contact, with the measured reason
    Recommend(recommend::RecommendArgs),
    /// The paper's claims, one by one, under each reading: verdicts, its figures redrawn, the torque ratio
    Audit(audit::AuditArgs),
    /// Many runs of a plan: in parallel, resumable, in shards that are merged
    Sweep(sweep::SweepArgs),
    /// A figure of a finished sweep: heat map, lines, distribution, scatter, Sobol indices
    ///
    /// Which one follows from the columns: --x alone is a distribution over the runs; two axes of the grid with --color a heat map; an
    /// axis and a value lines, with the spread of the draws, one line a word or axis value of --color; any other two a scatter.
    /// Runs that did not come to their end are left out.
    Plot(plot::PlotArgs),
    /// The methods, their orders and what each is for
    Methods(methods::MethodsArgs),
    /// The laws of contact and friction: equations, sources, the restitution delivered, the cost of regularising
    Laws(laws::LawsArgs),
    /// Rebuild tables, figures and the HTML page of a finished study; the HTML page of a finished sweep
    Report(report::ReportArgs),
    /// The default configuration, commented, or the one given; or the JSON Schema
    Config(config::ConfigArgs),
    /// Models as text files: those that come with the program, a start for your own, a check
    Model(model::ModelArgs),
    /// What a shell is told to complete this command line: deltazero completions bash
    Completions(completions::CompletionsArgs),
    /// Pages of the manual, one for each command, into a directory: deltazero man DIR
    Man(completions::ManArgs),
}

/// Where a configuration comes from.
#[derive(Args)]
struct ConfigFrom {
    /// Configuration in TOML; every key is optional and defaults to the paper's Table 1
    #[arg(value_name = "CONFIG")]
    config: Option<PathBuf>,
    /// A model of your own in TOML, in place of a mechanism; `deltazero model` has some to start from
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Set one key, or a parameter of the model, after the file, as in --set contact.stiffness=1e9 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl ConfigFrom {
    fn load(&self) -> Result<Config, Failure> {
        self.load_with(&[])
    }

    /// With `more` set after the rest.
    fn load_with(&self, more: &[String]) -> Result<Config, Failure> {
        let sets = [&self.set, more].concat();
        Ok(Config::load_with(self.model.as_deref(), self.config.as_deref(), &sets)?)
    }

    /// Whether nothing was given.
    fn is_empty(&self) -> bool {
        self.config.is_none() && self.model.is_none() && self.set.is_empty()
    }
}

/// Where results go, and what is said of them.
#[derive(Args)]
struct ResultsTo {
    /// Directory for the results; by default deltazero-out for a study, a folder in it for other commands
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite a directory that holds the results of another configuration or plan
    #[arg(long)]
    force: bool,
    /// No progress and no messages but errors
    #[arg(long)]
    quiet: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl ResultsTo {
    /// The directory, `usual` where none is named.
    fn dir(&self, usual: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from(usual))
    }
}

/// Where a configuration comes from and its results go.
#[derive(Args)]
struct RunArgs {
    #[command(flatten)]
    from: ConfigFrom,
    #[command(flatten)]
    to: ResultsTo,
}

impl RunArgs {
    fn load(&self) -> Result<Config, Failure> {
        self.from.load()
    }
}

/// Refuses every mechanism but the default one, the paper's, where a command speaks of no other.
fn default_only(config: Config, why: &str) -> Result<Config, Failure> {
    let name = config.mechanism.entry.name;
    if MECHANISMS.first().is_some_and(|default| default.name == name) {
        return Ok(config);
    }
    // Models from files stand in no list.
    let given = match MECHANISMS.iter().any(|entry| entry.name == name) {
        true => format!("mechanism = {name}"),
        false => "--model".to_owned(),
    };
    let way_out = "`simulate`, `study`, `recommend`, `sweep` and `regimes --axis` take it";
    Err(Failure::Usage(format!("{given}: {why}; {way_out}")))
}

/// What an interrupted command leaves.
const RESUMED: &str = "what was finished is on disk, the same command goes on from there";

/// Runs at the same time: so many, or one a core.
fn or_cores(threads: Option<u16>) -> usize {
    threads.map_or_else(|| Machine::here().cores, usize::from)
}

/// Why a command did not succeed, and with it the exit code.
#[derive(Debug)]
enum Failure {
    /// Bad usage or configuration: 2.
    Usage(String),
    /// The run failed: 1.
    Run(String),
    /// Interrupted, with what is on disk: 130.
    Interrupted(&'static str),
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::Run(error.to_string())
    }
}

/// Prints to standard output; a reader that closed it has what it wanted, and the command goes on.
fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::Run(format!("cannot write to standard output: {error}"))),
    }
}

/// Says something on standard error; a closed one is no reason to fail.
fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Says warnings, a line each; `--quiet` leaves them to the files.
fn warn(warnings: &[Warning], quiet: bool) {
    for warning in warnings.iter().filter(|_| !quiet) {
        say(&format!("warning: {}", warning.message));
    }
}

/// Says that blind runs among `events` are left out, and why.
fn note_left_out(config: &Config, events: &[Events], quiet: bool) {
    if let Some(reason) = config.no_blind_runs()
        && !quiet
        && config.permitted(events).len() < events.len()
    {
        say(&format!("blind runs are left out: {reason}"));
    }
}

/// A word in the place of CONFIG that is no file: a command misspelt, or put after its options.
fn misplaced_command(args: &study::StudyArgs) -> Option<Failure> {
    let word = args.run.from.config.as_deref()?;
    let is_word = word.to_str()?.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    (is_word && !word.exists()).then(|| {
        let commands: Vec<_> =
            Cli::command().get_subcommands().map(|command| command.get_name().to_owned()).collect();
        Failure::Usage(format!(
            "{}: neither a configuration file nor, in the first place, a command ({})",
            word.display(),
            commands.join(", ")
        ))
    })
}

/// Runs the command line; its exit code.
pub(crate) fn main() -> ExitCode {
    let cli = Cli::parse();
    let stop = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&stop);
    // Without a handler Ctrl-C ends the program at once, which loses nothing but this run.
    let _ = ctrlc::set_handler(move || {
        if handler.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let done = match cli.command {
        None => misplaced_command(&cli.study).map_or_else(|| study::run(&cli.study, &stop), Err),
        Some(Command::Study(args)) => study::run(&args, &stop),
        Some(Command::Simulate(args)) => simulate::run(&args, &stop),
        Some(Command::Regimes(args)) if !args.axis.is_empty() => axes::run(&args, &stop),
        Some(Command::Regimes(args)) => regimes::run(&args, &stop),
        Some(Command::Recommend(args)) => recommend::run(&args, &stop),
        Some(Command::Audit(args)) => audit::run(&args, &stop),
        Some(Command::Sweep(args)) => sweep::run(&args, &stop),
        Some(Command::Plot(args)) => plot::run(&args),
        Some(Command::Methods(args)) => methods::run(&args),
        Some(Command::Laws(args)) => laws::run(&args),
        Some(Command::Report(args)) => report::run(&args, &stop),
        Some(Command::Config(args)) => config::run(&args),
        Some(Command::Model(args)) => model::run(&args),
        Some(Command::Completions(args)) => completions::run(&args),
        Some(Command::Man(args)) => completions::man(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(2)
        }
        Err(Failure::Run(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(1)
        }
        Err(Failure::Interrupted(what)) => {
            say(&format!("interrupted; {what}"));
            ExitCode::from(130)
        }
    }
}
