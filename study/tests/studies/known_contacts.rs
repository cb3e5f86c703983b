//! The study of contacts whose motion is known: a ball between two compliant walls, a mass on a spring that hits a stop.
//!
//! Errors are held to closed forms. Counts of work, winners and tables are held to what they were when the closed forms were
//! first met: a change of any of them is meant, or a defect.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use deltazero_solvers::Grid;
use deltazero_solvers::problems::{CompliantBall, SpringStop};
use deltazero_study::columns::shown;
use deltazero_study::map::{CellStatus, Map, MapAxis, MapPlan};
use deltazero_study::problem::Problem;
use deltazero_study::reference::Reference;
use deltazero_study::run::{Limits, Price, integrate};
use deltazero_study::selection::{Benchmark, Candidate, Contest, Rules, Start};
use deltazero_study::setting::Events;
use deltazero_study::simulation::{Asked, Simulation};
use deltazero_study::steps::StepTables;
use deltazero_study::warning::{Code, Warning};
use deltazero_study::work_precision::{Row, Status};
use deltazero_study::{Plan, Subject};

use crate::common::{WALLS, plan, study};

const T_END: f64 = 0.4;

/// A spring of a hertz or so, a stop forty times as stiff.
const STOP: SpringStop = SpringStop {
    mass: 1.0,
    stiffness: 50.0,
    stop_stiffness: 2000.0,
    gap: 0.05,
    start: [-0.2, 0.0],
};

/// Number to three digits, or a stroke.
fn short(number: Option<f64>) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.2e}"))
}

/// Fails where two texts differ, and prints the second.
fn assert_text(own: &str, expected: &str) {
    assert!(own.trim() == expected.trim(), "\n{own}");
}

#[test]
fn the_reference_of_a_ball_between_walls_has_its_events_forces_and_energies() {
    let (subject, stop) = (Subject::of(WALLS), AtomicBool::new(false));
    let Plan { times, .. } = Plan::new(T_END);
    let reference = Reference::new(&subject, T_END, &times, Limits::none(&stop)).unwrap();
    let ([x, v], events) = WALLS.solution(T_END);
    // The start is no event, and what happens there is neither.
    assert_eq!(
        (reference.n_events(), reference.n_all_events()),
        (events.len(), events.len() as u64)
    );
    assert_eq!(reference.horizon(), T_END);
    assert!(reference.summary.agreement < 1e-12, "{:e}", reference.summary.agreement);
    assert!(reference.summary.can_decide(1e-9) && !reference.summary.can_decide(1e-16));

    let row = study(&subject, &plan(&["dop853"], &[Events::Located], &[1e-12], &[], T_END))
        .rows
        .remove(0);
    assert_eq!((row.status, row.missed, row.spurious), (Status::Ok, Some(0), Some(0)));
    // Measured: 2e-13 s.
    assert!(
        row.event_time_error_s.is_some_and(|error| error < 2e-12),
        "{:?}",
        row.event_time_error_s
    );
    let named = |rows: &[Row]| shown(rows).iter().any(|column| column.name == "batch");
    let at_once = Row { batch: 2, ..row.clone() };
    assert_eq!([named(std::slice::from_ref(&row)), named(&[row.clone(), at_once])], [false, true]);
    let near = |own: Option<f64>, exact: f64, what: &str| {
        let error = (own.unwrap() / exact - 1.0).abs();
        assert!(error < 1e-7, "{what}: {own:?} {exact} {error:e}");
    };
    // In flight at the end, so all that was lost was lost to the walls.
    let speed = |v: f64| 0.5 * WALLS.mass * v * v;
    near(row.errors.dissipated_j, speed(WALLS.start[1]) - speed(v), "dissipated");
    assert!((0.0..WALLS.gap).contains(&x));
    // Contact k begins at the speed e^k and turns it round.
    let (e, n_contacts) = (WALLS.restitution(), events.len() / 2);
    let impulses = (0..n_contacts).map(|k| WALLS.mass * e.powi(k as i32) * (1.0 + e));
    near(row.errors.impulse_n_s, impulses.sum(), "impulse");
    // K δ + D δ̇ is largest in the first contact, where it is searched for on a fine grid.
    let force = |t: f64| {
        let [x, v] = WALLS.solution(t).0;
        (x - WALLS.gap) * WALLS.stiffness + v * WALLS.damping
    };
    let fine = (0..=20_000).map(|i| events[0] + (events[1] - events[0]) * f64::from(i) / 2e4);
    near(row.errors.peak_force_n, fine.map(force).fold(0.0, f64::max), "peak");
    // They are relative to the work of a drive, of which there is none.
    assert_eq!((row.errors.dissipation_error, row.errors.energy_residual), (None, None));
}

