//! Runs of a batch: each as it would be alone.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_solvers::problems::BouncingBall;
use std::fmt::Debug;

use deltazero_solvers::{
    Alike, Control, Error, Grid, Integration, METHODS, Method, Needs, Next, Outcome, Over, Real,
    System, Trajectory,
};

use crate::log::{Log, Setting, as_records, settings};
use crate::script::{Script, floor, guard, unused};

type Recorder<P> =
    (Log<<P as System>::Mode>, Trajectory<<P as System>::State<f64>, <P as System>::Mode>);

/// What recorders need of the step from a time, beside samples.
const NEEDS: [fn(f64) -> Needs; 5] = [
    |_| Needs::Nothing,
    |t| {
        let any = [Needs::Nothing, Needs::Nothing, Needs::Ends, Needs::DenseOutput];
        any[(t.to_bits() % 61 % 4) as usize]
    },
    |_| Needs::DenseOutput,
    |_| Needs::Nothing,
    |_| Needs::Nothing,
];

fn recorders<P: System>(n: usize) -> Vec<Recorder<P>> {
    let grid = Grid::uniform(0.3, 3.0);
    let recorder = |i: usize| {
        let never = usize::MAX;
        // One run in seven is broken off, at its fifth step or its second event.
        let break_at = if i % 7 == 3 { [(5, never), (never, 2)][i % 2] } else { (never, never) };
        let needs = NEEDS[i % NEEDS.len()];
        (Log { break_at, needs, ..Log::default() }, Trajectory::on(grid.clone()))
    };
    (0..n).map(recorder).collect()
}

/// All that a run came to, to the last bit.
fn shown<P: System>(
    run: &Integration<'_, P>,
    end: &Result<Outcome, Error>,
    (log, samples): &Recorder<P>,
) -> String {
    let point = (run.point.t, &run.point.y, &run.point.mode);
    let Log { steps, states, events, passed, .. } = log;
    let shown = format!("{steps:?} {states:?} {events:?} {passed:?} {samples:?}");
    format!("{end:?} {point:?} {:?} {shown}", run.stats)
}

/// Runs of `problems` from their starts in one batch and one by one, each under its control. Returns how those of the
/// batch ended, and the number of rejected steps.
fn same_bits<P: Alike<State<f64> = [f64; 2]>>(
    method: &Method,
    controls: &[Control],
    runs: &[(&P, f64, [f64; 2])],
    t_end: f64,
    mut recorders: impl FnMut() -> Vec<Recorder<P>>,
) -> (Vec<Result<Outcome, Error>>, u64) {
    let begun = || runs.iter().map(|(problem, t, y)| Integration::new(*problem, *t, *y));
    let (mut batch, mut seen) = (begun().collect::<Vec<_>>(), recorders());
    let ends = method.run_batch(&mut batch, t_end, controls, &mut as_records(&mut seen)).unwrap();
    let mut n_rejected = 0;
    for (i, (mut run, mut record)) in begun().zip(recorders()).enumerate() {
        let mut solver = method.solver(runs[i].0, controls[i].clone()).unwrap();
        let end = run.run(t_end, &mut *solver, &mut record);
        let (one, many) = (shown(&run, &end, &record), shown(&batch[i], &ends[i], &seen[i]));
        assert_eq!(one, many, "{} with {:?}: run {i}", method.name, controls[i]);
        n_rejected += run.stats.n_rejected;
    }
    (ends, n_rejected)
}

/// Runs of one problem under one control.
pub(crate) fn many_have_same_bits<P: Alike<State<f64> = [f64; 2]>>(
    problem: &P,
    (method, control): &Setting,
    starts: &[[f64; 2]],
    t_end: f64,
) -> Vec<Result<Outcome, Error>> {
    let n = starts.len();
    let runs: Vec<_> = starts.iter().map(|y| (problem, 0.0, *y)).collect();
    same_bits(method, &vec![control.clone(); n], &runs, t_end, || recorders::<P>(n)).0
}

/// Explicit tableau methods, series, one that takes turns, and one that is none of these.
fn tried() -> impl Iterator<Item = Setting> {
    let names = ["rk4", "bs32", "rk45", "dop853", "vern98", "taylor", "auto", "radau5"];
    settings().into_iter().filter(move |(method, _)| names.contains(&method.name))
}

