//! `audit`: the paper's claims, whatever the threads.

use deltazero::figures::OF_AUDITS;
use deltazero::paper::audit::Audit;
use deltazero::report;
use serde_json::Value;

use crate::{Scratch, committed, with_sets};

const READINGS: [&str; 5] = ["pin", "full", "centroid", "printed", "cosine"];

/// What was found of `claim` under `reading`.
fn row<'a>(rows: &'a [Value], claim: &str, reading: &str) -> &'a Value {
    rows.iter().find(|row| row["claim"] == claim && row["reading"] == reading).unwrap()
}

fn measured(rows: &[Value], claim: &str, reading: &str) -> f64 {
    row(rows, claim, reading)["measured"].as_f64().unwrap()
}

#[test]
fn every_claim_of_the_paper_is_judged_under_every_reading_as_in_the_readme() {
    let scratch = Scratch::new();
    let ran = scratch.succeed(&["audit", "--out", "out", "--json"]);
    assert!(ran.stderr.contains("written to out"), "{}", ran.stderr);
    let rows: Vec<Value> = serde_json::from_str(&ran.stdout).unwrap();
    let table = scratch.table("out/audit.csv");
    assert_eq!(table.rows.len(), rows.len());
    for row in &rows {
        let verdict = row["verdict"].as_str().unwrap();
        assert!(["reproduced", "not_reproduced", "impossible"].contains(&verdict), "{row}");
        let is_ideal = row["reading"] == "ideal";
        assert!(is_ideal || READINGS.iter().any(|name| row["reading"] == *name), "{row}");
        assert!(!row["unit"].as_str().unwrap().is_empty(), "{row}");
    }
    judged(&rows);
    let record = scratch.json("out/audit.json");
    found(&record["audit"], &rows);
    as_committed(&serde_json::from_value(record["audit"].clone()).unwrap());
}

/// The figures of the paper, and those that model and paper agree or differ in.
fn judged(rows: &[Value]) {
    let times = [
        ("ideal_theta1_90", "ideal", 13.5186, "reproduced"),
        ("ideal_theta2_90", "ideal", 13.3975, "reproduced"),
        ("clearance_theta2_90", "cosine", 9.06, "reproduced"),
        ("clearance_theta2_90", "pin", 13.40, "not_reproduced"),
        ("clearance_theta2_90", "full", 13.40, "not_reproduced"),
        ("clearance_theta2_90", "centroid", 7.81, "not_reproduced"),
        // Its digits are lost long before: a last-bit change of the start moves it by 0.007 s.
        ("clearance_theta1_90", "printed", 11.8, "not_reproduced"),
    ];
    for (claim, reading, time, verdict) in times {
        let found = measured(rows, claim, reading);
        let bound = if reading == "printed" { 0.1 } else { 0.01 };
        assert!((found - time).abs() < bound, "{claim}, {reading}: {found}");
        assert_eq!(row(rows, claim, reading)["verdict"], verdict, "{claim}, {reading}");
    }
    let never = row(rows, "clearance_theta2_90", "printed");
    assert_eq!((&never["measured"], &never["verdict"]), (&Value::Null, &"not_reproduced".into()));
    let horizon = row(rows, "clearance_theta1_90", "printed")["horizon_s"].as_f64().unwrap();
    assert!((3.0..8.0).contains(&horizon), "{horizon}");
    let is_beyond =
        |claim: &str, reading: &str| row(rows, claim, reading)["beyond_horizon"] == true;
    // What is over before its digits are lost, and what is not; what is lost is marked, with fewer digits, everywhere.
    for (claim, reading, beyond) in [
        ("ideal_theta1_90", "ideal", false),
        ("separations", "printed", false),
        ("f_n1_settled", "printed", false),
        ("x01_max", "full", false),
        ("x01_max", "printed", true),
        ("f_n1_stays_settled", "printed", true),
        ("clearance_theta1_90", "pin", true),
    ] {
        assert_eq!(is_beyond(claim, reading), beyond, "{}", row(rows, claim, reading));
    }
    let papers = [
        ("ideal_theta1_90", 13.5),
        ("clearance_theta2_90", 9.0),
        ("f_n1_settled", 0.48),
        ("f_n2_settled", 0.4),
        ("x01_max", 5.4e-4),
        ("y01_max", 1e-4),
    ];
    for (claim, paper) in papers {
        let own = rows.iter().filter(|row| row["claim"] == claim);
        assert!(own.clone().all(|row| row["paper"] == paper), "{claim}");
        assert_eq!(own.count(), if claim.starts_with("ideal") { 1 } else { 5 });
    }
    for reading in READINGS {
        assert_eq!(row(rows, "x01_max", reading)["verdict"], "impossible");
    }
    let forces = [
        ("full", 0.27, 0.14),
        ("centroid", 0.63, 0.54),
        ("cosine", 0.40, 0.36),
        ("pin", 0.44, 0.24),
    ];
    for (reading, first, second) in forces {
        assert!((measured(rows, "f_n1_settled", reading) - first).abs() < 0.005, "{reading}");
        assert!((measured(rows, "f_n2_settled", reading) - second).abs() < 0.006, "{reading}");
    }
}

