//! A disk without room: a message that says so and where, nothing torn, and the same command goes on once there is room. What
//! takes longer stands in `tests/faults/run`.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::Scratch;

/// A disk in memory, mounted on a folder.
struct Disk(PathBuf);

impl Disk {
    /// None where this user may not mount one.
    fn of(scratch: &Scratch, kilobytes: u32) -> Option<Self> {
        let disk = Self(scratch.path("disk"));
        fs::create_dir(&disk.0).unwrap();
        disk.mount(&format!("size={kilobytes}k")).then_some(disk)
    }

    fn mount(&self, options: &str) -> bool {
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "deltazero"])
            .arg(&self.0)
            .output();
        mount.is_ok_and(|output| output.status.success())
    }

    fn grow(&self, kilobytes: u32) {
        assert!(self.mount(&format!("remount,size={kilobytes}k")));
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// Runs a command into `disk/out`, which has room for more of it each time, until it comes to its end; how often it was refused.
fn refusals(scratch: &Scratch, disk: &Disk, args: &[&str]) -> u32 {
    let mut n = 0;
    loop {
        let ran = scratch.run(&[args, &["--out", "disk/out"]].concat());
        if ran.code == Some(0) {
            return n;
        }
        assert!(matches!(ran.code, Some(1 | 2)), "{:?}: {}", ran.code, ran.stderr);
        for part in ["error: ", "disk/out", "No space left on device"] {
            assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
        }
        if scratch.path("disk/out").exists() {
            let left = scratch.files("disk/out");
            assert!(!left.iter().any(|name| name.ends_with(".partial")), "{left:?}");
        }
        n += 1;
        disk.grow(16 * (n + 1));
    }
}

#[test]
fn a_sweep_on_a_full_disk_says_so_and_goes_on_once_there_is_room() {
    let scratch = Scratch::with_plan(0.02);
    let Some(disk) = Disk::of(&scratch, 16) else { return };
    let whole = scratch.sweep("whole", &["--parquet"]);
    let refused = refusals(&scratch, &disk, &["sweep", "plan.toml", "--parquet"]);
    // Chunks, their join, the record and the rows by column each want room.
    assert!(refused > 5, "{refused}");
    assert_eq!(scratch.text("disk/out/runs.csv"), whole);
    for name in ["runs.csv", "runs.parquet"] {
        let [own, other] = ["disk/out", "whole"].map(|dir| scratch.path(dir).join(name));
        assert_eq!(fs::read(own).unwrap(), fs::read(other).unwrap(), "{name}");
    }
}

#[test]
fn a_simulation_on_a_full_disk_leaves_no_file_that_is_torn() {
    let scratch = Scratch::new();
    let Some(disk) = Disk::of(&scratch, 16) else { return };
    scratch.simulate("whole", &["run.t_end=0.5"]);
    let args = ["simulate", "--no-horizon", "--set", "run.t_end=0.5"];
    assert!(refusals(&scratch, &disk, &args) > 0);
    for name in ["trajectory.csv", "events.csv"] {
        assert_eq!(
            scratch.text(&format!("disk/out/{name}")),
            scratch.text(&format!("whole/{name}"))
        );
    }
}