/// Three modes with rates of degree three, a reset, a mode without parameters, and one that most runs skip.
pub(crate) fn script() -> Script {
    Script {
        rate: vec![vec![-1.0, 0.5], vec![0.3, -2.0, 0.7, 0.1], vec![-0.5, 0.0, 1.0]],
        guards: vec![
            vec![floor(1, 0.4), guard(&[2.5, -1.0], 0.0, 2)],
            vec![guard(&[1.3, -1.0, 0.0], -0.2, 2), unused()],
            vec![floor(0, 0.7), unused()],
        ],
    }
}

/// `n` starts a little apart.
pub(crate) fn starts(n: usize, [x, z]: [f64; 2], by: [f64; 2]) -> Vec<[f64; 2]> {
    (0..n).map(|i| [x + by[0] * i as f64, z + by[1] * i as f64]).collect()
}

#[test]
fn runs_of_a_batch_have_the_bits_of_runs_alone() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    for setting in tried() {
        // One, two, fewer and more than there are lanes.
        for n in [1, 2, 5, 23] {
            many_have_same_bits(&script(), &setting, &starts(n, [0.0, 0.3], [0.03, 0.05]), 3.0);
            many_have_same_bits(&ball, &setting, &starts(n, [0.0, 1.0], [0.1, 0.3]), 2.0);
        }
        many_have_same_bits(&ball, &setting, &starts(150, [0.5, 0.0], [0.01, -0.01]), 0.7);
    }
}

#[test]
fn runs_of_a_batch_do_not_depend_on_their_order() {
    for setting in tried() {
        let mut starts = starts(23, [0.0, 0.3], [0.03, 0.05]);
        starts.reverse();
        starts.swap(2, 17);
        many_have_same_bits(&script(), &setting, &starts, 3.0);
    }
}

#[test]
fn a_run_that_fails_ends_alone() {
    // A rate of x²⁰⁰, which is infinite beyond x = 34.8.
    let mut rate = vec![0.0; 201];
    rate[200] = 1.0;
    let script = Script { rate: vec![rate], guards: vec![vec![unused()]] };
    let starts: Vec<_> = (0..13).map(|i| [if i % 4 == 1 { 33.0 } else { 0.0 }, 0.0]).collect();
    let is_explicit = |setting: &Setting| !setting.0.is_implicit();
    for setting in tried().filter(is_explicit) {
        let ends = many_have_same_bits(&script, &setting, &starts, 3.0);
        for (i, end) in ends.iter().enumerate() {
            let broken_off = recorders::<Script>(i + 1)[i].0.break_at.0 == 5;
            match end {
                Ok(Outcome::Interrupted) => assert!(broken_off, "{i}"),
                end => assert_eq!(end.is_err(), i % 4 == 1, "{}, {i}: {end:?}", setting.0.name),
            }
        }
    }
}

/// Two runs at once; how they ended and how many steps were rejected.
fn pair_has_same_bits<P: Alike<State<f64> = [f64; 2]>>(
    (method, controls): (&Method, [Control; 2]),
    problems: &[P; 2],
    starts: [(f64, [f64; 2]); 2],
    t_end: f64,
) -> (Vec<Result<Outcome, Error>>, u64) {
    let runs = [0, 1].map(|i| (&problems[i], starts[i].0, starts[i].1));
    let (mut all, mut n_rejected) = (Vec::new(), 0);
    // The last two need nothing and any, all and nothing, nothing (twice), nothing and any.
    for n in [2, 4, 5, 10, 12] {
        let recorders = || recorders::<P>(n).split_off(n - 2);
        let (ends, n) = same_bits(method, &controls, &runs, t_end, recorders);
        all.extend(ends);
        n_rejected += n;
    }
    (all, n_rejected)
}

/// Two balls from rest at their heights.
fn balls_have_same_bits(with: (&Method, [Control; 2]), balls: [BouncingBall; 2], t_end: f64) {
    let starts = balls.each_ref().map(|ball| (0.0, ball.start()));
    pair_has_same_bits(with, &balls, starts, t_end);
}

