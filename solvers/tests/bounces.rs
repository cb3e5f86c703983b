//! A ball whose bounces accumulate: how many of them hold, and how well.

mod common;

use std::ops::ControlFlow;

use common::{at_most, steps_itself, tolerance};
use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Control, Event, Integration, METHODS, Record, Tolerance};

/// Time and speed after each bounce, until there are enough.
struct Bounces(Vec<(f64, f64)>);

/// Number of bounces looked at: their times are then within 1e-12 s of the accumulation.
const N: usize = 40;

impl Record<BouncingBall> for Bounces {
    fn event(&mut self, event: &Event<'_, BouncingBall>) -> ControlFlow<()> {
        self.0.push((event.t, event.y[1]));
        match self.0.len() {
            N => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}

#[test]
fn forty_bounces_hold_to_rounding_in_time_and_speed() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    for method in METHODS.iter().filter(|method| !steps_itself(method, &ball)) {
        for control in [Control::Fixed(0.01), tolerance(1e-10)] {
            let Ok(mut solver) = method.solver(&ball, control) else {
                continue;
            };
            let mut bounces = Bounces(Vec::new());
            let mut integration = Integration::new(&ball, 0.0, ball.start());
            integration.run(2.0, &mut *solver, &mut bounces).unwrap();
            assert_eq!(bounces.0.len(), N, "{}", method.name);
            for (n, (t, v)) in bounces.0.iter().enumerate() {
                let (exact_t, exact_v) = (ball.bounce_time(n), ball.bounce_speed(n));
                // Measured: 3.6e-15 and 1.1e-13.
                at_most("time", (t / exact_t - 1.0).abs(), 3e-14);
                at_most("speed", (v / exact_v - 1.0).abs(), 1e-12);
            }
        }
    }
}

#[test]
fn forty_bounces_of_self_stepping_methods_hold_to_rounding_in_time() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    for method in METHODS.iter().filter(|method| steps_itself(method, &ball)) {
        // The last arcs are 1e-24 m high. Restarting at first order, bdf is off by rtol otherwise, and
        // by 2.8e-6 with atol = rtol = 1e-10.
        let resolved = Tolerance { rtol: 1e-12, atol: vec![1e-24; 2] };
        let mut solver = method.solver(&ball, Control::Adaptive(resolved)).unwrap();
        let mut bounces = Bounces(Vec::new());
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        integration.run(2.0, &mut *solver, &mut bounces).unwrap();
        assert_eq!(bounces.0.len(), N, "{}", method.name);
        for (n, (t, _)) in bounces.0.iter().enumerate() {
            // Measured: 3.2e-14 for tsit45, 1.6e-14 for bdf.
            at_most("time", (t / ball.bounce_time(n) - 1.0).abs(), 3e-13);
        }
    }
}