#[test]
fn the_first_events_are_judged_by_a_reference_of_their_own_time() {
    let (subject, stop) = (Subject::of(WALLS), AtomicBool::new(false));
    let Plan { times, .. } = Plan::new(T_END);
    let limits = Limits::none(&stop);
    let first = Benchmark::of_first(subject.clone(), T_END, times, limits, 3).unwrap();
    assert!((3..6).contains(&first.n_events) && first.t_end < T_END, "{first:?}");
    let own = Reference::new(&subject, first.t_end, &first.times, limits).unwrap();
    assert!(first.reference == own);
}

#[test]
fn runs_of_a_problem_that_offers_no_batch_are_made_one_by_one() {
    let stops = [STOP, SpringStop { stop_stiffness: 1000.0, ..STOP }];
    let begun: Vec<(&SpringStop, [f64; 2])> = stops.iter().map(|stop| (stop, stop.start)).collect();
    let plan = plan(&["rk45"], &[Events::Located], &[1e-6], &[], 1.0);
    let setting = &plan.settings[0];
    let (mut one, mut other) = ((), ());
    let runs = SpringStop::integrate_at_once(&begun, setting, 1.0, &mut [&mut one, &mut other]);
    let alone = |i: usize| integrate(begun[i].0, setting, begun[i].1, 1.0, &mut ());
    assert_eq!(runs.len(), 2);
    for (i, run) in runs.iter().enumerate() {
        assert_eq!((run.y, run.stats, run.batch), (alone(i).y, alone(i).stats, 1));
    }
    assert_ne!(runs[0].y, runs[1].y);
}

/// A row without its times.
fn told(row: &Row) -> String {
    let errors = &row.errors;
    let counts =
        [row.n_rhs, row.n_accepted, row.n_rejected, row.n_jac, row.n_lin_solves, row.n_retaken];
    let events = [row.n_events, row.missed, row.spurious].map(Option::unwrap);
    let all = [
        row.e,
        errors.e_max,
        errors.e_l2,
        errors.e_final,
        errors.peak_force_error,
        errors.contact_impulse_error,
        errors.impulse_error,
        errors.dissipation_error,
    ];
    let all = all.map(short).join(" ");
    let by_event = short(row.work_by_phase.n_rhs_per_event());
    format!(
        "{} {} {}: {counts:?} {events:?} {all} {by_event}",
        row.method,
        row.events,
        row.setting()
    )
}

#[test]
fn without_a_sample_before_the_horizon_no_error_is_told() {
    let (subject, stop) = (Subject::of(WALLS), AtomicBool::new(false));
    let beyond = Plan {
        times: vec![2.0 * T_END],
        ..plan(&["rk45"], &[Events::Located], &[1e-3], &[], T_END)
    };
    let table = study(&subject, &beyond);
    let (reference, row) = (&table.reference, &table.rows[0]);
    assert_eq!(row.status, Status::Ok);
    assert!(row.e.is_some_and(f64::is_nan) && !reference.can_decide(0.1), "{row:?}");
    let told = [reference.undecided(), reference.limits().concat()];
    assert!(
        told.iter().all(|text| text.contains("no sample between its start and its end")),
        "{told:?}"
    );

    // So too where the horizon ends before the one sample that there is.
    let mut one = Reference::new(&subject, T_END, &[T_END], Limits::none(&stop)).unwrap();
    let setting = &beyond.settings[0];
    let (mut watch, grid) = (Limits::none(&stop).watch(Price::PLAIN), Grid::Times(vec![T_END]));
    let (_, run) = subject.parts[0].run(setting, Start::Exact, T_END, &grid, &mut watch);
    assert!(one.parts[0].error(&run) < 1.0);
    one.parts[0].lost_at = T_END;
    assert!(one.parts[0].error(&run).is_nan() && one.parts[0].judge(&run).e.is_nan());
}

