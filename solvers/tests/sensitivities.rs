//! Derivatives of states and event times, through events, against closed forms.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test panics to fail")]

mod common;

use common::{at_most, distance, steps_itself};
use deltazero_solvers::erk::ExplicitRk;
use deltazero_solvers::methods::DORMAND_PRINCE_5;
use deltazero_solvers::one_step::OneStepSolver;
use deltazero_solvers::problems::{BeltOscillator, BouncingBall, BouncingMode};
use deltazero_solvers::sensitivity::{Lost, Traced};
use deltazero_solvers::{
    Blind, Control, Error, Integration, METHODS, Method, Next, Outcome, PhaseSolver, Real,
    Sensitive, System, Tolerance,
};

/// A ball with restitution and gravity as states: `[y, v, e, g]`. It stops at guard 1, which is time left.
struct Ball {
    t_end: f64,
}

impl System for Ball {
    type Mode = ();
    type State<S: Real> = [S; 4];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 4]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, &[_, v, _, g]: &[S; 4], dydt: &mut [S; 4]) {
        *dydt = [v, -g, S::cst(0.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &[S; 4], g: &mut [S; 2]) {
        *g = [y[0], -t + self.t_end];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 4], bounds: &mut [f64; 2]) {
        *bounds = [1e-15; 2];
    }

    fn transition<S: Real>(&self, (): (), guard: usize, _t: S, y: &mut [S; 4]) -> Next<()> {
        if guard == 1 {
            return Next::Stop;
        }
        (y[0], y[1]) = (S::cst(0.0), -y[1] * y[2]);
        Next::Mode(())
    }
}

fn tolerance(rtol: f64, n: usize) -> Tolerance {
    Tolerance { rtol, atol: vec![rtol; n] }
}

/// The state at `t_end` of a run from `y` at zero, with `method` to a tolerance or with a step.
fn end<P: System>(
    system: &Sensitive<'_, P>,
    method: &Method,
    step: f64,
    y: &P::State<f64>,
    t_end: f64,
) -> Vec<f64> {
    let control = if method.is_fixed_step() {
        Control::Fixed(step)
    } else {
        Control::Adaptive(system.tolerance())
    };
    let mut solver = method.solver(system, control).unwrap();
    let mut run = Integration::new(system, 0.0, system.start(0.0, y).unwrap());
    assert_eq!(run.run(t_end, &mut *solver, &mut ()).unwrap(), Outcome::Finished);
    run.point.y
}

/// A solver by one method alone, which compiles faster than one by any.
fn by_rk45<'a, P: System>(system: &Sensitive<'a, P>) -> impl PhaseSolver<Sensitive<'a, P>> {
    let pair = ExplicitRk::new(&DORMAND_PRINCE_5, system.dim());
    OneStepSolver::new(system, pair, Control::Adaptive(system.tolerance()))
}

/// Derivatives of several values by differences of fourth order.
fn quotients(f: impl Fn(f64) -> Vec<f64>, x: f64, h: f64) -> Vec<f64> {
    let values = [-2.0, -1.0, 1.0, 2.0].map(|k| f(x + k * h));
    let quotient = |i: usize| {
        let [a, b, c, d] = values.each_ref().map(|values| values[i]);
        (a - 8.0 * b + 8.0 * c - d) / (12.0 * h)
    };
    (0..values[0].len()).map(quotient).collect()
}

