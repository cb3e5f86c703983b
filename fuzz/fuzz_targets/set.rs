//! Arguments of `--set`, a line each.

#![no_main]

use deltazero::config::Config;
use deltazero_fuzz::is_sound;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let sets: Vec<String> = text.lines().map(str::to_owned).collect();
    match Config::load(None, &sets) {
        Ok(config) => is_sound(&config),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