#[test]
fn rows_of_a_study_of_a_ball_between_walls_are_what_they_were() {
    let subject = Subject::of(WALLS);
    let plan = plan(&["rk4", "rk45", "radau5"], Events::ALL, &[1e-4, 1e-8], &[2e-4], T_END);
    let rows: Vec<String> = study(&subject, &plan).rows.iter().map(told).collect();
    assert_text(&rows.join("\n"), ROWS);
}

/// Right-hand sides, steps accepted and rejected, Jacobians, linear systems, steps retaken; events, missed, spurious; `e`, `e_max`,
/// `e_l2`, `e_final`, errors of peak, impulse of a contact, impulse, dissipation; right-hand sides an event.
const ROWS: &str = r#"
rk4 located h 2e-4 s: [8095, 2005, 0, 0, 0, 16] [10, 0, 0] 2.99e-6 3.01e-6 4.02e-7 2.73e-7 6.93e-8 1.78e-7 1.84e-7 - 7.50e0
rk4 blind h 2e-4 s: [8001, 2000, 0, 0, 0, 0] [10, 0, 0] 6.50e-2 6.53e-2 9.49e-3 5.00e-3 1.57e-3 1.58e-3 1.22e-3 - 1.00e-1
rk45 located rtol 1e-4: [462, 41, 13, 0, 0, 21] [10, 0, 0] 1.18e-2 1.20e-2 1.68e-3 1.04e-3 2.87e-4 3.22e-4 2.35e-4 - 1.38e1
rk45 located rtol 1e-8: [1146, 155, 18, 0, 0, 16] [10, 0, 0] 4.02e-6 4.06e-6 5.66e-7 3.45e-7 9.78e-8 9.61e-8 7.11e-8 - 1.08e1
rk45 blind rtol 1e-4: [518, 58, 28, 0, 0, 0] [10, 10, 10] 7.03e-2 7.03e-2 1.11e-2 7.88e-3 - - 2.08e-3 - 2.00e-1
rk45 blind rtol 1e-8: [2732, 282, 173, 0, 0, 0] [10, 0, 0] 1.58e-4 1.60e-4 2.30e-5 1.33e-5 4.51e-6 4.34e-6 3.12e-6 - 2.00e-1
radau5 located rtol 1e-4: [591, 47, 28, 47, 451, 32] [10, 0, 0] 4.45e-3 4.48e-3 6.28e-4 3.88e-4 1.20e-4 1.07e-4 7.69e-5 - 2.39e1
radau5 located rtol 1e-8: [1041, 150, 26, 150, 780, 28] [10, 0, 0] 2.24e-6 2.31e-6 3.19e-7 1.96e-7 6.29e-8 5.43e-8 3.91e-8 - 2.20e1
radau5 blind rtol 1e-4: [1239, 95, 87, 1037, 661, 0] [10, 0, 0] 3.44e-2 3.44e-2 4.92e-3 7.21e-4 1.39e-3 9.33e-4 6.47e-4 - 2.00e-1
radau5 blind rtol 1e-8: [2400, 269, 158, 1226, 1583, 0] [10, 0, 0] 8.39e-5 8.48e-5 1.10e-5 1.04e-5 4.20e-6 3.92e-6 8.05e-7 - 2.00e-1
"#;

