//! What is said of units that do not fit.

use deltazero_text::ModelFile;

use crate::common::file;
use crate::refusal;

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
    ("v = \"sin(v*t/x)\"", "the rate of `v` is in m s^-2, and this has no unit"),
    ("v = \"w/t\"", "the rate of `v` is in m s^-2, and this is in 0.001 m s^-2"),
];

/// A model of a mass m [kg], a force F [N], a speed w [mm/s], x [m] and v [m/s], with these rates and then these tables.
fn with_units(rates: &str, tables: &str) -> String {
    format!(
        "[parameters]\nm = {{ value = 2, unit = \"kg\" }}\nF = {{ value = 1, unit = \"N\" }}\n\
         w = {{ value = 1, unit = \"mm/s\" }}\nphi = {{ value = 30, unit = \"deg\" }}\nfree = 1\n\
         [states]\nx = {{ start = 0, unit = \"m\" }}\nv = {{ start = 0, unit = \"m/s\" }}\n\
         [rates]\nx = \"v\"\n[modes.a.rates]\n{rates}\n{tables}"
    )
}

/// The right side of `v̇ [m/s²] = …`.
fn with_right(right: &str) -> String {
    with_units(&format!("v = \"{right}\""), "")
}

/// What is said of the units of a right side; nothing where they are as they should be.
fn said_of_units(right: &str) -> String {
    let report = ModelFile::parse("units.toml", &with_right(right)).err();
    report.map_or(String::new(), |report| report.to_string())
}

#[test]
fn units_of_both_sides_are_compared() {
    for right in ["F/m", "sqrt(F^2)/m", "F/m + v^2*x^-1", "v/t*cos(v*t/x)", "abs(-F)/m", "free*w"] {
        assert_eq!(said_of_units(right), "");
    }
    for (rates, message) in WRONG_UNITS {
        let report = ModelFile::parse("units.toml", &with_units(rates, "")).unwrap_err();
        assert_eq!(report.message(), *message, "{report}");
        assert!(report.help().is_some_and(|help| !help.is_empty()), "{report}");
    }
}

#[test]
fn a_number_in_a_product_has_no_unit() {
    for right in [
        "-2*F/m",
        "F/(2*m)",
        "pi*F/m/3",
        "(2*F)^2/(4*F*m)",
        "sqrt(2*F^2)/m",
        "2^2*F/m",
        "F/m*x^(1/2)/x^0.5",
        "F/m*exp(-2)*sin(1)",
        "F/m*sum(i in 1..3, 0.5*i^2)",
        "2*free*x",
    ] {
        assert_eq!(said_of_units(right), "");
    }
    for (right, unit) in [
        ("-2*F", "is in m kg s^-2"),
        ("F/2", "is in m kg s^-2"),
        ("3*x", "is in m"),
        ("pi*x", "is in m"),
        ("(2*x)^3", "is in m^3"),
        ("2/x", "is in m^-1"),
        ("sqrt(4*x)", "is in m^0.5"),
        ("sum(i in 1..3, x*i)", "is in m"),
        ("2*cos(v*t/x)", "has no unit"),
    ] {
        let said = said_of_units(right);
        let both = format!("the rate of `v` is in m s^-2, and this {unit}\n");
        assert!(said.contains(&both) && said.contains("units.toml:13:6"), "{right}: {said}");
    }
    let said = said_of_units("-2*x");
    assert!(
        said.contains("this over that is in s^2: a factor is missing, or one too many; ")
            && said.contains("a parameter `{ value = 2, unit = \"s^-2\" }` has one"),
        "{said}"
    );
}

