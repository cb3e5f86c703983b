//! Ctrl-C: exit 130, whole files, and the same command goes on, as after a kill; no other command writes into a
//! directory meanwhile.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::{Scratch, number, with_sets};

/// The longest wait for something that takes milliseconds on an idle machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running command, ended with the test whatever becomes of it.
pub(crate) struct Running(Option<Child>);

impl Running {
    pub(crate) fn start(scratch: &Scratch, args: &[&str]) -> Self {
        Self(Some(scratch.command(args).spawn().unwrap()))
    }

    /// Waits until `path` exists, then `more`.
    pub(crate) fn until(&self, path: &Path, more: Duration) {
        let start = Instant::now();
        while !path.exists() {
            assert!(start.elapsed() < PATIENCE, "no {}", path.display());
            sleep(Duration::from_millis(5));
        }
        sleep(more);
    }

    /// Waits until `path` exists no more.
    fn until_gone(&self, path: &Path) {
        let start = Instant::now();
        while path.exists() {
            assert!(start.elapsed() < PATIENCE, "{} is still there", path.display());
            sleep(Duration::from_millis(5));
        }
    }

    /// The most memory that it had at once [B], where the system tells (Linux).
    pub(crate) fn peak_memory(&self) -> Option<u64> {
        let id = self.0.as_ref()?.id();
        let status = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
        Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
    }

    /// Kills it: it has no time for a last word.
    pub(crate) fn kill(mut self) {
        let mut child = self.0.take().unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
    }

    /// Sends SIGINT and waits for the end.
    pub(crate) fn interrupt(mut self) -> Output {
        let child = self.0.as_mut().unwrap();
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &pid]).status();
        assert!(sent.unwrap().success());
        self.ended()
    }

    /// Waits for the end.
    pub(crate) fn ended(mut self) -> Output {
        let child = self.0.as_mut().unwrap();
        let start = Instant::now();
        while child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < PATIENCE, "still running");
            sleep(Duration::from_millis(5));
        }
        self.0.take().unwrap().wait_with_output().unwrap()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[test]
fn an_interrupted_simulation_writes_what_it_has() {
    let scratch = Scratch::new();
    // Minutes of work.
    let sets = ["solver.method=rk4", "solver.step=1e-10", "run.sample=1e-6"];
    let run = Running::start(&scratch, &with_sets(&["simulate", "--out", "out"], &sets));
    run.until(&scratch.path("out"), Duration::from_millis(300));
    let output = run.interrupt();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("interrupted"), "{stderr}");
    assert_eq!(scratch.files("out"), ["events.csv", "run.json", "trajectory.csv"]);
    assert_eq!(scratch.json("out/run.json")["outcome"], "interrupted");
    let trajectory = scratch.table("out/trajectory.csv");
    assert!(trajectory.rows.iter().all(|row| number(row, "t_s") < 2.0));
    scratch.table("out/events.csv");
}

#[test]
fn an_interrupted_study_is_finished_by_the_same_command() {
    let scratch = Scratch::new();
    // The last run takes about a second, the others and the reference a tenth.
    let sets = [
        "run.t_end=0.02",
        "study.methods=[\"rk45\", \"rk4\"]",
        "study.events=[\"located\"]",
        "study.rtol=[1e-4, 1e-6]",
        "study.steps=[1e-5, 1e-10]",
        "study.repeats=1",
        "study.max_rhs=15_000_000",
    ];
    let args = with_sets(&["study", "--out", "out"], &sets);
    let run = Running::start(&scratch, &args);
    run.until(&scratch.path("out"), Duration::from_millis(300));
    let output = run.interrupt();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    let left = scratch.files("out");
    assert!(!left.iter().any(|name| name.ends_with(".partial")), "{left:?}");
    // Where the reference was done before, the table is there and says what is missing.
    if scratch.path("out/study.csv").exists() {
        let table = scratch.table("out/study.csv");
        assert_eq!(table.rows.len(), 4);
        assert!(!scratch.path("out/study.md").exists());
        assert_eq!(scratch.json("out/study.json")["finished"], false);
    }
    scratch.succeed(&args);
    let statuses: Vec<String> =
        scratch.table("out/study.csv").rows.iter().map(|row| row["status"].clone()).collect();
    assert_eq!(statuses, ["ok", "ok", "ok", "cut"]);
    assert_eq!(scratch.json("out/study.json")["finished"], true);
}

