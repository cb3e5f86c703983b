//! `deltazero methods`.

use clap::Args;
use deltazero_solvers::METHODS;
use serde_json::json;

use super::{Failure, print};

#[derive(Args)]
pub(super) struct MethodsArgs {
    /// Print them as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &MethodsArgs) -> Result<(), Failure> {
    if args.json {
        let list: Vec<_> = METHODS
            .iter()
            .map(|method| {
                json!({
                    "method": method.name,
                    "order": method.order,
                    "fixed_step": method.is_fixed_step(),
                    "about": method.about,
                })
            })
            .collect();
        return print(&format!("{:#}\n", json!(list)));
    }
    let mut text = String::from("method    order  about\n");
    for method in METHODS {
        text += &format!("{:<9} {:<6} {}\n", method.name, method.order, method.about);
    }
    print(&text)
}
