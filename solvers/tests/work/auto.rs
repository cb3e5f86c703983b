//! Which half of `auto` the work goes to.

use std::ops::ControlFlow;

use deltazero_solvers::{
    Accepted, Control, Integration, Method, Next, Outcome, Real, Record, Stats, Steps, System,
    Tolerance, Work, WorkByKind,
};

use crate::common::{at_most, log_slope, near, tolerance};

/// `ẏ₁ = −λ (y₁ − cos t) − sin t`, `ẏ₂ = 1`, ended where y₁ falls below `floor`; `y = (cos t, t)`.
struct Relaxation {
    /// Rate λ at all times, or its peak in `λ = 1 + peak sin³²(t/8)`.
    rate: f64,
    has_peak: bool,
    floor: f64,
}

impl Relaxation {
    const START: [f64; 2] = [1.0, 0.0];
    /// End of the runs, where the peak is over.
    const END: f64 = 8.0 * std::f64::consts::PI;

    /// Always stiff.
    fn stiff() -> Self {
        Self { rate: 1e6, has_peak: false, floor: -2.0 }
    }

    /// Stiff about t = 4π, and slow within 5 of t = 0 and 8π.
    fn peaked() -> Self {
        Self { has_peak: true, ..Self::stiff() }
    }
}

impl System for Relaxation {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        let (sin, cos) = t.sin_cos();
        let mut rate = S::cst(self.rate);
        if self.has_peak {
            let (sin, _) = (t * 0.125).sin_cos();
            let power = (0..5).fold(sin, |power, _| power * power);
            rate = power * self.rate + 1.0;
        }
        *dydt = [(cos - y[0]) * rate - sin, S::cst(1.0)];
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = [y[0] - self.floor];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [4.0 * f64::EPSILON];
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

/// Which half took each step, and the greatest error of y₁ at their ends.
#[derive(Default)]
struct Halves {
    is_implicit: Vec<bool>,
    n_implicit: u64,
    error: f64,
}

impl Record<Relaxation> for Halves {
    fn step(&mut self, accepted: &Accepted<'_, Relaxation>) -> ControlFlow<()> {
        self.is_implicit.push(accepted.stats.n_implicit > self.n_implicit);
        self.n_implicit = accepted.stats.n_implicit;
        let error = accepted.step.y1()[0] - accepted.step.t1().cos();
        self.error = self.error.max(error.abs());
        ControlFlow::Continue(())
    }
}

fn auto() -> &'static Method {
    Method::named("auto").unwrap()
}

/// A run of `auto` on `problem` to `t_end`.
fn halves(problem: &Relaxation, rtol: f64, t_end: f64) -> (Halves, Stats, f64) {
    let mut halves = Halves::default();
    let mut solver = auto().solver(problem, tolerance(rtol)).unwrap();
    let mut run = Integration::new(problem, 0.0, Relaxation::START);
    run.run(t_end, &mut *solver, &mut halves).unwrap();
    assert_eq!(halves.n_implicit, run.stats.n_implicit);
    (halves, run.stats, run.point.t)
}

/// Nine states that decay, with rates of 0.1 to 0.9, ended where the first falls below a half.
struct Wide;

impl System for Wide {
    type Mode = ();
    type State<S: Real> = [S; 9];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 9]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 9], dydt: &mut [S; 9]) {
        *dydt = std::array::from_fn(|i| y[i] * (-0.1 * (i + 1) as f64));
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 9], g: &mut [S; 1]) {
        *g = [y[0] - 0.5];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 9], bounds: &mut [f64; 1]) {
        *bounds = [4.0 * f64::EPSILON];
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 9]) -> Next<()> {
        Next::Stop
    }
}

/// The oscillator of van der Pol, whose Jacobian changes along its cycle: `ẍ = (1 − x²) ẋ − x`.
struct Cycle;

impl System for Cycle {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [y[1], (-(y[0] * y[0]) + 1.0) * y[1] - y[0]];
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 2], _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], _bounds: &mut [f64; 0]) {}

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

