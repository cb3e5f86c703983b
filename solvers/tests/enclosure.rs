//! Enclosures hold closed forms, and refuse what they cannot show.
#![allow(clippy::unwrap_used, missing_docs, reason = "a test panics to fail")]

use deltazero_solvers::enclosure::{Doubt, Enclosure, Interval};
use deltazero_solvers::problems::{BouncingBall, FrictionOscillator};
use deltazero_solvers::{Error, Next, Real, System, Tolerance};

fn tolerance(n: usize) -> Tolerance {
    Tolerance { rtol: 1e-17, atol: vec![1e-17; n] }
}

/// A system without modes and with one guard, from functions of the state.
struct Smooth<R, G> {
    rhs: R,
    guard: G,
}

/// A function of two states, generic over the scalar.
trait OfState<const M: usize> {
    fn of<S: Real>(&self, t: S, y: &[S; 2]) -> [S; M];
}

impl<R: OfState<2>, G: OfState<1>> System for Smooth<R, G> {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = self.rhs.of(t, y);
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = self.guard.of(t, y);
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

macro_rules! of_state {
    ($name:ident, $m:literal, |$t:ident, $y:ident| $value:expr) => {
        struct $name;

        impl OfState<$m> for $name {
            fn of<S: Real>(&self, $t: S, $y: &[S; 2]) -> [S; $m] {
                $value
            }
        }
    };
}

of_state!(Oscillation, 2, |_t, y| [y[1], -y[0]]);
of_state!(Growth, 2, |_t, y| [y[0], -y[1] * 2.0]);
of_state!(Never, 1, |_t, _y| [S::cst(1.0)]);

fn at_end<R: OfState<2>, G: OfState<1>>(
    system: &Smooth<R, G>,
    y: [f64; 2],
    to: f64,
) -> Result<Vec<Interval>, Error> {
    let mut enclosure = Enclosure::new(system, (), 0.0, &y, tolerance(2))?;
    assert!(enclosure.advance(to)?.is_none());
    assert_eq!(enclosure.t(), to);
    Ok(enclosure.state())
}

#[test]
fn a_start_that_is_no_number_is_refused() {
    let refused = at_end(&Smooth { rhs: Oscillation, guard: Never }, [0.0, f64::NAN], 1.0);
    assert!(matches!(refused, Err(Error::NonFinite { component: 1, .. })), "{refused:?}");
}

#[test]
fn a_hundred_periods_of_an_oscillator_stay_narrow() {
    let to = 628.0;
    let y = at_end(&Smooth { rhs: Oscillation, guard: Never }, [1.0, 0.0], to).unwrap();
    let (sin, cos) = Interval::from(to).sin_cos();
    for (y, exact) in y.iter().zip([cos, -sin]) {
        assert!(exact.is_in(*y), "{y:?} for {exact:?}");
        assert!(y.width() < 1e-12, "{:e}", y.width());
    }
}

#[test]
fn exponentials_are_held_to_the_last_digits() {
    let e = std::f64::consts::E;
    let y = at_end(&Smooth { rhs: Growth, guard: Never }, [1.0, 1.0], 1.0).unwrap();
    let exact = Interval::new(e, e.next_up());
    let inverse_square = Interval::from(1.0) / (exact * exact);
    for (y, exact) in y.iter().zip([exact, inverse_square]) {
        assert!(exact.is_in(*y) && y.width() < 1e-14, "{y:?} for {exact:?}");
    }
}

#[test]
fn bounces_are_held_with_their_times_and_heights() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    let mode = ball.initial_mode(0.0, &ball.start());
    let mut enclosure = Enclosure::new(&ball, mode, 0.0, &ball.start(), tolerance(2)).unwrap();
    // t_n = t_0 (1 + 2e + … + 2eⁿ), with the speed √(2 g h) eⁿ.
    let mut exact = (Interval::from(2.0) / 9.8).sqrt();
    let mut flight = exact;
    let mut speed = (Interval::from(2.0) * 9.8).sqrt();
    for n in 0..5 {
        let bounce = enclosure.advance(1.33).unwrap().unwrap();
        assert!(bounce.t.lo() <= exact.hi() && exact.lo() <= bounce.t.hi(), "{n}: {bounce:?}");
        let (before, after) = (bounce.y_before[1], bounce.y_after[1]);
        assert!(before.lo() <= -speed.lo() && -speed.hi() <= before.hi(), "{n}: {bounce:?}");
        speed = speed * 0.5;
        assert!(after.lo() <= speed.hi() && speed.lo() <= after.hi(), "{n}: {bounce:?}");
        assert!(bounce.t.width() < 1e-13 && after.width() < 1e-13, "{n}: {bounce:?}");
        exact = exact + flight;
        flight = flight * 0.5;
    }
}

