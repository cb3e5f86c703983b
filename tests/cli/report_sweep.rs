//! `sweep.html`: what it holds for each kind of plan, that it is redone from itself, what is refused.

use std::fs;

use crate::Scratch;
use crate::plot::SETS;

/// 32 runs, of which the 16 of the last value of `study.max_rhs` do not come to their end.
const AXES: &str = r#"
check = 0.5

[[axis]]
key = "contact.stiffness"
log = [5e6, 2e7]
points = 4

[[axis]]
key = "contact.damping"
values = [100, 500]

[[axis]]
key = "friction.law"
values = ["coulomb", "stribeck"]

[[axis]]
key = "study.max_rhs"
values = [1_000_000, 10]
"#;

const DRAWS: &str = r#"
[random]
samples = 24
seed = 3
sampling = "latin_hypercube"

[[random.key]]
key = "contact.stiffness"
log_uniform = [1e6, 1e8]

[[random.key]]
key = "friction.coefficient"
normal = [0.1, 0.01]
"#;

const SALTELLI: &str = r#"
[random]
samples = 16
sampling = "saltelli"

[[random.key]]
key = "friction.coefficient"
uniform = [0.05, 0.2]

[[random.key]]
key = "drive.m1"
uniform = [0.5, 2]
"#;

/// 12 runs.
const OF_MODEL: &str = r#"
[[axis]]
key = "K"
log = [1e5, 1e7]
points = 3

[random]
samples = 4

[[random.key]]
key = "zeta"
uniform = [0.02, 0.3]
"#;

/// With the sweep of a plan in `out`, and its report.
fn reported(plan: &str, more: &[&str]) -> (Scratch, String) {
    let scratch = Scratch::with_sweep(plan);
    scratch.succeed(&[&["report", "out"], more].concat());
    let page = scratch.text("out/sweep.html");
    (scratch, page)
}

/// The text of a page without tags, in lines.
fn text(page: &str) -> String {
    let body = &page[page.find("<main>").unwrap()..page.find("<script>").unwrap()];
    let parts = body.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    let text: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    unescaped(&text.join("\n"))
}

