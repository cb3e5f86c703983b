//! The numbers of the README are those of a study that the program wrote.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use std::sync::atomic::AtomicBool;

use deltazero::config::Config;
use deltazero::paper::audit::Audit;
use deltazero::report;
use deltazero::report::laws::markdown;
use deltazero::study::friction::costs;
use deltazero::study::plan::plan;
use deltazero::study::restitution::deliveries;
use deltazero_study::run::Limits;
use deltazero_study::setting::Events;
use deltazero_study::steps::step_size::{ACCURACY, step_histories};
use deltazero_study::work_precision::{WorkPrecision, cheapest};
use serde_json::Value;

fn file(name: &str) -> String {
    std::fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_answer_in_the_readme_is_that_of_the_committed_study() {
    let table: WorkPrecision = serde_json::from_str(&file("docs/table1/study.json")).unwrap();
    assert!(file("README.md").contains(&report::answer(&table)));
}

/// The configuration of a record, which is that of these keys but for what a study or an audit does not use.
fn config_of(record: &Value, sets: &[&str]) -> Config {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let (mut config, asked) =
        (Config::from_json(&record["config"]).unwrap(), Config::load(None, &sets).unwrap());
    (config.contest, config.study.repeats) = (asked.contest.clone(), asked.study.repeats);
    assert_eq!(config, asked);
    config
}

/// The study of a page, which is of the defaults with these keys.
fn study_of(name: &str, sets: &[&str]) -> WorkPrecision {
    let study: Value = serde_json::from_str(&file(&format!("docs/{name}/study.json"))).unwrap();
    config_of(&study, sets);
    serde_json::from_value(study).unwrap()
}

#[test]
fn the_answers_on_the_pages_are_those_of_their_committed_studies() {
    let methods = "study.methods=[\"rk4\", \"rk45\", \"dop853\", \"vern98\", \"taylor\", \"rodas5p\", \"radau5\", \
                   \"bdf\", \"auto\"]";
    for (name, sets) in [
        ("slider_crank", &["mechanism=slider-crank"][..]),
        ("four_bar", &["mechanism=four-bar"]),
        ("cam_follower", &["mechanism=cam-follower"]),
        ("rocking_block", &["mechanism=rocking-block"]),
        ("impact_oscillator", &["mechanism=impact-oscillator"]),
        ("chain", &["bays=3", "run.t_end=0.5", methods]),
    ] {
        let answer = report::answer(&study_of(name, sets));
        assert!(file(&format!("docs/{name}.md")).contains(&answer), "{name}: {answer}");
    }
}

#[test]
fn the_answer_on_the_page_of_text_models_is_that_of_the_last_model_there() {
    let (page, study) = (file("docs/own_model.md"), file("docs/own_model/study.json"));
    let table: WorkPrecision = serde_json::from_str(&study).unwrap();
    assert!(page.contains(&report::answer(&table)), "{}", report::answer(&table));
    let record: Value = serde_json::from_str(&study).unwrap();
    let (_, last) = page.rsplit_once("```toml\n").unwrap();
    let (model, _) = last.split_once("```").unwrap();
    assert_eq!(record["config"]["model"]["text"], model);
}

fn committed_audit() -> (Value, Audit) {
    let mut record: Value = serde_json::from_str(&file("docs/audit/audit.json")).unwrap();
    let audit = serde_json::from_value(record["audit"].take()).unwrap();
    (record, audit)
}

#[test]
fn the_claims_in_the_readme_are_those_of_the_committed_audit_which_is_the_default_one() {
    let (record, audit) = committed_audit();
    assert!(file("README.md").contains(&report::audit::answer(&audit.rows)));
    let config = config_of(&record, &[]);
    let text = file("docs/audit/audit.md");
    for finding in report::audit::findings(&config, &audit) {
        assert!(text.contains(&finding), "{finding}");
    }
}

#[test]
fn the_step_figures_of_the_committed_study_are_of_the_setting_that_its_answer_names() {
    let table: WorkPrecision = serde_json::from_str(&file("docs/table1/study.json")).unwrap();
    let best = cheapest(&table.rows, ACCURACY).unwrap();
    assert!(best.events == Events::Located && best.events_are_right(), "{best:?}");
    let config = Config::load(None, &[format!("study.methods=[\"{}\"]", best.method)]).unwrap();
    let subject = config.mechanism.subject(&config);
    let stop = AtomicBool::new(false);
    let limits = Limits::none(&stop);
    let histories = step_histories(&subject, &plan(&config), &table, limits);
    assert_eq!(histories.len(), 2);
    assert!(histories.iter().all(|history| history.setting == best.setting()), "{best:?}");
}

#[test]
fn the_committed_study_is_the_default_one() {
    let study: serde_json::Value = serde_json::from_str(&file("docs/table1/study.json")).unwrap();
    config_of(&study, &[]);
}

#[test]
fn the_committed_table_of_laws_is_what_the_program_prints() {
    assert_eq!(file("docs/laws.md"), markdown(&deliveries().unwrap(), &costs().unwrap()));
}

#[test]
fn readme_and_crate_docs_name_every_method() {
    for text in [file("README.md"), file("solvers/src/lib.rs")] {
        for method in deltazero_solvers::METHODS {
            assert!(text.contains(&format!("`{}`", method.name)), "{}", method.name);
        }
    }
}

#[test]
fn the_image_is_made_from_every_package() {
    let (manifest, image) = (file("Cargo.toml"), file("deploy/Containerfile"));
    let members = manifest.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    let members: Vec<&str> = members.split(',').map(|name| name.trim().trim_matches('"')).collect();
    assert!(members.len() >= 7, "{members:?}");
    for name in members {
        assert!(image.contains(&format!("\nCOPY {name} {name}\n")), "{name}");
    }
}

#[test]
fn the_finding_in_the_readme_is_that_of_the_committed_map() {
    let (readme, map) = (file("README.md"), file("docs/regimes/regimes.md"));
    let after = readme.split("<!-- map: made by `deltazero regimes`").nth(1).unwrap();
    let finding = after.split("<!-- end of map -->").next().unwrap();
    let lines: Vec<&str> = finding.lines().skip(1).filter(|line| line.starts_with("- ")).collect();
    assert!(lines.len() >= 4, "{finding}");
    for line in lines {
        assert!(map.contains(line), "{line}");
    }
}
