//! Models from text files, by the same commands as mechanisms.

use deltazero_text::models::MODELS;
use serde_json::{Value, json};

use super::{Scratch, number, with_sets};

/// A directory that holds a model.
fn with_model(name: &str) -> (Scratch, String) {
    let scratch = Scratch::new();
    let text = scratch.succeed(&["model", "new", name]).stdout;
    let file = format!("{name}.toml");
    std::fs::write(scratch.path(&file), text).unwrap();
    (scratch, file)
}

#[test]
fn every_model_is_listed_printed_checked_and_simulated() {
    let list = Scratch::new().succeed(&["model", "list"]).stdout;
    assert!(MODELS.len() > 12, "{list}");
    for model in MODELS {
        let line = list.lines().find(|line| line.starts_with(&format!("{} ", model.name)));
        assert!(line.is_some_and(|line| line.trim_end().len() > 40), "{}: {list}", model.name);
        let (scratch, file) = with_model(model.name);
        let checked = scratch.succeed(&["model", "check", &file]);
        assert!(checked.stdout.contains("Parameters: "), "{}", checked.stdout);
        let simulate = ["simulate", "--model", &file, "--no-horizon", "--out", "out"];
        let tight = ["--set", "solver.method=radau5", "--set", "solver.rtol=1e-8"];
        let ran = scratch.succeed(&[&simulate[..], &tight].concat());
        let run = scratch.json("out/run.json");
        assert!(run["outcome"] == "finished" || run["outcome"] == "stopped", "{}", ran.stdout);
        assert_eq!(run["config"]["model"]["text"], json!(model.text), "{}", model.name);
        let trajectory = scratch.table("out/trajectory.csv");
        assert!(trajectory.rows.len() >= 100, "{}: {}", model.name, trajectory.rows.len());
    }
}

#[test]
fn a_model_has_a_study_a_recommendation_and_a_map_over_two_of_its_parameters() {
    let (scratch, file) = with_model("mass_against_stop");
    let sets = [
        "study.methods=[\"rk45\",\"radau5\"]",
        "study.rtol=[1e-7]",
        "study.repeats=1",
        "contest.methods=[\"rk45\",\"dop853\"]",
        "contest.repeats=1",
        "regimes.accuracy=[1e-5]",
        "run.t_end=0.05",
    ];
    let with = |args: &[&str]| {
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let args: Vec<&str> = args.iter().copied().chain(["--model", &file]).chain(sets).collect();
        scratch.succeed(&args)
    };
    with(&["study", "--out", "out"]);
    for row in &scratch.table("out/study.csv").rows {
        let right = ["status", "missed", "spurious"].map(|column| row[column].as_str());
        assert_eq!(right, ["ok", "0", "0"], "{row:?}");
        assert!(number(row, "e") < 1e-3, "{row:?}");
    }
    let page = scratch.text("out/report.html");
    assert!(page.contains("ass against a stop") && page.contains("zeta = "), "{page}");
    scratch.succeed(&["report", "out"]);
    let answer = with(&["recommend", "--json", "--accuracy", "1e-5"]).stdout;
    let answer: Value = serde_json::from_str(&answer).unwrap();
    assert!(answer["method"].is_string(), "{answer}");
    let axes = ["--axis", "K=1e6:1e8:2", "--axis", "zeta=0,0.1"];
    with(&[&["regimes", "--out", "map"][..], &axes].concat());
    let map = scratch.table("map/map.csv");
    assert_eq!(map.rows.len(), 4);
    for row in &map.rows {
        assert!(row["status"] == "ok" && number(row, "K") >= 1e6, "{row:?}");
    }
    assert_eq!(scratch.files("map/figures"), ["winners.png", "winners.svg"]);
}

#[test]
fn a_map_tells_how_far_it_compares_where_no_method_comes_to_the_end() {
    let scratch = Scratch::new();
    // x = 1/(1/a − t).
    let model = "name = \"blows up\"\nt_end = 2.0\n[parameters]\na = 1\nb = { value = 1, unit = \"1/s\" }\n\
                 [states]\nx = { start = \"a\", scale = 1 }\n[rates]\nx = \"b*x^2\"\n[modes.only]\n";
    std::fs::write(scratch.path("m.toml"), model).unwrap();
    let sets = ["contest.methods=[\"rk45\"]", "contest.repeats=1", "regimes.accuracy=[1e-3]"];
    let args =
        ["regimes", "--model", "m.toml", "--out", "map", "--axis", "a=0.1,1", "--axis", "b=1"];
    let told = scratch.succeed(&with_sets(&args, &sets)).stdout;
    let rows = scratch.table("map/map.csv").rows;
    assert_eq!([&rows[0]["t_end_s"], &rows[1]["t_end_s"]], ["2e0", "5e-1"]);
    assert_eq!(rows[0]["error"], "");
    assert!(rows[1]["error"].starts_with("no reference: "), "{}", rows[1]["error"]);
    assert!(told.lines().any(|line| line.ends_with("| 2 |")), "{told}");
    let sentence = "1, 1, 1e-3: compared to 0.5 s; beyond: no reference: ";
    assert!(told.lines().any(|line| line.starts_with(sentence)), "{told}");
}

