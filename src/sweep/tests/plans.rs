//! Plans that are refused, the values of those that are not.

use super::Scratch;

/// The last word of each plan's trouble: the plan, its line, what the message says.
const WRONG: [(&str, usize, &[&str]); 23] = [
    ("chunck = 3\n", 1, &["\"chunck\"", "did you mean \"chunk\"?"]),
    ("chunk = 3\n", 1, &["has neither [[axis]] nor [random]"]),
    ("axis = 3\n", 1, &["axis = 3 is an integer", "list of tables"]),
    ("[[axis]]\nvalues = [1]\n", 1, &["[[axis]] has no \"key\""]),
    (
        "[[axis]]\nkey = \"contact.stifness\"\nvalues = [1]\n",
        2,
        &["contact.stifness", "\"contact.stiffness\""],
    ),
    (
        "[[axis]]\nkey = \"mechanism\"\nvalues = [\"strut\"]\n",
        2,
        &["mechanism cannot be swept", "a plan for each"],
    ),
    ("[[axis]]\nkey = \"cam.speed\"\nvalues = [1]\n", 2, &["cam.speed"]),
    ("[[axis]]\nkey = \"bays\"\nlinear = [1, 2]\npoints = 3\n", 3, &["bays = 1.5", "an integer"]),
    (
        "[[axis]]\nkey = \"contact.damping\"\nvalues = [1, 2,\n  -3]\n",
        4,
        &["contact.damping = -3", "at least 0"],
    ),
    (
        "[[axis]]\nkey = \"contact.damping\"\nvalues = []\n",
        3,
        &["a list of values of contact.damping"],
    ),
    (
        "[[axis]]\nkey = \"contact.damping\"\nlinear = [0, -1]\npoints = 3\n",
        3,
        &["contact.damping = -1"],
    ),
    (
        "[[axis]]\nkey = \"contact.damping\"\nlog = [0, 1]\npoints = 3\n",
        3,
        &["log = [0, 1]", "use linear"],
    ),
    ("[[axis]]\nkey = \"contact.damping\"\nlog = [1, 2]\n", 1, &["has no \"points\""]),
    (
        "[[axis]]\nkey = \"contact.damping\"\nlog = [1, 2]\npoints = 1\n",
        4,
        &["points = 1", "from 2"],
    ),
    ("[[axis]]\nkey = \"contact.damping\"\nlog = [1, 2]\nvalues = [1]\n", 1, &["takes one of"]),
    (
        "[[axis]]\nkey = \"bays\"\nvalues = [1]\n[[axis]]\nkey = \"bays\"\nvalues = [1]\n",
        5,
        &["bays cannot be swept", "already, at ", "plan.toml:2"],
    ),
    ("[random]\nsamples = 3\n", 1, &["draws nothing"]),
    ("[random]\n[[random.key]]\nkey = \"drive.m1\"\nuniform = [1, 2]\n", 1, &["no \"samples\""]),
    (
        "[random]\nsamples = 3\nsampling = \"halton\"\n[[random.key]]\nkey = \"drive.m1\"\nuniform = [1, 2]\n",
        3,
        &["sampling = \"halton\"", "sobol"],
    ),
    (
        "[random]\nsamples = 3\n[[random.key]]\nkey = \"bays\"\nuniform = [1, 2]\n",
        5,
        &["uniform = [1, 2]", "takes no decimal numbers"],
    ),
    (
        "[random]\nsamples = 3\n[[random.key]]\nkey = \"friction.coefficient\"\nuniform = [-0.1, 0.1]\n",
        5,
        &["friction.coefficient = -0.1 is out of range"],
    ),
    (
        "[random]\nsamples = 100_000\nsampling = \"sobol\"\n[[random.key]]\nkey = \"drive.m1\"\nnormal = [1, 2]\n",
        2,
        &["at most 65536", "latin_hypercube"],
    ),
    (
        "[random]\nsamples = 100_000\nsampling = \"saltelli\"\n[[random.key]]\nkey = \"drive.m1\"\nnormal = [1, 2]\n",
        2,
        &["at most 65536 samples of 128 keys"],
    ),
];

