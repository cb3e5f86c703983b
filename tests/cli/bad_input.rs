//! Bad usage and bad configurations: exit 2, and a message that leads out.

use std::fs;

use crate::Scratch;

/// It is refused before anything is done; the message has all of `parts`.
fn refused(scratch: &Scratch, args: &[&str], parts: &[&str]) {
    for command in ["simulate", "study", "regimes"] {
        let ran = scratch.run(&[&[command, "--out", "out"], args].concat());
        assert_eq!(ran.code, Some(2), "{command} {args:?}: {}", ran.stderr);
        assert_eq!(ran.stdout, "");
        for part in parts {
            assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
        }
        assert!(!scratch.path("out").exists(), "{command} {args:?}");
    }
}

#[test]
fn a_bad_file_is_refused_with_file_line_key_value_and_a_way_out() {
    // The text, its bad line, and what the message says.
    let cases: [(&str, usize, &[&str]); 16] = [
        (
            "[contact]\nstifness = 1e7\n",
            2,
            &["contact.stifness", "did you mean \"contact.stiffness\"?"],
        ),
        (
            "[contact]\nstiffness = \"stiff\"\n",
            2,
            &["contact.stiffness = \"stiff\"", "expected a number"],
        ),
        ("\n\ncontact.stiffness = nan\n", 3, &["contact.stiffness = nan", "greater than 0"]),
        ("drive.m1 = inf\n", 1, &["drive.m1 = inf", "finite"]),
        ("drive.m1 = 1e999\n", 1, &["drive.m1 = 1e999", "finite"]),
        ("[contact]\nstiffness = -1e7\n", 2, &["contact.stiffness = -1e7", "greater than 0"]),
        ("[joint]\nclearance = -1e-4\n", 2, &["joint.clearance = -1e-4", "at least 0"]),
        ("[strut]\nlength = 0\n", 2, &["strut.length = 0", "greater than 0"]),
        ("[run]\nt_end = -2\n", 2, &["run.t_end = -2", "greater than 0"]),
        ("[solver]\nstep = 0.0\n", 2, &["solver.step = 0.0", "greater than 0"]),
        ("[solver]\nrtol = 1e-15\n", 2, &["solver.rtol = 1e-15", "from 1e-14 to 0.1"]),
        ("[solver]\nrtol = 0.2\n", 2, &["solver.rtol = 0.2", "from 1e-14 to 0.1"]),
        ("[solver]\nmethod = \"rk46\"\n", 2, &["solver.method = \"rk46\"", "did you mean \"rk4"]),
        ("[run]\nsample = 1e-12\n", 2, &["run.sample = 1e-12", "raise run.sample"]),
        ("[run\n", 1, &["expected `]`"]),
        ("a = 1\na = 2\n", 2, &["a stands here a second time"]),
    ];
    let scratch = Scratch::new();
    for (text, line, parts) in cases {
        fs::write(scratch.path("bad.toml"), text).unwrap();
        let place = format!("bad.toml:{line}: ");
        refused(&scratch, &["bad.toml"], &[&[place.as_str()], parts].concat());
    }
}

#[test]
fn a_bad_argument_of_set_is_refused_by_its_own_text() {
    let scratch = Scratch::new();
    let cases: [(&str, &[&str]); 8] = [
        (
            "contact.stifness=1",
            &["--set contact.stifness=1", "did you mean \"contact.stiffness\"?"],
        ),
        ("joint2.contact.damping=-1", &["joint2.contact.damping = -1", "at least 0"]),
        ("joint2.strut.length=1", &["joint2.strut.length", "cannot differ for one joint"]),
        ("reading=pinned", &["reading = \"pinned\"", "pin, full"]),
        ("run.sample=1e-7", &["4.0e7 rows", "8.0e9 bytes", "raise run.sample above 8.00e-7 s"]),
        ("bays=1000000", &["bays = 1000000 is out of range: from 1 to 2000"]),
        ("contact.stiffness", &["expected key=value"]),
        ("run.t_end=", &["expected key=value"]),
    ];
    for (set, parts) in cases {
        refused(&scratch, &["--set", set], parts);
    }
}

#[test]
fn a_file_that_cannot_be_read_is_refused_by_name() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path("dir.toml")).unwrap();
    fs::write(scratch.path("latin1.toml"), b"# comment\n# caf\xe9\n").unwrap();
    refused(&scratch, &["missing.toml"], &["missing.toml: cannot be read"]);
    refused(&scratch, &["dir.toml"], &["dir.toml: cannot be read"]);
    refused(&scratch, &["latin1.toml"], &["latin1.toml:2: ", "not UTF-8"]);
}

#[test]
fn bad_usage_is_refused() {
    let scratch = Scratch::new();
    refused(&scratch, &["--bogus"], &["--bogus", "--help"]);
    refused(&scratch, &["a.toml", "b.toml"], &["b.toml"]);
    let ran = scratch.run(&["study", "--threads", "0"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("1..=1024"), "{}", ran.stderr);
}

#[test]
fn a_misspelt_or_misplaced_command_is_met_with_the_list_of_commands() {
    let scratch = Scratch::new();
    for args in [&["simulte"][..], &["--quiet", "simulate"]] {
        let ran = scratch.run(args);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
        assert!(ran.stderr.contains("a command (study, simulate,"), "{}", ran.stderr);
    }
    assert!(scratch.files(".").is_empty());
}

#[test]
fn several_bays_are_refused_where_one_is_meant() {
    let scratch = Scratch::new();
    for (set, named) in [("bays=3", "bays = 3"), ("friction.law=lugre", "friction.law = lugre")] {
        let ran = scratch.run(&["audit", "--set", set]);
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        let expected = format!("{named}: an audit takes one bay");
        assert!(ran.stderr.contains(&expected), "{}", ran.stderr);
    }
    let set = |set| ["--set", "bays=3", "--set", set];
    refused(&scratch, &set("reading=full"), &["reading = full", "sticks of neighbours"]);
    refused(&scratch, &set("joint.clearance=0"), &["joint.clearance = 0", "above zero"]);
    refused(&scratch, &set("regimes.readings=[\"full\"]"), &["regimes.readings", "[\"pin\"]"]);
    refused(&scratch, &set("study.reference=extended"), &["study.reference = extended", "double"]);
    refused(
        &scratch,
        &set("solver.events=blind"),
        &["solver.events asks for blind runs", "one bay"],
    );
}