#[test]
fn a_study_of_a_model_draws_its_states_and_calls_modes_by_their_names() {
    let (scratch, file) = with_model("thermostat");
    let sets = ["study.methods=[\"rk45\"]", "study.rtol=[1e-6]", "study.repeats=1"];
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let args = ["study", "--model", &file, "--out", "out"].into_iter().chain(sets);
    scratch.succeed(&args.collect::<Vec<_>>());
    let svg = |name: &str| scratch.text(&format!("out/figures/{name}.svg"));
    let motion = svg("motion");
    for words in ["T [K]", "loss [W]", "t [s]", "\non\n", "\noff\n", "\nevent\n"] {
        assert!(motion.contains(words), "{words}");
    }
    for name in ["step_size", "step_size_zoom", "step_histogram", "steps_per_contact"] {
        let figure = svg(name);
        assert!(figure.contains("\non\n") || figure.contains("in “on”"), "{name}");
        assert!(!figure.contains("flight") && !figure.contains("contact"), "{name}");
    }
    let text = scratch.text("out/study.md");
    let figures = &text[..text.find("## All runs").unwrap()];
    assert!(figures.contains("for this model?") && figures.contains("## Model"), "{figures}");
    for words in ["around a stay in “off”, 1112.26 s long", "Time in “on” "] {
        assert!(figures.contains(words), "{words}: {figures}");
    }
    for word in ["flight", "slip", "stick", "Contact", " contact"] {
        assert!(!figures.contains(word), "{word}: {figures}");
    }
    assert!(scratch.text("out/report.html").contains(">Model</h2>"));
    let stays = scratch.table("out/stays.csv").rows;
    assert!(stays.len() > 5 && stays.iter().all(|row| row["mode"] == "on" || row["mode"] == "off"));
    assert!(scratch.table("out/steps.csv").rows.iter().any(|row| row["mode_name"] == "off"));
}

#[test]
fn a_unit_with_a_comma_is_one_field_of_a_header() {
    let (scratch, file) = with_model("thermostat");
    let text = scratch.text(&file);
    let commas = text.replacen("unit = \"", "unit = \"rel., ", 99);
    std::fs::write(scratch.path(&file), commas).unwrap();
    let sets = ["--set", "study.methods=[\"rk45\"]", "--set", "study.rtol=[1e-6]"];
    let args = ["--model", &file, "--set", "study.repeats=1"];
    scratch.succeed(&[&["simulate", "--out", "out"], &args[..]].concat());
    scratch.succeed(&[&["study", "--out", "out", "--force"], &args[..], &sets].concat());
    for name in ["trajectory.csv", "motion.csv"] {
        // Read with as many fields in the header as in each row.
        let table = scratch.table(&format!("out/{name}"));
        assert!(table.header.iter().any(|column| column.contains("rel.,_")), "{:?}", table.header);
    }
}

#[test]
fn no_two_columns_of_a_motion_have_one_name() {
    let (scratch, file) = with_model("paper_joint");
    let sets = ["study.methods=[\"rk45\"]", "study.rtol=[1e-6]", "run.t_end=0.01"];
    scratch.succeed(&with_sets(&["study", "--model", &file, "--out", "out"], &sets));
    let header = scratch.table("out/motion.csv").header;
    assert_eq!(header[..2], ["shown", "part"]);
    let distinct: std::collections::BTreeSet<&String> = header.iter().collect();
    assert_eq!(distinct.len(), header.len(), "{header:?}");
}

/// A step that begins within rounding of such an event ends where it begins.
#[test]
fn events_at_times_that_fixed_steps_hit_have_a_study() {
    let (scratch, file) = with_model("integrate_and_fire");
    let sets = ["--set", "study.methods=[\"rk4\"]", "--set", "study.repeats=1"];
    scratch.succeed(&[&["study", "--model", &file, "--out", "out"][..], &sets].concat());
    let steps = scratch.table("out/steps.csv").rows;
    assert!(steps.len() > 100 && steps.iter().all(|step| number(step, "h_s") > 0.0));
}

#[test]
fn the_event_of_a_start_is_no_event_of_a_figure() {
    let scratch = Scratch::new();
    let model = "name = \"starts on a surface\"\nt_end = 1.0\n\
                 [parameters]\nr = { value = 1, unit = \"1/s\" }\n\
                 [states]\nx = { start = 0, unit = \"m\", scale = 1 }\n\
                 [modes.first]\nrates = { x = \"1\" }\nevents = [{ when = \"x > 0\", to = \"second\" }]\n\
                 [modes.second]\nrates = { x = \"2\" }\nevents = [{ when = \"x > 0.5\", to = \"last\" }]\n\
                 [modes.last]\nrates = { x = \"-r*x\" }\n";
    std::fs::write(scratch.path("m.toml"), model).unwrap();
    let sets = ["study.methods=[\"rk45\"]", "study.rtol=[1e-6]"];
    scratch.succeed(&with_sets(&["study", "--model", "m.toml", "--out", "out"], &sets));
    let text = scratch.text("out/study.md");
    assert!(text.contains("Ticks: events, 1 in all."), "{text}");
}

