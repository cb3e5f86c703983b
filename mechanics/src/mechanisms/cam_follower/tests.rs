use deltazero_solvers::{Grid, Method, Trajectory};
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::errors::log_log_slope;
use deltazero_study::run::{Accuracy, Setting, integrate};
use deltazero_study::setting::Events;

use super::*;
use crate::config::Config;
use crate::laws::ContactLaw;
use crate::mechanisms::test_runs::{Run, assert_numbers, by_every_method, distance, setting};

impl CamFollower {
    /// N(φ) [N], of a follower that a rigid contact holds to the cam; below zero it would have to pull.
    fn rigid_force(&self, phi: f64) -> f64 {
        let (sin, cos) = libm::sincos(phi);
        let half = 0.5 * self.lift;
        let inertia = self.mass * self.speed * self.speed - self.stiffness;
        let turning = inertia * cos + self.damping * self.speed * sin;
        self.preload + half * (self.stiffness + turning)
    }

    /// The speed Ω above which a follower on the contact `K δ + D δ̇` separates in the steady motion [rad/s]; none for
    /// another law.
    fn compliant_separation_speed(&self) -> Option<f64> {
        let Elastic::Linear { stiffness } = self.normal.elastic else { return None };
        if self.normal.hysteresis != 0.0 {
            return None;
        }
        let (half, k) = (0.5 * self.lift, self.stiffness);
        let mean = (self.preload + k * half) * stiffness / (stiffness + k);
        let excess = |omega: f64| {
            let own = [k - self.mass * omega * omega, self.damping * omega];
            let contact = [stiffness, self.normal.damping * omega];
            let sum = [own[0] + contact[0], own[1] + contact[1]];
            let [own, contact, sum] = [own, contact, sum].map(|[re, im]| libm::hypot(re, im));
            mean - half * own * contact / sum
        };
        let rigid = self.separation_speed();
        let bracket = Bracket { above: 0.5 * rigid, below: 2.0 * rigid };
        Some(find_root(excess, bracket, f64::EPSILON * rigid))
    }

    /// State x, ẋ at the time `s` after `(x, v)` in flight; not a number from the critical damping `2√(k m)` on.
    fn flight(&self, [x, v]: [f64; 2], s: f64) -> [f64; 2] {
        let rest = -self.preload / self.stiffness;
        let sigma = 0.5 * self.damping / self.mass;
        let omega = (self.stiffness / self.mass - sigma * sigma).sqrt();
        let (a, b) = (x - rest, (v + sigma * (x - rest)) / omega);
        let ((sin, cos), decay) = (libm::sincos(omega * s), libm::exp(-sigma * s));
        let (q, p) = (a * cos + b * sin, b * cos - a * sin);
        [rest + decay * q, decay * (omega * p - sigma * q)]
    }
}

/// The default with a contact of the stiffness K [N/m] and a tenth of the critical damping.
fn on_contact(stiffness: f64) -> CamFollower {
    let cam = CamFollower::default();
    let damping = 0.2 * (stiffness * cam.mass).sqrt();
    let normal = NormalLaw { elastic: Elastic::power(stiffness, 1.0), damping, ..cam.normal };
    CamFollower { normal, ..cam }
}

#[test]
fn every_method_agrees_over_twenty_turns() {
    let cam = CamFollower::default();
    let end = 20.0 * cam.period();
    let reference = Run::by(&cam, "taylor", 1e-14, end);
    assert_eq!(reference.events().len(), 411);
    for (name, run) in by_every_method(&cam, end) {
        assert_eq!(run.events().len(), reference.events().len(), "{name}");
        let off = distance(&cam, &run.end.y, &reference.end.y);
        // Measured: 1.2e-6 (bs32) and 1.4e-6 (tr_bdf2); 1.1e-10 (auto).
        let bound = match name {
            "dop853" | "vern98" | "taylor" | "rodas5p" | "auto" => 1e-9,
            _ => 1e-5,
        };
        assert!(off < bound, "{name}: {off:e}");
    }
}

#[test]
fn an_extended_run_agrees_with_it() {
    let cam = CamFollower::default();
    let end = 2.0 * cam.period();
    let reference = Run::by(&cam, "taylor", 1e-14, end).end.y;
    let run = cam.integrate_extended(1e-20, cam.start(), end, &mut Trajectory::on(Grid::Steps));
    // Measured: 3.2e-13.
    assert!(distance(&cam, &run.y, &reference) < 3e-12);
}