#[test]
fn sticking_is_held_where_the_state_loses_a_dimension() {
    let oscillator =
        FrictionOscillator { mass: 2.0, stiffness: 50.0, friction: 5.0, release: -1.0 };
    let start = oscillator.start();
    let mode = oscillator.initial_mode(0.0, &start);
    let mut enclosure = Enclosure::new(&oscillator, mode, 0.0, &start, tolerance(2)).unwrap();
    // ω = 5/s: half periods of π/5 s.
    let pi = std::f64::consts::PI;
    let half_period = Interval::new(pi, pi.next_up()) / 5.0;
    for (n, turning) in [0.8, -0.6, 0.4].into_iter().enumerate() {
        let event = enclosure.advance(10.0).unwrap().unwrap();
        let exact = half_period * (n + 1) as f64;
        assert!(event.t.lo() <= exact.hi() && exact.lo() <= event.t.hi(), "{n}: {event:?}");
        assert!(event.t.width() < 1e-13, "{n}: {event:?}");
        assert!(event.y_after[0].distance(turning) < 1e-16, "{n}: {event:?}");
        assert_eq!(event.y_after[1], Interval::ZERO);
    }
}

fn doubt<R: OfState<2>, G: OfState<1>>(
    system: Smooth<R, G>,
    y: [f64; 2],
    to: f64,
) -> Option<Doubt> {
    let mut enclosure = Enclosure::new(&system, (), 0.0, &y, tolerance(2)).unwrap();
    match enclosure.advance(to) {
        Err(Error::NotProven { doubt, .. }) => Some(doubt),
        Err(error) => panic!("{error}"),
        Ok(_) => None,
    }
}

of_state!(BelowOne, 1, |_t, y| [-y[0] + 1.0]);
of_state!(BelowTwo, 1, |_t, y| [-y[0] + 2.0]);
of_state!(Itself, 1, |_t, y| [y[0]]);
of_state!(Opposite, 1, |_t, y| [-y[0]]);
of_state!(Square, 2, |_t, y| [y[1] * y[1], S::cst(1.0)]);
of_state!(Exponential, 2, |t, y| [y[0].exp(), t]);
of_state!(Branching, 2, |_t, y| if y[0].value() > 0.5 { [y[1], -y[0]] } else { [y[1], y[0]] });

#[test]
fn what_cannot_be_shown_is_refused() {
    // sin t touches one at π/2, and stays below two.
    let swing = [0.0, 1.0];
    let touch = doubt(Smooth { rhs: Oscillation, guard: BelowOne }, swing, 3.0);
    assert_eq!(touch, Some(Doubt::Touch { guard: 0 }));
    assert_eq!(doubt(Smooth { rhs: Oscillation, guard: BelowTwo }, swing, 3.0), None);
    // t³/3 leaves zero upward: its first two derivatives are zero there.
    let rest = [0.0, 0.0];
    assert_eq!(doubt(Smooth { rhs: Square, guard: Itself }, rest, 1.0), None);
    let falls = doubt(Smooth { rhs: Square, guard: Opposite }, rest, 1.0);
    assert_eq!(falls, Some(Doubt::Rise { guard: 0 }));
    let unknown = doubt(Smooth { rhs: Exponential, guard: Never }, swing, 1.0);
    assert_eq!(unknown, Some(Doubt::NoBox));
    let branch = doubt(Smooth { rhs: Branching, guard: Never }, swing, 1.0);
    assert_eq!(branch, Some(Doubt::Branch));
}

#[test]
fn an_event_at_the_end_asked_for_is_refused_and_found_beyond() {
    of_state!(Steady, 2, |_t, _y| [S::cst(-1.0), S::cst(0.0)]);
    let fall = Smooth { rhs: Steady, guard: Itself };
    let enclosure = || Enclosure::new(&fall, (), 0.0, &[1.0, 0.0], tolerance(2)).unwrap();
    assert!(matches!(enclosure().advance(1.0), Err(Error::NotProven { .. })));
    let mut beyond = enclosure();
    let event = beyond.advance(1.1).unwrap().unwrap();
    assert!(event.t.contains(1.0) && event.t.width() < 1e-14 && event.after.is_none());
    assert!(beyond.advance(2.0).unwrap().is_none());
    let (left, y) = (Interval::from(1.0) - beyond.t(), beyond.state()[0]);
    assert!(left.is_in(y) && y.width() < 1e-14, "{y:?} at {}", beyond.t());
}

/// A mass at rest between a wall on each side that is met at once, or a wall whose next mode hangs on the sign of a
/// speed.
struct Walls {
    both: bool,
    speed: f64,
}

impl System for Walls {
    type Mode = u8;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> u8 {
        0
    }

    fn rhs<S: Real>(&self, _mode: u8, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(-1.0), y[1].sin_cos().1 * self.speed];
    }

    fn guards<S: Real>(&self, _mode: u8, _t: S, y: &[S; 2], g: &mut [S; 2]) {
        *g = [y[0], if self.both { y[0] * 2.0 } else { S::cst(1.0) }];
    }

    fn guard_bounds(&self, _mode: u8, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 2]) {
        *bounds = [1e-15; 2];
    }

    fn transition<S: Real>(&self, _mode: u8, _guard: usize, _t: S, y: &mut [S; 2]) -> Next<u8> {
        y[0] = S::cst(1.0);
        Next::Mode(if (y[1] - 0.5).value() > 0.0 { 1 } else { 2 })
    }
}

