//! Sweeps of models from files: rows, the same bytes, what is refused, a file that is gone.

use std::fs;

use crate::{Scratch, committed, number};

/// 24 runs.
const PLAN: &str = r#"
model = "stop.toml"
chunk = 3

[[axis]]
key = "K"
log = [1e5, 1e7]
points = 3

[[axis]]
key = "solver.method"
values = ["rk45", "dop853"]

[random]
samples = 4
seed = 3

[[random.key]]
key = "parameters.zeta"
uniform = [0.02, 0.3]
"#;

impl Scratch {
    /// With `text` as the plan and a model of the program as `stop.toml`.
    pub(crate) fn with_model_and_plan(model: &str, text: &str) -> Self {
        let scratch = Self::new();
        let model = scratch.succeed(&["model", "new", model]).stdout;
        fs::write(scratch.path("stop.toml"), model).unwrap();
        fs::write(scratch.path("plan.toml"), text).unwrap();
        scratch
    }

    /// The message with which a plan is refused.
    fn refused(&self, plan: &str) -> String {
        fs::write(self.path("plan.toml"), plan).unwrap();
        let ran = self.run(&["sweep", "plan.toml", "--out", "refused"]);
        assert_eq!(ran.code, Some(2), "{plan}: {}", ran.stderr);
        assert!(!self.path("refused").exists());
        ran.stderr
    }
}

#[test]
fn an_observable_with_the_name_of_a_result_leaves_it_that_name() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", PLAN);
    let own = "n_rhs = { value = \"0*x/x_0\", observe = true }\n\n[states]";
    let model = scratch.text("stop.toml").replacen("\n[states]", own, 1);
    fs::write(scratch.path("stop.toml"), model).unwrap();
    scratch.sweep("out", &["--set", "run.t_end=0.02"]);
    for row in scratch.table("out/runs.csv").rows {
        assert!(number(&row, "n_rhs") > 0.0 && number(&row, "n_rhs_2") == 0.0, "{row:?}");
    }
}

#[test]
fn a_row_of_a_model_is_what_simulate_says_of_its_values() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", PLAN);
    scratch.sweep("out", &["--set", "solver.rtol=1e-8"]);
    let table = scratch.table("out/runs.csv");
    assert_eq!(table.rows.len(), 24);
    let head = ["run", "K", "solver.method", "zeta", "status", "outcome", "t_s", "mode", "x_m"];
    assert_eq!(table.header[..9], head);
    let json = |name: &str| scratch.json(name);
    for run in [0, 13, 23] {
        let row = &table.rows[run];
        let mut args = vec!["simulate", "--model", "stop.toml", "--out", "single", "--force"];
        args.extend(["--no-horizon", "--set", "solver.rtol=1e-8"]);
        let sets = ["K", "solver.method", "zeta"].map(|key| format!("{key}={}", row[key]));
        sets.iter().for_each(|set| args.extend(["--set", set]));
        scratch.succeed(&args);
        let single = json("single/run.json");
        assert_eq!(single["counts"]["n_rhs"].to_string(), row["n_rhs"]);
        assert_eq!(single["counts"]["n_events"].to_string(), row["n_events"]);
        assert_eq!(single["energy"]["dissipated"].as_f64().unwrap(), number(row, "dissipated_j"));
        let contacts = &single["contacts"][0];
        assert_eq!(contacts["peak_force_n"].as_f64().unwrap(), number(row, "peak_force_n"));
        let trajectory = scratch.table("single/trajectory.csv");
        let last = trajectory.rows.last().unwrap();
        for column in ["x_m", "v_m_s", "F_n"] {
            assert_eq!(last[column], row[column], "{column}");
        }
    }
}

#[test]
fn rows_of_a_model_are_the_same_for_one_thread_two_threads_and_shards() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", PLAN);
    let one = scratch.sweep("one", &["--threads", "1"]);
    assert_eq!(one.lines().filter(|line| line.contains(",ok,")).count(), 24);
    assert_eq!(scratch.sweep("two", &["--threads", "2"]), one);
    // The same model by the command line, from another folder; a setting of it is no other model.
    fs::create_dir(scratch.path("models")).unwrap();
    fs::copy(scratch.path("stop.toml"), scratch.path("models/stop.toml")).unwrap();
    let plan = PLAN.replacen("model = \"stop.toml\"\n", "", 1);
    fs::write(scratch.path("plan.toml"), plan).unwrap();
    for i in ["3/3", "1/3", "2/3"] {
        let args = ["sweep", "plan.toml", "--model", "models/stop.toml", "--out", "three"];
        scratch.succeed(&[&args[..], &["--shard", i]].concat());
    }
    let [one_hash, three_hash] =
        ["one", "three"].map(|dir| scratch.json(&format!("{dir}/sweep.json"))["hash"].clone());
    assert_eq!(one_hash, three_hash);
    assert_eq!(scratch.sweep("three", &["--model", "models/stop.toml", "--merge"]), one);
}