#[test]
fn the_follower_separates_above_the_closed_form_speed_alone() {
    for stiffness in [1e8, 1e10] {
        let cam = on_contact(stiffness);
        let critical = cam.compliant_separation_speed().unwrap();
        for (factor, separates) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
            let cam = CamFollower { speed: factor * critical, ..cam.clone() };
            let run = Run::by(&cam, "rk45", 1e-9, 3.0 * cam.period());
            assert_eq!(!run.events().is_empty(), separates, "{stiffness:e}: {factor}");
        }
    }
}

#[test]
fn the_speed_of_separation_is_that_of_a_rigid_contact_less_its_compliance() {
    for stiffness in [1e8, 1e9, 1e10] {
        let cam = on_contact(stiffness);
        let lower = 1.0 - cam.compliant_separation_speed().unwrap() / cam.separation_speed();
        let expected = 0.5 * (cam.stiffness + 2.0 * cam.preload / cam.lift) / stiffness;
        // Measured: 6.7e-4, of the damping c.
        assert!((lower / expected - 1.0).abs() < 6e-3, "{stiffness:e}: {lower:e} for {expected:e}");
    }
    let cam = CamFollower::default();
    let cam = CamFollower { speed: cam.separation_speed(), ..cam };
    let angles = (0..6284).map(|k| 1e-3 * f64::from(k));
    let least = angles.map(|phi| cam.rigid_force(phi)).fold(f64::INFINITY, f64::min);
    // Measured: 1.1e-6 N of 200 N; the angles are a thousandth apart.
    assert!((-1e-12..1e-5).contains(&least), "{least:e}");
    let undamped = CamFollower { damping: 0.0, ..cam };
    let load = 2.0 * (undamped.preload + undamped.stiffness * undamped.lift);
    let expected = (load / (undamped.mass * undamped.lift)).sqrt();
    // Measured: 0.
    assert!((undamped.separation_speed() / expected - 1.0).abs() < 1e-15);
}

#[test]
fn flights_end_as_in_closed_form() {
    let cam = CamFollower::default();
    let run = Run::by(&cam, "taylor", 1e-13, 3.0 * cam.period());
    let samples = &run.trajectory.samples;
    let at = |t: f64| samples.iter().rev().find(|sample| sample.t == t).unwrap().y;
    let mut flights = 0;
    for pair in run.events().windows(2).filter(|pair| pair[1].before == Mode::Free) {
        flights += 1;
        let ([x, v, phi], end) = (at(pair[0].t), at(pair[1].t));
        let gap = |s: f64| cam.flight([x, v], s)[0] - cam.cam(phi + cam.speed * s)[0];
        let span = pair[1].t - pair[0].t;
        let bracket = Bracket { above: 0.9 * span, below: 1.1 * span };
        let late = (find_root(gap, bracket, 0.0) - span).abs();
        let [x, v] = cam.flight([x, v], span);
        let off = distance(&cam, &[x, v, end[2]], &end);
        // Measured: 2.0e-15 s and 7.4e-16.
        assert!(late < 2e-14 && off < 7e-15, "{late:e} s, {off:e}");
    }
    assert_eq!(flights, 18);
}

#[test]
fn the_first_flight_tends_to_that_from_a_rigid_contact() {
    let cam = CamFollower::default();
    let bracket = Bracket { above: 0.0, below: std::f64::consts::PI };
    let lifts = find_root(|phi| cam.rigid_force(phi), bracket, 0.0);
    let gap = |s: f64| cam.flight(cam.cam(lifts), s)[0] - cam.cam(lifts + cam.speed * s)[0];
    let bracket = Bracket { above: 0.1 * cam.period(), below: 0.9 * cam.period() };
    let lands = lifts + cam.speed * find_root(gap, bracket, 0.0);
    // Measured: −6.59e-4, −6.60e-5 and −6.60e-6 rad; 1.03e-3, 1.03e-4 and 1.03e-5 rad.
    for stiffness in [1e8, 1e9, 1e10] {
        let cam = on_contact(stiffness);
        let run = Run::by(&cam, "dop853", 1e-11, cam.period());
        let landing = run.events().iter().find(|event| event.before == Mode::Free).unwrap();
        let off = [run.events()[0].t * cam.speed - lifts, landing.t * cam.speed - lands];
        let expected = [-6.6e4 / stiffness, 1.03e5 / stiffness];
        for (off, expected) in off.into_iter().zip(expected) {
            assert!((off / expected - 1.0).abs() < 0.02, "{off:e} for {expected:e}");
        }
    }
}