#[test]
fn bounces_depend_on_height_restitution_and_gravity_as_in_closed_form() {
    let (h, e, g) = (1.0, 0.5, 9.8);
    let values = |h: f64, e: f64, g: f64| {
        let ball = BouncingBall { restitution: e, gravity: g, height: h };
        let [y, v] = ball.state(1.2);
        vec![y, v, ball.bounce_time(2)]
    };
    let expected = [
        quotients(|h| values(h, e, g), h, 1e-4),
        quotients(|e| values(h, e, g), e, 1e-4),
        quotients(|g| values(h, e, g), g, 1e-3),
    ];
    // In closed form t₂ = √(2h/g) (1 + 2e + 2e²), to check the quotients.
    let t2 = (2.0 * h / g).sqrt() * (1.0 + 2.0 * e + 2.0 * e * e);
    let by_e = (2.0 * h / g).sqrt() * (2.0 + 4.0 * e);
    let times = [t2 / (2.0 * h), by_e, -t2 / (2.0 * g)];
    // Measured: 5.2e-13.
    at_most("quotients", distance(&times, &expected.each_ref().map(|all| all[2])), 5e-12);

    let directions = vec![[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let ball = Ball { t_end: 10.0 };
    let system = Sensitive::new(&ball, directions, tolerance(1e-10, 4)).unwrap();
    for method in METHODS {
        let y = end(&system, method, 0.01, &[h, 0.0, e, g], 1.2);
        let found: Vec<f64> = (0..3)
            .flat_map(|i| [&system.derivative(i, &y)[..2], &[system.event_time(i, &y)]].concat())
            .collect();
        // Measured: 5.3e-13 and 1.2e-9.
        let bound = if steps_itself(method, &system) { 1e-8 } else { 5e-12 };
        at_most(method.name, distance(&found, &expected.concat()), bound);
    }
}

/// An oscillator that hits a moving stop: `ẍ = −x` above `s(t) = a sin 3t − c`; `[x, v, e, a]`.
struct MovingStop;

impl MovingStop {
    /// Position and velocity of the stop.
    fn stop<S: Real>(t: S, a: S) -> [S; 2] {
        let (sin, cos) = (t * 3.0).sin_cos();
        [a * sin - 0.4, a * cos * 3.0]
    }
}

impl System for MovingStop {
    type Mode = ();
    type State<S: Real> = [S; 4];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 4]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 4], dydt: &mut [S; 4]) {
        *dydt = [y[1], -y[0], S::cst(0.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &[S; 4], g: &mut [S; 1]) {
        *g = [y[0] - Self::stop(t, y[3])[0]];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 4], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, (): (), _guard: usize, t: S, y: &mut [S; 4]) -> Next<()> {
        let [s, s_dot] = Self::stop(t, y[3]);
        (y[0], y[1]) = (s, s_dot - (y[1] - s_dot) * y[2]);
        Next::Mode(())
    }
}

#[test]
fn impacts_on_a_moving_stop_depend_on_start_restitution_and_amplitude_as_runs_do() {
    let start = [1.0, 0.2, 0.7, 0.1];
    let (method, t_end) = (Method::named("dop853").unwrap(), 15.0);
    let directions: Vec<[f64; 4]> =
        (0..4).map(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)))).collect();
    let system = Sensitive::new(&MovingStop, directions, tolerance(1e-12, 4)).unwrap();
    // The run has four impacts.
    let run = |y: [f64; 4]| {
        let (mut times, control) = (Times::default(), Control::Adaptive(tolerance(1e-13, 4)));
        let y = common::end_state(&MovingStop, method, control, (0.0, y), t_end, &mut times);
        assert_eq!(times.0.len(), 4);
        vec![y[0], y[1], times.0[3]]
    };
    let expected: Vec<f64> = (0..4)
        .flat_map(|i| {
            let changed = |x| std::array::from_fn(|j| if i == j { x } else { start[j] });
            quotients(|x| run(changed(x)), start[i], 3e-4)
        })
        .collect();
    for method in METHODS {
        let y = end(&system, method, 1e-3, &start, t_end);
        let found: Vec<f64> = (0..4)
            .flat_map(|i| [&system.derivative(i, &y)[..2], &[system.event_time(i, &y)]].concat())
            .collect();
        // Measured: 9.8e-10 and 3.4e-7.
        let bound = if steps_itself(method, &system) { 3e-6 } else { 9e-9 };
        at_most(method.name, distance(&found, &expected), bound);
    }
}

/// Keeps the times of events.
#[derive(Default)]
struct Times(Vec<f64>);

impl<P: System> deltazero_solvers::Record<P> for Times {
    fn event(&mut self, event: &deltazero_solvers::Event<'_, P>) -> std::ops::ControlFlow<()> {
        self.0.push(event.t);
        std::ops::ControlFlow::Continue(())
    }
}

#[test]
fn stick_forgets_the_velocity_and_slip_keeps_its_phase() {
    let belt = |start| BeltOscillator {
        mass: 2.0,
        stiffness: 50.0,
        belt_speed: 0.3,
        static_friction: 8.0,
        kinetic_friction: 3.0,
        start,
    };
    let (start, directions) = ([0.0, 0.1], vec![[1.0, 0.0], [0.0, 1.0]]);
    let model = belt(start);
    // In stick, in the slip after it, and on the cycle; a start in slip.
    for t_end in [0.5, 0.9, 3.0] {
        let expected = [
            quotients(|x| belt([x, start[1]]).state(t_end).to_vec(), start[0], 3e-5),
            quotients(|v| belt([start[0], v]).state(t_end).to_vec(), start[1], 3e-5),
        ];
        let system = Sensitive::new(&model, directions.clone(), tolerance(1e-9, 2)).unwrap();
        for method in METHODS {
            let y = end(&system, method, 1e-3, &start, t_end);
            let found = [system.derivative(0, &y), system.derivative(1, &y)].concat();
            // Measured: 5.1e-8 and 2.1e-6.
            let bound = if steps_itself(method, &system) { 2e-5 } else { 5e-7 };
            at_most(method.name, distance(&found, &expected.concat()), bound);
        }
    }
}

