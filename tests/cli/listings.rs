//! `methods`, `config`, `--help`, `completions`: what they print.

use deltazero::laws::ContactLaw;
use serde_json::Value;

use crate::Scratch;

#[test]
fn methods_are_listed_for_readers_and_for_machines() {
    let scratch = Scratch::new();
    let text = scratch.succeed(&["methods"]).stdout;
    let json = scratch.succeed(&["methods", "--json"]).stdout;
    let list: Vec<Value> = serde_json::from_str(&json).unwrap();
    for name in ["rk4", "rk45", "bdf"] {
        assert!(list.iter().any(|method| method["method"] == name), "{json}");
    }
    for method in &list {
        let name = method["method"].as_str().unwrap();
        assert!(text.lines().any(|line| line.starts_with(name)), "{text}");
        assert!(method["fixed_step"].is_boolean());
    }
}

#[test]
fn laws_are_listed_for_machines_with_what_they_deliver() {
    let scratch = Scratch::new();
    let json = scratch.succeed(&["laws", "--json"]).stdout;
    let laws: Value = serde_json::from_str(&json).unwrap();
    let list = laws["normal"].as_array().unwrap();
    let words: Vec<_> = list.iter().filter_map(|law| law["law"].as_str()).collect();
    assert_eq!(
        (&words[..], laws["friction"].as_array().map(Vec::len)),
        (ContactLaw::WORDS, Some(21))
    );
    for law in list {
        let n = law["impacts"].as_array().map_or(0, Vec::len);
        assert_eq!(n, if law["has_memory"] == true { 19 } else { 0 }, "{law}");
    }
}

#[test]
fn the_schema_is_json_and_knows_every_table() {
    let scratch = Scratch::new();
    let schema: Value =
        serde_json::from_str(&scratch.succeed(&["config", "--schema"]).stdout).unwrap();
    for table in [
        "strut",
        "drive",
        "slider_crank",
        "joint",
        "contact",
        "friction",
        "run",
        "solver",
        "contest",
        "regimes",
    ] {
        assert!(schema["properties"][table].is_object(), "{table}");
    }
}

#[test]
fn help_names_every_command_and_version_is_a_number() {
    let scratch = Scratch::new();
    let help = scratch.succeed(&["--help"]).stdout;
    for command in [
        "study",
        "report",
        "simulate",
        "regimes",
        "recommend",
        "audit",
        "methods",
        "laws",
        "config",
    ] {
        assert!(help.contains(command), "{help}");
    }
    let version = scratch.succeed(&["--version"]).stdout;
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
}

#[test]
fn a_configuration_that_is_given_is_printed_with_its_mechanism() {
    let scratch = Scratch::new();
    let crank = scratch.succeed(&["config", "--set", "mechanism=slider-crank"]).stdout;
    assert!(crank.contains("\nstiffness = 6.61e10\n") && crank.contains("\nt_end = 0.024\n"));
    std::fs::write(scratch.path("crank.toml"), &crank).unwrap();
    let again = scratch.succeed(&["config", "crank.toml"]).stdout;
    assert_eq!(again, crank);
    let stiffer = scratch.succeed(&["config", "crank.toml", "--set", "contact.stiffness=1e9"]);
    assert!(stiffer.stdout.contains("\nstiffness = 1000000000.0\n"), "{}", stiffer.stdout);
    let ran = scratch.run(&["config", "--set", "contact.stifness=1e9"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("did you mean \"contact.stiffness\"?"), "{}", ran.stderr);
}

#[test]
fn shells_complete_every_command_and_option() {
    let scratch = Scratch::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = scratch.succeed(&["completions", shell]).stdout;
        for word in ["simulate", "recommend", "completions", "accuracy", "no-horizon"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let ran = scratch.run(&["completions", "csh"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("bash"), "{}", ran.stderr);
}

/// Where there is a bash: it takes the script, and completes by it.
#[cfg(target_os = "linux")]
#[test]
fn bash_completes_by_its_script() {
    let scratch = Scratch::new();
    let script = scratch.succeed(&["completions", "bash"]).stdout;
    let tried = "COMP_WORDS=(deltazero reco); COMP_CWORD=1; _deltazero deltazero reco deltazero; echo ${COMPREPLY[@]}";
    let bash =
        std::process::Command::new("bash").arg("-c").arg(format!("{script}\n{tried}")).output();
    let Ok(output) = bash else { return };
    assert_eq!(String::from_utf8_lossy(&output.stdout), "recommend\n");
}

#[test]
fn the_manual_has_a_page_for_every_command() {
    let scratch = Scratch::new();
    scratch.succeed(&["man", "pages"]);
    let help = scratch.succeed(&["--help"]).stdout;
    let listed = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let commands = listed.lines().map(|line| line.split_whitespace().next().unwrap());
    let mut n_pages = 0;
    for command in commands.filter(|command| *command != "help") {
        let page = scratch.text(&format!("pages/deltazero-{command}.1"));
        assert!(page.contains(".SH SYNOPSIS") && page.contains(command), "{command}: {page}");
        n_pages += 1;
    }
    assert!(n_pages > 10, "{listed}");
    assert!(scratch.text("pages/deltazero.1").contains("deltazero\\-recommend(1)"));
}
