//! Sweeps: the same bytes whatever threads, shards and kills; what is refused; the page about them.

use std::fs;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::RowAccessor as _;

use crate::interrupt::Running;
use crate::{Scratch, committed};

/// 600 runs of some 0.1 ms.
const PLAN: &str = r#"
config = "base.toml"
chunk = 10

[[axis]]
key = "contact.stiffness"
log = [5e6, 2e7]
points = 3

[random]
samples = 200
seed = 3

[[random.key]]
key = "friction.coefficient"
uniform = [0.05, 0.2]
"#;

impl Scratch {
    /// With [`PLAN`] in it, its runs `t_end` seconds long.
    pub(crate) fn with_plan(t_end: f64) -> Self {
        let scratch = Self::new();
        fs::write(scratch.path("plan.toml"), PLAN).unwrap();
        let base = format!("run.t_end = {t_end}\nsolver.rtol = 1e-6\n");
        fs::write(scratch.path("base.toml"), base).unwrap();
        scratch
    }

    fn chunks(&self, dir: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path(dir).join("chunks")).into_iter().flatten().flatten();
        let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
        paths.retain(|path| path.extension().is_some_and(|end| end == "rows"));
        paths.sort();
        paths
    }
}

/// Starts a sweep of the plan into `out`.
fn start(scratch: &Scratch) -> Running {
    Running::start(scratch, &["sweep", "plan.toml", "--out", "out", "--threads", "2", "--quiet"])
}