/// The ratio of torques without clearance is a closed form; clearance moves it little where the reading is
/// consistent.
fn found(audit: &Value, rows: &[Value]) {
    let time = |claim: &str| measured(rows, claim, "ideal");
    let faster = time("ideal_theta1_90") / time("ideal_theta2_90");
    let ideal = measured(rows, "torque_ratio_ideal", "ideal");
    // Measured: 5.0e-8; the search ends at 1e-7.
    assert!((ideal / (faster * faster / 0.3) - 1.0).abs() < 3e-7, "{ideal}");
    for reading in ["pin", "full"] {
        let ratio = measured(rows, "torque_ratio_clearance", reading);
        // Measured: 2.2e-5 and 1.2e-4.
        assert!((ratio / ideal - 1.0).abs() < 1e-3, "{reading}: {ratio}");
    }
    for curve in audit["torque_ratio"]["curves"].as_array().unwrap() {
        let points = curve["theta2_90"].as_array().unwrap();
        let times: Vec<f64> = points.iter().map(|point| point[1].as_f64().unwrap()).collect();
        assert!(times.is_sorted(), "a weaker torque arrives later: {curve}");
    }
    // Energy is fed in where the reading is not consistent, and nowhere else.
    for run in audit["runs"].as_array().unwrap() {
        let fed = run["fed_in_j"].as_f64().unwrap().abs() / run["work_j"].as_f64().unwrap().abs();
        let consistent =
            run["reading"].is_null() || run["reading"] == "pin" || run["reading"] == "full";
        // Measured: at most 7.4e-14, and at least 0.044.
        assert!(if consistent { fed < 7e-13 } else { fed > 0.01 }, "{run}");
    }
}

/// What can be predicted is in the README to every digit shown, and in the committed audit; what cannot is marked as such in
/// both.
fn as_committed(audit: &Audit) {
    let (readme, today) = (committed("README.md"), report::audit::answer(&audit.rows));
    let cells = |line: &str| -> Vec<String> { line.split(" | ").map(str::to_owned).collect() };
    let mut n_beyond = 0;
    for line in today.lines().filter(|line| line.starts_with("| `")) {
        let name = line.split(" | ").next().unwrap();
        let stored = readme.lines().find(|stored| stored.starts_with(&format!("{name} |")));
        let stored = stored.unwrap_or_else(|| panic!("{name} is not in the README"));
        assert_eq!(cells(line).len(), cells(stored).len(), "{line}\n{stored}");
        for (now, then) in cells(line).iter().zip(cells(stored)) {
            let is_beyond = now.contains('~');
            n_beyond += usize::from(is_beyond);
            assert!(if is_beyond { then.contains('~') } else { *now == then }, "{line}\n{stored}");
        }
    }
    // x01_max and the settled forces under `printed` among them, or there is nothing to be marked.
    assert!(n_beyond > 0, "{today}");
    let stored: Value = serde_json::from_str(&committed("docs/audit/audit.json")).unwrap();
    let stored: Audit = serde_json::from_value(stored["audit"].clone()).unwrap();
    for (row, stored) in audit.rows.iter().zip(stored.rows) {
        assert_eq!((&row.claim, &row.reading), (&stored.claim, &stored.reading));
        assert_eq!(row.beyond_horizon, stored.beyond_horizon, "{row:?} {stored:?}");
        if !row.beyond_horizon {
            let apart = row.measured.zip(stored.measured).map(|(a, b)| (a - b).abs());
            let size = row.measured.map_or(0.0, f64::abs);
            // Measured after a change of the solvers: 7.7e-5, of a maximum, which is looked for where steps have nodes.
            assert!(apart.is_none_or(|apart| apart <= 5e-4 * size), "{row:?} {stored:?}");
            assert_eq!(row.measured.is_some(), stored.measured.is_some(), "{row:?} {stored:?}");
        }
    }
}