fn unescaped(text: &str) -> String {
    text.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

/// What stands in the code under a folded line.
fn folded(page: &str, line: &str) -> String {
    let at = page.find(&format!("<summary>{line}</summary>")).unwrap();
    let code = page[at..].split_once("<code>").unwrap().1.split_once("</code>").unwrap().0;
    unescaped(code)
}

/// The time that a sweep took, as its page tells it, and what stands before and after that.
fn around_time(text: &str) -> (&str, &str, &str) {
    let (before, rest) = text.split_once("\nTook\n").unwrap();
    let (time, after) = rest.split_once('\n').unwrap();
    (before, time, after)
}

fn figures(scratch: &Scratch) -> Vec<String> {
    let names = scratch.files("out").into_iter();
    names
        .filter_map(|name| Some(name.strip_prefix("figures/")?.strip_suffix(".svg")?.to_owned()))
        .collect()
}

#[test]
fn axes_have_lines_heat_maps_ranks_and_estimated_errors() {
    let (scratch, page) = reported(AXES, &[]);
    let text = text(&page);
    for part in [
        "5e6 to 2e7 N/mⁿ, 4 values at equal ratios",
        "100, 500 N s/m",
        "16 ok, 16 failed",
        "16 runs, as the first of them: ",
        "rk45 located, rtol 1e-6",
        "finished 100 % (16)",
        "Words have no ranks, so what friction.law does",
        "sees monotonic dependence alone",
        "Events can be judged in ",
        ". The largest estimated e is ",
        "It rises with contact.stiffness most: ρ = ",
    ] {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    let figures = figures(&scratch);
    for name in [
        "n_rhs_over_contact.stiffness_by_friction.law",
        "contact.damping_over_contact.stiffness_by_n_rhs",
    ] {
        assert!(figures.iter().any(|own| own == name), "no {name} in {figures:?}");
    }
    assert_eq!(page.matches("<figure id").count(), figures.len());
    for name in &figures {
        assert!(page.contains(&format!("<figure id=\"{name}\">")), "{name}");
    }
}

#[test]
fn a_page_is_the_same_each_time_and_has_all_that_redoes_its_sweep() {
    let (scratch, page) = reported(AXES, &[]);
    scratch.succeed(&["report", "out", "--quiet"]);
    assert_eq!(scratch.text("out/sweep.html"), page);
    let record = scratch.json("out/sweep.json");
    let rows = scratch.text("out/runs.csv");
    fs::write(scratch.path("plan.toml"), folded(&page, "The plan")).unwrap();
    fs::write(scratch.path("config.toml"), folded(&page, "The configuration")).unwrap();
    assert_eq!(scratch.sweep("redone", &["--quiet"]), rows);
    assert_eq!(scratch.json("redone/sweep.json")["hash"], record["hash"]);
}

#[test]
fn draws_have_distributions_and_a_scatter_over_the_strongest_key() {
    let (scratch, page) = reported(DRAWS, &["--y", "n_rhs", "--y", "outcome", "--y", "n_rhs"]);
    assert_eq!(figures(&scratch), ["n_rhs", "n_rhs_over_contact.stiffness"]);
    let text = text(&page);
    for part in [
        "drawn, log-uniform from 1e6 to 1e8 N/mⁿ",
        "drawn, normal, mean 0.1, standard deviation 0.01",
        "24: 24 draws (latin_hypercube, seed 3)",
        "deltazero report DIR --y n_rhs --y outcome",
    ] {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    // The table of ranks begins with the strongest.
    let ranks = &text[text.find("Rank correlations, the strongest first").unwrap()..];
    let at = |key: &str| ranks.find(key).unwrap();
    assert!(at("contact.stiffness") < at("friction.coefficient"), "{ranks}");
}

#[test]
fn the_end_of_the_runs_is_told_as_one_only_where_it_is_not_varied() {
    let (scratch, page) = reported(DRAWS, &[]);
    assert!(text(&page).contains("\nTo\n0.05 s\n"), "{}", text(&page));
    let plan = "[[axis]]\nkey = \"run.t_end\"\nvalues = [0.01, 0.02]\n";
    fs::write(scratch.path("plan.toml"), plan).unwrap();
    scratch.sweep("ends", &["--set", "solver.rtol=1e-6", "--quiet"]);
    scratch.succeed(&["report", "ends", "--quiet"]);
    let text = text(&scratch.text("ends/sweep.html"));
    assert!(text.contains(" s, but for run.t_end above\n"), "{text}");
}

#[test]
fn a_design_for_sobol_indices_has_these_and_no_ranks() {
    let (scratch, page) = reported(SALTELLI, &["--y", "work_j", "--y", "dissipated_j"]);
    assert_eq!(figures(&scratch), ["sobol_of_dissipated_j", "sobol_of_work_j"]);
    let text = text(&page);
    for part in [
        "64: 16 samples of 4 runs (saltelli, seed 0)",
        "drive.m1 explains most (total ",
        "Sobol indices, the largest total first",
    ] {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    assert!(!text.contains('ρ'), "{text}");
}

#[test]
fn shards_have_the_page_of_one_command_once_they_are_merged() {
    let (scratch, one) = reported(DRAWS, &[]);
    for (i, shard) in ["2/3", "1/3", "3/3"].into_iter().enumerate() {
        let sweep = ["sweep", "plan.toml", "--out", "three", "--shard", shard];
        scratch.succeed(&[&sweep[..], &SETS].concat());
        let ran = scratch.run(&["report", "three"]);
        assert_eq!(ran.code, Some(2), "{i}: {}", ran.stderr);
        let why = "three: the sweep is not finished; `deltazero sweep` with its plan goes on";
        assert!(ran.stderr.contains(why), "{i}: {}", ran.stderr);
        assert!(!scratch.path("three/sweep.html").exists());
    }
    scratch.sweep("three", &[&["--merge"][..], &SETS].concat());
    scratch.succeed(&["report", "three"]);
    let three = scratch.text("three/sweep.html");
    // Of all that the pages say, the time alone tells how the runs were made.
    let (one, three) = (text(&one), text(&three));
    let [(before, _, after), (before_merged, took, after_merged)] =
        [&one, &three].map(|page| around_time(page));
    assert_eq!((before, after), (before_merged, after_merged));
    let seconds = took.strip_suffix(" s, 3 shards and the merge together").unwrap();
    let shards = ["1-of-3", "2-of-3", "3-of-3"].map(|name| format!("three/shards/{name}.json"));
    let records = shards.iter().map(String::as_str).chain(["three/sweep.json"]);
    let all: f64 = records.map(|name| scratch.json(name)["wall_s"].as_f64().unwrap()).sum();
    assert!((seconds.parse::<f64>().unwrap() - all).abs() <= 0.05 + 1e-9, "{seconds} s, {all} s");
    for name in figures(&scratch) {
        let of = |dir: &str| scratch.text(&format!("{dir}/figures/{name}.svg"));
        assert_eq!(of("three"), of("out"), "{name}");
    }
}

#[test]
fn a_sweep_of_a_model_has_the_page_of_its_parameters_without_its_file() {
    let scratch = Scratch::with_model_and_plan("mass_against_stop", OF_MODEL);
    scratch.sweep("out", &["--model", "stop.toml"]);
    fs::remove_file(scratch.path("stop.toml")).unwrap();
    scratch.succeed(&["report", "out", "--y", "peak_force_n"]);
    let page = scratch.text("out/sweep.html");
    let text = text(&page);
    for part in [
        "1e5 to 1e7 N/m, 3 values at equal ratios",
        "drawn, uniform from 0.02 to 0.3",
        "12: 3 grid points, at each 4 draws (random, seed 0)",
        "12 ok, 0 failed",
        "Rank correlations, the strongest first",
    ] {
        assert!(text.contains(part), "no {part:?} in: {text}");
    }
    assert_eq!(figures(&scratch).len(), page.matches("<figure id").count());
    // The configuration has the text of the model in it.
    fs::write(scratch.path("plan.toml"), folded(&page, "The plan")).unwrap();
    fs::write(scratch.path("config.toml"), folded(&page, "The configuration")).unwrap();
    let rows = scratch.text("out/runs.csv");
    assert_eq!(scratch.sweep("redone", &[]), rows);
    let [one, two] = ["out", "redone"].map(|dir| scratch.json(&format!("{dir}/sweep.json")));
    assert_eq!(one["hash"], two["hash"]);
}

#[test]
fn what_has_no_report_is_refused_with_a_way_out() {
    let (scratch, _) = reported(DRAWS, &[]);
    let before = scratch.text("out/sweep.html");
    let refused = |args: &[&str], part: &str| {
        let ran = scratch.run(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(part), "no {part:?} in: {}", ran.stderr);
    };
    let nearest = "no column \"n_rh\", did you mean \"n_rhs\"?; it has run, ";
    refused(&["report", "out", "--y", "n_rh"], nearest);
    refused(&["report", "out", "--y", "contact.stiffness"], "is a key that the plan sets");
    fs::create_dir(scratch.path("empty")).unwrap();
    refused(&["report", "empty"], "no study.json and no sweep.json");
    refused(&["report", "nowhere"], "name the DIR of a study or of a sweep");
    fs::write(scratch.path("empty/study.json"), "{\"rows\": []}").unwrap();
    refused(&["report", "empty", "--y", "n_rhs"], "--y names columns of a sweep");
    let record =
        scratch.text("out/sweep.json").replace("\"finished\": true", "\"finished\": false");
    fs::write(scratch.path("out/sweep.json"), record).unwrap();
    refused(
        &["report", "out"],
        "the sweep is not finished; `deltazero sweep` with its plan goes on",
    );
    assert_eq!(scratch.text("out/sweep.html"), before);
}

#[test]
fn a_sweep_of_which_no_run_came_to_its_end_says_why() {
    let (scratch, page) =
        reported(&format!("{DRAWS}\n[[axis]]\nkey = \"study.max_rhs\"\nvalues = [10]\n"), &[]);
    let text = text(&page);
    assert!(
        text.contains("0 ok, 24 failed") && text.contains("24 runs, as the first of them: "),
        "{text}"
    );
    assert!(text.contains("No run has it."), "{text}");
    assert_eq!(figures(&scratch), [""; 0]);
}