#[test]
fn rows_are_the_same_for_one_thread_two_threads_and_seven_shards_in_any_order() {
    let scratch = Scratch::with_plan(0.1);
    let one = scratch.sweep("one", &["--threads", "1"]);
    assert_eq!(one.lines().count(), 601);
    assert_eq!(scratch.sweep("two", &["--threads", "2"]), one);
    for i in [5, 2, 7, 1, 6, 3] {
        let shard = format!("{i}/7");
        let ran = scratch.succeed(&["sweep", "plan.toml", "--out", "seven", "--shard", &shard]);
        assert!(ran.stdout.contains(&format!("shard {i} of 7:")), "{}", ran.stdout);
    }
    let merge = ["sweep", "plan.toml", "--out", "seven", "--merge"];
    let ran = scratch.run(&merge);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    for part in ["9 of 60 chunks are missing (runs 30 to 39, ", "with --shard 4/7\n"] {
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    assert!(!scratch.path("seven/runs.csv").exists());
    scratch.succeed(&["sweep", "plan.toml", "--out", "seven", "--shard", "4/7"]);
    scratch.succeed(&merge);
    assert_eq!(scratch.text("seven/runs.csv"), one);
    assert!(scratch.chunks("seven").is_empty());
    // What is done is not done again.
    let before = fs::metadata(scratch.path("one/runs.csv")).unwrap().modified().unwrap();
    let again = scratch.succeed(&["sweep", "plan.toml", "--out", "one"]);
    assert!(again.stdout.starts_with("600 runs: 600 ok, 0 failed"), "{}", again.stdout);
    assert_eq!(fs::metadata(scratch.path("one/runs.csv")).unwrap().modified().unwrap(), before);
}

#[test]
fn the_time_of_a_shard_is_that_of_all_its_commands() {
    let scratch = Scratch::with_plan(0.001);
    let shard = ["sweep", "plan.toml", "--out", "out", "--shard", "1/2", "--quiet"];
    scratch.succeed(&shard);
    let mut record = scratch.json("out/shards/1-of-2.json");
    record["wall_s"] = 1234.5.into();
    fs::write(scratch.path("out/shards/1-of-2.json"), record.to_string()).unwrap();
    scratch.succeed(&shard);
    let wall_s = scratch.json("out/shards/1-of-2.json")["wall_s"].as_f64().unwrap();
    assert!(wall_s > 1234.5, "{wall_s}");
}

#[test]
fn a_finished_sweep_gives_its_rows_by_column_too() {
    let scratch = Scratch::with_plan(0.02);
    scratch.sweep("out", &[]);
    let ran = scratch.succeed(&["sweep", "plan.toml", "--out", "out", "--parquet"]);
    assert!(ran.stderr.contains("runs.csv, runs.parquet, sweep.json"), "{}", ran.stderr);
    let file = fs::File::open(scratch.path("out/runs.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let text = fs::read_to_string(scratch.path("out/runs.csv")).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|column| *column == name).unwrap();
    for (row, line) in reader.get_row_iter(None).unwrap().zip(text.lines().skip(1)) {
        let (row, fields): (_, Vec<&str>) = (row.unwrap(), line.split(',').collect());
        assert_eq!(row.get_long(0).unwrap().to_string(), fields[0]);
        let column = at("friction.coefficient");
        assert_eq!(row.get_double(column).unwrap(), fields[column].parse::<f64>().unwrap());
        let column = at("n_events");
        assert_eq!(row.get_long(column).unwrap().to_string(), fields[column]);
        assert_eq!(row.get_string(at("status")).unwrap(), "ok");
    }
    let metadata = reader.metadata().file_metadata();
    assert_eq!(metadata.num_rows(), 600);
    let of_sweep = metadata.key_value_metadata().unwrap()[0].value.as_ref().unwrap();
    let of_sweep: serde_json::Value = serde_json::from_str(of_sweep).unwrap();
    assert_eq!(of_sweep["units"]["peak_force_n"], "N");
    assert_eq!(of_sweep["plan"]["axes"][0]["key"], "contact.stiffness");
}

#[test]
fn another_sweep_leaves_nothing_of_the_one_before_but_what_is_not_its_own() {
    let scratch = Scratch::with_plan(0.01);
    scratch.succeed(&["sweep", "plan.toml", "--out", "out", "--shard", "1/1", "--quiet"]);
    scratch.sweep("out", &["--merge", "--parquet"]);
    scratch.succeed(&["report", "out", "--y", "peak_force_n", "--quiet"]);
    let axes = ["--x", "contact.stiffness", "--y", "peak_force_n", "--color", "n_events"];
    scratch.succeed(&[&["plot", "out"][..], &axes].concat());
    fs::write(scratch.path("out/figures/mine.svg"), "mine").unwrap();
    let all = scratch.files("out");
    let colored = "figures/peak_force_n_over_contact.stiffness_by_n_events.png";
    for name in [colored, "runs.parquet", "shards/1-of-1.json", "sweep.html"] {
        assert!(all.iter().any(|own| own == name), "{name}: {all:?}");
    }
    fs::write(scratch.path("plan.toml"), PLAN.replace("seed = 3", "seed = 4")).unwrap();
    scratch.sweep("out", &["--force"]);
    assert_eq!(scratch.files("out"), ["figures/mine.svg", "runs.csv", "sweep.json"]);
}

#[test]
fn files_of_a_user_and_of_a_map_in_the_folder_of_chunks_stay() {
    let scratch = Scratch::with_plan(0.001);
    let map = deltazero::chunks::Chunks::new(&scratch.path("out"), "0123456789abcdef", 200, 1);
    let row = deltazero::chunks::Rows { text: "[]\n".to_owned(), n: 1, failed: 0 };
    map.write(100, &row).unwrap();
    fs::write(scratch.path("out/chunks/my_data.txt"), "mine").unwrap();
    for args in [&[][..], &[], &["--force"], &["--force", "--set", "run.t_end=0.002"]] {
        scratch.sweep("out", args);
        assert_eq!(scratch.text("out/chunks/my_data.txt"), "mine");
        assert_eq!(scratch.chunks("out"), [scratch.path("out/chunks/0000100.rows")], "{args:?}");
        assert_eq!(map.read(100).unwrap().as_ref(), Some(&row));
    }
}

#[test]
fn force_makes_a_finished_sweep_again() {
    let scratch = Scratch::with_plan(0.01);
    let whole = scratch.sweep("out", &[]);
    // Of the same length, so that the record does not tell.
    let torn = whole.replacen("\n1,", "\nx,", 1);
    fs::write(scratch.path("out/runs.csv"), &torn).unwrap();
    let ran = scratch.run(&["sweep", "plan.toml", "--out", "out", "--parquet"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let expected = "line 3, run: \"x\" is no whole number; make the sweep again with --force\n";
    assert!(ran.stderr.contains(expected), "{}", ran.stderr);
    assert_eq!(scratch.sweep("out", &["--force", "--parquet"]), whole);
    assert!(scratch.path("out/runs.parquet").exists());
}

#[test]
fn a_row_is_what_simulate_says_of_its_values() {
    let scratch = Scratch::with_plan(0.1);
    scratch.sweep("out", &[]);
    let table = scratch.table("out/runs.csv");
    for run in [0, 250, 599] {
        let row = &table.rows[run];
        let sets = ["contact.stiffness", "friction.coefficient"];
        let sets: Vec<String> = sets.iter().map(|key| format!("{key}={}", row[*key])).collect();
        let mut args = vec!["simulate", "base.toml", "--out", "single", "--force", "--no-horizon"];
        sets.iter().for_each(|set| args.extend(["--set", set]));
        scratch.succeed(&args);
        let single = scratch.json("single/run.json");
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        assert_eq!(single["counts"]["n_rhs"].to_string(), row["n_rhs"]);
        assert_eq!(single["counts"]["n_events"].to_string(), row["n_events"]);
        assert_eq!(single["energy"]["dissipated"].as_f64().unwrap(), number("dissipated_j"));
        let contacts = &single["contacts"][0];
        assert_eq!(contacts["peak_force_n"].as_f64().unwrap(), number("bay1_joint1_peak_force_n"));
        let trajectory = scratch.table("single/trajectory.csv");
        let last = trajectory.of_joint(2).pop().unwrap();
        assert_eq!(last["theta_rad"], row["bay1_joint2_theta_rad"]);
    }
}

#[test]
fn without_its_audit_a_row_is_the_same_but_for_contacts_and_energy() {
    let scratch = Scratch::with_plan(0.1);
    let whole = scratch.sweep("whole", &[]);
    fs::write(scratch.path("plan.toml"), format!("audit = false\n{PLAN}")).unwrap();
    let short = scratch.sweep("short", &[]);
    let rows = |text: &str| -> Vec<Vec<String>> {
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (whole, short) = (rows(&whole), rows(&short));
    let is_audited = |name: &str| {
        let told = ["n_contacts", "peak_force_n", "deepest_m", "impact_speed_m_s", "impulse_n_s"];
        let of_energy = ["work_j", "dissipated_j", "energy_residual_j"];
        told.iter().chain(&of_energy).any(|end| name.ends_with(end)) || name == "warnings"
    };
    let kept: Vec<usize> = (0..whole[0].len()).filter(|i| !is_audited(&whole[0][*i])).collect();
    // Five columns of each joint and of both are gone, and three of energy; `warnings` is empty.
    assert_eq!((whole[0].len() - short[0].len(), whole.len()), (3 * 5 + 3, short.len()));
    for (whole, short) in whole.iter().zip(&short) {
        let kept: Vec<_> = kept.iter().map(|i| &whole[*i]).collect();
        let own: Vec<_> = short[..short.len() - 1].iter().collect();
        assert_eq!(kept, own);
    }
}

#[test]
fn a_sweep_that_is_killed_again_and_again_ends_with_the_same_bytes() {
    let scratch = Scratch::with_plan(0.4);
    let whole = scratch.sweep("whole", &[]);
    for kill in 0..6 {
        // From before the first chunk to some hundred milliseconds into the work.
        let run = start(&scratch);
        run.until(&scratch.path("out"), Duration::from_millis(37 * kill));
        run.kill();
        if kill == 3 {
            // A chunk that is torn, and one of which a byte was altered.
            if let [first, .., last] = &scratch.chunks("out")[..] {
                let text = fs::read_to_string(first).unwrap();
                fs::write(first, &text[..text.len() / 2]).unwrap();
                let text = fs::read_to_string(last).unwrap();
                fs::write(last, text.replacen(",ok,", ",OK,", 1)).unwrap();
            }
        }
    }
    assert_eq!(scratch.sweep("out", &[]), whole);
    assert_eq!(scratch.files("out"), ["runs.csv", "sweep.json"]);
}

#[test]
fn torn_and_altered_chunks_are_made_again_and_merge_names_their_shard() {
    let scratch = Scratch::with_plan(0.1);
    let whole = scratch.sweep("whole", &[]);
    for i in ["1/2", "2/2"] {
        scratch.succeed(&["sweep", "plan.toml", "--out", "out", "--shard", i]);
    }
    let chunks = scratch.chunks("out");
    assert_eq!(chunks.len(), 60);
    let torn = fs::read(&chunks[3]).unwrap();
    fs::write(&chunks[3], &torn[..torn.len() - 1]).unwrap();
    let merge = ["sweep", "plan.toml", "--out", "out", "--merge"];
    let ran = scratch.run(&merge);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("1 of 60 chunks are missing (runs 30 to 39)"), "{}", ran.stderr);
    assert!(ran.stderr.contains("--shard 2/2"), "{}", ran.stderr);
    scratch.succeed(&["sweep", "plan.toml", "--out", "out", "--shard", "2/2"]);
    let altered = fs::read_to_string(&chunks[8]).unwrap();
    fs::write(&chunks[8], altered.replacen(",ok,", ",no,", 1)).unwrap();
    let ran = scratch.run(&merge);
    assert_eq!(ran.code, Some(2));
    for part in ["not as they were written", "runs 80 to 89", "--shard 1/2"] {
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    assert_eq!(scratch.sweep("out", &[]), whole);
}

#[test]
fn a_plan_that_differs_is_refused_by_what_differs() {
    let scratch = Scratch::with_plan(0.01);
    let whole = scratch.sweep("out", &[]);
    let refused = |what: &str| {
        let ran = scratch.run(&["sweep", "plan.toml", "--out", "out"]);
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        let expected = format!("out: holds a sweep of another {what}; name another directory");
        assert!(ran.stderr.contains(&expected), "{}", ran.stderr);
    };
    fs::write(scratch.path("plan.toml"), PLAN.replace("seed = 3", "seed = 4")).unwrap();
    refused("plan");
    fs::write(scratch.path("base.toml"), "run.t_end = 0.02\n").unwrap();
    refused("plan and configuration");
    assert_eq!(scratch.text("out/runs.csv"), whole);
    assert_ne!(scratch.sweep("out", &["--force"]), whole);
    let ran = scratch.run(&["simulate", "--out", "out"]);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
}

#[test]
fn a_sweep_of_a_build_that_rounds_otherwise_is_refused() {
    let scratch = Scratch::with_plan(0.01);
    scratch.sweep("out", &[]);
    let mut record = scratch.json("out/sweep.json");
    record["hash"] = "of the other build".into();
    record["build"] = match record["build"] {
        serde_json::Value::Null => "fused multiply-add".into(),
        _ => serde_json::Value::Null,
    };
    fs::write(scratch.path("out/sweep.json"), record.to_string()).unwrap();
    for shard in [&[][..], &["--shard", "1/2"]] {
        let ran = scratch.run(&[&["sweep", "plan.toml", "--out", "out"], shard].concat());
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        let expected = "a sweep of another build (one has fused multiply-add, the other has not";
        assert!(ran.stderr.contains(expected), "{}", ran.stderr);
    }
}

#[test]
fn an_interrupted_sweep_says_how_to_go_on() {
    let scratch = Scratch::with_plan(2.0);
    let run = start(&scratch);
    run.until(&scratch.path("out/sweep.json"), Duration::from_millis(200));
    let output = run.interrupt();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("the same command goes on"), "{stderr}");
    let left = scratch.files("out");
    assert!(!left.iter().any(|name| name.ends_with(".partial")), "{left:?}");
    assert_eq!(scratch.json("out/sweep.json")["finished"], false);
    let whole = scratch.sweep("whole", &[]);
    assert_eq!(scratch.sweep("out", &[]), whole);
}

#[test]
fn a_failed_run_is_a_row_and_strict_makes_it_exit_1() {
    let scratch = Scratch::new();
    let plan = "[[axis]]\nkey = \"study.max_rhs\"\nvalues = [100, 1_000_000]\n";
    fs::write(scratch.path("plan.toml"), plan).unwrap();
    let args = ["sweep", "plan.toml", "--out", "out", "--set", "run.t_end=0.05"];
    let ran = scratch.succeed(&args);
    assert!(ran.stdout.starts_with("2 runs: 1 ok, 1 failed\n  run 0: "), "{}", ran.stdout);
    assert!(ran.stdout.contains("more than study.max_rhs = 100"), "{}", ran.stdout);
    let ran = scratch.run(&[&args[..], &["--strict"]].concat());
    assert_eq!(ran.code, Some(1));
    assert!(ran.stderr.contains("1 run failed"), "{}", ran.stderr);
    let ran = scratch.succeed(&[&args[..], &["--json"]].concat());
    let record: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!((&record["ok"], &record["failed"]), (&1.into(), &1.into()));
}

#[test]
fn bad_usage_of_a_sweep_is_refused() {
    let scratch = Scratch::with_plan(0.01);
    for (args, part) in [
        (&["--shard", "0/3"][..], "1 ≤ I ≤ N"),
        (&["--shard", "4/3"], "1 ≤ I ≤ N"),
        (&["--shard", "1/3", "--merge"], "cannot be used with"),
        (&["--set", "contact.stifness=1"], "did you mean \"contact.stiffness\"?"),
    ] {
        let ran = scratch.run(&[&["sweep", "plan.toml", "--out", "out"], args].concat());
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    }
    let ran = scratch.run(&["sweep", "missing.toml"]);
    assert!(
        ran.code == Some(2) && ran.stderr.contains("missing.toml: cannot be read"),
        "{}",
        ran.stderr
    );
    assert!(!scratch.path("out").exists());
}

/// A look at each point would take minutes.
#[test]
fn an_axis_of_a_billion_points_is_read_or_refused_at_once() {
    let scratch = Scratch::new();
    let read = |key: &str, ends: &str| {
        let plan = format!("[[axis]]\nkey = \"{key}\"\nlinear = {ends}\npoints = 1_000_000_000\n");
        fs::write(scratch.path("plan.toml"), plan).unwrap();
        let out = ["sweep", "plan.toml", "--out", key, "--shard", "1000000/1000000"];
        let run = Running::start(&scratch, &[&out[..], &["--set", "run.t_end=1e-6"]].concat());
        run.ended()
    };
    for (key, ends) in [("solver.atol", "[1e-12, 1e-9]"), ("joint.clearance", "[0, 0]")] {
        let ended = read(key, ends);
        assert_eq!(ended.status.code(), Some(0), "{key}: {ended:?}");
    }
    let ended = read("study.max_rhs", "[5, 5]");
    let stderr = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{stderr}");
    assert!(
        stderr.contains("points = 1_000_000_000: a whole number from 2 to 1000000"),
        "{stderr}"
    );
}

#[test]
fn two_shards_write_into_one_directory_at_once_and_a_whole_sweep_does_not() {
    let scratch = Scratch::with_plan(2.0);
    let args = |shard| ["sweep", "plan.toml", "--out", "out", "--quiet", "--shard", shard];
    let one = Running::start(&scratch, &args("1/2"));
    one.until(&scratch.path("out/shards/1-of-2.json"), Duration::ZERO);
    let two = Running::start(&scratch, &args("2/2"));
    two.until(&scratch.path("out/shards/2-of-2.json"), Duration::ZERO);
    for other in [&args("1/2")[..], &["sweep", "plan.toml", "--out", "out"]] {
        let ran = scratch.run(other);
        assert_eq!(ran.code, Some(2), "{}", ran.stderr);
        assert!(ran.stderr.contains("another deltazero is writing there"), "{}", ran.stderr);
    }
    one.kill();
    two.kill();
}

#[test]
fn a_plan_of_ten_million_runs_starts_at_once_in_little_memory() {
    let scratch = Scratch::with_plan(0.001);
    let plan = PLAN.replace("samples = 200", "samples = 5_000_000").replace("chunk = 10\n", "");
    let plan = plan.replace("points = 3", "points = 2");
    fs::write(scratch.path("plan.toml"), plan).unwrap();
    let began = Instant::now();
    let run = start(&scratch);
    while scratch.chunks("out").len() < 2 {
        assert!(began.elapsed() < Duration::from_secs(60), "no chunk");
        sleep(Duration::from_millis(10));
    }
    if let Some(peak) = run.peak_memory() {
        // Measured: some 20 MB.
        assert!(peak < 200_000_000, "{peak} bytes");
    }
    run.kill();
    assert_eq!(scratch.json("out/sweep.json")["runs"], 10_000_000);
}

#[test]
fn the_plan_of_the_page_runs_and_the_page_names_its_columns() {
    let page = committed("docs/sweep.md");
    let plan = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let scratch = Scratch::new();
    fs::write(scratch.path("plan.toml"), plan).unwrap();
    let set = ["sweep", "plan.toml", "--out", "swept", "--set", "run.t_end=0.05"];
    let ran = scratch.succeed(&set);
    assert!(ran.stdout.starts_with("48 runs: 48 ok, 0 failed"), "{}", ran.stdout);
    let table = scratch.table("swept/runs.csv");
    assert_eq!(table.rows.len(), 48);
    let motion = ["d1_m", "d2_m", "theta_rad", "v1_m_s", "v2_m_s", "omega_rad_s", "f_n_n", "f_t_n"];
    for column in &table.header {
        let own = column.trim_start_matches("bay1_").trim_start_matches("joint1_");
        let own = own.trim_start_matches("joint2_");
        let is_named = page.contains(&format!("| `{own}` |"));
        let is_key = plan.contains(&format!("key = \"{column}\""));
        assert!(is_named || is_key || motion.contains(&own), "{column}");
    }
}
