//! What a file may say.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use common::{file, model};
use deltazero_solvers::contracts::check;
use deltazero_solvers::{Control, Integration, Method, Next, Outcome, System, Tolerance};
use deltazero_study::Problem;
use deltazero_study::problem::Role;
use deltazero_text::models::MODELS;
use deltazero_text::{ModelFile, TextModel};
use num_dual::Dual64;

/// Masses in a row between springs, the last of which hits a stop and is pushed.
const ROW: &str = include_str!("models/row.toml");

fn vector<S>(n: usize, entry: impl FnMut(usize) -> S) -> Vec<S> {
    (0..n).map(entry).collect()
}

fn modes(model: &TextModel) -> [deltazero_text::Mode; 2] {
    let y = Problem::start(model);
    let first = model.initial_mode(0.0, &y);
    let Next::Mode(second) = model.transition(first, 0, 0.0, &mut y.clone()) else { panic!() };
    [first, second]
}

#[test]
fn guards_that_depend_on_neighbours_are_differentiated_many_at_once() {
    let [carts, ball] = ["carts", "bouncing_ball"]
        .map(|name| model(MODELS.iter().find(|model| model.name == name).unwrap().text));
    // Fifty carts, each impact of two that follow each other.
    assert_eq!((carts.dim(), carts.guard_span()), (100, 2));
    assert_eq!((ball.dim(), ball.guard_span()), (2, 1));
}

#[test]
fn a_model_without_a_name_has_that_of_its_file() {
    let text = "[states]\nx = 1\n[modes.one]\nrates = { x = 0 }\n";
    let name =
        |text: &str| ModelFile::parse("models/my drop.toml", text).unwrap().name().to_owned();
    assert_eq!(name(text), "my drop");
    assert_eq!(name(&format!("name = \"drop\"\n{text}")), "drop");
}

#[test]
fn a_line_is_shown_at_its_value_though_its_key_holds_the_same_signs() {
    let file = file(
        "[parameters]\nstop_at_90 = 9\n[states]\nx = 1\n[modes.on]\nrates = { x = \"-stop_at_90\" }\n",
    );
    for (words, place) in [
        (&["stop_at_90", "9"][..], "model.toml:2:14\n"),
        (&["stop_at_90"], "model.toml:2:1\n"),
        (&["stop_at_90", "12"], "model.toml:2:1\n"),
        (&[], "model.toml:2:1\n"),
    ] {
        let shown = file.report_of_line(2, words, "it is wrong", "").to_string();
        assert!(shown.contains(place), "{words:?}: {shown}");
    }
}

#[test]
fn what_is_declared_and_not_used_is_told() {
    let file = file(
        "[parameters]\nk = 1\nl = 1\nm = 1\n[states]\nx = { start = \"m\" }\n[discrete]\nn = 0\nf = 0\n\
         [modes.a]\nrates = { x = \"k + n + f\" }\n\
         events = [{ when = \"x > 1\", set = { n = \"n + 1\" }, rest = { to = \"b\" } }]\n\
         [modes.b]\nrates = { x = 0 }\n\
         [modes.c]\nrates = { x = 0 }\nevents = [{ when = \"x > 1\", to = \"d\" }]\n\
         [modes.d]\nrates = { x = 0 }\n",
    );
    let leftovers = file.leftovers();
    let told: Vec<&str> = leftovers.iter().map(deltazero_text::Report::message).collect();
    let leads = "no event leads from the first mode to the mode";
    assert_eq!(
        told,
        [
            "no formula has the parameter `l`",
            "no event sets the discrete value `f`",
            &format!("{leads} `c`"),
            &format!("{leads} `d`"),
        ]
    );
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
            assert_eq!(check(&model, &mode, 0.1, &y), Ok(()));
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
    assert_eq!(error.message(), "`phi` is set by parts and cannot be set for all");
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

/// A mode `a` before a mode `b`, with bounds `m` of their own.
fn with_bounds(definitions: &str, [of_a, of_b]: [&str; 2]) -> String {
    format!(
        "[states]\nx = {{ length = 3, start = \"i\" }}\n[definitions]\n{definitions}\n[rates]\nx = \"-x[i]\"\n\
         [modes.a]\ndefinitions = {{ {of_a} }}\nevents = [{{ when = \"t > 2\", to = \"b\" }}]\n\
         [modes.b]\ndefinitions = {{ {of_b} }}\n"
    )
}

#[test]
fn an_observable_of_one_mode_has_its_indices_there_and_is_zero_elsewhere() {
    let w = "w = { value = \"j*x[j]\", for = \"j in 1..m\", observe = true }";
    let model = model(&with_bounds(
        "u = { value = \"100*x[1]\", observe = true }",
        [&format!("m = 3, {w}"), ""],
    ));
    let columns = model.columns(0);
    let names: Vec<&str> = columns[3..].iter().map(|column| &*column.name).collect();
    assert_eq!(names, ["u", "w[1]", "w[2]", "w[3]"]);
    let y = Problem::start(&model);
    for (mode, expected) in
        modes(&model).iter().zip([[100.0, 1.0, 4.0, 9.0], [100.0, 0.0, 0.0, 0.0]])
    {
        model.rows(mode, 0.0, &y, &mut |_, row| assert_eq!(row[3..], expected));
    }
}

#[test]
fn a_run_starts_in_the_first_mode_of_the_file_though_its_subtable_stands_first() {
    for first in ["[modes.b.rates]\nx = \"-x\"\n", "[modes.b.definitions.F]\nvalue = 1\n"] {
        let model = model(&format!(
            "[states]\nx = 1\n[rates]\nx = 1\n{first}[modes.a]\n[modes.b]\nrole = \"contact\"\n"
        ));
        assert_eq!(model.named_modes(), ["b", "a"]);
        assert_eq!(model.name_of(model.initial_mode(0.0, &Problem::start(&model))), "b");
    }
}
