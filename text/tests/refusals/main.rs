//! How a file is read, and what is said of one that is wrong.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

#[path = "../common/mod.rs"]
mod common;
mod units;

use common::{file, model};
use deltazero_study::Problem;
use deltazero_text::ModelFile;

/// Masses in a row between springs, the last of which hits a stop and is pushed.
const ROW: &str = include_str!("../models/row.toml");

/// A model with one formula that is wrong.
fn with_rate(rate: &str) -> String {
    format!(
        "[parameters]\nmass = 2\nn = 3\n[definitions]\na = \"b + 1\"\nb = \"a\"\n[states]\nx = 1\ny = {{ length = \"n\" }}\n\
        [rates]\ny = 0\n[modes.flight]\nrates = {{ x = \"{rate}\" }}\n"
    )
}

/// A formula with what is said of it, and of what part.
const WRONG: &[(&str, &str, &str)] = &[
    ("2x", "an operator is missing before this", "x"),
    ("x**2", "`**` is no operator", "**"),
    ("mas*x", "nothing here is called `mas`", "mas"),
    ("sin x", "an operator is missing before this", "x"),
    ("sin*x", "nothing here is called `sin`", "sin"),
    ("foo(x)", "no function is called `foo`", "foo(x)"),
    ("atan2(x)", "`atan2` has 2 arguments, not 1", "atan2(x)"),
    ("(x", "`)` is missing here", ""),
    ("x)", "this parenthesis was never opened", ")"),
    ("x +", "the formula ends here without its last operand", ""),
    ("x · 2", "`·` has no meaning in an expression", "·"),
    ("y", "`y` is a vector of 3 states", "y"),
    ("y[4]", "`y` has no index 4", "4"),
    ("y[1.5]", "an index is a whole number, and this is 1.5", "1.5"),
    ("y[x]", "an index is a formula of parameters and indices alone", "x"),
    ("x[1]", "`x` is one number and has no index", "1"),
    ("a", "`a` is defined by itself", ""),
    ("1/0", "this is inf, which is no number", "1/0"),
    ("x/(mass - 2)", "this is zero with mass = 2, and divides", "(mass - 2)"),
    ("1/(mass - 2)", "this is inf with mass = 2, which is no number", "1/(mass - 2)"),
    ("x > 1", "a comparison does not stand here", ">"),
    ("sum(n in 1..3, n)", "`n` has two meanings", "n in 1..3"),
    (
        "if(x > 1, 1, 2)",
        "each side of the condition of `if` is a formula of parameters and indices alone",
        "x",
    ),
    ("x and 2", "the condition of an event is one comparison", "and"),
    ("1e999", "`1e999` is beyond the largest number", "1e999"),
    ("", "a formula is missing here", ""),
];

#[test]
fn what_is_wrong_is_said_with_its_place() {
    for (rate, message, place) in WRONG {
        let text = with_rate(rate);
        let report = ModelFile::parse("wrong.toml", &text).unwrap_err();
        assert_eq!(report.message(), *message, "{rate}\n{report}");
        if !place.is_empty() {
            assert_eq!(&text[report.span()], *place, "{rate}\n{report}");
        }
        assert!(report.to_string().contains("wrong.toml:"), "{report}");
        assert!(report.help().is_some(), "no way out of {report}");
    }
}

#[test]
fn a_formula_over_several_lines_is_wrong_at_its_place() {
    let text = with_rate("0").replace("\"0\"", "\'\'\'\n    2 +\n    mas*x\'\'\'");
    let report = ModelFile::parse("wrong.toml", &text).unwrap_err();
    assert_eq!(report.message(), "nothing here is called `mas`");
    assert_eq!(&text[report.span()], "mas", "{report}");
}

#[test]
fn small_digits_are_no_part_of_a_name() {
    for (rate, message, help) in [
        ("x²", "`²` has no meaning in an expression", "a square is written `x^2`"),
        ("2*x³", "`³` has no meaning in an expression", "a cube is written `x^3`"),
        ("x₀", "`₀` has no meaning in an expression", "the digits 0 to 9"),
    ] {
        let told = refusal(&with_rate(rate));
        assert!(told.contains(message) && told.contains(help), "{rate}: {told}");
    }
    for name in ["r²", "x₀"] {
        let told = refusal(&format!("[parameters]\n\"{name}\" = 1\n{BALL}"));
        assert!(told.contains(&format!("`{name}` is no name for a formula")), "{told}");
        assert!(told.contains("the digits 0 to 9") && told.contains("model.toml:2:1"), "{told}");
    }
    file(&format!("[parameters]\n\"θ_2\" = 1\n{BALL}").replace("-9.81", "\"-9.81*θ_2\""));
}