#[test]
fn a_sweep_goes_on_without_the_file_of_its_model_and_another_model_is_refused() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", PLAN);
    let whole = scratch.sweep("whole", &[]);
    let shard = |i| scratch.succeed(&["sweep", "plan.toml", "--out", "out", "--shard", i]);
    shard("1/2");
    let model = scratch.text("stop.toml");
    assert_eq!(scratch.json("out/sweep.json")["config"]["model"]["text"], model.as_str());
    fs::write(scratch.path("stop.toml"), model.replacen("9.81", "9.80", 1)).unwrap();
    let ran = scratch.run(&["sweep", "plan.toml", "--out", "out", "--shard", "2/2"]);
    assert_eq!(ran.code, Some(2));
    let another = "out: holds a sweep of another model and configuration; name another directory";
    assert!(ran.stderr.contains(another), "{}", ran.stderr);
    fs::remove_file(scratch.path("stop.toml")).unwrap();
    shard("2/2");
    assert_eq!(scratch.sweep("out", &["--merge"]), whole);
    let ran = scratch.run(&["sweep", "plan.toml", "--out", "elsewhere"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("stop.toml: cannot be read"), "{}", ran.stderr);
}

#[test]
fn a_plan_that_does_not_go_with_its_model_is_refused_with_its_place() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", PLAN);
    let model = "model = \"stop.toml\"\n";
    for (plan, words) in [
        ("[[axis]]\nkey = \"K\"\nvalues = [1e6, 0]\n", &["plan.toml:4: K = 0 is out of range"][..]),
        ("[[axis]]\nkey = \"zeta\"\nlinear = [0, 1]\npoints = 3\n", &["plan.toml:4: zeta = 1 is"]),
        ("[[axis]]\nkey = \"zetta\"\nvalues = [0.1]\n", &["plan.toml:3: ", "mean \"zeta\""]),
        ("[[axis]]\nkey = \"bays\"\nvalues = [1]\n", &["plan.toml:3: ", "neither a parameter"]),
        (
            "[[axis]]\nkey = \"K\"\nvalues = [1e6]\n[[axis]]\nkey = \"parameters.K\"\nvalues = [1]\n",
            &["plan.toml:6: ", "swept already, at plan.toml:3"],
        ),
        (
            "[random]\nsamples = 2\n[[random.key]]\nkey = \"m\"\nuniform = [0, 1]\n",
            &["plan.toml:6: m = 0 is out of range"],
        ),
        (
            "[random]\nsamples = 2\n[[random.key]]\nkey = \"m\"\nnormal = [-1, 1]\n",
            &["plan.toml:6: m = -1 is out of range"],
        ),
    ] {
        let said = scratch.refused(&format!("{model}{plan}"));
        for word in words {
            assert!(said.contains(word), "no {word:?} in: {said}");
        }
    }
    let axis = "[[axis]]\nkey = \"K\"\nvalues = [1e6]\n";
    fs::write(scratch.path("plan.toml"), format!("{model}{axis}")).unwrap();
    for set in ["K=2e6", "parameters.K=2e6"] {
        let ran = scratch.run(&["sweep", "plan.toml", "--out", "refused", "--set", set]);
        let told = format!("plan.toml:3: K cannot be swept: --set {set} gives it");
        assert!(ran.code == Some(2) && ran.stderr.contains(&told), "{}", ran.stderr);
    }
    let said = scratch.refused(&format!("model = \"none.toml\"\n{axis}"));
    assert!(said.contains("none.toml: cannot be read"), "{said}");
    fs::write(scratch.path("stop.toml"), scratch.text("stop.toml").replacen("K*x", "k*x", 1))
        .unwrap();
    let said = scratch.refused(&format!("{model}{axis}"));
    assert!(said.contains("`k`") && said.contains("stop.toml:16:"), "{said}");
}

#[test]
fn lengths_of_vectors_and_the_end_of_the_runs_are_swept() {
    let plan = "[[axis]]\nkey = \"n\"\nvalues = [2, 3, 2.5]\n\
                [[axis]]\nkey = \"run.t_end\"\nvalues = [0.1, 0.2]\n";
    let scratch = Scratch::with_model_and_plan("carts", plan);
    scratch.sweep("out", &["--model", "stop.toml"]);
    let table = scratch.table("out/runs.csv");
    let t_end: Vec<f64> = table.rows[..4].iter().map(|row| number(row, "t_s")).collect();
    assert_eq!(t_end, [0.1, 0.2, 0.1, 0.2]);
    for (row, is_long) in table.rows[..4].iter().zip([false, false, true, true]) {
        assert_eq!(row["status"], "ok");
        let has = ["x[3]_m", "x[2]_m"].map(|column| !row[column].is_empty());
        assert_eq!(has, [is_long, true], "{row:?}");
    }
    for row in &table.rows[4..] {
        assert!(row["status"].contains("stop.toml:") && row["status"].contains("2.5"), "{row:?}");
    }
    let drawn = "model = \"stop.toml\"\n[random]\nsamples = 2\n[[random.key]]\nkey = \"n\"\nuniform = [2, 9]\n";
    let said = scratch.refused(drawn);
    assert!(said.contains("plan.toml:6: ") && said.contains("length of a vector"), "{said}");
}

#[test]
fn the_plan_of_the_page_over_a_model_runs() {
    let page = committed("docs/sweep.md");
    let plans = page.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
    let plan = plans.into_iter().find(|plan| plan.contains("model = \"stop.toml\"")).unwrap();
    let scratch = Scratch::with_model_and_plan("mass_against_stop", plan);
    let ran = scratch.succeed(&["sweep", "plan.toml", "--out", "swept"]);
    assert!(ran.stdout.starts_with("36 runs: 36 ok, 0 failed"), "{}", ran.stdout);
}
