//! What a file means where it could be read in another way.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use common::model;
use deltazero_solvers::{Grid, Method, Next, System, Trajectory};
use deltazero_study::problem::{self, Problem, Quantity};
use deltazero_study::run::{Accuracy, Events, Setting, integrate};
use deltazero_text::ModelFile;

/// A ball between a floor, which names no rest, and a ceiling, which does.
const BETWEEN: &str = r#"
    [states]
    y = 1
    v = 0
    [modes.flight]
    rates = { y = "v", v = "-9.81" }
    events = [
      { when = "y < 0", set = { y = 0, v = "-0.5*v" } },
      { when = "y > 2", set = { y = 2, v = "-0.5*v" }, rest = { to = "hangs", set = { y = 2, v = 0 } } },
    ]
    [modes.hangs]
    rates = { y = 0, v = 0 }
"#;

#[test]
fn a_rest_is_that_of_the_event_that_fell() {
    let model = model(BETWEEN);
    let flight = model.initial_mode(0.0, &Problem::start(&model));
    for (guard, height) in [(0, None), (1, Some(2.0))] {
        let mut y = Problem::start(&model);
        let Next::Mode(after) = model.transition(flight, guard, 1.0, &mut y) else { panic!() };
        let rest = model.accumulation(after, guard, 1.0, &mut y);
        assert_eq!(rest.map(|_| y[0]), height);
    }
}

#[test]
fn the_rate_of_a_depth_is_that_of_the_branch_that_its_value_takes() {
    for (depth, rate) in [
        ("max(-y, 0)", 5.0),
        ("max(0, -y)", 0.0),
        ("-min(y, 0)", 5.0),
        ("-min(0, y)", 0.0),
        ("abs(y)", -5.0),
    ] {
        let model = model(&format!(
            "[states]\ny = 0\nv = -5\n[modes.a]\nrole = \"contact\"\nrates = {{ y = \"v\", v = 0 }}\n\
             [contact]\ndepth = \"{depth}\"\nforce = 0\n"
        ));
        let y = Problem::start(&model);
        let mode = model.initial_mode(0.0, &y);
        assert_eq!(model.touch(&mode, 0.0, &y, 0).unwrap().rate, rate, "{depth}");
    }
}

/// A mass on a spring; `own` is said of its one mode.
fn spring(own: &str) -> String {
    format!(
        "[parameters]\nk = 4.0\n[states]\nx = 1\nv = 0\n[modes.swing]\n{own}rates = {{ x = \"v\", v = \"-k*x\" }}\n\
         [energy]\nkinetic = \"v^2/2\"\nelastic = \"k*x^2/2\"\n"
    )
}

#[test]
fn elastic_energy_stands_as_it_is_where_nothing_touches() {
    let elastic = |text: &str| {
        let model = model(text);
        let y = Problem::start(&model);
        model.energies(&model.initial_mode(0.0, &y), 0.0, &y).unwrap().elastic
    };
    assert_eq!(elastic(&spring("")), 2.0);
    let own = "definitions = { k2 = \"k\" }\n";
    let touch = format!("[modes.touch]\nrole = \"contact\"\nrates = {{ x = 0, v = 0 }}\n{own}");
    assert_eq!(elastic(&(spring("") + &touch)), 0.0);
    assert_eq!(elastic(&(spring(own).replace("k*x^2", "k2*x^2") + &touch)), 2.0);
}