#[test]
fn a_parameter_is_set_as_a_key_is_and_the_printed_settings_read_back() {
    let (scratch, file) = with_model("mass_against_stop");
    let set = ["--set", "K=1e6", "--set", "parameters.zeta=0.2", "--set", "solver.rtol=1e-9"];
    let model = ["--model", &file];
    let printed = scratch.succeed(&[&["config"][..], &model, &set].concat()).stdout;
    std::fs::write(scratch.path("my.toml"), printed).unwrap();
    scratch.succeed(&[&["simulate", "--out", "set"][..], &model, &set].concat());
    scratch.succeed(&[&["simulate", "my.toml", "--out", "file"][..], &model].concat());
    let [set, file] = ["set", "file"].map(|dir| scratch.json(&format!("{dir}/run.json")));
    assert_eq!(set["config"]["parameters"]["K"], 1e6);
    assert_eq!(set["config"], file["config"]);
    let trajectories = ["set", "file"].map(|dir| scratch.text(&format!("{dir}/trajectory.csv")));
    assert_eq!(trajectories[0], trajectories[1]);
}

#[test]
fn what_is_wrong_with_a_model_or_its_values_is_said_with_its_place() {
    let (scratch, file) = with_model("mass_against_stop");
    let text = scratch.text(&file);
    std::fs::write(scratch.path("wrong.toml"), text.replacen("K*x", "k*x", 1)).unwrap();
    for (args, words) in [
        (&["--model", "wrong.toml"][..], &["wrong.toml", "`k`", "^"][..]),
        (&["--model", &file, "--set", "Q=1"], &["--set Q=1", "\"Q\"", "parameter of the model"]),
        (&["--model", &file, "--set", "zetta=1"], &["did you mean \"zeta\""]),
        (&["--model", &file, "--set", "solver.rtoll=1"], &["did you mean \"solver.rtol\""]),
        (&["--model", &file, "--set", "K=-1"], &["--set K=-1", "out of range", "greater than 0"]),
        (&["--model", &file, "--set", "bays=3"], &["bays"]),
        (&["--model", "none.toml"], &["none.toml", "cannot be read"]),
    ] {
        let ran = scratch.run(&[&["simulate"][..], args].concat());
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.stderr);
        for word in words {
            assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
        }
    }
    for (axes, words) in [
        (&["--axis", "K=1,2"][..], "a map has two axes"),
        (&["--axis", "K=1,2", "--axis", "Q=1,2"], "parameter of the model"),
        (&["--axis", "K=-1,2", "--axis", "zeta=0,1"], "out of range"),
        (&["--axis", "K=1,2", "--axis", "parameters.K=3,4"], "given twice"),
        (&["--axis", "K=1,2", "--axis", "run.t_end=1,2"], "every cell is run by the same settings"),
        (
            &["--axis", "K=1,2", "--axis", "zeta=0,1", "--set", "parameters.zeta=0.5"],
            "--axis zeta: --set parameters.zeta=0.5 gives it one value",
        ),
    ] {
        let ran = scratch.run(&[&["regimes", "--model", &file][..], axes].concat());
        assert_eq!(ran.code, Some(2), "{axes:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{words}: {}", ran.stderr);
    }
    let ran = scratch.run(&["model", "new", "bouncing_bal"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("bouncing_ball"), "{}", ran.stderr);
}

#[test]
fn an_error_that_is_not_defined_is_a_dash_in_tables() {
    let scratch = Scratch::new();
    // A pendulum upside down, whose motion is lost before its only sample.
    let model = "name = \"pendulum\"\nt_end = 1.0\n\
                 [parameters]\n\
                 k = { value = 1e4, unit = \"1/s^2\" }\n\
                 [states]\n\
                 x = { start = 3.14159, unit = \"rad\", scale = 1 }\n\
                 v = { start = 0, unit = \"rad/s\", scale = 1 }\n\
                 [rates]\nx = \"v\"\nv = \"-k*sin(x)\"\n\
                 [modes.only]\n";
    std::fs::write(scratch.path("pendulum.toml"), model).unwrap();
    let sets = [
        "run.sample=0.9",
        "study.methods=[\"rk45\"]",
        "study.rtol=[1e-4, 1e-6]",
        "study.repeats=1",
    ];
    let args = with_sets(&["study", "--model", "pendulum.toml", "--out", "out"], &sets);
    let ran = scratch.succeed(&args);
    assert!(ran.stderr.contains("reference good to e = –\n"), "{}", ran.stderr);
    let [text, page] = ["out/study.md", "out/report.html"].map(|name| scratch.text(name));
    assert!(text.contains(" | ok | – | ") && !text.contains("NaN"), "{text}");
    assert!(!page.contains("e = NaN") && !page.contains(">NaN<"), "NaN in report.html");
    assert_eq!(scratch.table("out/study.csv").rows[0]["e"], "");
}