#[test]
fn an_interrupted_map_keeps_its_finished_cells() {
    let scratch = Scratch::new();
    // The stiffest comes first; the whole map takes seconds.
    let sets = ["regimes.stiffness=[1e5, 1e6, 1e7]", "regimes.threads=1", "contest.repeats=1"];
    let args = with_sets(&["regimes", "--quiet", "--out", "out"], &sets);
    let run = Running::start(&scratch, &args);
    run.until(&scratch.path("out/chunks/0000010.rows"), Duration::ZERO);
    let output = run.interrupt();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("the same command goes on"), "{stderr}");
    let rows = scratch.table("out/regimes.csv").rows;
    assert!(!rows.is_empty() && rows.len() < 30, "{} rows", rows.len());
    assert!(rows.iter().all(|row| row["status"] == "ok"), "{rows:?}");
}

#[test]
fn an_interrupted_audit_writes_nothing_and_says_so() {
    let scratch = Scratch::new();
    let run = Running::start(&scratch, &["audit", "--quiet", "--threads", "1", "--out", "out"]);
    run.until(&scratch.path("out"), Duration::from_millis(300));
    let output = run.interrupt();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("nothing is written"), "{stderr}");
    assert_eq!(scratch.files("out"), [""; 0]);
}

#[test]
fn a_forced_command_leaves_no_file_of_another_run_beside_its_own() {
    // Each takes minutes.
    let simulate = ["simulate", "--set", "solver.method=rk4", "--set", "solver.step=1e-10"];
    let of_audit = ["audit.csv", "courses.csv", "figures/torque_ratio.svg", "audit.json"];
    for (args, files) in [
        (&simulate[..], &["trajectory.csv", "events.csv", "run.json"][..]),
        (&["audit", "--threads", "1"], &of_audit),
    ] {
        let scratch = Scratch::new();
        fs::create_dir_all(scratch.path("out/figures")).unwrap();
        for name in files.iter().chain(&["figures/mine.svg"]) {
            fs::write(scratch.path("out").join(name), "{\"hash\": \"0\"}").unwrap();
        }
        let forced = [args, &["--quiet", "--out", "out", "--force"]].concat();
        let run = Running::start(&scratch, &forced);
        run.until_gone(&scratch.path("out").join(files[files.len() - 1]));
        run.kill();
        assert_eq!(scratch.files("out"), ["figures/mine.svg"], "{args:?}");
    }
}

#[test]
fn a_killed_study_keeps_its_finished_runs_and_the_same_command_goes_on() {
    let scratch = Scratch::new();
    // The last run takes a second or more, the others and the reference a tenth.
    let sets = [
        "run.t_end=0.002",
        "study.methods=[\"rk45\", \"rk4\"]",
        "study.events=[\"located\"]",
        "study.rtol=[1e-4, 1e-6]",
        "study.steps=[1e-5, 1e-12]",
        "study.repeats=1",
        "study.max_rhs=15_000_000",
    ];
    let args = with_sets(&["study", "--quiet", "--out", "out"], &sets);
    let run = Running::start(&scratch, &args);
    // Runs that are over while the file is not yet due again are written with the next.
    run.until(&scratch.path("out/study.json"), Duration::from_millis(300));
    run.kill();
    let mut kept = scratch.json("out/study.json");
    assert_eq!(kept["finished"], false);
    let rows = kept["rows"].as_array_mut().unwrap();
    assert!(!rows.is_empty() && rows.iter().all(|row| row["status"] == "ok"), "{rows:?}");
    // The mark tells what is not run again.
    let n_kept = rows.len();
    rows.iter_mut().for_each(|row| row["n_retaken"] = 12345.into());
    fs::write(scratch.path("out/study.json"), kept.to_string()).unwrap();
    scratch.succeed(&args);
    let rows = scratch.table("out/study.csv").rows;
    assert_eq!(rows.iter().filter(|row| row["n_retaken"] == "12345").count(), n_kept);
    let statuses: Vec<&str> = rows.iter().map(|row| row["status"].as_str()).collect();
    assert_eq!(statuses, ["ok", "ok", "ok", "cut"]);
}

#[test]
fn two_commands_do_not_write_into_one_directory() {
    let scratch = Scratch::new();
    let long = ["solver.method=rk4", "solver.step=1e-10"];
    let args = with_sets(&["simulate", "--quiet", "--out", "out"], &long);
    let run = Running::start(&scratch, &args);
    run.until(&scratch.path("out/.deltazero-lock"), Duration::from_millis(300));
    let study = ["study", "--force", "--out", "out"];
    let others = [&args[..], &study[..], &["regimes", "--out", "out"], &["report", "out"]];
    for other in others {
        let ran = scratch.run(other);
        assert_eq!(ran.code, Some(2), "{other:?}: {}", ran.stderr);
        let says = ["error: out: another deltazero is writing there", "--out"];
        assert!(says.iter().all(|what| ran.stderr.contains(what)), "{}", ran.stderr);
    }
    assert_eq!(scratch.files("out"), [""; 0]);
    // However it ends, the next one may write.
    run.kill();
    scratch.simulate("out", &["run.t_end=0.01"]);
}