#[test]
fn threads_change_nothing_and_every_figure_has_data() {
    let scratch = Scratch::new();
    // Torques 120 times as strong open the struts in an eleventh of the time.
    let run = |dir: &str, threads: &str| {
        let sets = ["drive.m1=120", "drive.m4=36", "contact.restitution=0.4", "reading=full"];
        let args = with_sets(&["audit", "--out", dir, "--threads", threads, "--quiet"], &sets);
        scratch.succeed(&args)
    };
    let (one, two) = (run("one", "1"), run("two", "2"));
    // The other way round it is the same motion.
    let sets = ["drive.m1=-120", "drive.m4=-36"];
    scratch.succeed(&with_sets(&["audit", "--out", "reversed", "--quiet"], &sets));
    assert_eq!(scratch.text("reversed/audit.csv"), scratch.text("one/audit.csv"));
    assert_eq!((one.stdout == two.stdout, one.stderr.as_str()), (true, ""));
    let files = scratch.files("one");
    assert_eq!(files, scratch.files("two"));
    for name in files.iter().filter(|name| !name.ends_with(".png")) {
        let same = scratch.text(&format!("one/{name}")) == scratch.text(&format!("two/{name}"));
        assert!(same, "{name}");
    }
    for name in ["audit.html", "audit.md", "audit.csv", "audit.json", "courses.csv"] {
        assert!(files.iter().any(|file| file == name), "{files:?}");
    }
    let svgs: Vec<&String> = files.iter().filter(|name| name.ends_with(".svg")).collect();
    assert_eq!(svgs, OF_AUDITS.map(|name| format!("figures/{name}.svg")).each_ref());
    for svg in svgs {
        assert!(files.contains(&svg.replace(".svg", ".png")), "{files:?}");
        assert!(!scratch.text(&format!("one/{svg}")).contains("no data"), "{svg}");
    }
}

#[test]
fn runs_that_end_early_leave_their_claims_undecided() {
    let scratch = Scratch::new();
    let sets =
        ["study.max_rhs=20000", "solver.rtol=1e-3", "contact.restitution=0.4", "reading=full"];
    let args = with_sets(&["audit", "--out", "out", "--json"], &sets);
    let ran = scratch.succeed(&args);
    for told in [
        "warning: an audit does not use reading, solver.rtol: ",
        "contact.law = power does not have",
    ] {
        assert!(ran.stderr.contains(told), "{}", ran.stderr);
    }
    assert!(ran.stderr.contains("warning: pin, joint 1: the run ends at 0."), "{}", ran.stderr);
    let rows: Vec<Value> = serde_json::from_str(&ran.stdout).unwrap();
    let of_readings: Vec<&Value> = rows.iter().filter(|row| row["reading"] != "ideal").collect();
    assert!(of_readings.len() > 50, "{}", of_readings.len());
    for row in of_readings {
        let is_impossible = row["claim"].as_str().unwrap().starts_with("x01_max");
        let verdict = if is_impossible { "impossible" } else { "undecided" };
        assert!(row["verdict"] == verdict && row["measured"].is_null(), "{row}");
    }
    let page = scratch.text("out/audit.md");
    assert!(page.contains("more than study.max_rhs = 20000") && !page.contains("never"), "{page}");
    assert!(!page.contains("contradict each other"), "{page}");
    // Texts of tables stand as they are, not to three digits.
    assert!(scratch.text("out/audit.html").contains(">13.5185923"));
    for torque in ["drive.m1", "drive.m4"] {
        let ran = scratch.run(&with_sets(&["audit"], &[&format!("{torque}=0")]));
        let told = format!("{torque} = 0");
        assert!(ran.code == Some(2) && ran.stderr.contains(&told), "{}", ran.stderr);
    }
}

#[test]
fn an_ideal_joint_has_the_same_times_with_and_without_readings() {
    let scratch = Scratch::new();
    let args = ["audit", "--json", "--set", "joint.clearance=0", "--set", "drive.m1=2"];
    let rows: Vec<Value> = serde_json::from_str(&scratch.succeed(&args).stdout).unwrap();
    assert!(scratch.path("deltazero-out/audit/audit.html").exists());
    for (joint, ideal) in [(1, "ideal_theta1_90"), (2, "ideal_theta2_90")] {
        for reading in READINGS {
            let claim = format!("clearance_theta{joint}_90");
            assert_eq!(measured(&rows, &claim, reading), measured(&rows, ideal, "ideal"));
        }
    }
}