#[test]
fn a_contest_on_a_ball_between_walls_takes_the_trials_that_it_took() {
    let (stop, plan) = (AtomicBool::new(false), Plan::new(T_END));
    let subject = Subject::of(WALLS);
    let benchmark = Benchmark::new(subject, T_END, plan.times, Limits::none(&stop)).unwrap();
    let methods = ["rk4", "rk45", "dop853", "radau5", "rodas5p"].map(str::to_owned);
    let candidates = Candidate::all(&methods, Events::ALL);
    let rules = Rules { candidates, repeats: 1, ..Rules::default() };
    let mut text = String::new();
    for accuracy in [1e-3, 1e-6, 1e-10] {
        let contest = Contest { benchmark: &benchmark, accuracy, rules: &rules, stop: &stop };
        let standings = contest.run(&|_| {});
        let entries = standings.entries.iter().map(|entry| {
            let [e, least, most] = [entry.e, entry.e_spread[0], entry.e_spread[1]].map(|e| format!("{e:.1e}"));
            let (events, work, growth) = ((entry.missed, entry.spurious), entry.work, short(entry.growth));
            let about = [(entry.timed, "timed"), (entry.grazes, "grazes"), (entry.bound_by_stability, "bound")];
            let about: Vec<&str> = about.iter().filter(|(is, _)| *is).map(|(_, what)| *what).collect();
            let (method, setting) = (format!("{} {}", entry.method, entry.events), entry.setting());
            format!("{method} {setting}: {e} of {least} to {most} {events:?}, work {work}, growth {growth} {about:?}")
        });
        let failures = standings.failures.iter().map(|failure| {
            let (kind, step) = (failure.kind.name(), short(failure.mean_step_s));
            format!("{} {}: {kind}, step {step}", failure.method, failure.events)
        });
        let mut lines: Vec<String> = entries.chain(failures).collect();
        lines.sort();
        writeln!(text, "{accuracy:e}: {} trials\n{}", standings.n_trials, lines.join("\n"))
            .unwrap();
    }
    assert_text(&text, CONTESTS);
}

const CONTESTS: &str = r#"
1e-3: 45 trials
dop853 blind: cut, step 5.06e-3
dop853 located rtol 5.6e-5: 3.9e-4 of 1.8e-4 to 3.9e-4 (0, 0), work 892, growth 1.00e0 ["timed"]
radau5 blind: cut, step 7.83e-3
radau5 located rtol 1e-5: 4.6e-4 of 3.7e-4 to 4.6e-4 (0, 0), work 2982, growth 1.07e0 []
rk4 blind: cut, step 1.30e-4
rk4 located h 4.2e-4 s: 9.8e-6 of 5.6e-6 to 9.8e-6 (0, 0), work 3931, growth - []
rk45 blind: cut, step 2.41e-3
rk45 located rtol 1.8e-6: 5.3e-4 of 3.0e-4 to 5.3e-4 (0, 0), work 618, growth 1.34e0 ["timed"]
rodas5p blind: cut, step 8.43e-3
rodas5p located rtol 3.2e-5: 4.8e-4 of 4.3e-4 to 4.8e-4 (0, 0), work 3597, growth 1.10e0 []
1e-6: 51 trials
dop853 blind: cut, step 3.02e-3
dop853 located rtol 1e-7: 6.0e-7 of 2.9e-7 to 6.0e-7 (0, 0), work 881, growth 1.10e0 ["timed"]
radau5 blind: cut, step 4.52e-3
radau5 located rtol 1.8e-9: 5.8e-7 of 3.5e-7 to 5.8e-7 (0, 0), work 5765, growth 1.44e0 []
rk4 blind: cut, step 2.40e-4
rk4 located h 1.3e-4 s: 7.2e-7 of 5.4e-7 to 7.2e-7 (0, 0), work 12411, growth - []
rk45 blind: cut, step 1.55e-3
rk45 located rtol 1.8e-9: 6.9e-7 of 3.7e-7 to 6.9e-7 (0, 0), work 1482, growth 1.57e0 ["timed"]
rodas5p blind: cut, step 3.00e-3
rodas5p located rtol 5.6e-8: 2.6e-7 of 1.5e-7 to 2.6e-7 (0, 0), work 5757, growth 1.42e0 []
1e-10: 53 trials
dop853 blind: cut, step 1.85e-3
dop853 located rtol 1e-11: 7.7e-11 of 3.7e-11 to 7.7e-11 (0, 0), work 1599, growth 1.13e0 ["timed"]
radau5 blind: cut, step 3.31e-3
radau5 located: cut, step 5.46e-4
rk4 blind: cut, step 3.70e-4
rk4 located: cut, step 1.30e-5
rk45 blind: cut, step 5.90e-4
rk45 located rtol 1e-13: 4.5e-11 of 2.5e-11 to 4.6e-11 (0, 0), work 8262, growth 1.59e0 []
rodas5p blind: cut, step 1.67e-3
rodas5p located: cut, step 1.43e-3
"#;

