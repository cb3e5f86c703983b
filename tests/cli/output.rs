//! Where results go, what is not overwritten, and streams that close early.

use std::fs;

use crate::{Scratch, with_sets};

const SHORT: &str = "run.t_end=0.01";

#[test]
fn results_of_another_configuration_are_overwritten_only_by_force() {
    let scratch = Scratch::new();
    scratch.simulate("out", &[SHORT]);
    scratch.simulate("out", &[SHORT]);
    let before = scratch.text("out/trajectory.csv");
    let other = with_sets(&["simulate", "--out", "out"], &[SHORT, "drive.m1=2"]);
    let ran = scratch.run(&other);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
    for part in ["out: ", "another configuration", "--force", "--out"] {
        assert!(ran.stderr.contains(part), "{}", ran.stderr);
    }
    assert!(scratch.text("out/trajectory.csv") == before);
    let study = scratch.run(&with_sets(&["study", "--out", "out"], &[SHORT]));
    assert_eq!(study.code, Some(2), "another command is another configuration");
    scratch.succeed(&[&other[..], &["--force"]].concat());
    assert!(scratch.text("out/trajectory.csv") != before);
    scratch.succeed(&other);
}

#[test]
fn threads_are_no_part_of_what_results_are_of() {
    let scratch = Scratch::new();
    scratch.simulate("out", &[SHORT]);
    scratch.simulate("out", &[SHORT, "study.threads=2", "regimes.threads=1"]);
}

#[test]
fn a_command_forced_into_the_directory_of_another_is_at_home_there_afterwards() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("out")).unwrap();
    fs::write(scratch.path("out/study.json"), "{\"hash\": \"0\"}").unwrap();
    let args = with_sets(&["simulate", "--out", "out"], &[SHORT]);
    assert_eq!(scratch.run(&args).code, Some(2));
    scratch.succeed(&[&args[..], &["--force"]].concat());
    scratch.succeed(&args);
    assert_eq!(scratch.text("out/study.json"), "{\"hash\": \"0\"}");
}

#[test]
fn results_that_cannot_be_read_are_not_overwritten() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("out")).unwrap();
    fs::write(scratch.path("out/run.json"), "{ half a fi").unwrap();
    let ran = scratch.run(&with_sets(&["simulate", "--out", "out"], &[SHORT]));
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    assert_eq!(scratch.text("out/run.json"), "{ half a fi");
}

#[test]
fn files_that_are_no_results_are_left_alone() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("out")).unwrap();
    fs::write(scratch.path("out/notes.txt"), "mine").unwrap();
    scratch.simulate("out", &[SHORT]);
    assert_eq!(scratch.files("out"), ["events.csv", "notes.txt", "run.json", "trajectory.csv"]);
    assert_eq!(scratch.text("out/notes.txt"), "mine");
}

#[test]
fn a_place_that_can_hold_no_results_is_refused_by_name() {
    let scratch = Scratch::new();
    fs::write(scratch.path("file"), "mine").unwrap();
    for dir in ["file", "file/below", "file/further/below", ""] {
        for command in ["simulate", "study"] {
            let ran = scratch.run(&with_sets(&[command, "--out", dir], &[SHORT]));
            assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{dir:?}");
            assert!(ran.stderr.contains(dir), "{}", ran.stderr);
        }
    }
    assert_eq!(scratch.text("file"), "mine");
}

#[test]
fn quiet_says_nothing_and_still_prints_the_result() {
    let scratch = Scratch::new();
    let ran = scratch.succeed(&["simulate", "--quiet", "--set", SHORT]);
    assert_eq!(ran.stderr, "");
    assert!(ran.stdout.starts_with("finished: "), "{}", ran.stdout);
}

/// The exit code and standard error with a standard output that nobody reads.
fn unread(scratch: &Scratch, args: &[&str]) -> (Option<i32>, String) {
    let mut child = scratch.command(args).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_closed_standard_output_is_no_error() {
    let scratch = Scratch::new();
    for args in [&["config"][..], &["config", "--schema"], &["methods"], &["--help"]] {
        assert_eq!(unread(&scratch, args), (Some(0), String::new()), "{args:?}");
    }
    let args = ["simulate", "--json", "--quiet", "--set", SHORT];
    assert_eq!(unread(&scratch, &args), (Some(0), String::new()));
    assert_eq!(scratch.json("deltazero-out/simulate/run.json")["outcome"], "finished");
}

#[test]
fn a_closed_standard_output_hides_no_failure() {
    let scratch = Scratch::new();
    let sets = ["solver.method=rk4", "solver.step=0.01", "run.t_end=0.3"];
    let (code, stderr) = unread(&scratch, &with_sets(&["simulate", "--quiet"], &sets));
    assert_eq!(code, Some(1));
    assert!(stderr.contains("smaller step"), "{stderr}");
}