#[test]
fn a_number_alone_on_a_side_has_the_unit_of_the_other() {
    for right in ["9.81", "-9.81/2", "1e-3*sqrt(2)", "sum(i in 1..3, i)"] {
        assert_eq!(said_of_units(right), "");
    }
    for tables in [
        "[modes.a]\nevents = [{ when = \"x > 0.05\", set = { v = \"-1/2\" } }]\n",
        "[modes.a]\nevents = [{ when = \"max(x, 1e-3) > 2*0.01\", stop = true }]\n",
        "[definitions]\nd = { value = \"1/3\", unit = \"mm\" }\n[energy]\nkinetic = 1\n",
        "[definitions]\nd = \"if(free > 1, x, 0.1) + x\"\n",
        "[parts.one.start]\nx = 0.1\n",
    ] {
        file(&with_units("v = 0", tables));
    }
    for (tables, both) in [
        (
            "[modes.a]\nevents = [{ when = \"2*x > 3*v\", stop = true }]\n",
            ["this is in m", "this is in m s^-1"],
        ),
        (
            "[modes.a]\nevents = [{ when = \"x > 1\", set = { v = \"-2*x\" } }]\n",
            ["`v` is in m s^-1", "this is in m"],
        ),
        (
            "[definitions]\nd = { value = \"2*x\", unit = \"N\" }\n",
            ["`d` is in m kg s^-2", "this is in m"],
        ),
        ("[energy]\nkinetic = \"m*v^2/2*x\"\n", ["is in m^2 kg s^-2", "this is in m^3 kg s^-2"]),
        ("[parts.one.start]\nx = \"2*F\"\n", ["`x` is in m", "this is in m kg s^-2"]),
    ] {
        let said = refusal(&with_units("v = 0", tables));
        assert!(both.iter().all(|own| said.contains(own)), "{tables}: {said}");
    }
}

#[test]
fn a_number_in_a_sum_has_no_unit_unless_it_is_zero() {
    for right in ["F/m + 0", "0*x + F/m - 0*free", "(1 + v*t/x)*F/m", "F/m + free", "hypot(F, 0)/m"]
    {
        assert_eq!(said_of_units(right), "");
    }
    for (right, unit) in [
        ("F/m + 1", "this is in m s^-2"),
        ("1 - 2*F/m", "this is in m s^-2"),
        ("(1 - x)*F/m", "this is in m"),
        ("F/m*sqrt(v^2 + 1e-6)", "this is in m^2 s^-2"),
        ("hypot(F, 1e-6)/m", "this is in m kg s^-2"),
    ] {
        let said = said_of_units(right);
        for words in [unit, "this is a number without a unit", "unit = \"m", "0 fits every unit"] {
            assert!(said.contains(words), "{right}, {words}: {said}");
        }
    }
}

#[test]
fn a_definition_of_a_number_is_a_number() {
    let with = |flight: &str| {
        let own = format!(
            "[modes.a.definitions]\nk = {flight}\n[energy]\nkinetic = \"k*x\"\n[power]\ndrive = \"k*v\"\n"
        );
        ModelFile::parse("model.toml", &with_units("v = \"F/m - k/m\"", &own)).err()
    };
    for fits in ["0", "\"F\"", "{ value = 3, unit = \"N\" }", "\"2*F\"", "\"3*free\""] {
        assert!(with(fits).is_none(), "{fits}: {}", with(fits).unwrap());
    }
    for wrong in ["3", "\"x\"", "{ value = 3, unit = \"kg\" }"] {
        assert!(with(wrong).is_some(), "{wrong}");
    }
}

#[test]
fn a_number_may_convert_one_scale_to_another() {
    for right in [
        "0.001*w/t",
        "w/1000/t",
        "w/(2000*t)",
        "(w/1000)^2/(2*x)",
        "v/t*sin(phi*pi/180)",
        "v/t*cos(2*pi/180*phi)",
        "F/m + 1e-3*w/t",
        "2*w/3.6/t",
        "48*F*(w/1000)^3/(v/1000)^3/m",
    ] {
        assert_eq!(said_of_units(right), "");
    }
    for right in ["w/t", "-w/t", "w^2/x", "v/t*sin(phi)", "F/m + w/t"] {
        let said = said_of_units(right);
        assert!(said.contains("both are of one kind: a factor of "), "{right}: {said}");
    }
}

#[test]
fn a_number_far_from_the_factor_that_converts_is_warned_of() {
    let warned = |right: &str| {
        let warnings = file(&with_right(right)).warnings();
        warnings.iter().map(ToString::to_string).collect::<String>()
    };
    // With w in mm/s, and an angle in degrees.
    for right in [
        "0.001*w/t",
        "w/1000/t",
        "w/(2000*t)",
        "0.02*w/t",
        "v/t*sin(phi*pi/180)",
        "2*F/m",
        "F/m + 1e-3*w/t",
    ] {
        assert_eq!(warned(right), "", "{right}");
    }
    for right in ["2*w/t", "1000*w/t", "F/m + 2*w/t", "v/t*sin(2*phi)"] {
        assert!(warned(right).contains("the numbers here make"), "{right}: {}", warned(right));
    }
    let conditions = [
        ("x > 2*w*t", 1),
        ("x > 0.002*w*t", 0),
        ("w > 2*v", 1),
        ("2000*v < w", 0),
        ("2*v < 2*w", 1),
    ];
    for (when, n) in conditions {
        let tables = format!("[[modes.a.events]]\nwhen = \"{when}\"\nto = \"a\"\n");
        assert_eq!(file(&with_units("v = 0", &tables)).warnings().len(), n, "{when}");
    }
}

