//! What a file may say, and what is said of a file that is wrong.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_solvers::taylor::expand::begins_with_rhs;
use deltazero_solvers::{Control, Integration, Method, Next, Outcome, System, Tolerance};
use deltazero_study::Problem;
use deltazero_study::problem::Role;
use deltazero_text::{ModelFile, TextModel};
use num_dual::Dual64;

/// Masses in a row between springs, the last of which hits a stop and is pushed.
const ROW: &str = include_str!("models/row.toml");

fn file(text: &str) -> ModelFile {
    ModelFile::parse("model.toml", text).unwrap_or_else(|report| panic!("{report}"))
}

fn vector<S>(n: usize, entry: impl FnMut(usize) -> S) -> Vec<S> {
    (0..n).map(entry).collect()
}

fn model(text: &str) -> TextModel {
    file(text).models(&[]).unwrap().remove(0)
}

fn modes(model: &TextModel) -> [deltazero_text::Mode; 2] {
    let y = Problem::start(model);
    let first = model.initial_mode(0.0, &y);
    let Next::Mode(second) = model.transition(first, 0, 0.0, &mut y.clone()) else { panic!() };
    [first, second]
}

#[test]
fn a_row_of_masses_is_what_it_says() {
    let model = model(ROW);
    assert_eq!((model.dim(), model.n_guards()), (12, 6));
    let names: Vec<_> = model.states().into_iter().map(|state| state.name).collect();
    assert_eq!((&*names[0], &*names[11]), ("x[1]", "v[6]"));
    let columns = model.columns(0);
    let names: Vec<&str> = columns[12..].iter().map(|column| &*column.name).collect();
    assert_eq!(names, ["S[1]", "S[2]", "S[3]", "S[4]", "S[5]", "total", "F"]);
    assert_eq!(model.groups().len(), 7);
    assert_eq!(model.unit_of_time(), 0.5);
    let y = vector(12, |i| if i < 6 { 0.002 * (i * i) as f64 } else { 0.1 * i as f64 });
    let [free, hit] = modes(&model);
    assert_eq!((model.role(&free, 0), model.role(&hit, 0)), (Role::Free, Role::Contact));
    let mut dydt = y.clone();
    model.rhs(hit, 0.25, &y, &mut dydt);
    let x = &y[..6];
    let push = 2.0 * libm::sin(0.75);
    let last = (push - 1e4 * (x[5] - 0.01) - 100.0 * (x[5] - x[4])) / 0.5;
    assert_eq!(dydt[0], y[6]);
    assert!((dydt[11] - last).abs() < 1e-12 * last.abs());
    let second = 100.0 * (x[2] - 2.0 * x[1] + x[0]) / 0.5;
    assert!((dydt[7] - second).abs() < 1e-12);
    let touch = model.touch(&hit, 0.25, &y, 0).unwrap();
    assert_eq!(touch.rate, y[11]);
    assert!((touch.force - 1e4 * (x[5] - 0.01)).abs() < 1e-10);
    assert_eq!(model.touch(&free, 0.25, &y, 0).unwrap().force, 0.0);
    let [of_free, of_hit] = [free, hit].map(|mode| model.energies(&mode, 0.25, &y).unwrap());
    assert_eq!(of_free.elastic, 0.0);
    assert!((of_hit.elastic - 5e3 * (x[5] - 0.01) * (x[5] - 0.01)).abs() < 1e-12);
}

#[test]
fn operations_of_guards_follow_those_of_rates() {
    for text in [ROW] {
        let model = model(text);
        let y = vector(model.dim(), |i| 0.3 + 0.1 * i as f64);
        for mode in modes(&model) {
            assert!(begins_with_rhs(&model, &mode, 0.1, &y));
        }
    }
}

#[test]
fn the_jacobian_is_that_of_single_columns() {
    for n in [2, 6, 40] {
        let model = file(ROW).models(&[("n".to_owned(), f64::from(n))]).unwrap().remove(0);
        let y = vector(model.dim(), |i| 0.3 + 0.1 * i as f64);
        for mode in modes(&model) {
            let mut found = vec![0.0; model.dim() * model.dim()];
            model.jacobian(mode, 0.1, &y, |i, j, entry| found[i * model.dim() + j] = entry);
            for j in 0..model.dim() {
                let seeded =
                    vector(model.dim(), |i| Dual64::new(y[i], f64::from(u8::from(i == j))));
                let mut dydt = seeded.clone();
                model.rhs(mode, Dual64::from_re(0.1), &seeded, &mut dydt);
                for (i, d) in dydt.iter().enumerate() {
                    assert_eq!(found[i * model.dim() + j], d.eps, "{n}: {i}, {j}");
                }
            }
            let mut dfdt = y.clone();
            model.time_derivative(mode, 0.1, &y, &mut dfdt);
            let last = dfdt[model.dim() - 1];
            assert!((last - 2.0 * 3.0 * libm::cos(0.3) / 0.5).abs() < 1e-12);
        }
    }
}