#[test]
fn steps_of_a_mass_that_hits_a_stop_are_told_as_they_were_taken() {
    let (subject, stop) = (Subject::of(STOP), AtomicBool::new(false));
    let plan = plan(&["rk45", "radau5"], &[Events::Located], &[1e-5, 1e-7], &[], 2.0);
    let table = study(&subject, &plan);
    let tables = StepTables::new(&subject, &plan, &table, Limits::none(&stop));
    let (_, events) = STOP.solution(2.0);
    let mut text = String::new();
    for history in &tables.histories {
        assert_eq!(history.events.len(), events.len());
        for (own, exact) in history.events.iter().zip(&events) {
            assert!((own - exact).abs() < 1e-4, "{own} {exact}");
        }
        let sum: f64 = history.steps.iter().map(|step| step.h_s).sum();
        assert!((sum - 2.0).abs() < 1e-12, "{sum}");
        let bins = tables.histogram.iter().filter(|bin| bin.method == history.method);
        assert_eq!(bins.clone().map(|bin| bin.n_steps).sum::<u64>(), history.steps.len() as u64);
        assert!(bins.clone().is_sorted_by(|a, b| (a.kind, a.h_s.0) < (b.kind, b.h_s.0)));
        for bin in bins {
            let is_in = |h: f64| bin.h_s.0 <= h && h < bin.h_s.1;
            let steps =
                history.steps.iter().filter(|step| step.kind() == bin.kind && is_in(step.h_s));
            assert_eq!(steps.count() as u64, bin.n_steps, "{bin:?}");
            assert!((bin.h_s.1 / bin.h_s.0).log10() - 0.1 < 1e-12, "{bin:?}");
        }
        let stays = tables.stays.iter().filter(|stay| stay.method == history.method);
        let stays: Vec<_> = stays.collect();
        // It begins free, and each event ends a stay.
        assert_eq!(stays.len(), events.len() + 1);
        for (i, stay) in stays.iter().enumerate() {
            assert_eq!((stay.is_contact, stay.is_whole), (i % 2 == 1, 0 < i && i < events.len()));
            assert!((stay.mean_step() * stay.n_steps as f64 - stay.duration_s).abs() < 1e-15);
        }
        let n_steps: Vec<usize> = stays.iter().map(|stay| stay.n_steps).collect();
        let n_lands = history.steps.iter().filter(|step| step.lands).count();
        writeln!(text, "{}: {n_steps:?}, {n_lands} land", history.title()).unwrap();
    }
    for cost in &tables.restart_costs {
        let recovery = [cost.recovery_steps, cost.lost_steps].map(short);
        let counts =
            [cost.rejected, cost.rhs_restart, cost.rhs_location, cost.rhs_step, cost.rhs_event()];
        let counts = counts.map(|count| short(Some(count)));
        writeln!(text, "{}: {} events, {recovery:?} {counts:?}", cost.method, cost.n_events)
            .unwrap();
    }
    for row in tables.restarts.iter().filter(|row| row.step <= 3) {
        let sizes = row.h_over_settled.map(|size| short(Some(size)));
        writeln!(
            text,
            "{} {} {}: {} of {sizes:?}, {}",
            row.method, row.into_contact, row.step, row.n, row.n_rejected
        )
        .unwrap();
    }
    assert_text(&text, STEPS);
}