#[test]
fn a_number_that_is_to_have_a_unit_is_told_with_its_sign_and_in_a_unit_that_fits() {
    let help = "a parameter `{ value = 0.25, unit = \"m s^-2\" }` has one";
    let said = said_of_units("F/m - 0.25");
    assert!(said.contains(help), "{said}");
    // A unit with a factor has no name in base units.
    for right in ["(w - 0.25)/t", "F/m*(90 - phi)"] {
        let said = said_of_units(right);
        assert!(said.contains("a parameter with its `unit` has one"), "{right}: {said}");
    }
}

#[test]
fn conditions_kept_values_and_contacts_are_looked_at() {
    for tables in [
        "[definitions]\nd = \"if(m > k, x, x)\"\n[parameters.k]\nvalue = 1\nunit = \"m\"\n",
        "[modes.a]\nkeep = { at = \"x + v\" }\n",
        "[modes.a]\nrole = \"contact\"\n[contact]\ndepth = \"x - 0.5\"\nforce = \"F\"\n",
        "[modes.a]\nrole = \"contact\"\n[contact]\ndepth = \"x\"\nforce = \"F + x\"\n",
    ] {
        let said = refusal(&with_units("v = 0", tables));
        assert!(said.contains("this is in") && said.contains("help"), "{tables}: {said}");
    }
}

#[test]
fn functions_in_functions_are_looked_at_once() {
    let right = format!("F/m*{}v*t/x{}", "sin(".repeat(60), ")".repeat(60));
    assert_eq!(said_of_units(&right), "");
}

/// A mass on a spring of K [kN/m] with a common definition, and one of the mode that stands before it.
fn with_definitions(common: &str, of_mode: &str) -> String {
    format!(
        "[parameters]\nm = {{ value = 2, unit = \"kg\" }}\nK = {{ value = 1, unit = \"kN/m\" }}\n\
         [states]\nx = {{ start = 0, unit = \"m\" }}\nv = {{ start = 0, unit = \"m/s\" }}\n\
         [definitions]\n{common}\n[modes.a]\ndefinitions = {{ {of_mode} }}\nrates = {{ x = \"v\", v = \"F/m\" }}\n"
    )
}

#[test]
fn a_definition_of_a_mode_is_looked_at_though_a_common_one_has_its_name() {
    let kilonewtons = "F = \"-K*x\"";
    for (common, both) in [
        (
            "F = { value = 0, unit = \"N\" }",
            [
                "`F` is in m kg s^-2, and this is in 1000 m kg s^-2",
                "the unit of its column in tables",
            ],
        ),
        ("F = 0", ["the rate of `v` is in m s^-2", "this is in 1000 m s^-2"]),
    ] {
        let said = refusal(&with_definitions(common, kilonewtons));
        assert!(both.iter().all(|own| said.contains(own)), "{common}: {said}");
    }
    let newtons = "F = { value = \"-1000*K*x\", unit = \"N\" }";
    let fits = with_definitions("F = \"x\"", newtons);
    file(&fits);
    // Here the column of newtons would hold metres in the mode `b`.
    let said = refusal(&(fits + "[modes.b]\nrates = { x = \"v\", v = 0 }\n"));
    assert!(
        said.contains("and this is in m\n") && said.contains("the unit of its column"),
        "{said}"
    );
    file(&with_definitions("F = { value = 0, unit = \"N\" }", "F = \"-1000*K*x\""));
}

#[test]
fn definitions_of_two_modes_have_one_column_and_one_unit() {
    let with = |[of_a, of_b]: [&str; 2]| {
        let gap = |unit: &str| {
            format!("definitions = {{ gap = {{ value = \"x\", unit = \"{unit}\" }} }}\n")
        };
        let text = "[states]\nx = 1\n[rates]\nx = 1\n[modes.a]\n".to_owned();
        text + &gap(of_a) + "[modes.b]\n" + &gap(of_b)
    };
    for units in [["m", "m"], ["N m", "J"]] {
        file(&with(units));
    }
    for units in [["m", "mm"], ["rpm", "rps"], ["m", "rpm"]] {
        let said = refusal(&with(units));
        for words in ["and both have one column in tables", "the other one", "help", ":8:45"] {
            assert!(said.contains(words), "{words}: {said}");
        }
    }
}
