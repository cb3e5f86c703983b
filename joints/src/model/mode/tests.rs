//! Guards against what a mode means.

use deltazero_solvers::{Grid, Method, Outcome, System, Trajectory};
use deltazero_study::Problem as _;
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;

use super::*;
use crate::keys::test_defaults::table1;
use crate::keys::{FrictionLaw, ReadingName, Shared};
use crate::laws::ContactLaw;
use crate::model::Jointed as _;
use crate::model::struts::struts;

/// xorshift64: numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        2.0 * (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    }
}

/// Whether `y` is a state of `mode`, by what the mode means and not by its guards.
fn is_inside(block: &Block, mode: Mode, y: &State<f64>) -> bool {
    let (pose, normal) = (block.pose(y), &block.normal);
    // A drive turns as it pulls.
    if block.stop_at_90 && block.torque.signum() * y[2] > FRAC_PI_2 {
        return false;
    }
    let Some(onset) = mode.onset() else { return pose.delta < 0.0 };
    let force = normal.force(pose.delta, pose.delta_dot, onset);
    // A force that damping alone makes positive outside pushes the pin back in at once.
    let presses = force > 0.0 && (pose.delta > 0.0 || normal.hysteresis == 0.0);
    if let Mode::Relaxing(_) = mode {
        return pose.delta > 0.0 && !presses;
    }
    let is_touching = if normal.adhesion { pose.delta > 0.0 } else { presses };
    let is_in_range = normal.elastic.deepest().is_none_or(|deepest| pose.delta < deepest);
    let slides = match mode.sigma() {
        Some(sigma) => {
            let s = sigma * block.v_t(&pose, y);
            let [low, high] = block.sliding.span(onset.piece);
            low < s && s < high
        }
        None => {
            let forces = block.forces(mode, y, &pose);
            forces.tangential.abs() < block.sliding.at_rest(block.mu) * forces.normal
        }
    };
    is_touching && is_in_range && slides
}

/// A state near the surface of contact, or far beyond it, and up to and past 90°.
fn state(block: &Block, random: &mut Random) -> State<f64> {
    let depth = 10_f64.powf(-2.0 + 2.0 * random.next()) * random.next().signum();
    let (rho, phi) = (block.clearance * (1.0 + 0.9 * depth), 3.0 * random.next());
    let mut y = [rho * phi.cos(), rho * phi.sin(), 0.0, 0.0, 0.0, 0.0];
    y[2] = 1.7 * random.next();
    let speed = 10_f64.powf(-3.0 + 2.0 * random.next());
    for y in &mut y[3..] {
        *y = speed * random.next();
    }
    y
}

#[test]
fn guards_are_positive_inside_their_mode_and_nowhere_else() {
    let mut random = Random(88_172_645_463_325_252);
    for law in ContactLaw::ALL {
        for friction in FrictionLaw::ALL {
            for adhesion in [true, false] {
                let mut config = Shared { reading: ReadingName::Full, ..table1() };
                for joint in &mut config.joints {
                    (joint.contact.law, joint.friction.law) = (law, *friction);
                    (joint.contact.adhesion, joint.contact.length) = (adhesion, 1e-3);
                    joint.contact.young_modulus = 1e8;
                }
                config.drive.m4 = -config.drive.m4;
                for block in &struts(&config) {
                    for _ in 0..200 {
                        check(block, &state(block, &mut random), &mut random);
                    }
                }
            }
        }
    }
}

/// Compares the guards of every mode at `y` with what the mode means.
fn check(block: &Block, y: &State<f64>, random: &mut Random) {
    let mut onset = block.normal.onset(1e-3 * (1.0 + random.next()));
    onset = block.sliding.begun_at((1e-2 * random.next()).abs(), onset);
    let mut modes = vec![Mode::Apart, Mode::SlipPlus(onset), Mode::SlipMinus(onset)];
    if !block.normal.adhesion {
        modes.push(Mode::Relaxing(onset));
    }
    if block.sliding.sticks() {
        modes.push(Mode::Stick(onset));
    }
    for mode in modes {
        let (mut g, mut bounds) = ([0.0; N_GUARDS], [0.0; N_GUARDS]);
        block.guards(mode, 0.0, y, &mut g);
        block.guard_bounds(mode, 0.0, y, &mut bounds);
        if g.iter().zip(bounds).any(|(g, bound)| g.abs() <= bound) {
            continue;
        }
        let holds = g.iter().all(|g| *g > 0.0);
        assert_eq!(
            holds,
            is_inside(block, mode, y),
            "{mode} of {:?} at {y:?}: guards {g:?}",
            block.normal
        );
    }
}

/// The equations keep their form under (X, θ, M) → (−X, −θ, −M).
#[test]
fn a_run_under_the_reversed_torque_is_the_mirrored_one_to_its_end() {
    let run = |m1| {
        let mut config = table1();
        config.drive.m1 = m1;
        let [block, _] = struts(&config);
        let accuracy = Accuracy::Rtol(1e-6, None);
        let method = Method::named("rk45").unwrap();
        let setting = Setting { method, events: Events::Located, accuracy };
        block.integrate(&setting, block.start(), 3.0, &mut Trajectory::on(Grid::Steps))
    };
    let (one, other) = (run(100.0), run(-100.0));
    assert_eq!([&one.outcome, &other.outcome], [&Ok(Outcome::Stopped); 2]);
    let [x, y, theta, v_x, v_y, omega] = other.y;
    assert_eq!((one.t, one.y), (other.t, [-x, y, -theta, -v_x, v_y, -omega]));
    assert_eq!(one.mode.sigma(), other.mode.sigma().map(|sigma| -sigma));
}

/// With adhesion, and a torque of friction that turns the pin less than it moves it, a pin sticks while it is pulled.
#[test]
fn a_pin_that_begins_to_stick_is_within_the_guards_of_its_stick() {
    let mut random = Random(88_172_645_463_325_252);
    let [mut pressed, mut pulled] = [0; 2];
    for reading in [ReadingName::Pin, ReadingName::Full] {
        let mut config = Shared { reading, ..table1() };
        for joint in &mut config.joints {
            (joint.friction.coefficient, joint.contact.damping) = (10.0, 1e6);
        }
        for block in &struts(&config) {
            for _ in 0..10_000 {
                let mut y = state(block, &mut random);
                block.project_v_t(&mut y);
                let slip = Mode::SlipPlus(Onset::PLAIN);
                let stick = block.reversed(slip, Onset::PLAIN, &mut y, None);
                let pose = block.pose(&y);
                if pose.delta < 0.0 || !stick.sticks() {
                    continue;
                }
                let mut g = [0.0; N_GUARDS];
                block.guards(stick, 0.0, &y, &mut g);
                let of_stick = [g[GUARD_UPPER], g[GUARD_LOWER]];
                assert!(of_stick.iter().all(|g| *g >= 0.0), "{reading:?} {y:?}: {of_stick:?}");
                let normal = block.forces(stick, &y, &pose).normal;
                *(if normal < 0.0 { &mut pulled } else { &mut pressed }) += 1;
            }
        }
    }
    assert!(pressed > 1000 && pulled > 20, "{pressed} pressed, {pulled} pulled");
}