#[test]
fn two_runs_of_systems_of_a_kind_have_the_bits_of_runs_alone() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    let moon = BouncingBall { restitution: 0.5, gravity: 1.6, height: 0.3 };
    let lies = BouncingBall { height: 0.0, ..ball };
    for (method, control) in tried() {
        let tighter = match &control {
            Control::Fixed(h) => Control::Fixed(0.3 * h),
            Control::Adaptive(_) => crate::common::tolerance(1e-5),
        };
        for controls in [[control.clone(), control.clone()], [control, tighter]] {
            // Both bounce, one comes to rest, both do, one is never in flight.
            for (balls, t_end) in
                [([ball, moon], 0.9), ([ball, moon], 2.0), ([ball, moon], 4.0), ([ball, lies], 1.0)]
            {
                balls_have_same_bits((method, controls.clone()), balls, t_end);
                let [a, b] = controls.clone();
                balls_have_same_bits((method, [b, a]), [balls[1], balls[0]], t_end);
            }
        }
    }
}

#[test]
fn many_runs_of_systems_of_a_kind_have_the_bits_of_runs_alone() {
    let ball = |i: usize| {
        let i = i as f64;
        BouncingBall { restitution: 0.5 + 0.02 * i, gravity: 1.6 + 0.7 * i, height: 0.1 * i }
    };
    let balls: Vec<_> = (0..19).map(ball).collect();
    let runs: Vec<_> =
        balls.iter().enumerate().map(|(i, ball)| (ball, 0.01 * i as f64, ball.start())).collect();
    for (method, control) in tried() {
        let of = |i: usize| match &control {
            Control::Fixed(h) => Control::Fixed(h / (1.0 + i as f64)),
            // Series of several orders, the first of which is that of a quarter of all.
            Control::Adaptive(_) => {
                crate::common::tolerance([1e-8, 1e-5, 3e-8, 1e-11][i % 4] * (1.0 + 1e-3 * i as f64))
            }
        };
        let controls: Vec<_> = (0..runs.len()).map(of).collect();
        for t_end in [0.05, 1.5] {
            same_bits(method, &controls, &runs, t_end, || recorders::<BouncingBall>(runs.len()));
        }
    }
}

#[test]
fn one_of_two_runs_may_have_a_tolerance_and_the_other_a_step() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    let moon = BouncingBall { restitution: 0.5, gravity: 1.6, height: 0.3 };
    for name in ["rk45", "dop853", "taylor"] {
        let method = Method::named(name).unwrap();
        let controls = [Control::Fixed(0.03), crate::common::tolerance(1e-6)];
        balls_have_same_bits((method, controls.clone()), [ball, moon], 2.0);
        let [a, b] = controls;
        balls_have_same_bits((method, [b, a]), [ball, moon], 2.0);
    }
}

/// A mass on a spring above a floor, with a drag that grows with its speed: `v̇ = −a y − b v √(v² + 0.1)`.
#[derive(Clone, Copy)]
struct Drag {
    stiffness: f64,
    /// Below zero it drives, and the speed is infinite after a finite time.
    drag: f64,
    floor: f64,
}

impl System for Drag {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        Self::rhs_of(&self.constants(), t, y, dydt);
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &[S; 2], g: &mut [S; 1]) {
        Self::guards_of(&self.constants(), t, y, g);
    }

    fn guard_bounds(&self, (): (), _t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [4.0 * f64::EPSILON * (y[0].abs() + self.floor.abs())];
    }

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, y: &mut [S; 2]) -> Next<()> {
        *y = [S::cst(self.floor), -y[1] * 0.8];
        Next::Mode(())
    }
}

impl Drag {
    fn constants(&self) -> [f64; 3] {
        [-self.stiffness, -self.drag, self.floor]
    }
}

impl Alike for Drag {
    type Parameters<C: Copy + Debug> = [C; 3];

    fn parameters(&self, (): &()) -> Option<[f64; 3]> {
        Some(self.constants())
    }

    fn rhs_of<S: Over<C>, C: Copy + Debug>(
        [stiffness, drag, _]: &[C; 3],
        _t: S,
        y: &[S; 2],
        dydt: &mut [S; 2],
    ) {
        let drag = y[1] * (y[1] * y[1] + 0.1).sqrt() * *drag;
        *dydt = [y[1], y[0] * *stiffness + drag];
    }

    fn guards_of<S: Over<C>, C: Copy + Debug>(
        [_, _, floor]: &[C; 3],
        _t: S,
        y: &[S; 2],
        g: &mut [S; 1],
    ) {
        *g = [y[0] - *floor];
    }
}

