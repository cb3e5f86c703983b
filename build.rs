//! Tells the program what built it, for the record of what its times were measured with.

use std::env;
use std::process::Command;

#[allow(clippy::print_stdout, reason = "how a build script speaks to cargo")]
fn main() {
    let rustc = Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
        .arg("--version")
        .output()
        .ok()
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .unwrap_or_default();
    let set = |name: &str| env::var(name).unwrap_or_default();
    let flags = set("CARGO_ENCODED_RUSTFLAGS").replace('\u{1f}', " ");
    let optimised = format!("opt-level {}", set("OPT_LEVEL"));
    let machine = env::var("CARGO_FEATURE_MACHINE_CODE").map_or("", |_| "machine code");
    let parts = [rustc.trim(), &set("TARGET"), &optimised, &flags, machine];
    let said: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    println!("cargo:rustc-env=DELTAZERO_BUILT_BY={}", said.join(", "));
    println!("cargo:rerun-if-changed=build.rs");
}
