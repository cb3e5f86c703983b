//! `deltazero config`.

use std::path::PathBuf;

use clap::Args;
use deltazero::config::{Config, default_toml, json_schema};

use super::{Failure, print};

#[derive(Args)]
pub(super) struct ConfigArgs {
    /// Configuration in TOML, to be printed with every key and comments
    #[arg(value_name = "CONFIG")]
    config: Option<PathBuf>,
    /// Set one key after the file, as in --set mechanism=slider-crank (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the JSON Schema of the configuration instead
    #[arg(long, conflicts_with_all = ["config", "set"])]
    schema: bool,
}

pub(super) fn run(args: &ConfigArgs) -> Result<(), Failure> {
    if args.schema {
        return print(&format!("{:#}\n", json_schema()));
    }
    if args.config.is_none() && args.set.is_empty() {
        return print(&default_toml());
    }
    print(&Config::load(args.config.as_deref(), &args.set)?.commented_toml())
}
