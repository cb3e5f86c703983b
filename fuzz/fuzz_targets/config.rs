//! A configuration in TOML: refused with a message, or the same when it is printed and read again.

#![no_main]

use deltazero::config::Config;
use deltazero_fuzz::{file, is_sound};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &[u8]| {
    match Config::load(Some(&file("config.toml", text)), &[]) {
        Ok(config) => is_sound(&config),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