#[test]
fn events_in_either_order_and_undecided_transitions_are_refused() {
    let next = |both, start| {
        let walls = Walls { both, speed: 0.1 };
        let mut enclosure = Enclosure::new(&walls, 0, 0.0, &[0.7, start], tolerance(2)).unwrap();
        match enclosure.advance(1.0) {
            Err(Error::NotProven { doubt, .. }) => Err(doubt),
            other => Ok(other.unwrap().unwrap().after),
        }
    };
    assert_eq!(next(true, 0.0), Err(Doubt::Order { guards: [1, 0] }));
    assert_eq!((next(false, 0.0), next(false, 0.5)), (Ok(Some(2)), Ok(Some(1))));
    // y₁ = 0.5 at the event, to rounding: sin y₁ leads there by the closed form of ẏ = 0.1 cos y.
    let gudermann = |u: f64| 2.0 * (0.5 * u).tanh().atan();
    let start = gudermann(2.0 * 0.25_f64.tan().atanh() - 0.07);
    assert_eq!(next(false, start), Err(Doubt::Transition { guard: 0 }));
}

/// A fall that an instability makes uncertain, and what follows: `ẏ₁ = y₁ + sin t − cos t` from zero is `−sin t`. Where
/// `30 − t − sin t` falls below zero the state rises by a hundred, unless it is reset by the range that a value is in.
struct Uncertain {
    by_range: bool,
}

impl System for Uncertain {
    type Mode = bool;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> bool {
        false
    }

    fn rhs<S: Real>(&self, _has_risen: bool, t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        let (sin, cos) = t.sin_cos();
        *dydt = [S::cst(-1.0), y[1] + sin - cos];
    }

    fn guards<S: Real>(&self, has_risen: bool, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = [if has_risen { S::cst(1.0) } else { y[0] + y[1] }];
    }

    fn transition<S: Real>(&self, _: bool, _guard: usize, _t: S, y: &mut [S; 2]) -> Next<bool> {
        let is_high = self.by_range && y[1].value() > 0.675;
        y[0] = if is_high { y[0] } else { y[0] + 100.0 };
        Next::Mode(true)
    }
}

#[test]
fn a_mode_is_not_claimed_before_it_has_surely_begun() {
    let system = Uncertain { by_range: false };
    let mut enclosure = Enclosure::new(&system, false, 0.0, &[30.0, 0.0], tolerance(2)).unwrap();
    let event = enclosure.advance(40.0).unwrap().unwrap();
    // t + sin t = 30 at 30.6749….
    assert!(event.t.contains(30.675) && event.t.width() > 1e-3, "{event:?}");
    for to in [enclosure.t().next_up(), event.t.hi()] {
        let early = enclosure.advance(to).err();
        assert!(matches!(early, Some(Error::NotProven { doubt: Doubt::Begin, .. })), "{early:?}");
    }
    assert!(enclosure.advance(enclosure.t() + 0.1).unwrap().is_none());
    let fallen = Interval::from(130.0) - enclosure.t();
    assert!(fallen.is_in(enclosure.state()[0]), "{fallen:?}: {:?}", enclosure.state());
}

#[test]
fn a_reset_that_hangs_on_a_range_is_refused_where_that_is_undecided() {
    // y₁ = −sin t = 0.67502 at the event, to some 0.02, and its range begins at 0.675.
    let system = Uncertain { by_range: true };
    let mut enclosure = Enclosure::new(&system, false, 0.0, &[30.0, 0.0], tolerance(2)).unwrap();
    let refused = enclosure.advance(40.0).err();
    let doubt = Doubt::Transition { guard: 0 };
    assert!(
        matches!(&refused, Some(Error::NotProven { doubt: found, .. }) if *found == doubt),
        "{refused:?}"
    );
}

of_state!(OfConstants, 2, |_t, _y| {
    let third = S::cst(1.0) / 3.0;
    let sign = if third.value() > 0.0 { S::cst(1.0) } else { S::cst(-1.0) };
    [third.max(S::cst(0.5)) + (-third).abs().min(S::cst(0.25)), sign]
});

#[test]
fn decisions_on_constants_are_those_of_their_signs() {
    let y = at_end(&Smooth { rhs: OfConstants, guard: Never }, [0.0, 0.0], 1.0).unwrap();
    assert!(y[0].contains(0.75) && y[1].contains(1.0), "{y:?}");
    assert!(y[0].width() < 1e-14 && y[1].width() < 1e-14, "{y:?}");
}

#[test]
fn a_guard_with_an_arc_of_constants_is_refused() {
    of_state!(BelowArc, 1, |_t, y| [-y[0] + S::cst(1.0).atan2(S::cst(3.0))]);
    // The function of libm is not bounded.
    let found = doubt(Smooth { rhs: Oscillation, guard: BelowArc }, [0.0, 1.0], 1.0);
    assert_eq!(found, Some(Doubt::Rise { guard: 0 }));
}