#[test]
fn auto_is_its_explicit_method_bit_for_bit_where_nothing_is_stiff() {
    let slow = Relaxation { rate: 0.1, has_peak: false, floor: 0.5 };
    expect_explicit(&slow, Relaxation::START, (1e-4, "rk43"));
    expect_explicit(&slow, Relaxation::START, (1e-7, "taylor"));
    expect_explicit(&Wide, [1.0; 9], (1e-7, "dop853"));
    expect_explicit(&Cycle, [2.0, 0.0], (1e-4, "rk43"));
    expect_explicit(&Cycle, [2.0, 0.0], (1e-10, "taylor"));
}

fn expect_explicit<P: System>(problem: &P, start: P::State<f64>, (rtol, explicit): (f64, &str)) {
    let run = |method: &Method| {
        let control = Control::Adaptive(Tolerance { rtol, atol: vec![rtol; start.as_ref().len()] });
        let mut solver = method.solver(problem, control).unwrap();
        let mut run = Integration::new(problem, 0.0, start.clone());
        run.run(10.0 * Relaxation::END, &mut *solver, &mut ()).unwrap();
        (run.point.y.as_ref().to_vec(), run.stats)
    };
    let ((y, stats), expected) = (run(auto()), run(Method::named(explicit).unwrap()));
    assert_eq!(stats.n_implicit, 0);
    let looked = Work { n_jac: 0, ..stats.work };
    assert_eq!((y, Stats { work: looked, ..stats }), expected);
    // Few looks: one a phase, and one for 2048 right-hand sides at most, of which a series counts as 12.
    assert!(stats.work.n_jac <= stats.n_events + 1 + 12 * stats.work.n_rhs / 2048);
}

/// Two that are bound by stability first, or all the time.
enum Bound {
    /// `ẍ = −ω² x − 2 ζ ω ẋ` with a large ω, far below the tolerance from the start: all that is seen of it is
    /// the bound.
    Ringing,
    /// `ẏ = −y³`, at first so steep that a bound kept from there is one of 1e7 steps.
    Cubic,
}

impl System for Bound {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        let (omega, zeta) = (1e3, 0.1);
        *dydt = match self {
            Self::Ringing => [y[1], -(y[0] * (omega * omega)) - y[1] * (2.0 * zeta * omega)],
            Self::Cubic => y.map(|y| -(y * y * y)),
        };
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 2], _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], _bounds: &mut [f64; 0]) {}

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

impl Bound {
    fn run(&self, method: &str, start: [f64; 2], t_end: f64) -> ([f64; 2], Stats) {
        let mut solver = Method::named(method).unwrap().solver(self, tolerance(1e-3)).unwrap();
        let mut run = Integration::new(self, 0.0, start);
        run.run(t_end, &mut *solver, &mut ()).unwrap();
        (run.point.y, run.stats)
    }
}

#[test]
fn explicit_steps_of_auto_keep_within_their_bound_of_stability() {
    // Fewer right-hand sides than a trial waits for.
    let run = |name| Bound::Ringing.run(name, [1e-9, 0.0], 0.07).1;
    let (auto, alone) = (run("auto"), run("rk43"));
    assert_eq!((auto.n_implicit, auto.n_rejected), (0, 0));
    // Measured: 5.
    assert!(alone.n_rejected > 2, "{}", alone.n_rejected);
}

#[test]
fn auto_turns_implicit_where_the_fast_motion_is_below_the_tolerance() {
    let stats = Bound::Ringing.run("auto", [1e-9, 0.0], 10.0).1;
    // Measured: 33 explicit steps and 160 right-hand sides; in steps within the bound of stability it would be 16 000.
    at_most("explicit", (stats.n_accepted - stats.n_implicit) as f64, 50.0);
    at_most("n_rhs", stats.work.n_rhs as f64, 250.0);
    // Above it, while the motion is seen, no implicit step is taken.
    let seen = Bound::Ringing.run("auto", [1.0, 0.0], 0.02).1;
    assert_eq!(seen.n_implicit, 0);
}