/// Whole files with what is said of them.
const WRONG_FILES: &[(&str, &str)] = &[
    ("[states]\nx = 1\n[modes.a]\n", "`x` has no rate in the mode `a`"),
    ("[state]\nx = 1\n", "no key `state` is known here"),
    ("[states]\nx = 1\n[modes.a]\nrates = { x = 1, z = 2 }\n", "nothing here is called `z`"),
    (
        "[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\nevents = [{ when = \"x == 1\", stop = true }]",
        "an event is no equality",
    ),
    (
        "[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\nevents = [{ when = \"x > 1 and x < 2\", stop = true }]",
        "the condition of an event is one comparison",
    ),
    (
        "[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\nevents = [{ when = \"x > 1\", to = \"B\" }]\n[modes.b]\nrates = { x = 1 }",
        "no mode is called `B`",
    ),
    (
        "[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\nevents = [{ when = \"x > 1\" }]",
        "nothing follows this event",
    ),
    ("[states]\nx = 1\n[modes.a\n", "unclosed table, expected `]`"),
    ("mode = \"b\"\n[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\n", "no mode is called `b`"),
    (
        "[parameters]\nk = { value = 1, above = 1 }\n[states]\nx = 1\n[modes.a]\nrates = { x = 1 }\n",
        "`k` must be above 1",
    ),
    // The formula of a vector has the index `i`.
    (
        "[states]\ni = 100\nx = { length = 3 }\n[modes.a]\nrates = { i = 0, x = \"i\" }\n",
        "`i` has two meanings",
    ),
    (
        "[parameters]\ni = 5\n[states]\nx = { length = 3, start = \"i\" }\n[modes.a]\nrates = { x = 0 }\n",
        "`i` has two meanings",
    ),
    (
        "[states]\nx = { length = 3 }\n[modes.a]\ndefinitions = { i = 2 }\nrates = { x = \"i\" }\n",
        "`i` has two meanings",
    ),
    (
        "[states]\nx = { start = 0, scale = \"i\" }\n[modes.a]\nrates = { x = 1 }\n",
        "nothing here is called `i`",
    ),
    (
        "[states]\nx = 0\nz = { length = 3 }\n[modes.a]\nrates = { x = 1, z = 0 }\n\
         events = [{ for = \"i in 2..2\", when = \"x > i\", set = { x = 0, z = \"i\" } }]\n",
        "`i` is an index already",
    ),
    (
        "[states]\nsin = 1\n[modes.a]\nrates = { sin = 1 }\n",
        "`sin` has a meaning of its own in a formula",
    ),
];

#[test]
fn files_that_are_wrong_are_refused() {
    for (text, message) in WRONG_FILES {
        let report = ModelFile::parse("wrong.toml", text).unwrap_err();
        assert_eq!(report.message(), *message, "{text}\n{report}");
        assert!(report.help().is_some(), "no way out of {report}");
    }
}

/// What is no TOML, with what is said of it, the part that it is said of, and the way out.
const NO_TOML: &[(&str, &str, &str, &str)] = &[
    ("x = 1\nx = 2\n", "`x` stands here a second time", "2:1", "a key stands once in its table"),
    ("[a]\nx = 1\n[b]\n[a]\n", "`a` stands here a second time", "4:2", "join both, or rename one"),
    ("a = { x = 1, x = 2 }\n", "`x` stands here a second time", "1:14", "a key stands once"),
    (
        "name = pendulum\n",
        "string values must be quoted, expected literal string",
        "1:8",
        "`\"pendulum\"`",
    ),
    ("θ = 1\n", "invalid unquoted key, expected letters, numbers, `-`, `_`", "1:1", "`\"θ…\" = …`"),
    ("x = .5\n", "invalid mantissa, expected digits", "1:5", "`0.5`"),
    ("a == 1\n", "extra `=`", "1:4", "an entry is `key = value`"),
    ("a = [1, 2\n", "unclosed array, expected `]`", "1:10", "a list `[a, b]`"),
];

#[test]
fn what_is_no_toml_is_told_with_its_place_and_the_way_out() {
    for (text, message, place, help) in NO_TOML {
        let report = ModelFile::parse("no.toml", text).unwrap_err();
        let told = report.to_string();
        assert_eq!(report.message(), *message, "{told}");
        assert!(told.contains(&format!("no.toml:{place}\n")) && told.contains(help), "{told}");
        assert!(told.contains('^'), "{told}");
    }
}

