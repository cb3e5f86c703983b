//! What it was measured on.

use std::fmt::Write;
use std::process::Command;

/// The machine, the compilers and their flags, as a list in Markdown.
pub(crate) fn record() -> String {
    let mut text = String::new();
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = cpu.lines().find(|line| line.starts_with(name))?;
        line.split_once(':').map(|(_, value)| value.trim().to_owned())
    };
    let or = |text: Option<String>| text.unwrap_or_else(|| "unknown".to_owned());
    let family = format!("family {} model {}", or(field("cpu family")), or(field("model\t")));
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let _ = writeln!(
        text,
        "- CPU: {} ({family}), {cores} cores; one thread measured",
        or(field("model name"))
    );
    for (what, command) in [("rustc", "rustc"), ("C++", "g++"), ("Python", "python3")] {
        let version = Command::new(command).arg("--version").output().ok();
        let version = version.and_then(|output| String::from_utf8(output.stdout).ok());
        let first = version.and_then(|text| text.lines().next().map(str::to_owned));
        let _ = writeln!(text, "- {what}: {}", first.unwrap_or_else(|| "not there".to_owned()));
    }
    text.push_str(
        "- native: `-C target-cpu=native` and `-O3 -march=native`; plain: `-C target-cpu=generic`. \
         Rust: thin LTO, one codegen unit.\n",
    );
    text
}