#[test]
fn two_runs_whose_series_do_not_end_have_the_bits_of_runs_alone() {
    let slow = Drag { stiffness: 9.0, drag: 0.3, floor: -0.5 };
    let stiff = Drag { stiffness: 400.0, drag: 30.0, floor: -0.2 };
    let blows_up = Drag { stiffness: 1.0, drag: -2.0, floor: -5.0 };
    let [near, far] = [(0.0, [1.0, 0.0]), (0.1, [0.3, -2.0])];
    let tolerance = crate::common::tolerance;
    let mut n_rejected = 0;
    for method in METHODS.iter().filter(|method| method.is_for_batches()) {
        let controls = if method.is_fixed_step() {
            vec![[Control::Fixed(0.01), Control::Fixed(0.007)]]
        } else {
            // Of the first two series have one order.
            [[1e-8, 9e-9], [3e-2, 2e-2], [1e-6, 1e-11]].map(|rtols| rtols.map(tolerance)).to_vec()
        };
        for controls in controls {
            let with = || (method, controls.clone());
            let both = [slow, stiff];
            // Forward, one of them not at all, one forward and the other backward, both backward.
            for t_end in [2.0, 0.1, 0.05, -0.3] {
                n_rejected += pair_has_same_bits(with(), &both, [near, far], t_end).1;
                let (both, starts) = ([stiff, slow], [far, near]);
                n_rejected += pair_has_same_bits(with(), &both, starts, t_end).1;
            }
            let (ends, _) = pair_has_same_bits(with(), &[blows_up, slow], [far, near], 2.0);
            assert!(ends.iter().any(Result::is_err), "{}: {ends:?}", method.name);
        }
    }
    assert!(n_rejected > 0);
}

#[test]
fn turns_of_two_methods_have_the_bits_of_runs_alone() {
    let drag = |stiffness, drag, floor| Drag { stiffness, drag, floor };
    // Resting in the drag most of the time, at times, never.
    let all = [drag(1e5, 1e5, -0.5), drag(2e4, 3e3, -1e-3), drag(9.0, 0.3, -0.5)];
    let method = Method::named("auto").unwrap();
    for rtol in [1e-3, 1e-8] {
        for n in [1, 2, 3, 12] {
            let runs: Vec<_> = (0..n).map(|i| (&all[i % 3], 0.0, [1.0, 0.1 * i as f64])).collect();
            let controls = vec![crate::common::tolerance(rtol); n];
            for t_end in [2.0, 0.1] {
                same_bits(method, &controls, &runs, t_end, || recorders::<Drag>(n));
            }
        }
        let turns = all.map(|system| {
            let mut run = Integration::new(&system, 0.0, [1.0, 0.1]);
            let control = crate::common::tolerance(rtol);
            let mut solver = method.solver(&system, control).unwrap();
            run.run(2.0, &mut *solver, &mut ()).unwrap();
            run.stats
        });
        for stats in &turns[..2] {
            assert!(stats.n_implicit > 0 && stats.n_implicit < stats.n_accepted, "{stats:?}");
        }
        assert_eq!(turns[2].n_implicit, 0);
    }
}

#[test]
fn a_guard_that_grazes_in_a_batch_is_told_as_alone() {
    for (method, control) in tried() {
        let swing = |off: f64| Drag { stiffness: 9.0, drag: 0.0, floor: -1.0 + off };
        let swings = [0.0, 1e-9, -1e-9, 0.5, -0.5, 1e-8].map(swing);
        let runs = swings.each_ref().map(|swing| (swing, 0.0, [1.0, 0.0]));
        let controls = vec![control.clone(); runs.len()];
        same_bits(method, &controls, &runs, 4.0, || recorders::<Drag>(runs.len()));
        let mut touches = Integration::new(&swings[0], 0.0, [1.0, 0.0]);
        let mut solver = method.solver(&swings[0], control).unwrap();
        touches.run(4.0, &mut *solver, &mut ()).unwrap();
        assert!(touches.stats.n_grazing > 0, "{}", method.name);
    }
}

