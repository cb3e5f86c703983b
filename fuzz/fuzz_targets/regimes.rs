//! The cells of `regimes.json`, and the map that is made of them.

#![no_main]

use std::sync::LazyLock;

use deltazero::config::Config;
use deltazero::figures::regimes::drawings;
use deltazero::report::regimes::{csv, markdown};
use deltazero::study::regimes::Cell;
use libfuzzer_sys::fuzz_target;

static CONFIG: LazyLock<Config> = LazyLock::new(|| Config::table1().expect("Table 1"));

fuzz_target!(|text: &[u8]| {
    let Ok(cells) = serde_json::from_slice::<Vec<Cell>>(text) else { return };
    let _ = csv(&cells);
    let drawings = drawings(&cells);
    let _ = markdown(&CONFIG, &cells, &drawings);
    drawings.iter().for_each(|drawing| drop(drawing.picture()));
});
