//! A ball whose bounces accumulate: how many of them hold, and how well.

mod common;

use std::ops::ControlFlow;

use common::{at_most, steps_itself, tolerance};
use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Accepted, Control, Event, Integration, METHODS, Record};

/// Time and speed after each bounce, until there are enough.
struct Bounces(Vec<(f64, f64)>);

/// Number of bounces looked at: their times are then within 1e-12 s of the accumulation.
const N: usize = 40;

impl Record<BouncingBall> for Bounces {
    fn step(&mut self, _: &Accepted<'_, BouncingBall>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

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
fn self_stepping_methods_hold_bounces_above_their_tolerance() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    for method in METHODS.iter().filter(|method| steps_itself(method, &ball)) {
        let mut solver = method.solver(&ball, tolerance(1e-10)).unwrap();
        let mut bounces = Bounces(Vec::new());
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        integration.run(2.0, &mut *solver, &mut bounces).unwrap();
        for (n, (t, _)) in bounces.0.iter().enumerate().take(12) {
            let exact = ball.bounce_time(n);
            // Measured: 7.3e-9 at rtol = 1e-10, each phase starting at first order.
            at_most("time", (t / exact - 1.0).abs(), 5e-8);
        }
    }
}
