//! A step allocates nothing once its memory is there.

mod common;

use common::{steps_itself, takes_fixed_steps, tolerance};
use deltazero_solvers::problems::{CompliantBall, Exit};
use deltazero_solvers::{
    Control, Error, Integration, METHODS, Method, Next, Outcome, Real, System, Tolerance,
};

/// Allocations and events of a run from t = 1 s to t = 20 s, after one to t = 1 s.
fn allocations<P: System>(
    system: &P,
    start: P::State<f64>,
    method: &Method,
    control: Control,
) -> Result<(u64, u64), Error> {
    let mut solver = method.solver(system, control)?;
    let mut integration = Integration::new(system, 0.0, start);
    integration.run(1.0, &mut *solver, &mut ())?;
    let before = integration.stats;
    let mut outcome = Ok(Outcome::Interrupted);
    let counted = allocation_counter::measure(|| {
        outcome = integration.run(20.0, &mut *solver, &mut ());
    });
    assert_eq!(outcome, Ok(Outcome::Finished));
    assert!(integration.stats.n_accepted > before.n_accepted + 20);
    let n_events = integration.stats.n_events - before.n_events;
    assert!(n_events > 20);
    Ok((counted.count_total, n_events))
}

#[test]
fn steps_and_events_of_one_step_methods_allocate_nothing() {
    let ball = CompliantBall {
        mass: 1.0,
        stiffness: 100.0,
        damping: 0.0,
        exit: Exit::Force,
        gap: 1.0,
        start: [0.5, 2.0],
    };
    let n = |method, control| allocations(&ball, ball.start, method, control).map(|(n, _)| n);
    for method in METHODS.iter().filter(|method| !steps_itself(method, &ball)) {
        if takes_fixed_steps(method, &ball) {
            assert_eq!(n(method, Control::Fixed(0.01)), Ok(0), "{}", method.name);
        }
        if !method.is_fixed_step() {
            assert_eq!(n(method, tolerance(1e-8)), Ok(0), "{}", method.name);
        }
    }
}

/// Oscillators side by side, each before a wall.
struct Row;

impl System for Row {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = Vec<S>;

    fn dim(&self) -> usize {
        6
    }

    fn n_guards(&self) -> usize {
        3
    }

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        for i in 0..3 {
            dydt[i] = y[3 + i];
            dydt[3 + i] = y[i] * -9.0;
        }
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &Vec<S>, g: &mut Vec<S>) {
        g.iter_mut().zip(y).for_each(|(g, x)| *g = *x + 0.2);
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, bounds: &mut Vec<f64>) {
        bounds.fill(4.0 * f64::EPSILON);
    }

    fn transition<S: Real>(&self, (): (), i: usize, _t: S, y: &mut Vec<S>) -> Next<()> {
        y[i] = S::cst(-0.2);
        y[3 + i] = -y[3 + i];
        Next::Mode(())
    }
}

#[test]
fn steps_of_states_in_a_vector_allocate_nothing() {
    for name in ["bs32", "rk45", "dop853", "vern98"] {
        let start = vec![0.0, 0.1, 0.2, 1.0, 1.1, 1.2];
        let control = Control::Adaptive(Tolerance { rtol: 1e-8, atol: vec![1e-8; 6] });
        let (n, n_events) =
            allocations(&Row, start, Method::named(name).unwrap(), control).unwrap();
        // An event: the states before, after and in its mode, and the guards where their errors are found.
        assert!(n <= 4 * n_events, "{name}: {n} at {n_events} events");
    }
}

#[test]
fn the_counter_counts() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(vec![0_u8; 100])));
    assert_eq!(counted.count_total, 1);
}
