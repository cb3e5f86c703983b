//! Friction by bristles: energy, order, limits, and bays that have them.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use std::ops::ControlFlow;

use common::{balance, config, distance, located, run, run_chain, setting};
use deltazero::model::struts::chain_of;
use deltazero::model::{Chain, Jointed as _};
use deltazero::run::{mode_changes, trajectories};
use deltazero_solvers::{Event, Next, Record};
use deltazero_study::Problem as _;
use deltazero_study::errors::{ErrorScale, ScaledGroup, log_log_slope, match_events, worse};
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;

const LUGRE: &str = "friction.law=lugre";

/// Of a joint with this clearance [m], where θ reaches `theta` [rad].
fn scale(clearance: f64, theta: f64) -> ErrorScale {
    let group = |states: &[usize], scale| ScaledGroup { states: states.to_vec(), scale, site: 0 };
    let groups = vec![group(&[0, 1], clearance), group(&[2], theta)];
    ErrorScale { groups, event_window: 1e-3 }
}

/// Of the struts, over some tenths of a second.
fn of_struts() -> ErrorScale {
    scale(1e-4, 0.01)
}

#[test]
fn the_energy_of_bristles_balances() {
    // Measured: 1.2e-13, 6.1e-13, 1.3e-13, 1.5e-11 and 1.3e-11, where rk45 leaves 1.3e-8.
    for (set, t_end, method, bound) in [
        ("reading=pin", 0.5, "rk45", 1e-12),
        ("reading=full", 0.5, "rk45", 6e-12),
        ("contact.adhesion=false", 0.5, "rk45", 1e-12),
        ("bays=3", 0.5, "rk45", 1e-10),
        ("mechanism=slider-crank", 0.024, "vern98", 1e-10),
    ] {
        let config = config(&[set, LUGRE, &format!("run.t_end={t_end}")]);
        let balance = balance(&config, &located(method, 1e-10));
        let relative = (balance.residual / balance.work).abs();
        assert!(relative < bound, "{set}: {relative:e}");
    }
}

#[test]
fn bristles_are_unbent_where_a_contact_begins() {
    for set in ["contact.adhesion=true", "contact.adhesion=false"] {
        let config = config(&["bays=3", LUGRE, set, "run.t_end=0.2"]);
        let chain = chain_of(&config);
        let mut seen = Touches { bent: 0, begun: 0 };
        let run = chain.integrate(&located("rk45", 1e-8), chain.start(), 0.2, &mut seen);
        assert!(run.outcome.is_ok() && seen.begun > 10 && seen.bent > 0, "{seen:?}");
    }
}

/// Looks at the bristles, the last of the seven states of a bay, at every event.
#[derive(Debug)]
struct Touches {
    /// Events within a contact, where they are bent.
    bent: usize,
    /// Beginnings of a contact.
    begun: usize,
}

