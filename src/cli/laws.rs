//! `deltazero laws`.

use clap::Args;
use deltazero::report::laws::{json, markdown};
use deltazero::study::friction::costs;
use deltazero::study::restitution::deliveries;

use super::{Failure, print};

#[derive(Args)]
pub(super) struct LawsArgs {
    /// Print them as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &LawsArgs) -> Result<(), Failure> {
    let (deliveries, costs) = (deliveries()?, costs()?);
    if args.json {
        return print(&format!("{:#}\n", json(&deliveries, &costs)));
    }
    print(&markdown(&deliveries, &costs))
}