#[test]
fn a_terminal_event_gives_the_derivatives_of_the_end_of_the_run() {
    struct Throw;
    impl System for Throw {
        type Mode = ();
        type State<S: Real> = [S; 3];
        type Guards<S: Real> = [S; 1];
        fn initial_mode(&self, _t: f64, _y: &[f64; 3]) {}
        fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 3], dydt: &mut [S; 3]) {
            *dydt = [S::cst(3.0), y[2], S::cst(-9.8)];
        }
        fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 3], g: &mut [S; 1]) {
            *g = [y[1] + 1.0];
        }
        fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 3], bounds: &mut [f64; 1]) {
            *bounds = [1e-15];
        }
        fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 3]) -> Next<()> {
            Next::Stop
        }
    }
    let system = Sensitive::new(&Throw, vec![[0.0, 0.0, 1.0]], tolerance(1e-10, 3)).unwrap();
    let mut solver = by_rk45(&system);
    let v = 2.0_f64;
    let mut run = Integration::new(&system, 0.0, system.start(0.0, &[0.0, 0.0, v]).unwrap());
    assert_eq!(run.run(10.0, &mut solver, &mut ()).unwrap(), Outcome::Stopped);
    // t = (v + √(v² + 2 g))/g, x = 3 t, v_end = −√(v² + 2 g).
    let root = (v * v + 19.6).sqrt();
    let dt = (1.0 + v / root) / 9.8;
    let expected = [3.0 * dt, 0.0, -v / root, dt];
    at_most("terminal", distance(&run.point.y[3..], &expected), 2e-15);
}

/// What guards and modes of an event can be; the states are `[x, p]` with `ẋ = −1`, and the event is at x = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Toy {
    Before,
    /// Guard 0 is far below zero here.
    Passing,
    After,
    /// Remembers a state or a time.
    Carrying(f64),
}

struct Toys {
    next: fn(f64, [f64; 2]) -> Toy,
    /// Rate of the second guard.
    second: f64,
}

impl System for Toys {
    type Mode = Toy;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Toy {
        Toy::Before
    }

    fn rhs<S: Real>(&self, mode: Toy, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [if mode == Toy::After { -y[1] } else { S::cst(-1.0) }, S::cst(0.0)];
    }

    fn guards<S: Real>(&self, mode: Toy, _t: S, y: &[S; 2], g: &mut [S; 2]) {
        *g = match mode {
            Toy::Before => [y[0], y[0] * self.second + (1.0 - self.second)],
            Toy::Passing => [S::cst(-1.0), S::cst(1.0)],
            _ => [S::cst(1.0); 2],
        };
    }

    fn guard_bounds(&self, _: Toy, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 2]) {
        *bounds = [1e-15; 2];
    }

    fn transition<S: Real>(&self, mode: Toy, _guard: usize, t: S, y: &mut [S; 2]) -> Next<Toy> {
        if mode == Toy::Before {
            return Next::Mode((self.next)(t.value(), y.map(Real::value)));
        }
        y[0] = y[0] * 3.0 + y[1];
        Next::Mode(Toy::After)
    }
}

/// A run of the toy from `[1, 0.5]` to 1.5, along both states.
fn toy(
    next: fn(f64, [f64; 2]) -> Toy,
    second: f64,
) -> (Result<Outcome, Error>, Traced<Toy>, Vec<f64>) {
    let toys = Toys { next, second };
    let directions = vec![[1.0, 0.0], [0.0, 1.0]];
    let system = Sensitive::new(&toys, directions, tolerance(1e-8, 2)).unwrap();
    let mut solver = by_rk45(&system);
    let mut run = Integration::new(&system, 0.0, system.start(0.0, &[1.0, 0.5]).unwrap());
    let end = run.run(1.5, &mut solver, &mut ());
    (end, run.point.mode, run.point.y)
}

#[test]
fn two_events_at_one_instant_by_a_jump_are_one_map() {
    let (end, mode, y) = toy(|_, _| Toy::Passing, 0.0);
    assert_eq!((end, mode.mode), (Ok(Outcome::Finished), Toy::After));
    // x = 3·0 + p − p (t − x₀) after the event at t = x₀.
    // Measured: 1.3e-15.
    at_most("state", distance(&y[..2], &[0.5 - 0.5 * 0.5, 0.5]), 1e-14);
    at_most("by x", distance(&y[2..5], &[0.5, 0.0, 1.0]), 1e-14);
    at_most("by p", distance(&y[5..], &[0.5, 1.0, 0.0]), 1e-14);
}