/// The energy balance of a run over so many turns, and whether the run has no warning.
fn balance(cam: &CamFollower, setting: &Setting, turns: f64) -> (Balance, bool) {
    let mut balance = EnergyBalance::new(cam, Events::Located, &cam.start());
    let run = integrate(cam, setting, cam.start(), turns * cam.period(), &mut balance);
    assert!(run.outcome.is_ok(), "{:?}", run.outcome);
    let is_clean = balance.check.warnings(setting.rtol()).is_empty();
    (balance.at(&run.mode, run.t, &run.y).unwrap(), is_clean)
}

/// The default with a law of the configuration.
fn under_law(law: &str, adhesion: bool) -> CamFollower {
    let sets = [
        format!("contact.law={law}"),
        format!("contact.adhesion={adhesion}"),
        "contact.stiffness=1e8".to_owned(),
        "contact.restitution=0.8".to_owned(),
    ];
    let joint = Config::load(None, &sets).unwrap().joints[0].clone();
    let normal = NormalLaw::new(&joint.contact, &joint.joint);
    CamFollower { normal, ..CamFollower::default() }
}

#[test]
fn under_every_law_the_energy_balances_and_two_methods_agree() {
    for law in ContactLaw::ALL {
        for adhesion in [true, false] {
            let cam = under_law(law.word, adhesion);
            let (balance, is_clean) = balance(&cam, &setting("vern98", 1e-10), 2.0);
            let relative = balance.residual.abs() / balance.kinetic;
            // Measured: 5.2e-8 (lankarani_nikravesh_cylinder), 4.3e-9 of the others.
            assert!(is_clean && relative < 5e-7, "{law} {adhesion}: {relative:e}");
            let [a, b] =
                ["vern98", "taylor"].map(|by| Run::by(&cam, by, 1e-11, 2.0 * cam.period()));
            assert_eq!(a.events().len(), b.events().len(), "{law} {adhesion}");
            let off = distance(&cam, &a.end.y, &b.end.y);
            // Measured: 2.2e-8 (lankarani_nikravesh_cylinder), 9.9e-9 of the others.
            assert!(off < 2e-7, "{law} {adhesion}: {off:e}");
        }
    }
}

#[test]
fn the_energy_residual_of_rk4_falls_with_its_order() {
    let cam = CamFollower::default();
    let method = Method::named("rk4").unwrap();
    let residual = |h: f64| {
        let rk4 = Setting { method, events: Events::Located, accuracy: Accuracy::Step(h) };
        (h, balance(&cam, &rk4, 1.0).0.residual.abs())
    };
    let points = [1.6e-5, 8e-6, 4e-6, 2e-6].map(residual);
    let slope = log_log_slope(&points).unwrap();
    // Measured: 3.96.
    assert!((slope - 4.0).abs() < 0.2, "{slope}");
}

#[test]
fn it_starts_with_the_force_of_a_rigid_contact_less_its_compliance() {
    for stiffness in [1e8, 1e10] {
        let cam = on_contact(stiffness);
        let start = cam.start();
        let force = cam.touch(&cam.initial_mode(0.0, &start), 0.0, &start, 0).unwrap().force;
        let expected = cam.rigid_force(0.0) * stiffness / (stiffness + cam.stiffness);
        // Measured: 2.2e-16.
        assert!((force / expected - 1.0).abs() < 2e-15, "{force} for {expected}");
    }
}

#[test]
fn a_dent_that_is_pressed_again_is_the_same_contact() {
    let cam = under_law("flores", false);
    let onset = cam.normal.onset(0.3);
    let relaxing = Mode::Relaxing(onset);
    let after = |mode, guard, delta: f64| cam.transition(mode, guard, 0.0, &mut [-delta, 0.0, 0.0]);
    assert_eq!(after(relaxing, GUARD_CONTACT, 1e-6), Next::Mode(Mode::Contact(onset)));
    assert_eq!(after(relaxing, GUARD_SURFACE, 0.0), Next::Mode(Mode::Free));
    assert_eq!(after(Mode::Contact(onset), GUARD_RANGE, 1e-6), Next::Mode(relaxing));
    assert_eq!(after(Mode::Contact(onset), GUARD_CONTACT, 0.0), Next::Mode(Mode::Free));
}