/// Rates of x and y by every function that is smooth, on both sides of a surface.
const FUNCTIONS: &str = "[states]\nx = 1\ny = 2\n[modes.a.rates]\n\
    x = \"sin(x*y) - cos(y)^3 + exp(-x)*tanh(y) + x^1.5 + (x + 3)^0.3 + 2/y - y/x\"\n\
    y = \"sinh(x) - cosh(y)*sqrt(x + 3) + log(x + 4)/log10(y + 3) + atan2(y, x) + x^66 - x^67 + t\"\n";

#[test]
fn the_jacobian_of_every_function_is_that_of_dual_numbers() {
    let model = model(FUNCTIONS);
    for y in [[0.7, 1.3], [-0.6, 0.9], [-1.2, -1.9], [1.1, -0.4]] {
        let y = y.to_vec();
        let mode = model.initial_mode(0.0, &y);
        let mut n_entries = 0;
        model.jacobian(mode, 0.1, &y, |i, j, entry| {
            let seeded = vector(2, |k| Dual64::new(y[k], f64::from(u8::from(k == j))));
            let mut dydt = seeded.clone();
            model.rhs(mode, Dual64::from_re(0.1), &seeded, &mut dydt);
            // Measured: at most 6.3e-16.
            let off = (entry - dydt[i].eps).abs() / dydt[i].eps.abs();
            assert!(off < 6e-15, "{y:?} ({i}, {j}): {entry} and {}", dydt[i].eps);
            n_entries += 1;
        });
        assert_eq!(n_entries, 4);
    }
}

#[test]
fn a_condition_on_parameters_chooses_a_formula() {
    let digits = ["<", "<=", ">", ">=", "==", "!="]
        .iter()
        .enumerate()
        .map(|(i, relation)| format!("{}*if(n {relation} 3, 1, 0)", 10_u32.pow(i as u32)));
    let sum = digits.collect::<Vec<_>>().join(" + ");
    let file = file(&format!(
        "[parameters]\nn = 1\n[states]\nx = 1\n[modes.a]\nrates = {{ x = \"{sum}\" }}\n"
    ));
    for (n, expected) in [(2.0, 100_011.0), (3.0, 11_010.0), (4.0, 101_100.0)] {
        let model = file.models(&[("n".to_owned(), n)]).unwrap().remove(0);
        let (y, mut dydt) = (vec![1.0], vec![0.0]);
        model.rhs(model.initial_mode(0.0, &y), 0.0, &y, &mut dydt);
        assert_eq!(dydt, [expected], "{n}");
    }
}

#[test]
fn a_row_of_masses_runs_through_its_contacts() {
    let model = model(ROW);
    let tolerance = Tolerance { rtol: 1e-10, atol: vec![1e-12; 12] };
    let mut solver =
        Method::named("dop853").unwrap().solver(&model, Control::Adaptive(tolerance)).unwrap();
    let mut run = Integration::new(&model, 0.0, Problem::start(&model));
    assert_eq!(run.run(0.9, &mut *solver, &mut ()), Ok(Outcome::Finished));
    assert!(run.stats.n_events > 2);
}

#[test]
fn parts_differ_in_parameters_and_starts() {
    let text = "[parameters]\nphi = 1\n[states]\nx = { start = \"phi\" }\n[modes.a]\nrates = { x = \"-phi*x\" }\n\
        [parts.AB]\nphi = 2\n[parts.BC]\nphi = 3\nstart = { x = 7 }\n";
    let file = file(text);
    let models = file.models(&[]).unwrap();
    assert_eq!(models.iter().map(Problem::name).collect::<Vec<_>>(), ["AB", "BC"]);
    assert_eq!(Problem::start(&models[0]).as_ref(), [2.0]);
    assert_eq!(Problem::start(&models[1]).as_ref(), [7.0]);
    assert_eq!([0, 1].map(|i| models[i].labels(0)), [[("part", 1)], [("part", 2)]]);
    let error = file.models(&[("phi".to_owned(), 1.5)]).unwrap_err();
    assert_eq!(error.message(), "`phi` is set by each part and cannot be set for all");
}

