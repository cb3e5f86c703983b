//! `deltazero config`.

use clap::Args;
use deltazero::config::{default_toml, json_schema};

use super::{ConfigFrom, Failure, print};

#[derive(Args)]
pub(super) struct ConfigArgs {
    #[command(flatten)]
    from: ConfigFrom,
    /// Print the JSON Schema of the configuration instead
    #[arg(long, conflicts_with_all = ["config", "model", "set"])]
    schema: bool,
}

pub(super) fn run(args: &ConfigArgs) -> Result<(), Failure> {
    if args.schema {
        return print(&format!("{:#}\n", json_schema()));
    }
    if args.from.is_empty() {
        return print(&default_toml());
    }
    print(&args.from.load()?.commented_toml())
}