const STEPS: &str = r#"
rk45, rtol 1e-7: [14, 18, 27, 18, 27, 18, 27], 6 land
radau5, rtol 1e-7: [15, 18, 26, 18, 26, 18, 26], 6 land
rk45: 6 events, ["1.00e0", "8.04e-1"] ["5.00e-1", "1.14e0", "1.20e1", "6.00e0", "2.10e1"]
radau5: 6 events, ["1.00e0", "8.24e-1"] ["1.00e0", "1.14e0", "2.10e1", "4.57e0", "3.05e1"]
rk45 true 1: 3 of ["2.15e-1", "2.15e-1", "2.15e-1"], 3
rk45 true 2: 3 of ["2.03e-1", "2.03e-1", "2.03e-1"], 0
rk45 true 3: 3 of ["2.06e-1", "2.06e-1", "2.06e-1"], 0
rk45 false 1: 3 of ["1.96e-1", "1.96e-1", "1.96e-1"], 0
rk45 false 2: 3 of ["7.05e-1", "7.05e-1", "7.05e-1"], 0
rk45 false 3: 3 of ["6.28e-1", "6.28e-1", "6.28e-1"], 0
radau5 true 1: 3 of ["1.85e-1", "1.85e-1", "1.85e-1"], 6
radau5 true 2: 3 of ["1.79e-1", "1.79e-1", "1.79e-1"], 0
radau5 true 3: 3 of ["1.79e-1", "1.79e-1", "1.79e-1"], 0
radau5 false 1: 3 of ["1.76e-1", "1.76e-1", "1.76e-1"], 0
radau5 false 2: 3 of ["8.44e-1", "8.44e-1", "8.44e-1"], 0
radau5 false 3: 3 of ["7.98e-1", "7.98e-1", "7.98e-1"], 0
"#;

#[test]
fn a_map_has_a_winner_at_each_place_and_tells_by_how_much() {
    let axes = [MapAxis::new("K", "N/m", &[1e3, 1e5]), MapAxis::new("D", "N s/m", &[0.5, 5.0])];
    let methods = ["rk45", "dop853", "radau5"].map(str::to_owned);
    let candidates = Candidate::all(&methods, Events::ALL);
    let rules = Rules { candidates, repeats: 1, ..Rules::default() };
    let plan = MapPlan { rules, accuracies: vec![1e-4, 1e-7], ..MapPlan::new(T_END) };
    let of =
        |[stiffness, damping]: [f64; 2]| Subject::of(CompliantBall { stiffness, damping, ..WALLS });
    let map = Map::new(axes, &plan, 2, of);
    let places: Vec<_> = map.cells.iter().map(|cell| (cell.at, cell.contest.accuracy)).collect();
    let at = |k: f64, d: f64| [([k, d], 1e-4), ([k, d], 1e-7)];
    assert_eq!(places, [at(1e3, 0.5), at(1e3, 5.0), at(1e5, 0.5), at(1e5, 5.0)].concat());
    assert_eq!(map.axes[0].label(), "K [N/m]");
    for cell in &map.cells {
        let contest = &cell.contest;
        let [stiffness, damping] = cell.at;
        let (_, events) = CompliantBall { stiffness, damping, ..WALLS }.solution(T_END);
        assert_eq!((contest.status, contest.n_events), (CellStatus::Ok, Some(events.len())));
        assert_eq!((contest.t_end_s, contest.horizon_s), (Some(T_END), None));
        let (first, second) = (contest.winner().unwrap(), contest.second());
        assert!(contest.fixed().all(|entry| !entry.timed || entry.time_s() >= first.time_s()));
        assert_eq!(contest.margin(), second.map(|second| second.time_s() / first.time_s()));
        assert_eq!(contest.auto_over_winner(), None);
        let time = |of: &dyn Fn(bool, Events) -> bool| {
            let own = contest.standings.entries.iter();
            own.filter(|entry| of(entry.implicit, entry.events))
                .map(|entry| entry.time_s())
                .fold(f64::NAN, f64::min)
        };
        let ratio = |a: f64, b: f64| Some(a / b).filter(|ratio| ratio.is_finite());
        let of_kind = ratio(time(&|implicit, _| !implicit), time(&|implicit, _| implicit));
        assert_eq!(contest.explicit_over_implicit(), of_kind);
        let of_events = ratio(
            time(&|_, events| events == Events::Blind),
            time(&|_, events| events == Events::Located),
        );
        assert_eq!(contest.blind_over_located(), of_events);
    }
}

