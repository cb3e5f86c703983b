//! Commands, one a file: read a configuration, run one experiment, write its results.

mod config;
mod methods;
mod output;
mod progress;
mod simulate;
mod study;

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, Parser, Subcommand};
use deltazero::config::{Config, ConfigError};

/// Which integrator, at which setting, for this contact?
///
/// Without a command: the study of the paper's Table 1, 0-2 s, into ./deltazero-out.
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
    /// Methods x tolerances against the reference: tables and figures
    Study(study::StudyArgs),
    /// One run with one method: trajectory.csv, events.csv, run.json
    Simulate(simulate::SimulateArgs),
    /// The methods, their orders and what each is for
    Methods(methods::MethodsArgs),
    /// The default configuration, commented; or its JSON Schema
    Config(config::ConfigArgs),
}

/// Where a configuration comes from and its results go.
#[derive(Args)]
struct RunArgs {
    /// Configuration in TOML; every key is optional and defaults to the paper's Table 1
    #[arg(value_name = "CONFIG")]
    config: Option<PathBuf>,
    /// Set one key after the file, as in --set contact.stiffness=1e9 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Directory for the results
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite a directory that holds the results of another configuration
    #[arg(long)]
    force: bool,
    /// No progress and no messages but errors
    #[arg(long)]
    quiet: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl RunArgs {
    fn load(&self) -> Result<Config, Failure> {
        Ok(Config::load(self.config.as_deref(), &self.set)?)
    }
}

/// Why a command did not succeed, and with it the exit code.
#[derive(Debug)]
enum Failure {
    /// Bad usage or configuration: 2.
    Usage(String),
    /// The run failed: 1.
    Run(String),
    /// Interrupted; what was finished is on disk: 130.
    Interrupted,
    /// Standard output was closed by its reader: silent, 0.
    OutputClosed,
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self::Usage(error.to_string())
    }
}

/// Prints to standard output.
fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::OutputClosed),
        Err(error) => Err(Failure::Run(format!(
            "cannot write to standard output: {error}"
        ))),
    }
}

/// Says something on standard error; a closed one is no reason to fail.
fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
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
    let done = match cli.command.unwrap_or(Command::Study(cli.study)) {
        Command::Study(args) => study::run(&args, &stop),
        Command::Simulate(args) => simulate::run(&args, &stop),
        Command::Methods(args) => methods::run(&args),
        Command::Config(args) => config::run(&args),
    };
    match done {
        Ok(()) | Err(Failure::OutputClosed) => ExitCode::SUCCESS,
        Err(Failure::Usage(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(2)
        }
        Err(Failure::Run(message)) => {
            say(&format!("error: {message}"));
            ExitCode::from(1)
        }
        Err(Failure::Interrupted) => {
            say("interrupted; what was finished is on disk, the same command goes on from there");
            ExitCode::from(130)
        }
    }
}
