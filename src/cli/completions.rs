//! `deltazero completions` and `deltazero man`: the command line as shells complete it, and as a manual.

use std::fs::create_dir_all;
use std::path::PathBuf;

use clap::{Args, CommandFactory as _};
use clap_complete::{Shell, generate};

use super::{Cli, Failure, print};

/// Name of the program, as it is installed.
const PROGRAM: &str = "deltazero";

#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

#[derive(Args)]
pub(super) struct ManArgs {
    /// Directory for the pages
    #[arg(value_name = "DIR")]
    dir: PathBuf,
}

pub(super) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), PROGRAM, &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// A page for the program and one for each command, in section 1.
pub(super) fn man(args: &ManArgs) -> Result<(), Failure> {
    create_dir_all(&args.dir)
        .and_then(|()| clap_mangen::generate_to(Cli::command(), &args.dir))
        .map_err(|error| Failure::Run(format!("{}: {error}", args.dir.display())))
}