#[test]
fn what_stands_twice_is_shown_at_both_places() {
    let expected = "\
error: `x` stands here a second time
 --> twice.toml:4:1
  |
2 | x = 1
  | - first here
3 | v = 0
4 | x = 2
  | ^
  |
  = help: a key stands once in its table, and a table once in a file: join both, or rename one";
    let report = ModelFile::parse("twice.toml", "[states]\nx = 1\nv = 0\nx = 2\n").unwrap_err();
    assert_eq!(report.to_string(), expected);
    for (text, n_first) in [
        ("[states]\nx = 1\n[modes.a]\n  [states]\nv = 1\n", 1),
        ("[modes.a]\nrates = { v = 1, x = 1, x = 2 }\n", 1),
        ("[modes.a]\nrates = { x = 1, v = 1, x = 2 }\n", 1),
        // The first one is not where a line begins.
        ("[modes]\na.x = 1\n[states]\nx = 1\n[modes.a]\n", 0),
    ] {
        let told = refusal(text);
        assert_eq!(told.matches("first here").count(), n_first, "{told}");
    }
}

#[test]
fn a_formula_that_is_no_number_is_told_with_the_values_that_make_it_so() {
    let with = |m: f64| {
        let text = format!(
            "[parameters]\nm = {{ value = {m}, min = -1 }}\nk = 3\nfree = 7\n[definitions]\nw = \"k/m*u\"\nu = 2\n\
             [states]\nx = 1\ny = {{ length = 2 }}\n[modes.a.rates]\nx = \"-sqrt(w)*x\"\ny = \"log(i - 2)\"\n"
        );
        refusal(&text)
    };
    let told = with(0.0);
    for words in ["model.toml:6:6", "this is inf with k = 3, m = 0, which is no number", "`above`"]
    {
        assert!(told.contains(words), "{words}: {told}");
    }
    let told = with(-1.0);
    // All that the root is made of.
    for words in ["this is NaN with k = 3, m = -1, which is no number", "^^^^^^^"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    let told = with(1.0);
    assert!(told.contains("this is NaN with i = 1, which is no number"), "{told}");
    let fine = "[parameters]\nm = { value = 1, min = 0 }\n[states]\nx = 1\n[modes.a]\nrates = { x = \"x/m\" }\n";
    let told = file(fine).models(&[("m".to_owned(), 0.0)]).unwrap_err().to_string();
    assert!(
        told.contains("this is zero with m = 0, and divides") && told.contains("6:18"),
        "{told}"
    );
}

#[test]
fn a_number_that_is_not_finite_is_refused() {
    for number in ["nan", "inf", "-inf", "1e999"] {
        let told = refusal(&format!("[parameters]\nm = {number}\n{BALL}"));
        assert!(
            told.contains("model.toml:2:5") && told.contains("`m` must be a finite number"),
            "{told}"
        );
        assert!(
            told.contains("not infinite, NaN or beyond 1.8e308") && told.contains("help"),
            "{told}"
        );
    }
}

#[test]
fn a_report_shows_the_line_and_the_nearest_name() {
    let report = ModelFile::parse("wrong.toml", &with_rate("x/mas")).unwrap_err();
    let expected = "\
error: nothing here is called `mas`
  --> wrong.toml:13:18
   |
13 | rates = { x = \"x/mas\" }
   |                  ^^^
   |
   = help: did you mean `mass`?";
    assert_eq!(report.to_string(), expected);
    assert_eq!(report.line_and_column(), (13, 18));
}

#[test]
fn kinks_of_what_moves_are_warned_of() {
    let text = "[parameters]\nk = -4\n[states]\nx = 1\n[modes.a]\nrates = { x = \"-abs(x) + abs(k) + sqrt(1 + x^2)\" }\n";
    let file = file(text);
    let warnings = file.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(&text[warnings[0].span()], "abs(x)");
}

#[test]
fn roots_of_what_passes_zero_are_warned_of() {
    let n_warnings = |rate: &str| {
        let text = BALL.replace("-9.81", &format!("\"{rate}\""));
        file(&text).warnings().len()
    };
    for kinked in ["sqrt(x^2)", "(4*x^2)^0.5", "hypot(x, 0)", "x^0.3", "x^-1.5", "(x^2)^0.75"] {
        assert_eq!(n_warnings(kinked), 1, "{kinked}");
    }
    for smooth in ["hypot(x, v)", "(x^2 + v^2)^0.5", "(1 + x^2)^-0.5", "x^1.5", "x^-1", "2^0.5*x"] {
        assert_eq!(n_warnings(smooth), 0, "{smooth}");
    }
}

#[test]
fn functions_that_end_are_told_from_those_with_a_kink() {
    let told = |rate: &str| {
        let text = BALL.replace("-9.81", &format!("\"{rate}\""));
        file(&text).warnings().iter().map(ToString::to_string).collect::<String>()
    };
    for edge in ["sqrt(x)", "x^0.3", "x^v", "log(x)"] {
        assert!(
            told(edge).contains("is not a number where that is below zero"),
            "{edge}: {}",
            told(edge)
        );
    }
    for edge in ["asin(x)", "acos(x/2)"] {
        assert!(told(edge).contains("where that is beyond −1 and 1"), "{edge}: {}", told(edge));
    }
    assert!(told("log(x^2)").contains("is not a number where that is at zero"));
    for kink in ["abs(x)", "sqrt(x^2)", "(x^2)^0.75", "sqrt(max(x, 0))", "log(1 + abs(x))"] {
        assert!(told(kink).contains("is not smooth"), "{kink}: {}", told(kink));
    }
    assert!(!told("sqrt(max(x, 0))").contains("not a number"));
    for whole in ["log(1 + x^2)", "2^v", "asin(0.5)*x"] {
        assert_eq!(told(whole), "", "{whole}");
    }
}

#[test]
fn edges_of_what_events_set_and_modes_keep_are_warned_of_and_kinks_are_not() {
    let told = |value: &str| {
        let set = format!("events = [{{ when = \"x < 0\", set = {{ v = \"{value}\" }} }}]\n");
        let rest = format!(
            "events = [{{ when = \"x < 0\", set = {{ v = 0 }}, rest = {{ to = \"flight\", set = {{ v = \"{value}\" }} }} }}]\n"
        );
        let keep = format!("keep = {{ c = \"{value}\" }}\n");
        [set, rest, keep].map(|own| {
            let text = BALL.to_owned() + &own;
            file(&text).warnings().iter().map(ToString::to_string).collect::<String>()
        })
    };
    for edge in ["log(x - 1)", "sqrt(x)", "asin(v)"] {
        for told in told(edge) {
            assert!(told.contains("is not a number where that is"), "{edge}: {told}");
            assert!(told.contains(edge) && told.contains("if an event happens there"), "{told}");
        }
    }
    for fine in ["-0.5*abs(v)", "sqrt(x^2)", "log(1 + x^2)"] {
        assert_eq!(told(fine), ["", "", ""], "{fine}");
    }
}

#[test]
fn the_end_of_the_runs_is_given_at_the_top_or_among_the_settings() {
    assert_eq!(file(ROW).t_end(), Some(0.5));
    let long = format!("{BALL}[run]\nt_end = 2\n[solver]\nmethod = \"any\"\n");
    assert_eq!(file(&long).t_end(), Some(2.0));
    assert_eq!(file(BALL).t_end(), None);
    assert_eq!(file(ROW).parameters()[0].range.max, Some(1000.0));
    let twice = refusal(&format!("t_end = 1\n{long}"));
    assert!(
        twice.contains("`t_end` is short for `run.t_end`") && twice.contains(":1:1"),
        "{twice}"
    );
}

#[test]
fn a_parameter_is_of_the_shape_where_lengths_are_made_of_it() {
    let row = file(ROW);
    let names = row.parameters().iter().map(|parameter| parameter.name.as_str());
    let of_shape: Vec<&str> = names.filter(|name| row.is_of_shape(name)).collect();
    assert_eq!(of_shape, ["n"]);
    let text = "[parameters]\nrows = 2\ncolumns = 2\nk = 1\n[definitions]\nn = \"rows*columns\"\n\
                F = { value = \"k*x[i]\", for = \"i in 1..n\", observe = true }\n\
                [states]\nx = { start = 1, length = 4 }\n[modes.a]\nrates = { x = \"-k*x[i]\" }\n";
    let wide = file(text);
    let of_shape = ["rows", "columns", "k"].map(|name| wide.is_of_shape(name));
    assert_eq!(of_shape, [true, true, false]);
}

fn refusal(text: &str) -> String {
    ModelFile::parse("model.toml", text).unwrap_err().to_string()
}

const BALL: &str = "[states]\nx = 1\nv = 0\n[modes.flight]\nrates = { x = \"v\", v = -9.81 }\n";

#[test]
fn what_is_kept_is_of_no_other_kept_value() {
    let text = BALL.to_owned() + "keep = { a = \"2*x\", b = \"10*a\" }\n";
    let message = refusal(&text);
    assert!(message.contains("a kept value is made of another one"), "{message}");
    assert!(message.contains("model.toml:6") && message.contains('^'), "{message}");
}

#[test]
fn a_rest_leads_to_a_mode() {
    let event = "events = [{ when = \"x < 0\", set = { x = 0, v = \"-0.5*v\" }, rest = {} }]\n";
    let message = refusal(&(BALL.to_owned() + event));
    assert!(message.contains("a rest leads to a mode"), "{message}");
}

#[test]
fn a_rest_in_another_mode_has_no_kept_value() {
    let with = |to: &str| {
        let event = format!(
            "keep = {{ c = \"v\" }}\nevents = [{{ when = \"x < 0\"{to}, set = {{ x = 0, v = \"-v\" }}, \
             rest = {{ to = \"floor\", set = {{ v = \"2*c\" }} }} }}]\n[modes.floor]\nrates = {{ x = 0, v = 0 }}\n"
        );
        BALL.to_owned() + &event
    };
    let message = refusal(&with(", to = \"floor\""));
    assert!(message.contains("what a mode keeps is gone in the rest"), "{message}");
    for to in ["", ", to = \"flight\""] {
        file(&with(to));
    }
}

#[test]
fn values_of_a_file_with_parts_may_be_given_back_to_it() {
    let text = "[parameters]\nm = 1.0\nk = 2.0\n[states]\nx = 1\n[modes.only]\nrates = { x = \"-k*x/m\" }\n\
                [parts.one]\nm = 3.0\n[parts.two]\nm = 4.0\n";
    let file = file(text);
    let own = |m: f64| [("m".to_owned(), m), ("k".to_owned(), 5.0)];
    assert_eq!(file.models(&own(1.0)).unwrap().len(), 2);
    let message = file.models(&own(2.0)).unwrap_err().to_string();
    assert!(message.contains("is set by parts"), "{message}");
}

#[test]
fn many_kinks_are_told_at_once() {
    let text = "[states]\nx = 1\n[definitions]\nS = \"sum(i in 1..20000, sin(i*t))\"\n[modes.only]\n\
                rates = { x = \"sum(i in 1..5000, abs(S + i))\" }\n";
    assert!(!file(text).warnings().is_empty());
}

#[test]
fn names_that_break_tables_are_refused() {
    for name in ["a,b", "a\\\"b", "a\\nb", "a\\u2028b", ""] {
        let message = refusal(&BALL.replace("flight", &format!("\"{name}\"")));
        assert!(message.contains("is no name for a mode"), "{name}: {message}");
    }
    for name in ["slip+", "at rest", "Flug übers Eis"] {
        file(&BALL.replace("flight", &format!("\"{name}\"")));
    }
}

#[test]
fn each_column_has_a_name_of_its_own() {
    let with = |definition: &str| {
        BALL.replace("x = 1", "x = { start = 1, unit = \"m\" }") + "[definitions]\n" + definition
    };
    for (definition, message) in [
        (
            "x_m = { value = \"2*x\", observe = true }",
            "`x_m` has the same column in tables as another",
        ),
        ("t_s = { value = \"t\", observe = true }", "tables have a column `t_s` of their own"),
        ("run = { value = 1, observe = true }", "tables have a column `run` of their own"),
    ] {
        let message_of_file = ModelFile::parse("model.toml", &with(definition)).unwrap_err();
        assert_eq!(message_of_file.message(), message);
    }
    file(&with("x_m = \"2*x\"\nrun = { value = 1, observe = true, unit = \"s\" }\n"));
}

#[test]
fn units_that_are_not_read_are_warned_of() {
    let form = "a product has spaces, one `/` stands before a symbol or parentheses: ";
    for (unit, way_out) in [
        ("m/s/s", form),
        ("kg/m s", form),
        ("Nm", "a product has spaces: `N m`"),
        ("m/KG", "`KG` is no unit; did you mean `kg`?"),
        ("lb^2", "`lb` is no unit; known are m, g, s, "),
    ] {
        let text = BALL.replace("x = 1", &format!("x = {{ start = 1, unit = \"{unit}\" }}"));
        let warnings = file(&text).warnings();
        assert_eq!(&text[warnings[0].span()], format!("\"{unit}\""));
        assert!(warnings[0].message().starts_with(&format!("the unit `{unit}` is not read")));
        let told = warnings[0].to_string();
        assert!(told.contains(&format!("help: {way_out}")), "{told}");
    }
}

#[test]
fn each_of_many_observables_is_told_once_however_many_modes_there_are() {
    let observables: String =
        (0..12_000).map(|i| format!("o{i} = {{ value = {i}, observe = true }}\n")).collect();
    let modes: String = (0..20).map(|i| format!("[modes.m{i}]\nrates = {{ x = 1 }}\n")).collect();
    let many = model(&format!("[states]\nx = 1\n{modes}[definitions]\n{observables}"));
    let columns = many.columns(0);
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
    assert_eq!((names.len(), &names[..3]), (12_001, &["x", "o0", "o1"][..]));
}

#[test]
fn an_observable_with_other_indices_in_another_mode_is_refused() {
    let with = |common: &str, of_a: &str, of_b: &str| {
        format!(
            "[states]\nx = {{ length = 3, start = 1 }}\n[rates]\nx = 0\n[definitions]\n{common}\n\
             [modes.a]\ndefinitions = {{ {of_a} }}\n[modes.b]\ndefinitions = {{ {of_b} }}\n"
        )
    };
    let w = |last: &str| {
        format!("w = {{ value = \"j*x[j]\", for = \"j in 1..{last}\", observe = true }}")
    };
    file(&with(&w("m"), "m = 2", "m = 2"));
    for text in [with(&w("m"), "m = 3", "m = 2"), with("", &w("3"), &w("2"))] {
        let report = ModelFile::parse("model.toml", &text).unwrap_err();
        assert_eq!(report.message(), "`w` has other indices in the mode `b` than in `a`");
        assert!(text[report.span()].starts_with("j in 1..") && report.help().is_some(), "{report}");
    }
}

#[test]
fn parts_of_other_lengths_are_refused() {
    let with = |parts: &str| {
        format!(
            "[parameters]\nn = 2\nk = 1\n[states]\nx = {{ length = \"n\", start = \"i\" }}\n[modes.a]\n\
             rates = {{ x = \"-k*x[i]\" }}\n{parts}"
        )
    };
    for (parts, place) in [
        ("[parts.one]\nn = 3\n[parts.two]\nn = 1\n", ":11:1"),
        ("[parts.one]\nn = 3\n[parts.two]\nk = 1\n", ":9:1"),
        ("[parts.one]\n[parts.two]\n[parts.three]\nn = 1\n", ":11:1"),
    ] {
        let told = refusal(&with(parts));
        assert!(told.contains("and lengths are made of it") && told.contains("help"), "{told}");
        assert!(told.contains(place), "{place}: {told}");
    }
    file(&with("[parts.one]\nn = 3\n[parts.two]\nn = 3\nk = 2\n"));
}

#[test]
fn a_group_has_a_name_of_its_own_and_one_unit() {
    let with = |x: &str, y: &str| {
        format!("[states]\nx = {{ {x} }}\ny = {{ {y} }}\n[modes.a]\nrates = {{ x = 0, y = 0 }}\n")
    };
    for (x, y, message, place) in [
        ("start = 1", "start = 1e6, group = \"x\"", "`x` is a state outside the group", "\"x\""),
        ("group = \"y\"", "start = 1", "`y` is a state outside the group", "\"y\""),
        (
            "length = 2",
            "start = 1, group = \"x[2]\"",
            "`x` is a state outside the group",
            "\"x[2]\"",
        ),
        (
            "unit = \"m\", group = \"g\"",
            "unit = \"m/s\", group = \"g\"",
            "the states of the group `g` differ in their units",
            "\"m/s\"",
        ),
    ] {
        let text = with(x, y);
        let report = ModelFile::parse("model.toml", &text).unwrap_err();
        assert!(report.message().starts_with(message) && report.help().is_some(), "{report}");
        assert_eq!(&text[report.span()], place, "{report}");
    }
    for (x, y) in [
        ("group = \"x\"", "group = \"x\""),
        ("length = 2, group = \"x\"", "start = 1"),
        ("unit = \"N m\", group = \"g\"", "unit = \"J\", group = \"g\""),
        ("unit = \"N\", group = \"g\"", "group = \"g\""),
    ] {
        file(&with(x, y));
    }
}