#[test]
fn a_longest_step_that_the_user_sets_is_no_sign_of_stiffness() {
    // The bound of stability is 2.5e-3.
    let steps = Steps { longest: 1e-3, ..tolerance(1e-3).into() };
    let mut solver = auto().solver(&Bound::Ringing, steps).unwrap();
    let mut run = Integration::new(&Bound::Ringing, 0.0, [1e-9, 0.0]);
    run.run(1.0, &mut *solver, &mut ()).unwrap();
    assert_eq!(run.stats.n_implicit, 0);
    assert!(run.stats.n_accepted < 1010, "{:?}", run.stats);
}

#[test]
fn explicit_steps_of_auto_grow_where_the_stiffness_of_their_start_is_gone() {
    let (y, stats) = Bound::Cubic.run("auto", [1e3, 1e3], 10.0);
    assert!((y[0] * 20.0_f64.sqrt() - 1.0).abs() < 0.1, "{y:?}");
    // Measured: 610.
    at_most("n_rhs", stats.work.n_rhs as f64, 1e3);
}

#[test]
fn auto_turns_implicit_on_a_stiff_relaxation_and_its_work_is_bounded() {
    for rtol in [1e-3, 1e-5, 1e-7] {
        let (halves, stats, _) = halves(&Relaxation::stiff(), rtol, 10.0);
        // Measured: 170, the worst; dop853 alone needs 2e7.
        at_most("n_rhs", stats.work.n_rhs as f64, 350.0);
        assert!(halves.is_implicit.last().unwrap());
        // Measured: 2.5 rtol at most.
        at_most("error", halves.error, 25.0 * rtol);
    }
}

#[test]
fn auto_turns_both_ways_within_one_phase_as_the_stiffness_comes_and_goes() {
    for rtol in [1e-5, 1e-7, 1e-9] {
        let (halves, stats, _) = halves(&Relaxation::peaked(), rtol, Relaxation::END);
        let turns = halves.is_implicit.windows(2).filter(|pair| pair[0] != pair[1]).count();
        // A trial too early is two more.
        assert!(turns == 2 || turns == 4, "{turns}");
        assert!(!halves.is_implicit[0] && stats.n_implicit > 50);
        // Measured: 2500, the worst; dop853 alone needs millions.
        at_most("n_rhs", stats.work.n_rhs as f64, 5e3);
        // Measured: 1.2, 0.8 and 6.3 rtol.
        at_most("error", halves.error, 30.0 * rtol);
    }
}

#[test]
fn the_error_of_auto_follows_its_tolerance_through_its_turns() {
    let rtols = [1e-5, 3.2e-6, 1e-6, 3.2e-7, 1e-7, 3.2e-8, 1e-8, 3.2e-9, 1e-9];
    let points = rtols.map(|rtol| {
        let (halves, ..) = halves(&Relaxation::peaked(), rtol, Relaxation::END);
        (rtol, halves.error)
    });
    // Measured: 0.82.
    near("auto", log_slope(&points), 0.9, 0.3);
}

#[test]
fn auto_lands_on_a_guard_that_falls_in_an_implicit_step() {
    let problem = Relaxation { floor: 0.5, ..Relaxation::stiff() };
    let (halves, stats, t) = halves(&problem, 1e-7, 10.0);
    assert_eq!(stats.n_events, 1);
    assert!(halves.is_implicit.last().unwrap());
    // Measured: 3.0e-10.
    at_most("time", (t - std::f64::consts::FRAC_PI_3).abs(), 6e-9);
}

#[test]
fn auto_decides_the_same_in_every_run_and_shows_it_to_any_recorder() {
    let problem = Relaxation::peaked();
    let (_, stats, _) = halves(&problem, 1e-6, Relaxation::END);
    let mut solver = auto().solver(&problem, tolerance(1e-6)).unwrap();
    let mut run = Integration::new(&problem, 0.0, Relaxation::START);
    let mut split = WorkByKind::new(|()| ());
    assert_eq!(run.run(Relaxation::END, &mut *solver, &mut split), Ok(Outcome::Finished));
    assert_eq!((run.stats, split.kinds), (stats, vec![((), stats)]));
}