#[test]
fn events_set_all_at_once_and_modes_hold_values() {
    let text = "[parameters]\ne = 0.5\n[states]\nx = -1\nv = 2\n[discrete]\nk = 0\n[rates]\nx = \"v\"\nv = \"k\"\n\
        [modes.a]\nevents = [{ when = \"x > 0\", set = { x = \"v\", v = \"x - e*v\", k = \"k + 1\" }, to = \"b\" }]\n\
        [modes.b]\nkeep = { v0 = \"v\" }\nrates = { v = \"v0 + k\" }\nevents = [{ when = \"x > 100\", stop = true }]\n";
    let model = model(text);
    let mut y = vector(2, |i| [0.25, 2.0][i]);
    let first = model.initial_mode(0.0, &Problem::start(&model));
    let Next::Mode(second) = model.transition(first, 0, 0.0, &mut y) else { panic!() };
    assert_eq!(y, [2.0, -0.75]);
    assert_eq!(format!("{second:?}"), "b");
    let mut dydt = y.clone();
    model.rhs(second, 0.0, &y, &mut dydt);
    assert_eq!(dydt, [-0.75, 0.25]);
    assert_eq!(model.transition(second, 0, 0.0, &mut y), Next::Stop);
    assert!(model.takes_energy(&first, &second) && !model.takes_energy(&second, &first));
}

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
    ("1/0", "this is inf with these parameters, which is no number", "1/0"),
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
    }
}

#[test]
fn a_formula_over_several_lines_is_wrong_at_its_place() {
    let text = with_rate("0").replace("\"0\"", "\'\'\'\n    2 +\n    mas*x\'\'\'");
    let report = ModelFile::parse("wrong.toml", &text).unwrap_err();
    assert_eq!(report.message(), "nothing here is called `mas`");
    assert_eq!(&text[report.span()], "mas", "{report}");
}

/// Equations of x [m], v [m/s] and F [N] with what is said of their units.
const WRONG_UNITS: &[(&str, &str)] = &[
    ("v = \"F\"", "the rate of `v` is in m s^-2, and this is in m kg s^-2"),
    ("v = \"F/m + x\"", "these are added or subtracted, and their units differ"),
    ("v = \"F/m\"\nx = \"x\"", "the rate of `x` is in m s^-1, and this is in m"),
    ("v = \"sin(x)*F/m\"", "the argument of `sin` has no unit, and this is in m"),
    ("v = \"F/m*2^x\"", "an exponent has no unit, and this is in m"),
    ("v = \"F/m + min(x, v)/t\"", "these stand in one function, and their units differ"),
    ("v = \"F/m + x^2/t\"", "these are added or subtracted, and their units differ"),
    ("v = \"F/m + x^-2\"", "these are added or subtracted, and their units differ"),
    ("v = \"sin(1)\"", "the rate of `v` is in m s^-2, and this has no unit"),
    ("v = \"w/t\"", "the rate of `v` is in m s^-2, and this is in 0.001 m s^-2"),
];

#[test]
fn units_of_both_sides_are_compared() {
    let model = |rates: &str| {
        format!(
            "[parameters]\nm = {{ value = 2, unit = \"kg\" }}\nF = {{ value = 1, unit = \"N\" }}\n\
             w = {{ value = 1, unit = \"mm/s\" }}\n[states]\nx = {{ start = 0, unit = \"m\" }}\n\
             v = {{ start = 0, unit = \"m/s\" }}\n[rates]\nx = \"v\"\n[modes.a.rates]\n{rates}\n"
        )
    };
    for right in [
        "F/m",
        "3*x",
        "F/m + 1",
        "sqrt(F^2)/m",
        "F/m + v^2*x^-1",
        "v/t*cos(v*t/x)",
        "abs(-F)/m",
        "0.001*w",
    ] {
        file(&model(&format!("v = \"{right}\"")));
    }
    for (rates, message) in WRONG_UNITS {
        let report = ModelFile::parse("units.toml", &model(rates)).unwrap_err();
        assert_eq!(report.message(), *message, "{report}");
    }
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
    assert!(message.contains("is set by each part"), "{message}");
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
    for unit in ["m/s/s", "Nm", "xyz", "kg/m s"] {
        let text = BALL.replace("x = 1", &format!("x = {{ start = 1, unit = \"{unit}\" }}"));
        let warnings = file(&text).warnings();
        assert_eq!(&text[warnings[0].span()], format!("\"{unit}\""));
        assert!(warnings[0].message().starts_with(&format!("the unit `{unit}` is not read")));
    }
}

#[test]
fn many_observables_in_many_modes_are_read_in_a_moment() {
    let observables: String =
        (0..12_000).map(|i| format!("o{i} = {{ value = {i}, observe = true }}\n")).collect();
    let modes: String = (0..20).map(|i| format!("[modes.m{i}]\nrates = {{ x = 1 }}\n")).collect();
    let start = std::time::Instant::now();
    file(&format!("[states]\nx = 1\n{modes}[definitions]\n{observables}"));
    let seconds = start.elapsed().as_secs_f64();
    // Measured: 0.6 s.
    assert!(seconds < 5.0, "{seconds} s");
}