#[test]
fn guard_bounds_are_above_zero_at_rest_in_every_mode() {
    let default = CamFollower::default();
    let flat =
        NormalLaw { elastic: Elastic::power(1e10, 1.5), damping: 0.0, ..default.normal.clone() };
    for normal in [default.normal.clone(), flat] {
        let cam = CamFollower { normal, ..default.clone() };
        for mode in [Mode::Free, Mode::Relaxing(Onset::PLAIN), Mode::Contact(Onset::PLAIN)] {
            let mut bounds = [0.0; 3];
            cam.guard_bounds(mode, 0.0, &[0.0; 3], &mut bounds);
            assert!(bounds.iter().all(|bound| *bound > 0.0), "{mode:?}: {bounds:?}");
        }
    }
}

#[test]
fn cylinders_inside_each_other_need_a_gap_and_tell_their_radii() {
    for law in ContactLaw::ALL {
        let load = |more: &[&str]| {
            let sets = ["mechanism=cam-follower".to_owned(), format!("contact.law={law}")];
            let more = more.iter().map(|set| (*set).to_owned());
            Config::load(None, &sets.into_iter().chain(more).collect::<Vec<_>>())
        };
        let inside = load(&["joint.clearance=0"]);
        if !law.is_of_cylinders() {
            assert!(inside.is_ok(), "{law}: {inside:?}");
            continue;
        }
        let refused = inside.unwrap_err().to_string();
        let expected = format!(
            "--set joint.clearance=0: joint.clearance = 0 does not go with contact.law = {law}: cylinders"
        );
        assert!(refused.starts_with(&expected), "{refused}");
        let beside = load(&["joint.clearance=0", "contact.curvature=external"]).unwrap();
        let facts = beside.mechanism.facts(&beside);
        let (_, contact) = facts.iter().find(|(name, _)| name == "Contact").unwrap();
        assert!(contact.ends_with("radii r = 4.9e-3 m and r + c, c = 0e0 m"), "{contact}");
    }
}

/// Measured: 1.2e-13, of the dent.
const EXACT: f64 = 1e-12;

/// Unlike the default in every value.
fn other() -> CamFollower {
    let normal = NormalLaw {
        elastic: Elastic::power(8e7, 1.0),
        damping: 700.0,
        ..CamFollower::default().normal
    };
    CamFollower {
        mass: 0.25,
        stiffness: 9000.0,
        preload: 110.0,
        damping: 6.0,
        lift: 0.012,
        speed: 430.0,
        normal,
    }
}

const PRESSED: Mode = Mode::Contact(Onset::PLAIN);
const DENTED: [f64; 3] = [0.001_816_759_743_917_007_5, 1.1, 0.8];

#[test]
fn the_follower_has_the_numbers_of_the_equations() {
    let (cam, y) = (other(), DENTED);
    let force = 765.545_100_164_538_1;
    let Touch { depth, rate, force: found } = cam.touch(&PRESSED, 0.0, &y, 0).unwrap();
    assert_numbers("touch", EXACT, &[depth, rate, found], &[3e-6, 0.750_778_714_520_768_7, force]);
    assert_eq!(cam.touch(&Mode::Free, 0.0, &y, 0).unwrap().force, 0.0);
    for (mode, acceleration) in
        [(PRESSED, 2_530.377_049_877_14), (Mode::Free, -531.803_350_781_012_3)]
    {
        let mut rates = [0.0; 3];
        cam.rhs(mode, 0.0, &y, &mut rates);
        assert_numbers("rates", EXACT, &rates, &[1.1, acceleration, 430.0]);
    }
    let scales: Vec<f64> = cam.states().iter().map(|state| state.scale).collect();
    assert_numbers("scales", EXACT, &scales, &[0.012, 2.58, 2.0 * std::f64::consts::PI]);
    assert_numbers("period", EXACT, &[cam.unit_of_time()], &[0.014_612_058_853_906_015]);
    assert_numbers("start", EXACT, &cam.start()[..1], &[-4.841_330_350_335_587e-6]);
    let energy = cam.energies(&PRESSED, 0.0, &y).unwrap();
    let expected = [0.365_946_343_682_899_1, 0.000_36];
    assert_numbers("energy", EXACT, &[energy.kinetic, energy.elastic], &expected);
    assert_eq!(cam.energies(&Mode::Free, 0.0, &y).unwrap().elastic, 0.0);
    for (mode, drive, damping) in
        [(PRESSED, 1_416.854_576_390_197, 401.828_074_724_220_6), (Mode::Free, 0.0, 7.26)]
    {
        let power = cam.powers(&mode, 0.0, &y).unwrap();
        assert_numbers("powers", EXACT, &[power.drive, power.damping], &[drive, damping]);
        let mut row = Vec::new();
        cam.rows(&mode, 0.0, &y, &mut |_, values| row.extend_from_slice(values));
        let f_n = if mode == PRESSED { force } else { 0.0 };
        assert_numbers("row", EXACT, &row, &[y[0], y[1], y[2], 3e-6, f_n]);
    }
}