#[test]
fn a_contact_that_no_mode_has_is_warned_of() {
    let warnings = |own: &str| {
        let text = spring(own) + "[contact]\ndepth = \"-x\"\nforce = \"-k*x\"\n";
        let file = ModelFile::parse("model.toml", &text).unwrap();
        file.warnings().iter().map(|warning| text[warning.span()].to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(warnings(""), ["-k*x"]);
    assert!(warnings("role = \"contact\"\n").is_empty());
}

/// A contact of a depth of 3 and a force of 6 in these units.
fn contact_in(length: &str, force: &str) -> String {
    format!(
        "[parameters]\nK = {{ value = 2, unit = \"{force}/({length})\" }}\n[states]\n\
         x = {{ start = 3, unit = \"{length}\" }}\nv = {{ start = 1, unit = \"{length}/s\" }}\n[definitions]\n\
         F = {{ value = \"K*x\", unit = \"{force}\" }}\n[rates]\nx = \"v\"\nv = \"0\"\n\
         [modes.a]\nrole = \"contact\"\n[contact]\ndepth = \"x\"\nforce = \"F\"\n"
    )
}

#[test]
fn a_contact_is_told_in_metres_and_newtons() {
    for (length, force, [metre, newton]) in
        [("m", "N", [1.0, 1.0]), ("mm", "mN", [1e-3, 1e-3]), ("cm", "kN", [1e-2, 1e3])]
    {
        let text = contact_in(length, force);
        let model = model(&text);
        let y = Problem::start(&model);
        let told = model.touch(&model.initial_mode(0.0, &y), 0.0, &y, 0).unwrap();
        let expected = [3.0 * metre, metre, 6.0 * newton];
        assert_eq!([told.depth, told.rate, told.force], expected, "{length}, {force}");
        assert!(ModelFile::parse("model.toml", &text).unwrap().warnings().is_empty());
    }
}

#[test]
fn a_force_of_unknown_unit_beside_a_depth_in_millimetres_is_warned_of() {
    let force = "force = \"F\"";
    for (length, n_warnings) in [("m", 0), ("mm", 1)] {
        let text = contact_in(length, "N").replace("[parameters]\n", "[parameters]\nk = 2\n");
        let text = text.replace(force, "force = \"k*x\"");
        let file =
            ModelFile::parse("model.toml", &text).unwrap_or_else(|report| panic!("{report}"));
        let told: Vec<String> = file.warnings().iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), n_warnings, "{told:?}");
        assert!(told.iter().all(|told| told.contains("the unit of this force is not known")));
    }
}

#[test]
fn a_depth_with_a_number_is_taken_to_be_converted_by_it_which_is_warned_of() {
    for (depth, metres) in [("x", 3e-3), ("0.001*x", 3e-3), ("x/2000", 1.5e-3), ("x/2", 1.5)] {
        let text = contact_in("mm", "N").replace("depth = \"x\"", &format!("depth = \"{depth}\""));
        let model = model(&text);
        let y = Problem::start(&model);
        let told = model.touch(&model.initial_mode(0.0, &y), 0.0, &y, 0).unwrap();
        assert!((told.depth - metres).abs() < 1e-15, "{depth}: {}", told.depth);
        let file = ModelFile::parse("model.toml", &text).unwrap();
        let warnings = file.warnings().iter().map(ToString::to_string).collect::<String>();
        let is_warned = warnings.contains("are taken to convert it to m");
        assert_eq!(is_warned, depth != "x", "{depth}: {warnings}");
    }
}

#[test]
fn a_contact_that_is_no_length_or_no_force_is_warned_of() {
    let text = contact_in("rad", "N m");
    let file = ModelFile::parse("model.toml", &text).unwrap_or_else(|report| panic!("{report}"));
    let told = file.warnings().iter().map(ToString::to_string).collect::<String>();
    for own in ["depth of a contact is told in m, and this", "force of a contact is told in N, and"]
    {
        assert!(told.contains(own), "{told}");
    }
}

#[test]
fn one_number_has_no_index() {
    let model = model(
        "[parameters]\ni = 5\n[states]\nx = { start = \"i\", scale = \"2*i\" }\n[modes.a]\nrates = { x = \"-i\" }\n",
    );
    assert_eq!(Problem::start(&model)[..], [5.0]);
    assert_eq!(model.states()[0].scale, 10.0);
}

