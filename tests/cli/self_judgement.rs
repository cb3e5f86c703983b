//! What runs of models say against themselves, and what they must not.

use deltazero_text::models::MODELS;
use serde_json::Value;

use super::Scratch;

/// A model in a directory, and what `simulate` with these settings tells of it.
fn simulated(model: &str, sets: &[&str]) -> Value {
    let scratch = Scratch::new();
    std::fs::write(scratch.path("model.toml"), model).unwrap();
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let args = ["simulate", "--model", "model.toml", "--out", "out"];
    scratch.succeed(&args.into_iter().chain(sets).collect::<Vec<_>>());
    scratch.json("out/run.json")
}

/// The codes of its warnings.
fn warned(run: &Value) -> Vec<&str> {
    let warnings = run["warnings"].as_array().unwrap();
    warnings.iter().map(|warning| warning["code"].as_str().unwrap()).collect()
}

#[test]
fn a_contact_whose_depth_or_force_has_the_wrong_sign_is_told() {
    let model = MODELS.iter().find(|model| model.name == "mass_against_stop").unwrap();
    let with = |from: &str, to: &str| {
        let text = model.text.replacen(from, to, 1);
        assert!(from == to || text != model.text, "{from}");
        let run = simulated(&text, &[]);
        warned(&run).iter().filter(|code| **code == "contact").count()
    };
    let [depth, force] = ["depth = \"x\"", "force = \"F\""];
    assert_eq!(with(depth, depth), 0);
    assert_eq!(with(depth, "depth = \"-x\""), 1);
    assert_eq!(with(force, "force = \"-F\""), 1);
}

/// Lorenz's system from (1, 1, 1), counted from there, or not.
fn lorenz(start: f64) -> String {
    let from = 1.0 - start;
    format!(
        "t_end = 60.0\n[states]\nx = {{ start = {start}, scale = 1 }}\ny = {{ start = {start}, scale = 1 }}\n\
         z = {{ start = {start}, scale = 1 }}\n[definitions]\nX = \"x + {from}\"\nY = \"y + {from}\"\nZ = \"z + {from}\"\n\
         [modes.only]\nrates = {{ x = \"10*(Y - X)\", y = \"X*(28 - Z) - Y\", z = \"X*Y - 8/3*Z\" }}\n"
    )
}

#[test]
fn a_motion_is_no_more_predictable_from_zero_than_from_elsewhere() {
    for start in [1.0, 0.0, 1e-9] {
        let run = simulated(&lorenz(start), &[]);
        let horizon = run["horizon_s"].as_f64().unwrap();
        // Measured: 25.2, 25.4 and 25.9 s.
        assert!((15.0..30.0).contains(&horizon), "{start}: {horizon}");
        assert!(warned(&run).contains(&"horizon"), "{run}");
    }
}

#[test]
fn a_motion_that_rounds_the_last_bit_of_its_start_away_has_a_horizon_too() {
    // Ueda's oscillator: from 1, where the last bit is soon below the rounding of x, and from rest, where nothing has a rate.
    for start in [1, 0] {
        let model = format!(
            "t_end = 300\n[states]\nx = {{ start = {start}, scale = 1 }}\nv = {{ start = 0, scale = 1 }}\n[rates]\nx = \"v\"\n\
             [modes.only]\nrates = {{ v = \"-x^3 - 0.05*v + 7.5*sin(t)\" }}\n"
        );
        let horizon = simulated(&model, &[])["horizon_s"].as_f64().unwrap();
        assert!((50.0..150.0).contains(&horizon), "{start}: {horizon}");
    }
}

#[test]
fn what_rests_at_zero_is_predictable() {
    let model = "t_end = 1\n[states]\nx = { start = 0, scale = 1 }\nv = { start = 0, scale = 1 }\n[rates]\nx = \"v\"\n\
                 [modes.rests]\nrates = { v = 0 }\nevents = [{ when = \"x < 0\", to = \"falls\" }]\n[modes.falls]\nrates = { v = -1 }\n";
    let run = simulated(model, &[]);
    assert!(run["horizon_s"].is_null() && warned(&run).is_empty(), "{run}");
}

