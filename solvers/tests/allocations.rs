//! A step allocates nothing once its memory is there.

mod common;

use common::{steps_itself, takes_fixed_steps, tolerance};
use deltazero_solvers::problems::{CompliantBall, Exit};
use deltazero_solvers::{Control, Error, Integration, METHODS, Method, Outcome};

/// Allocations of a run from t = 1 s to t = 20 s, after one to t = 1 s.
fn allocations(ball: &CompliantBall, method: &Method, control: Control) -> Result<u64, Error> {
    let mut solver = method.solver(ball, control)?;
    let mut integration = Integration::new(ball, 0.0, ball.start);
    integration.run(1.0, &mut *solver, &mut ())?;
    let before = integration.stats;
    let mut outcome = Ok(Outcome::Interrupted);
    let counted = allocation_counter::measure(|| {
        outcome = integration.run(20.0, &mut *solver, &mut ());
    });
    assert_eq!(outcome, Ok(Outcome::Finished));
    assert!(integration.stats.n_accepted > before.n_accepted + 20);
    assert!(integration.stats.n_events > before.n_events + 20);
    Ok(counted.count_total)
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
    for method in METHODS.iter().filter(|method| !steps_itself(method, &ball)) {
        let name = method.name;
        if takes_fixed_steps(method, &ball) {
            assert_eq!(allocations(&ball, method, Control::Fixed(0.01)), Ok(0), "{name}");
        }
        if !method.is_fixed_step() {
            assert_eq!(allocations(&ball, method, tolerance(1e-8)), Ok(0), "{name}");
        }
    }
}

#[test]
fn the_counter_counts() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(vec![0_u8; 100])));
    assert_eq!(counted.count_total, 1);
}
