//! Modes that carry data.

use deltazero_solvers::{Error, Next, Outcome, Real, System};

use crate::common::{at_most, steps_itself};
use crate::log::{run, settings};

/// What a [`Trampoline`] remembers of its last impact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Flight,
    /// With the speed at entry.
    Contact {
        speed: f64,
    },
}

/// A mass that falls with gravity 1 on a mat. The mat pushes with a force that the speed `s` of
/// the impact sets, so that every contact lasts the same time, and gives half the speed back.
///
/// ```text
/// flight: ÿ = −1 while y ≥ 0;    contact: ÿ = 2 s/τ while y ≤ 0,  y = −s t + s t²/τ
/// ```
struct Trampoline;

/// Duration τ of a contact.
const CONTACT: f64 = 0.125;

impl System for Trampoline {
    type Mode = Mode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Mode {
        Mode::Flight
    }

    fn rhs<S: Real>(&self, mode: Mode, _t: S, &[_, v]: &[S; 2], dydt: &mut [S; 2]) {
        let acceleration = match mode {
            Mode::Flight => -1.0,
            Mode::Contact { speed } => 2.0 * speed / CONTACT,
        };
        *dydt = [v, S::cst(acceleration)];
    }

    fn guards<S: Real>(&self, mode: Mode, _t: S, &[y, _]: &[S; 2], g: &mut [S; 1]) {
        *g = [if mode == Mode::Flight { y } else { -y }];
    }

    fn guard_bounds(&self, _: Mode, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, mode: Mode, _guard: usize, _t: S, y: &mut [S; 2]) -> Next<Mode> {
        Next::Mode(match mode {
            Mode::Flight => Mode::Contact { speed: -y[1].value() },
            Mode::Contact { .. } => {
                y[1] = y[1] * 0.5;
                Mode::Flight
            }
        })
    }
}

#[test]
fn a_mode_carries_what_its_entry_stored() {
    // From 1/2 at rest: impacts at 1, then every flight lasts twice its first speed.
    let (mut t, mut speed) = (1.0, 1.0);
    let mut expected = Vec::new();
    for _ in 0..6 {
        expected.push((t, speed));
        expected.push((t + CONTACT, speed));
        speed *= 0.5;
        t += CONTACT + 2.0 * speed;
    }
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, ..) = run(&Trampoline, &setting, (0.0, [0.5, 0.0]), 3.7);
        assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
        assert_eq!(log.events.len(), 12, "{name}: {:?}", log.events);
        // Measured: 3.0e-13, for bdf 1.9e-7.
        let bound = if steps_itself(setting.0, &Trampoline) { 1e-6 } else { 2e-12 };
        for ((t, _, before, after, _), expected) in log.events.iter().zip(&expected) {
            at_most(name, (t - expected.0).abs(), bound);
            let stored = match (before, after) {
                (Mode::Flight, Next::Mode(Mode::Contact { speed })) => speed,
                (Mode::Contact { speed }, Next::Mode(Mode::Flight)) => speed,
                other => panic!("{name}: {other:?}"),
            };
            at_most(name, (stored - expected.1).abs(), bound);
        }
        for pair in log.events.windows(2) {
            assert_eq!(pair[0].3, Next::Mode(pair[1].2), "{name}: data are kept to the bit");
        }
    }
}

/// What an [`Unresting`] system carries from one transition to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Restless {
    /// The number of impacts so far.
    Bouncing { impacts: u32 },
    /// The corner that it stands on, by its sign.
    Rocking(i8),
}

/// A state that rests below its surface, whatever the transition.
struct Unresting(Restless);

impl System for Unresting {
    type Mode = Restless;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Restless {
        self.0
    }

    fn rhs<S: Real>(&self, _: Restless, _t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(0.0); 2];
    }

    fn guards<S: Real>(&self, _: Restless, _t: S, &[y, _]: &[S; 2], g: &mut [S; 1]) {
        *g = [y];
    }

    fn guard_bounds(&self, _: Restless, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(
        &self,
        mode: Restless,
        _guard: usize,
        _t: S,
        _y: &mut [S; 2],
    ) -> Next<Restless> {
        Next::Mode(match mode {
            Restless::Bouncing { impacts } => Restless::Bouncing { impacts: impacts + 1 },
            Restless::Rocking(corner) => Restless::Rocking(-corner),
        })
    }
}

/// What an error of chatter tells to change in an [`Unresting`] system, with every method.
fn expect_cure(mode: Restless, expected: &str) {
    for setting in settings() {
        let (_, outcome, ..) = run(&Unresting(mode), &setting, (0.0, [-1.0, 0.0]), 1.0);
        let Err(Error::Chatter { cure, .. }) = outcome else { panic!("{outcome:?}") };
        assert!(cure.contains(expected), "{}: {cure}", setting.0.name);
    }
}

#[test]
fn a_mode_that_carries_data_and_violates_itself_is_told_as_one() {
    expect_cure(Restless::Bouncing { impacts: 0 }, "stays violated after its own transition");
}

#[test]
fn two_values_that_a_mode_carries_in_turn_are_told_as_two_modes() {
    expect_cure(Restless::Rocking(1), "hand over to each other");
}
