//! `deltazero model`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use deltazero::config::{self, Config};
use deltazero_text::models::{MODELS, Model};

use super::{Failure, print, say, warn};

#[derive(Args)]
pub(super) struct ModelArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The models that come with the program
    List,
    /// Print one of them, to start from
    New {
        /// Its name
        #[arg(value_name = "NAME")]
        name: String,
    },
    /// Check a model file, and tell what is in it
    Check {
        /// A model in TOML
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
}

pub(super) fn run(args: &ModelArgs) -> Result<(), Failure> {
    match &args.command {
        Command::List => {
            let line = |model: &Model| format!("{:<20} {}\n", model.name, model.about());
            print(&MODELS.iter().map(line).collect::<String>())
        }
        Command::New { name } => match MODELS.iter().find(|model| model.name == name) {
            Some(model) => print(model.text),
            None => {
                let names: Vec<&str> = MODELS.iter().map(|model| model.name).collect();
                Err(Failure::Usage(format!("no model {name}; there are {}", names.join(", "))))
            }
        },
        Command::Check { file } => check(file),
    }
}

fn check(file: &Path) -> Result<(), Failure> {
    let config = Config::load_with(Some(file), None, &[])?;
    let mechanism = &config.mechanism;
    let mut text = format!("{}: {}\n", file.display(), mechanism.title(&config));
    for (name, what) in mechanism.facts(&config) {
        let _ = writeln!(text, "  {name}: {what}");
    }
    let subject = mechanism.subject(&config);
    for part in &subject.parts {
        part.check().map_err(|error| Failure::Usage(format!("{}: {error}", file.display())))?;
        let name = if part.name.is_empty() { "States" } else { &part.name };
        let states: Vec<String> = part.states.iter().map(|state| state.name.to_string()).collect();
        let _ = writeln!(text, "  {name}: {}", shortened(&states));
    }
    print(&text)?;
    warn(&mechanism.warnings(&config), false);
    config::Model::read(file)?.leftovers().iter().for_each(|warning| say(warning));
    Ok(())
}

/// The first and the last of very many.
fn shortened(names: &[String]) -> String {
    const MOST: usize = 12;
    match names {
        [first, second, .., last] if names.len() > MOST => {
            format!("{first}, {second}, … {last} ({} in all)", names.len())
        }
        _ => names.join(", "),
    }
}