#[test]
fn events_without_derivatives_are_errors_that_say_why() {
    let refused = |next, second, expected: Lost, words: &str| {
        let (end, mode, y) = toy(next, second);
        let error = end.unwrap_err();
        assert_eq!(mode.lost, Some(expected));
        assert!(matches!(error, Error::NonFinite { component: 2, .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
        assert!(y[0].abs() < 1e-14, "the event has been passed: {y:?}");
    };
    let continuous = "branches there";
    refused(|_, y| Toy::Carrying(y[1]), 0.0, Lost::Mode { guard: 0 }, continuous);
    // The state at the event is zero from every start, only the time differs.
    refused(|t, _| Toy::Carrying(t), 0.0, Lost::Mode { guard: 0 }, continuous);
    let branches = |_, [_, p]: [f64; 2]| if p > 0.5 { Toy::Passing } else { Toy::After };
    refused(branches, 0.0, Lost::Mode { guard: 0 }, continuous);
    // Numbers that do not depend on the state may be carried.
    assert_eq!(toy(|_, _| Toy::Carrying(7.0), 0.0).0, Ok(Outcome::Finished));
}

/// A spring `ÿ = −y` that is let go at 1 passes zero at the speed 1: up to there it loses a tenth of the speed, and beyond a half.
struct Brittle;

impl System for Brittle {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, &[y, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, -y];
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = [y[0]];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, y: &mut [S; 2]) -> Next<()> {
        let kept = if y[1].value() < -1.0 { 0.5 } else { 0.9 };
        *y = [S::cst(0.0), -y[1] * kept];
        Next::Mode(())
    }
}

#[test]
fn a_transition_that_branches_within_the_tolerance_has_no_derivatives() {
    for (height, expected) in [(0.9, None), (1.1, None), (1.0, Some(Lost::Mode { guard: 0 }))] {
        let system = Sensitive::new(&Brittle, vec![[1.0, 0.0]], tolerance(1e-8, 2)).unwrap();
        let mut run = Integration::new(&system, 0.0, system.start(0.0, &[height, 0.0]).unwrap());
        let end = run.run(2.5, &mut by_rk45(&system), &mut ());
        assert_eq!((run.point.mode.lost, end.is_err()), (expected, expected.is_some()));
    }
}

/// `ẋ = a x + 1.3 + 0.3 cos t` up to 0.6, from where on `ẋ = 0` from the root of the time.
struct ByTime {
    a: f64,
}

impl System for ByTime {
    type Mode = bool;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 1]) -> bool {
        true
    }

    fn rhs<S: Real>(&self, rises: bool, t: S, &[x]: &[S; 1], dydt: &mut [S; 1]) {
        *dydt = [if rises { x * self.a + t.cos() * 0.3 + 1.3 } else { S::cst(0.0) }];
    }

    fn guards<S: Real>(&self, rises: bool, _t: S, &[x]: &[S; 1], g: &mut [S; 1]) {
        *g = [if rises { -x + 0.6 } else { S::cst(1.0) }];
    }

    fn transition<S: Real>(&self, _: bool, _: usize, t: S, y: &mut [S; 1]) -> Next<bool> {
        *y = [t.sqrt()];
        Next::Mode(false)
    }
}

#[test]
fn a_state_that_is_set_by_the_time_of_an_event_has_derivatives() {
    for k in 0..20 {
        let model = ByTime { a: -0.5 + 0.05 * f64::from(k) };
        let system = Sensitive::new(&model, vec![[1.0]], tolerance(1e-9, 1)).unwrap();
        let mut run = Integration::new(&system, 0.0, system.start(0.0, &[0.0]).unwrap());
        run.run(1.0, &mut by_rk45(&system), &mut ()).unwrap();
        // x = √t after the event at t.
        let [x, dx, dt] = run.point.y[..] else { panic!("one direction") };
        assert!(dt < -0.1, "{dt}");
        at_most("by the start", (dx - dt / (2.0 * x)).abs(), 1e-15);
    }
}

#[test]
fn guards_that_fall_together_have_no_derivatives() {
    // The other guard switches next, or no more.
    for next in [|_, _| Toy::Before, |_, _| Toy::After] {
        let (end, mode, _) = toy(next, 1.0);
        assert!(end.is_err());
        assert!(matches!(mode.lost, Some(Lost::Together { .. })), "{mode:?}");
    }
}

