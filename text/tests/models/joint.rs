//! Both joints of the paper, against the golden runs of the built-in mechanism.

use deltazero_solvers::Grid;

use super::runs::{Run, below, parameter, parts, t_end};

mod stick;

/// State in the paper's order, and mode: 0 free, ±1 the sign of v_T, 2 stick.
type Row = (f64, i8, [f64; 6]);

fn rows<const N: usize>(name: &str) -> Vec<[f64; N]> {
    let path = format!("{}/../tests/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let row = |line: &str| -> [f64; N] {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        fields.try_into().unwrap()
    };
    text.lines().skip(1).map(row).collect()
}

/// Samples and events of a joint.
fn golden(joint: usize) -> (Vec<Row>, Vec<(f64, i8, i8)>) {
    let states = rows::<9>("pin_table1.csv").into_iter();
    let events = rows::<4>("pin_table1.events.csv").into_iter();
    let own = |number: f64| number as usize == joint;
    (
        states.filter(|row| own(row[0])).map(|[_, t, mode, y @ ..]| (t, mode as i8, y)).collect(),
        events
            .filter(|row| own(row[0]))
            .map(|[_, t, before, after]| (t, before as i8, after as i8))
            .collect(),
    )
}

fn code(mode: &str) -> i8 {
    match mode {
        "free" => 0,
        "slip+" => 1,
        "slip-" => -1,
        "stick" => 2,
        other => panic!("{other}"),
    }
}

/// e and the largest error of an event's time, of both joints.
fn compare(method: &str, rtol: f64) -> [f64; 2] {
    let c = parameter("paper_joint", "c");
    let [one, two] = [golden(1), golden(2)];
    let most = one.0.iter().chain(&two.0).fold(0.0_f64, |most, (.., y)| most.max(y[2].abs()));
    let (mut e, mut late) = (0.0_f64, 0.0_f64);
    for (k, (model, (states, events))) in
        parts("paper_joint", &[]).iter().zip([one, two]).enumerate()
    {
        let times = states.iter().map(|row| row.0).collect();
        let run = Run::on(model, method, rtol, t_end("paper_joint"), Grid::Times(times));
        assert_eq!(run.samples.len(), states.len());
        for ((_, own), (_, _, golden)) in run.samples.iter().zip(&states) {
            // The paper has (y02, z02, θ2) at joint 2.
            let [x, y] = if k == 0 { [0, 1] } else { [1, 0] };
            let pin = libm::hypot(own[0] - golden[x], own[1] - golden[y]) / c;
            e = e.max(pin).max((own[2] - golden[2]).abs() / most);
        }
        assert_eq!(run.changes.len(), events.len(), "{method}: {:?}", run.changes);
        for (n, (change, (t, before, after))) in run.changes.iter().zip(&events).enumerate() {
            assert_eq!(
                [code(&change.before), code(&change.after)],
                [*before, *after],
                "{change:?}"
            );
            // The first is at 0⁺, where its time has no digits.
            if n > 0 {
                late = late.max((change.t - t).abs());
            }
        }
    }
    [e, late]
}

#[test]
fn both_joints_have_all_golden_events_and_states() {
    for (method, rtol, bounds) in [
        // Measured: e = 9.9e-13, 2.2e-12, 2.3e-13, 8.0e-13, 6.7e-9, 2.0e-8;
        // events 5.7e-11, 4.1e-11, 3.7e-13, 6.2e-13, 3.2e-7, 9.2e-7 s.
        ("rk45", 1e-12, [9e-12, 5e-10]),
        ("dop853", 1e-12, [1e-11, 4e-10]),
        ("vern98", 1e-12, [2e-12, 3e-12]),
        ("taylor", 1e-12, [8e-12, 6e-12]),
        ("radau5", 1e-10, [6e-8, 3e-6]),
        ("bdf", 1e-10, [1e-7, 9e-6]),
    ] {
        let [e, late] = compare(method, rtol);
        below(&format!("{method} e"), e, bounds[0]);
        below(&format!("{method} events [s]"), late, bounds[1]);
    }
}