#[test]
fn energies_of_a_model_without_units_are_not_checked() {
    let energies = |state: &str| {
        let text = format!(
            "[states]\nx = {state}\n[modes.a]\nrates = {{ x = 1 }}\n\
             [energy]\nkinetic = \"1 - cos(x)\"\nelastic = \"exp(x)\"\n[power]\ndrive = \"sin(x)\"\n"
        );
        ModelFile::parse("model.toml", &text).map_err(|report| report.message().to_owned())
    };
    assert!(energies("1").is_ok());
    let message = energies("{ start = 1, unit = \"rad\" }").unwrap_err();
    assert!(message.starts_with("an energy is in m^2 kg s^-2"), "{message}");
}

/// A body that falls from rest through air.
const DRAG: &str = "[states]\nvx = 0\nvy = 0\n[modes.fall.rates]\n\
    vx = \"1 - 0.5*vx*hypot(vx, vy)\"\nvy = \"-9.81 - 0.5*vy*sqrt(vx^2 + vy^2) + KINK\"\n";

#[test]
fn a_speed_at_rest_has_the_slope_zero() {
    // By formulas, and by dual numbers.
    for kink in ["0", "abs(vx)"] {
        let text = DRAG.replace("KINK", kink);
        let model = model(&text);
        let y = Problem::start(&model);
        let mode = model.initial_mode(0.0, &y);
        let expected = if kink == "0" { 0.0 } else { 1.0 };
        model.jacobian(mode, 0.0, &y, |i, j, entry| {
            assert_eq!(entry, if (i, j) == (1, 0) { expected } else { 0.0 }, "{kink}: {i}, {j}");
        });
    }
}

#[test]
fn the_first_event_is_the_starts_own_where_a_guard_falls_from_zero() {
    let falling = |velocity: f64, guard: &str| {
        model(&format!(
            "[states]\ny = 0\nw = {velocity}\n[rates]\ny = \"w\"\nw = \"-1\"\n[modes.up]\n\
             events = [{{ when = \"{guard}\", to = \"down\" }}]\n[modes.down]\n"
        ))
    };
    for (velocity, guard, is_own) in [
        (5.0, "y < 0", false),
        (0.0, "y < 0", true),
        (0.0, "y > 0", false),
        (-5.0, "y < 0", true),
        (5.0, "t > 3", false),
    ] {
        assert_eq!(falling(velocity, guard).starts_on_surface(), is_own, "{velocity} {guard}");
    }
}

/// Where to is a matter of the last digit; both modes are free.
#[test]
fn a_run_that_goes_to_another_mode_of_the_same_role_has_other_events() {
    let model = model(
        "[parameters]\nlimit = 0.36788\n[states]\ny = 1\n[rates]\ny = \"-y\"\n\
         [modes.a]\nevents = [{ when = \"t > 1\", to = \"choice\" }]\n\
         [modes.choice]\nevents = [{ when = \"y > limit\", to = \"high\" }, { when = \"y < limit\", to = \"low\" }]\n\
         [modes.high]\n[modes.low]\n",
    );
    let changes = |start: f64| {
        let mut trajectory = Trajectory::on(Grid::Steps);
        let accuracy = Accuracy::Rtol(1e-9, None);
        let setting =
            Setting { method: Method::named("rk45").unwrap(), events: Events::Located, accuracy };
        let mut y0 = model.start();
        y0[0] = start;
        let run = integrate(&model, &setting, y0, 2.0, &mut trajectory);
        assert!(run.outcome.is_ok());
        problem::changes(&model, &trajectory.events).remove(0)
    };
    let [low, high] = [1.0, 1.0001].map(changes);
    assert_eq!((low.len(), high.len()), (2, 2));
    assert!(low[0].is_like(&high[0]) && !low[1].is_like(&high[1]), "{low:?} {high:?}");
}

#[test]
fn a_column_of_megametres_is_not_named_as_one_of_millimetres() {
    let header = |unit: &'static str| Quantity::new("x", unit, 1.0).header();
    let all = ["Mm", "mm", "MN/Mm", "N m/s²", ""].map(header);
    assert_eq!(all, ["x_Mm", "x_mm", "x_Mn_Mm", "x_n_m_s2", "x"]);
}