#[test]
fn a_wrong_plan_is_refused_with_file_line_key_value_and_a_way_out() {
    let scratch = Scratch::new();
    for (text, line, parts) in WRONG {
        let error = scratch.sweep(text, &[]).err().map(|error| error.to_string());
        let error = error.unwrap_or_else(|| panic!("accepted:\n{text}"));
        assert!(error.contains(&format!("plan.toml:{line}: ")), "{text}: {error}");
        for part in parts {
            assert!(error.contains(part), "no {part:?} in: {error}");
        }
        assert!(!error.contains('\n'), "{error}");
    }
    let foreign = "[[axis]]\nkey = \"strut.length\"\nvalues = [1]\n";
    let error = scratch.sweep(foreign, &["mechanism=cam-follower"]).err().unwrap().to_string();
    assert!(error.contains("mechanism = cam-follower does not use it"), "{error}");
    for (mechanism, key) in [
        ("slider-crank", "strut.length"),
        ("slider-crank", "run.stop_at_90"),
        ("four-bar", "regimes.readings"),
    ] {
        let plan = format!("[[axis]]\nkey = \"{key}\"\nvalues = [1]\n");
        let error = scratch.sweep(&plan, &[&format!("mechanism={mechanism}")]).err().unwrap();
        let told = format!("plan.toml:2: {key} cannot be swept: mechanism = {mechanism} does not");
        assert!(error.to_string().contains(&told), "{error}");
    }
    let base = "config = \"base.toml\"\n[[axis]]\nkey = \"bays\"\nvalues = [1]\n";
    let error = scratch.sweep(base, &[]).err().unwrap().to_string();
    assert!(error.contains("base.toml: cannot be read"), "{error}");
    scratch.write("base.toml", "[contact]\nstifness = 3\n");
    let error = scratch.sweep(base, &[]).err().unwrap().to_string();
    assert!(error.contains("base.toml:2: ") && error.contains("did you mean"), "{error}");
    let none = "[[axis]]\nkey = \"joint.clearance\"\nvalues = [0]\n";
    let error = scratch.sweep(none, &["friction.law=lugre"]).err().unwrap().to_string();
    assert!(error.contains("does not go with friction.law = lugre"), "{error}");
}

#[test]
fn a_key_that_the_plan_varies_takes_no_value_by_set() {
    let scratch = Scratch::new();
    let plan = "config = \"base.toml\"\n[[axis]]\nkey = \"contact.stiffness\"\nvalues = [1e6]\n";
    scratch.write("base.toml", "contact.stiffness = 1e7\n");
    let error = scratch.sweep(plan, &["joint2.contact.stiffness=2e7"]).err().unwrap().to_string();
    assert!(error.contains("as in joint1.contact.stiffness"), "{error}");
    for set in ["contact.stiffness=1e8", "contact={ stiffness = 1e8 }"] {
        let error = scratch.sweep(plan, &[set]).err().unwrap().to_string();
        let told = format!("plan.toml:3: contact.stiffness cannot be swept: --set {set} gives it");
        assert!(error.contains(&told) && error.contains("leave one of the two away"), "{error}");
    }
}

#[test]
fn ends_whose_distance_is_no_number_are_refused() {
    let scratch = Scratch::new();
    let linear = "[[axis]]\nkey = \"drive.m1\"\nlinear = [-1e308, 1e308]\npoints = 3\n";
    let uniform =
        "[random]\nsamples = 8\n[[random.key]]\nkey = \"drive.m1\"\nuniform = [-1e308, 1e308]\n";
    for plan in [linear, uniform] {
        let error = scratch.sweep(plan, &[]).err().unwrap().to_string();
        assert!(error.contains("farther apart than the largest number"), "{error}");
    }
}