impl Record<Chain> for Touches {
    fn event(&mut self, event: &Event<'_, Chain>) -> ControlFlow<()> {
        let Next::Mode(after) = &event.after else { return ControlFlow::Continue(()) };
        let k = Chain::bay_of(event.guard);
        let z = event.y[7 * k + 6];
        match (event.before[k].is_contact(), after[k].is_contact()) {
            (true, true) => {
                assert!(z != 0.0 && z.abs() <= 1.5e-6, "bay {k}: {z:e} m at {} s", event.t);
                self.bent += 1;
            }
            (before, _) => {
                assert_eq!(z, 0.0, "bay {k} at {} s", event.t);
                self.begun += usize::from(!before);
            }
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn methods_of_every_kind_agree_on_bristles() {
    let config = config(&["reading=full", LUGRE, "run.t_end=0.5"]);
    let run = |setting: &Setting| run(&config, setting).1;
    let reference = run(&located("taylor", 1e-13));
    // Measured: 3.7e-10, 4.0e-9 and 4.3e-8.
    for (method, rtol, bound) in
        [("dop853", 1e-11, 3e-9), ("radau5", 1e-10, 3e-8), ("bdf", 1e-9, 4e-7)]
    {
        let own = run(&located(method, rtol));
        let e = distance(&own, &reference, &of_struts());
        assert!(e < bound, "{method}: {e:e}");
        for (own, exact) in own.trajectories.iter().zip(&reference.trajectories) {
            let found =
                match_events(&mode_changes(own), &mode_changes(exact), of_struts().event_window);
            assert_eq!((found.missed, found.spurious), (0, 0), "{method}: {found:?}");
        }
    }
}

#[test]
fn methods_that_take_long_steps_see_the_narrow_part_of_friction() {
    // Sliding at metres a second, friction changes below some millimetres a second.
    // Measured: 8.7e-12, 2.7e-10 and 2.8e-10.
    for (law, bound) in [("lugre", 3e-11), ("stribeck", 1e-9), ("tanh", 1e-9)] {
        let law = format!("friction.law={law}");
        let config = config(&["mechanism=slider-crank", "run.t_end=0.003", &law]);
        let run = |method, rtol| run(&config, &located(method, rtol)).1;
        let scale = scale(5e-4, 1.5);
        let e = distance(&run("taylor", 1e-12), &run("rodas5p", 1e-12), &scale);
        assert!(e < bound, "{law}: {e:e}");
    }
}

#[test]
fn rk4_keeps_its_order_through_the_kinks_of_bristles() {
    let config = config(&["reading=full", LUGRE, "run.t_end=0.2"]);
    let (_, reference) = run(&config, &located("taylor", 1e-13));
    let error = |h: f64| {
        let rk4 = setting("rk4", Events::Located, Accuracy::Step(h));
        (h, distance(&run(&config, &rk4).1, &reference, &of_struts()))
    };
    let slope = log_log_slope(&[2e-4, 1e-4, 5e-5, 2.5e-5].map(error)).unwrap();
    // Measured: 4.06.
    assert!((slope - 4.0).abs() < 0.2, "{slope}");
}

#[test]
fn stiff_bristles_are_coulombs_friction() {
    let coulomb = config(&["reading=full", "run.t_end=0.3"]);
    let (_, exact) = run(&coulomb, &located("dop853", 1e-10));
    let error = |stiffness: f64| {
        let own = format!("friction.bristle_stiffness={stiffness:e}");
        let sets =
            ["reading=full", "run.t_end=0.3", LUGRE, "friction.static_coefficient=0.1", &own];
        let (_, own) = run(&config(&sets), &located("dop853", 1e-9));
        (stiffness, distance(&own, &exact, &of_struts()))
    };
    let (soft, stiff) = (error(1e4), error(1e6));
    // Measured: 1.5e-1 and 1.3e-2.
    assert!(stiff.1 < 0.15 * soft.1, "{soft:?}, {stiff:?}");
}

#[test]
fn bays_may_have_bristles() {
    let config = config(&["bays=3", LUGRE, "run.t_end=0.1"]);
    let (chain, one) = run_chain(&config, "rk45", 1e-10);
    for (k, bay) in trajectories(&chain, &one).iter().enumerate() {
        for (sample, raw) in bay.samples.iter().zip(&one.samples) {
            assert_eq!(sample.y, raw.y[7 * k..7 * k + 6]);
        }
    }
    let (_, other) = run_chain(&config, "rodas5p", 1e-9);
    assert_eq!(chain.n_sites(), 3);
    let scale = scale(1e-4, 1e-3);
    for (one, other) in trajectories(&chain, &one).iter().zip(&trajectories(&chain, &other)) {
        let pairs = one.samples.iter().zip(&other.samples);
        let e = pairs.map(|(a, b)| scale.error(&a.y, &b.y)).fold(0.0, worse);
        // Measured: at most 3.4e-10.
        assert!(e < 3e-9, "{e:e}");
    }
}

#[test]
fn the_work_of_bristles_is_pinned() {
    let config = config(&[LUGRE, "run.t_end=0.5"]);
    let (_, run) = run(&config, &located("rk45", 1e-8));
    assert_eq!((run.stats().work.n_rhs, run.stats().n_events), (51994, 36));
}
