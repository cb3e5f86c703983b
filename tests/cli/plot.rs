//! Figures of a sweep: which one columns make, its files, what is refused; Sobol indices.

use std::fs;

use crate::{Ran, Scratch};

/// 72 runs, of which the 24 of the last value of `study.max_rhs` do not come to their end.
const PLAN: &str = r#"
[[axis]]
key = "contact.stiffness"
log = [5e6, 2e7]
points = 3

[[axis]]
key = "friction.law"
values = ["coulomb", "stribeck"]

[[axis]]
key = "study.max_rhs"
values = [1_000_000, 2_000_000, 10]

[random]
samples = 4
seed = 3

[[random.key]]
key = "friction.coefficient"
uniform = [0.05, 0.2]
"#;

/// 64 samples of two keys.
const SALTELLI: &str = r#"
[random]
samples = 64
sampling = "saltelli"

[[random.key]]
key = "friction.coefficient"
uniform = [0.05, 0.2]

[[random.key]]
key = "drive.m1"
log_uniform = [0.5, 2]
"#;

/// What keeps a sweep short.
pub(crate) const SETS: [&str; 5] =
    ["--set", "run.t_end=0.05", "--set", "solver.rtol=1e-6", "--quiet"];

impl Scratch {
    /// With a finished sweep of a plan in `out`.
    pub(crate) fn with_sweep(plan: &str) -> Self {
        let scratch = Self::new();
        fs::write(scratch.path("plan.toml"), plan).unwrap();
        scratch.sweep("out", &SETS);
        scratch
    }

    fn plot(&self, args: &[&str]) -> Ran {
        self.run(&[&["plot", "out"], args].concat())
    }
}

#[test]
fn a_distribution_counts_runs_without_a_value_once() {
    let scratch = Scratch::with_sweep(
        "[[axis]]\nkey = \"joint.clearance\"\nvalues = [1e-4, 0.0]\n\
         [random]\nsamples = 4\n\
         [[random.key]]\nkey = \"drive.m1\"\nuniform = [0.5, 2]\n",
    );
    // An ideal joint has no contact.
    let ran = scratch.plot(&["--x", "peak_force_n"]);
    let caption = "Shown: 4 runs; left out: 4 that have no value to show.";
    assert!(ran.stdout.contains(caption), "{}{}", ran.stdout, ran.stderr);
    assert!(!ran.stdout.contains("no such number"), "{}", ran.stdout);
}

#[test]
fn few_whole_numbers_have_a_histogram_at_their_own_distances() {
    let scratch = Scratch::with_sweep("[[axis]]\nkey = \"bays\"\nvalues = [1, 2, 4]\n");
    let ran = scratch.plot(&["--x", "bays"]);
    assert!(ran.stdout.contains(", median 2, "), "{}{}", ran.stdout, ran.stderr);
    let svg = scratch.text("out/figures/bays.svg");
    assert!(svg.contains("\n3.0\n"), "no tick between 2 and 4");
}

#[test]
fn a_value_that_no_axis_shows_is_neither_drawn_nor_counted() {
    let plan = "model = \"stop.toml\"\n[[axis]]\nkey = \"zeta\"\nvalues = [0.01, 0.05, 0.2]\n";
    let scratch = Scratch::with_model_and_plan("mass_against_stop", plan);
    let large = "large = { value = \"1e301*zeta\", observe = true }\n\n[states]";
    let model = scratch.text("stop.toml").replacen("\n[states]", large, 1);
    fs::write(scratch.path("stop.toml"), model).unwrap();
    scratch.sweep("out", &["--set", "run.t_end=0.02", "--quiet"]);
    let ran = scratch.plot(&["--x", "zeta", "--y", "large"]);
    let caption = "from 1e299 at the first to 5e299 at the last. \
                   Shown: 2 runs; left out: 1 that have no value to show.";
    assert!(ran.stdout.contains(caption), "{}{}", ran.stdout, ran.stderr);
}

