//! `deltazero config`.

use clap::Args;
use deltazero::config::{default_toml, json_schema};

use super::{Failure, print};

#[derive(Args)]
pub(super) struct ConfigArgs {
    /// Print the JSON Schema of the configuration instead
    #[arg(long)]
    schema: bool,
}

pub(super) fn run(args: &ConfigArgs) -> Result<(), Failure> {
    if args.schema { print(&format!("{:#}\n", json_schema())) } else { print(&default_toml()) }
}