/// A simulation by `dop853` to `T_END`, sampled at `times`.
fn simulated(ball: CompliantBall, rtol: f64, times: &[f64]) -> Simulation {
    let (subject, stop) = (Subject::of(ball), AtomicBool::new(false));
    let plan = plan(&["dop853"], &[Events::Located], &[rtol], &[], T_END);
    let (setting, limits) = (&plan.settings[0], Limits::none(&stop));
    let asked =
        Asked { setting, t_end: T_END, grid: Grid::Times(times.to_vec()), tell: &|_: &Warning| {} };
    subject.parts[0].simulate(&asked, &mut limits.watch(Price::of_setting(setting)))
}

#[test]
fn a_simulation_of_a_ball_between_walls_tells_its_motion_wall_by_wall() {
    let times = [0.01, 0.031, 0.1, 0.2, 0.39];
    let own = simulated(WALLS, 1e-12, &times);
    let (end, events) = WALLS.solution(T_END);
    assert_eq!((own.n_events, own.failed_site, own.stopped), (events.len(), None, None));
    assert_eq!((own.n_at_speed_floor, own.warnings.len()), (0, 0));
    for (own, exact) in own.run.y.iter().zip(end) {
        assert!((own - exact).abs() < 1e-9, "{own} {exact}");
    }
    let balance = own.balance.unwrap();
    let lost = 0.5 * WALLS.mass * (WALLS.start[1] * WALLS.start[1] - end[1] * end[1]);
    assert!(
        (balance.dissipated / lost - 1.0).abs() < 1e-9 && balance.residual.abs() < 1e-12,
        "{balance:?}"
    );

    let names: Vec<&str> = own.sites.iter().map(|site| site.name.as_str()).collect();
    assert_eq!(names, ["left wall", "right wall"]);
    let mut all = Vec::new();
    for (site, contacts) in own.sites.iter().zip(own.contacts.unwrap()) {
        let samples: Vec<_> = site.samples().collect();
        assert_eq!(samples.len(), times.len());
        for ((t, _, values), time) in samples.iter().zip(&times) {
            let [x, v] = WALLS.solution(*time).0;
            assert_eq!((*t, values.len()), (*time, site.columns.len()));
            assert!((values[0] - x).abs() < 1e-9 && (values[1] - v).abs() < 1e-9, "{values:?}");
        }
        let modes: Vec<&str> = samples.iter().map(|(_, mode, _)| *mode).collect();
        let at_walls = ["Contact(Right)", "Contact(Left)"];
        assert_eq!(modes, [["Flight(Right)"].as_slice(), &at_walls, &["Flight(Left)"; 2]].concat());
        all.extend(site.changes.iter().map(|change| change.t));
        let [first, last] = [&contacts[0], &contacts[contacts.len() - 1]];
        assert!(first.begin < last.begin && (contacts.len() == 2 || contacts.len() == 3));
        for contact in &contacts {
            let speed = WALLS.solution(contact.begin - 1e-9).0[1].abs();
            assert!(
                (contact.impact_speed.unwrap() / speed - 1.0).abs() < 1e-9,
                "{contact:?} {speed}"
            );
            let impulse = WALLS.mass * speed * (1.0 + WALLS.restitution());
            assert!((contact.impulse / impulse - 1.0).abs() < 1e-6, "{contact:?} {impulse}");
            assert!((contact.end - contact.begin - WALLS.contact_time()).abs() < 1e-9);
        }
    }
    all.sort_by(f64::total_cmp);
    for (own, exact) in all.iter().zip(&events) {
        assert!((own - exact).abs() < 1e-9, "{own} {exact}");
    }
    assert_eq!(all.len(), events.len());
}

#[test]
fn walls_that_give_energy_are_told_with_how_much() {
    let pushing = CompliantBall { damping: -2.0, ..WALLS };
    let own = simulated(pushing, 1e-10, &[]);
    let ([x, v], _) = pushing.solution(T_END);
    assert!((0.0..WALLS.gap).contains(&x), "in a wall at {x}");
    let given = 0.5 * WALLS.mass * (v * v - WALLS.start[1] * WALLS.start[1]);
    let told: Vec<_> =
        own.warnings.iter().map(|warning| (warning.code, &warning.message)).collect();
    let [(code, message)] = told[..] else { panic!("{told:?}") };
    assert_eq!(code, Code::Dissipation);
    assert!(message.contains(&format!("gave {given:.1e} J")), "{message} {given}");
}