#[test]
fn runs_need_controls_that_the_method_takes() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    let mut runs = [0.0, 0.1].map(|t| Integration::new(&ball, t, ball.start()));
    let (fixed, tolerance) = (Control::Fixed(0.1), crate::common::tolerance(1e-6));
    // No run begins, not even one of those that would follow one after the other.
    for (name, controls) in
        [("rk4", [fixed.clone(), tolerance.clone()]), ("bdf", [tolerance.clone(), fixed.clone()])]
    {
        let method = Method::named(name).unwrap();
        let ends = method.run_batch(&mut runs, 1.0, &controls, &mut [&mut (), &mut ()]);
        assert!(matches!(&ends, Err(Error::BadControl { method, .. }) if *method == name));
        assert_eq!(runs[0].point.t, 0.0);
    }
    let rk4 = Method::named("rk4").unwrap();
    assert_eq!(rk4.run_batch::<Script>(&mut [], 1.0, &[], &mut []), Ok(Vec::new()));
}

#[test]
#[should_panic(expected = "parameters")]
fn systems_of_a_kind_have_as_many_parameters_as_each_other() {
    let scripts = [script(), Script { rate: vec![vec![1.0; 9]; 3], ..script() }];
    let mut runs = scripts.each_ref().map(|script| Integration::new(script, 0.0, [0.0, 0.3]));
    let rk4 = Method::named("rk4").unwrap();
    let _ = rk4.run_batch(&mut runs, 1.0, &vec![Control::Fixed(0.1); 2], &mut [&mut (), &mut ()]);
}

/// A mass on a spring whose functions of its parameters are wrong: the slope, or the guard.
struct Wrong<const GUARD: bool>(Drag);

impl<const GUARD: bool> System for Wrong<GUARD> {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn dim(&self) -> usize {
        2
    }

    fn n_guards(&self) -> usize {
        1
    }

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        self.0.rhs((), t, y, dydt);
        if !GUARD {
            dydt[1] = dydt[1] + y[0] * 1e-12;
        }
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &[S; 2], g: &mut [S; 1]) {
        self.0.guards((), t, y, g);
        if GUARD {
            g[0] = g[0] * (1.0 + 1e-12);
        }
    }

    fn guard_bounds(&self, (): (), t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        self.0.guard_bounds((), t, y, bounds);
    }

    fn transition<S: Real>(&self, (): (), guard: usize, t: S, y: &mut [S; 2]) -> Next<()> {
        self.0.transition((), guard, t, y)
    }
}

impl<const GUARD: bool> Alike for Wrong<GUARD> {
    type Parameters<C: Copy + Debug> = [C; 3];

    fn parameters(&self, (): &()) -> Option<[f64; 3]> {
        Some(self.0.constants())
    }

    fn rhs_of<S: Over<C>, C: Copy + Debug>(of: &[C; 3], t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        Drag::rhs_of(of, t, y, dydt);
    }

    fn guards_of<S: Over<C>, C: Copy + Debug>(of: &[C; 3], t: S, y: &[S; 2], g: &mut [S; 1]) {
        Drag::guards_of(of, t, y, g);
    }
}

#[test]
fn parameters_that_do_not_describe_their_mode_are_an_error() {
    let drag = Drag { stiffness: 9.0, drag: 0.3, floor: -0.5 };
    fn functions<const GUARD: bool>(setting: &Setting, wrong: &Wrong<GUARD>) -> Vec<&'static str> {
        let mut runs = [1.0, 1.1].map(|x| Integration::new(wrong, 0.0, [x, 0.0]));
        let controls = vec![setting.1.clone(); 2];
        let ends = setting.0.run_batch(&mut runs, 2.0, &controls, &mut [&mut (), &mut ()]).unwrap();
        let function = |end| match end {
            Err(Error::UnlikeParameters { function, .. }) => function,
            end => panic!("{} with {:?}: {end:?}", setting.0.name, setting.1),
        };
        ends.into_iter().map(function).collect()
    }
    for setting in tried().filter(|(method, _)| method.is_for_batches()) {
        // Series with fixed steps are computed one after the other.
        if setting.0.name == "taylor" && matches!(setting.1, Control::Fixed(_)) {
            continue;
        }
        assert_eq!(functions(&setting, &Wrong::<false>(drag)), ["rhs_of"; 2]);
        assert_eq!(functions(&setting, &Wrong::<true>(drag)), ["guards_of"; 2]);
    }
}