#[test]
fn columns_make_the_figure_that_they_ask_for() {
    let scratch = Scratch::with_sweep(PLAN);
    let [stiffness, law, force] = ["contact.stiffness", "friction.law", "peak_force_n"];
    for (args, kind, file) in [
        (
            &["--x", stiffness, "--y", law, "--color", force][..],
            "heat map",
            "friction.law_over_contact.stiffness_by_peak_force_n",
        ),
        (
            &["--x", stiffness, "--y", force, "--color", law],
            "lines",
            "peak_force_n_over_contact.stiffness_by_friction.law",
        ),
        (&["--x", law, "--y", force], "lines", "peak_force_n_over_friction.law"),
        (&["--x", force], "distribution", "peak_force_n"),
        (&["--x", law], "distribution", "friction.law"),
        (&["--x", force, "--color", law], "distribution", "peak_force_n_by_friction.law"),
        (&["--x", force, "--y", "n_rhs"], "scatter", "n_rhs_over_peak_force_n"),
        (
            &["--x", stiffness, "--y", force, "--color", "friction.coefficient"],
            "scatter",
            "peak_force_n_over_contact.stiffness_by_friction.coefficient",
        ),
    ] {
        let ran = scratch.plot(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.starts_with(&format!("{kind} written: ")), "{}", ran.stderr);
        let left_out = "Shown: 48 runs; left out: 24 that failed.";
        assert!(ran.stdout.contains(left_out), "{}", ran.stdout);
        let svg = scratch.text(&format!("out/figures/{file}.svg"));
        let png = fs::read(scratch.path(&format!("out/figures/{file}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"));
        if args.contains(&force) {
            assert!(svg.contains("peak_force_n [N]"), "no unit in {file}.svg");
        }
        let again = [args, &["--out", "again", "--quiet"]].concat();
        assert_eq!(scratch.plot(&again).stderr, "");
        assert_eq!(scratch.text("again.svg"), svg);
        assert_eq!(fs::read(scratch.path("again.png")).unwrap(), png);
    }
    for out in ["s3/", "s3/."] {
        assert_eq!(scratch.plot(&["--x", force, "--out", out]).code, Some(0));
        assert_eq!(scratch.files("s3"), ["peak_force_n.png", "peak_force_n.svg"], "{out}");
        fs::remove_dir_all(scratch.path("s3")).unwrap();
    }
    let left: Vec<String> = scratch.files("out");
    assert!(!left.iter().any(|name| name.ends_with(".partial")), "{left:?}");
}

#[test]
fn what_cannot_be_drawn_is_refused_with_a_way_out() {
    let scratch = Scratch::with_sweep(PLAN);
    for (args, part) in [
        (
            &["--x", "peak_force"][..],
            "no column \"peak_force\", did you mean \"peak_force_n\"?; it has run, ",
        ),
        (&["--x", "contact.stiffness", "--y", "friction.law"], "with --color"),
        (&["--x", "n_rhs", "--color", "friction.coefficient"], "too many values to tell apart"),
        (&["--x", "largest_impact_speed_m_s"], "no run has a value to show in each of"),
        (
            &["--x", "n_rhs", "--y", "peak_force_n", "--color", "largest_impact_speed_m_s"],
            "no run has a value to show in each of n_rhs, peak_force_n, largest_impact_speed_m_s",
        ),
        (&["--sobol", "peak_force_n"], "sampling = \"saltelli\""),
        (&["--sobol", "n_rhs", "--x", "n_rhs"], "cannot be used with"),
        (&["--y", "n_rhs"], "--x"),
    ] {
        let ran = scratch.plot(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    assert!(!scratch.path("out/figures").exists());
    let ran = scratch.run(&["plot", "nowhere", "--x", "n_rhs"]);
    assert!(
        ran.code == Some(2) && ran.stderr.contains("name the DIR of a sweep"),
        "{}",
        ran.stderr
    );
    fs::write(scratch.path("file"), "").unwrap();
    let ran = scratch.plot(&["--x", "n_rhs", "--out", "file/figure"]);
    assert!(ran.code == Some(1) && ran.stderr.contains("cannot write"), "{}", ran.stderr);
    let record = scratch.text("out/sweep.json");
    fs::write(
        scratch.path("out/sweep.json"),
        record.replace("\"finished\": true", "\"finished\": false"),
    )
    .unwrap();
    let ran = scratch.plot(&["--x", "n_rhs"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("is not finished"), "{}", ran.stderr);
    let rows = scratch.text("out/runs.csv");
    fs::write(scratch.path("out/sweep.json"), record).unwrap();
    fs::write(scratch.path("out/runs.csv"), rows + "72,1e7\n").unwrap();
    let ran = scratch.plot(&["--x", "n_rhs"]);
    assert!(ran.code == Some(1) && ran.stderr.contains("runs.csv:74: "), "{}", ran.stderr);
}

#[test]
fn sobol_indices_of_a_key_are_its_own() {
    let scratch = Scratch::with_sweep(SALTELLI);
    assert_eq!(scratch.table("out/runs.csv").rows.len(), 64 * 4);
    let ran = scratch.plot(&["--sobol", "drive.m1", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let record: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let point = &record["sobol"]["points"][0];
    assert_eq!((&point["samples"], &point["left_out"]), (&64.into(), &0.into()));
    let index = |key: usize, of: &str| point["keys"][key][of]["value"].as_f64().unwrap();
    // The key itself as a column: it alone explains all of it. Measured: 0.992 and 0.990.
    assert_eq!((index(0, "main"), index(0, "total")), (0.0, 0.0));
    assert!((index(1, "main") - 1.0).abs() < 0.1, "{point}");
    assert!((index(1, "total") - 1.0).abs() < 0.1, "{point}");
    let ran = scratch.plot(&["--sobol", "work_j"]);
    assert!(ran.stdout.contains("| friction.coefficient | "), "{}", ran.stdout);
    assert!(scratch.text("out/figures/sobol_of_work_j.svg").contains("part of the variance"));
    for (column, part) in
        [("outcome", "holds words"), ("status", "holds words"), ("bays", "no column")]
    {
        let ran = scratch.plot(&["--sobol", column]);
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    let ran = scratch.plot(&["--sobol", "bay1_joint1_t_s"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("it does not vary"), "{}", ran.stderr);
}

#[test]
fn a_grid_point_without_sobol_indices_is_told_with_its_reason() {
    let plan = "[[axis]]\nkey = \"study.max_rhs\"\nvalues = [1_000_000, 10]\n".to_owned();
    let scratch = Scratch::with_sweep(&(plan + &SALTELLI.replace("= 64", "= 8")));
    let gap = "No indices at 1 of 2 grid points: study.max_rhs = 10 (0 whole samples of 8 needed).";
    let ran = scratch.plot(&["--sobol", "work_j"]);
    let (table, caption) = ran.stdout.split_once("\nMain and total").unwrap();
    for text in [table, caption] {
        assert!(text.contains(gap), "{}{}", ran.stdout, ran.stderr);
    }
    let left_out = "left out for want of a value: 8 samples (32 runs failed)";
    assert!(caption.contains(left_out), "{caption}");
    scratch.succeed(&["report", "out", "--y", "work_j", "--quiet"]);
    let page = scratch.text("out/sweep.html");
    assert_eq!(page.matches("(0 whole samples of 8 needed)").count(), 2, "{page}");
}