#[test]
fn a_touch_within_the_tolerance_has_no_derivatives() {
    for (height, is_crossing) in [(1e-3, true), (1e-11, false)] {
        // A ball thrown up falls from `height` above the floor: its speed there is √(2 g height).
        let ball = Ball { t_end: 10.0 };
        let directions = vec![[0.0, 1.0, 0.0, 0.0]];
        let system = Sensitive::new(&ball, directions, tolerance(1e-8, 4)).unwrap();
        let v: f64 = (2.0 * 9.8 * height).sqrt();
        let mut y = vec![-1e-16, -v, 0.5, 9.8, 0.0, 1.0, 0.0, 0.0, 0.0];
        let mode = system.initial_mode(0.0, &y);
        let Next::Mode(mode) = system.transition(mode, 0, 1.0, &mut y) else { panic!() };
        assert_eq!(mode.lost.is_none(), is_crossing, "{mode:?}");
        assert!(is_crossing || matches!(mode.lost, Some(Lost::Touch { guard: 0, .. })));
    }
}

#[test]
fn bounces_that_accumulate_end_the_derivatives() {
    let ball = Ball { t_end: 10.0 };
    let directions = vec![[0.0, 0.0, 1.0, 0.0]];
    let system = Sensitive::new(&ball, directions, tolerance(1e-8, 4)).unwrap();
    let mut solver = by_rk45(&system);
    let start = system.start(0.0, &[1.0, 0.0, 0.5, 9.8]).unwrap();
    let mut run = Integration::new(&system, 0.0, start);
    let error = run.run(2.0, &mut solver, &mut ()).unwrap_err();
    assert!(error.to_string().contains("without sensitivities"), "{error}");
    // The bounces accumulate at 1.3553 s.
    assert!((1.35..1.3553).contains(&run.point.t), "{}", run.point.t);
}

#[test]
fn the_limit_of_events_that_accumulate_has_no_derivatives() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    let system = Sensitive::new(&ball, vec![[1.0, 0.0]], tolerance(1e-8, 2)).unwrap();
    let mut y = system.start(0.0, &ball.start()).unwrap();
    let mode = system.initial_mode(0.0, &y);
    let limit = system.accumulation(mode, 0, 1.3, &mut y).unwrap();
    assert_eq!(
        (limit.mode, limit.lost),
        (BouncingMode::Rest, Some(Lost::Accumulation { guard: 0 }))
    );
    assert_eq!(system.state(&y), [0.0, 0.0]);
    assert!(system.derivative(0, &y).iter().all(|derivative| derivative.is_nan()));
}

#[test]
fn a_switch_without_change_of_slope_or_state_changes_no_derivative() {
    let toys = Toys { next: |_, _| Toy::Carrying(0.0), second: 0.0 };
    let directions = vec![[0.3, 0.7], [-0.2, 0.1]];
    let system = Sensitive::new(&toys, directions, tolerance(1e-8, 2)).unwrap();
    let mut y = system.start(0.0, &[0.0, 0.5]).unwrap();
    let before = y.clone();
    let mode = system.initial_mode(0.0, &y);
    system.transition(mode, 0, 1.0, &mut y);
    for direction in 0..2 {
        let [after, before] = [&y, &before].map(|y| system.derivative(direction, y).to_vec());
        at_most("saltation", distance(&after, &before), 1e-16);
        // ġ = −1.
        assert_eq!(system.event_time(direction, &y), before[0]);
    }
}

#[test]
fn a_start_between_two_modes_and_a_blind_system_are_refused() {
    let model = BeltOscillator {
        mass: 2.0,
        stiffness: 50.0,
        belt_speed: 0.3,
        static_friction: 8.0,
        kinetic_friction: 3.0,
        start: [0.0, 0.3],
    };
    let directions = vec![[1.0, 0.0], [0.0, 1.0]];
    let system = Sensitive::new(&model, directions, tolerance(1e-8, 2)).unwrap();
    // At the speed of the belt: a change of the velocity leads to slip.
    let refused = system.start(0.0, &model.start).unwrap_err();
    assert!(matches!(refused, Error::BadArgument { name: "direction", value: 1.0, .. }));
    let blind = Blind(&model);
    let refused = Sensitive::new(&blind, vec![[1.0, 0.0]], tolerance(1e-8, 2)).unwrap_err();
    assert_eq!(refused, Error::BlindSensitivities);
    assert!(Sensitive::new(&model, vec![], tolerance(1e-8, 2)).is_err());
    assert!(Sensitive::new(&model, vec![[0.0; 2]], tolerance(1e-8, 3)).is_err());
}