#[test]
fn its_guards_are_rounded_by_the_lift_and_the_speed_of_the_cam() {
    let (cam, y) = (other(), DENTED);
    let bounds_in = |mode| {
        let mut bounds = [0.0; 3];
        cam.guard_bounds(mode, 0.0, &y, &mut bounds);
        bounds
    };
    let delta = 0.023_416_759_743_917_007 * ROUNDING;
    assert_numbers("free", EXACT, &bounds_in(Mode::Free), &[delta, delta, ROUNDING]);
    let rounding = Rounding { delta, speed: 5.744, least_force: 0.000_387_35 };
    let own = cam.normal.guard_bounds(cam.penetration(&y), Onset::PLAIN, rounding);
    assert_numbers("pressed", EXACT, &bounds_in(PRESSED), &[own.contact, delta, own.range]);
    let relaxing = bounds_in(Mode::Relaxing(Onset::PLAIN));
    assert_numbers("relaxing", EXACT, &relaxing, &[own.relaxing, delta, own.range]);
}

#[test]
fn its_modes_are_told_by_what_touches() {
    let cam = other();
    let relaxing = Mode::Relaxing(Onset::PLAIN);
    assert_eq!(
        [Mode::Free, relaxing, PRESSED].map(|mode| cam.role(&mode, 0)),
        [Role::Free, Role::Free, Role::Contact]
    );
    let names = [Mode::Free, relaxing, PRESSED].map(|mode| format!("{mode:?}"));
    assert_eq!(names, ["free", "free (relaxing)", "contact"]);
    assert!(cam.is_counted(&PRESSED, &relaxing, 0) && !cam.is_counted(&relaxing, &Mode::Free, 0));
    assert!(cam.takes_energy(&PRESSED, &relaxing) && cam.takes_energy(&relaxing, &Mode::Free));
    assert!(!cam.takes_energy(&PRESSED, &Mode::Free));
    assert_eq!(cam.laws().deepest, Some(0.012));
    let hysteretic = under_law("flores", false);
    let onset = |speed| Mode::Contact(hysteretic.normal.onset(speed));
    assert!(hysteretic.begins_at_speed_floor(&Mode::Free, &onset(1e-9)));
    assert!(!hysteretic.begins_at_speed_floor(&Mode::Free, &onset(0.3)));
    assert!(!hysteretic.begins_at_speed_floor(&onset(1e-9), &onset(1e-9)));
    // h Ω/2 = 2.4 m/s.
    assert_eq!(hysteretic.initial_mode(0.0, &hysteretic.start()), onset(2.4));
    let away = [DENTED[0] + 6e-6, DENTED[1], DENTED[2]];
    assert_eq!(cam.initial_mode(0.0, &DENTED), PRESSED);
    assert_eq!(cam.initial_mode(0.0, &away), Mode::Free);
    let pulled = [DENTED[0], 3.0, DENTED[2]];
    assert!(matches!(cam.initial_mode(0.0, &pulled), Mode::Relaxing(_)));
}

#[test]
fn a_cam_that_presses_harder_than_the_law_can_carry_is_refused_before_it_moves() {
    let cam = under_law("johnson", false);
    assert!(cam.check().is_ok());
    let pressed = CamFollower { preload: 2.0 * cam.normal.elastic.strongest(), ..cam };
    let run = integrate(&pressed, &setting("rk45", 1e-9), [0.0; 3], 1e-3, &mut ());
    let error = run.outcome.unwrap_err();
    assert!(matches!(error, Error::Refused { .. }) && run.stats.work.n_rhs == 0, "{error}");
}