#[test]
fn the_values_of_an_axis_have_both_ends_and_even_distances_or_ratios() {
    let scratch = Scratch::new();
    let plan = "[[axis]]\nkey = \"contact.stiffness\"\nlog = [1e5, 1e10]\npoints = 6\n\
                [[axis]]\nkey = \"contact.damping\"\nlinear = [0, 300]\npoints = 4\n";
    let sweep = scratch.sweep(plan, &[]).unwrap();
    let values: Vec<f64> = (0..6).filter_map(|i| sweep.plan.axes[0].values.number(i)).collect();
    assert_eq!(values, [1e5, 1e6, 1e7, 1e8, 1e9, 1e10]);
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for (run, expected) in
        [(0, [1e5, 0.0]), (1, [1e5, 100.0]), (4, [1e6, 0.0]), (23, [1e10, 300.0])]
    {
        sweep.plan.indices(run, &mut indices);
        sweep.plan.values(run, &indices, &mut values);
        assert_eq!(values, expected.map(serde_json::Value::from), "{run}");
    }
}

#[test]
fn the_design_for_sobol_indices_exchanges_one_key_at_a_time() {
    let scratch = Scratch::new();
    let plan = "[[axis]]\nkey = \"bays\"\nvalues = [1, 2]\n\
                [random]\nsamples = 5\nsampling = \"saltelli\"\n\
                [[random.key]]\nkey = \"friction.coefficient\"\nuniform = [0.05, 0.2]\n\
                [[random.key]]\nkey = \"drive.m1\"\nuniform = [0.5, 2]\n";
    let sweep = scratch.sweep(plan, &[]).unwrap();
    assert_eq!(sweep.n_runs, 2 * 5 * 4);
    let values = |run| {
        let (mut indices, mut values) = (Vec::new(), Vec::new());
        sweep.plan.indices(run, &mut indices);
        sweep.plan.values(run, &indices, &mut values);
        values
    };
    for sample in 0..10 {
        let [a, b, first, second] = [0, 1, 2, 3].map(|run| values(4 * sample + run));
        assert_eq!(a[0], if sample < 5 { 1 } else { 2 });
        assert!(a[1] != b[1] && a[2] != b[2], "{a:?} {b:?}");
        assert_eq!([&first[1], &first[2]], [&b[1], &a[2]]);
        assert_eq!([&second[1], &second[2]], [&a[1], &b[2]]);
    }
}

#[test]
fn a_plan_written_as_a_file_is_read_back_as_it_was() {
    let scratch = Scratch::new();
    scratch.write("base.toml", "run.t_end = 0.1\n");
    for text in [
        super::PLAN.to_owned(),
        "audit = false\ncheck = 0.1\n[[axis]]\nkey = \"bays\"\nlinear = [1, 3]\npoints = 3\n"
            .to_owned(),
        "[[axis]]\nkey = \"contact.damping\"\nvalues = [0.1, 2, 1e-9]\n".to_owned(),
        "[random]\nsamples = 8\nseed = 5\nsampling = \"saltelli\"\n\
         [[random.key]]\nkey = \"drive.m1\"\nlog_uniform = [0.3, 2]\n"
            .to_owned(),
    ] {
        let plan = scratch.sweep(&text, &[]).ok().unwrap().plan;
        let written = plan.to_toml("base.toml");
        let again = scratch.sweep(&written, &[]).ok().unwrap().plan;
        assert_eq!(again, plan, "{written}");
    }
}

#[test]
fn whole_numbers_at_equal_distances_or_ratios_are_not_lost_by_rounding() {
    let scratch = Scratch::new();
    let values = |form: &str, points: u64| {
        let plan = format!("[[axis]]\nkey = \"study.max_rhs\"\n{form}\npoints = {points}\n");
        let sweep = scratch.sweep(&plan, &[]).unwrap();
        (0..points).map(|i| sweep.plan.axes[0].values.at(i)).collect::<Vec<_>>()
    };
    for n in 2..200 {
        assert_eq!(values(&format!("linear = [1, {n}]"), n), (1..=n).collect::<Vec<_>>());
    }
    let powers: Vec<u64> = (0..30).map(|k| 1 << k).collect();
    assert_eq!(values("log = [1, 536870912]", 30), powers);
}