#[test]
fn an_event_that_ends_the_run_and_is_lost_is_told_and_missed() {
    let model = "t_end = 100.0\n[states]\nx = { start = 0, scale = 1 }\nv = 1\n[modes.swing]\n\
                 rates = { x = \"v\", v = \"-x + 0.002*v\" }\nevents = [{ when = \"x > 1.1\", stop = true }]\n";
    let loose = ["solver.method=bs32", "solver.rtol=1e-4"];
    let run = simulated(model, &loose);
    assert_eq!((&run["outcome"], warned(&run)), (&"finished".into(), vec!["events"]), "{run}");
    // One that stops late has not lost it.
    for (rtol, least) in [("solver.rtol=1e-6", 1e-3), ("solver.rtol=1e-9", 0.0)] {
        let run = simulated(model, &["solver.method=bs32", rtol]);
        assert_eq!((&run["outcome"], warned(&run)), (&"stopped".into(), vec![]), "{run}");
        let late = (run["stopped_s"][0]["t_s"].as_f64().unwrap() - 95.787_714).abs();
        assert!(late >= least, "{rtol}: {late}");
    }
    let scratch = Scratch::new();
    std::fs::write(scratch.path("model.toml"), model).unwrap();
    let study = ["study", "--model", "model.toml", "--out", "out", "--set", "study.repeats=1"];
    let methods = ["--set", "study.methods=[\"bs32\"]", "--set", "study.rtol=[1e-4, 1e-9]"];
    scratch.succeed(&[&study[..], &methods].concat());
    let rows = scratch.table("out/study.csv").rows;
    let missed: Vec<_> = rows.iter().map(|row| row["missed"].as_str()).collect();
    assert_eq!(missed, ["1", "0"], "{rows:?}");
}

#[test]
fn an_event_that_ends_the_run_and_is_not_there_is_told() {
    let model = |most: f64| {
        format!(
            "t_end = 400.0\n[states]\nx = {{ start = 0, scale = 1 }}\nv = 1\n[modes.swing]\n\
             rates = {{ x = \"v\", v = \"-x\" }}\nevents = [{{ when = \"x > {most}\", stop = true }}]\n"
        )
    };
    // The swings grow by the method's error alone. An event that is early is not made up.
    for (most, rtol, codes) in
        [(1.02, "1e-3", &["events"][..]), (0.9, "1e-2", &[]), (0.9, "1e-6", &[])]
    {
        let set = format!("solver.rtol={rtol}");
        let run = simulated(&model(most), &["solver.method=rk45", &set]);
        assert_eq!((&run["outcome"], warned(&run)), (&"stopped".into(), codes.to_vec()), "{run}");
    }
}

#[test]
fn an_event_that_moves_a_state_or_ends_the_run_takes_the_energy_of_that() {
    let with = |event: &str| {
        format!(
            "t_end = 5.0\n[states]\nx = 0.5\nv = 1.0\n[rates]\nx = \"v\"\nv = \"-4*x\"\n[modes.free]\nevents = [{event}]\n\
             [modes.back]\nevents = [{{ when = \"x < -0.6\", set = {{ x = -0.1 }}, to = \"free\" }}]\n\
             [energy]\nkinetic = \"v^2/2\"\nelastic = \"2*x^2\"\n"
        )
    };
    for event in [
        "{ when = \"x > 0.69\", set = { x = 0.2 }, to = \"back\" }",
        "{ when = \"x > 0.6\", set = { v = 0 }, stop = true }",
    ] {
        let run = simulated(&with(event), &["solver.rtol=1e-9"]);
        assert_eq!(warned(&run), [] as [&str; 0], "{run}");
    }
}

#[test]
fn an_event_counts_where_a_guard_is_zero_at_the_start_and_rises() {
    let model = "t_end = 8.0\n[states]\nx = { start = 0, scale = 1 }\nv = { start = 0, scale = 1 }\n[rates]\nx = \"v\"\n\
                 v = \"sin(t) - 0.1*t\"\n[modes.forward]\nevents = [{ when = \"v < 0\", to = \"backward\" }]\n\
                 [modes.backward]\nevents = [{ when = \"v > 0\", to = \"forward\" }]\n";
    let run = simulated(model, &[]);
    assert_eq!(run["counts"]["n_events"], 1, "{run}");
}

#[test]
fn a_motion_that_the_time_does_not_resolve_is_no_result() {
    // From 20 μs before the end on y decays by e⁻², in 168 spacings of the time.
    let model = "t_end = 1e9\n[states]\ny = 1\n[modes.rests]\nrates = { y = 0 }\n\
                 events = [{ when = \"t > 999999999.99998\", to = \"decays\" }]\n[modes.decays]\nrates = { y = \"-1e5*y\" }\n";
    let scratch = Scratch::new();
    std::fs::write(scratch.path("model.toml"), model).unwrap();
    let args = ["simulate", "--model", "model.toml", "--no-horizon", "--force", "--out", "out"];
    for method in ["bdf", "tr_bdf2", "esdirk34", "tsit45"] {
        let method = format!("solver.method={method}");
        let ran = scratch.run(&[&args[..], &["--set", &method]].concat());
        assert!(ran.code == Some(1) && ran.stderr.contains("step fell to"), "{}", ran.stderr);
    }
}
