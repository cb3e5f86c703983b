use deltazero_solvers::{Grid, Trajectory};
use deltazero_study::energy_balance::EnergyBalance;
use deltazero_study::run::integrate;
use deltazero_study::setting::Events;
use num_dual::{Dual2_64, DualNum as _};

use super::*;
use crate::mechanisms::test_runs::{Run, balance, by_every_method, distance, setting};

/// Before the impacts accumulate [s].
const DEFAULT_END: f64 = 7.5;

#[test]
fn every_method_agrees_until_the_impacts_accumulate() {
    let block = RockingBlock::default();
    let reference = Run::by(&block, "taylor", 1e-14, DEFAULT_END);
    for (name, run) in by_every_method(&block, DEFAULT_END) {
        assert_eq!(run.events().len(), 35, "{name}");
        let off = distance(&block, &run.end.y, &reference.end.y);
        // Measured: 2.7e-7 (bs32), and of diffsol's implicit ones 1.2e-5 (esdirk34).
        let bound = match name {
            "bdf" | "tr_bdf2" | "esdirk34" => 1e-4,
            "dop853" | "vern98" | "taylor" => 9e-9,
            _ => 2e-6,
        };
        assert!(off < bound, "{name}: {off:e}");
    }
}

/// Not by esdirk34: at this tolerance its interpolant gives back what the smallest impacts take, and they go on.
#[test]
fn a_block_whose_impacts_accumulate_comes_to_rest() {
    let block = RockingBlock::default();
    for method in ["rk43", "bs32", "rk45", "dop853", "vern98", "taylor", "radau5", "rodas5p"] {
        let run = Run::by(&block, method, 1e-10, 10.0);
        let last = run.events().last().unwrap();
        assert!(last.after == Next::Mode(Mode::AtRest) && run.end.y[..2] == [0.0; 2], "{method}");
        assert_eq!(run.events().len(), 324, "{method}");
        // Measured: 2.7e-7 s (bs32).
        assert!((last.t - 7.773_267_543).abs() < 2e-6, "{method}: {}", last.t);
    }
}

/// `p² (cos(α − θ) − cos α)`, the potential part of the first integral [rad²/s²].
fn lift(block: &RockingBlock, theta: f64) -> f64 {
    let (p, alpha) = (block.frequency(), block.slenderness());
    p * p * (libm::cos(alpha - theta.abs()) - libm::cos(alpha))
}

#[test]
fn between_impacts_the_first_integral_is_kept_and_at_each_it_falls_by_the_square_of_the_ratio() {
    let block = RockingBlock::default();
    let run = Run::by(&block, "taylor", 1e-14, DEFAULT_END);
    for sample in &run.trajectory.samples {
        // A sample at an impact is the state after it.
        let impacts = run.events().iter().filter(|event| event.t <= sample.t).count();
        let left = libm::pow(block.velocity_ratio(), 2.0 * impacts as f64);
        let [theta, omega, _] = sample.y;
        let found = 0.5 * omega * omega + lift(&block, theta);
        let error = (found / (left * lift(&block, block.start_angle)) - 1.0).abs();
        // Measured: 1.4e-12.
        assert!(error < 1.4e-11, "{error:e} at {} s", sample.t);
    }
}

#[test]
fn the_ratio_keeps_the_angular_momentum_about_the_corner_that_lands() {
    for half_width in [0.05, 0.2, 0.6] {
        let block = RockingBlock { half_width, ..RockingBlock::default() };
        let (b, h) = (block.half_width, block.half_height);
        // Per unit of mass and θ̇: that of the centre, at (0, h) over the middle of the base, and of the turning.
        let own = (b * b + h * h) / 3.0;
        // About the right corner the centre moves at θ̇ (h, b), and the left corner is at (−b, 0).
        let before = own + h * h - b * b;
        let after = own + h * h + b * b;
        // Measured: 1.1e-16.
        let error = block.velocity_ratio() - before / after;
        assert!(error.abs() < 1e-15, "{half_width}: {error:e}");
    }
}

#[test]
fn a_slender_block_has_housners_quarter_period_and_amplitudes() {
    // Measured: 2.2e-6 and 2.2e-8, the square of α = 1e-2 and 1e-3 over 45.
    for (half_width, bound) in [(8e-3, 2e-5), (8e-4, 2e-7)] {
        let block = RockingBlock { half_width, ..RockingBlock::default() };
        let (p, r) = (block.frequency(), block.velocity_ratio());
        let block = RockingBlock { start_angle: 0.6 * block.slenderness(), ..block };
        let run = Run::by(&block, "taylor", 1e-13, 20.0 / p);
        assert_eq!(run.events().len(), 6);
        let (mut t, mut phi): (f64, f64) = (0.0, 0.6);
        for (n, event) in run.events().iter().enumerate() {
            let quarter = libm::acosh(1.0 / (1.0 - phi)) / p;
            t += if n == 0 { quarter } else { 2.0 * quarter };
            assert!((event.t / t - 1.0).abs() < bound, "{n}: {} for {t}", event.t);
            phi = 1.0 - (1.0 - r * r * (1.0 - (1.0 - phi) * (1.0 - phi))).sqrt();
        }
    }
}

#[test]
fn a_block_leaves_its_rest_where_the_base_exceeds_g_tan_alpha_and_overturns() {
    let block = RockingBlock { start_angle: 0.0, base_amplitude: 3.0, ..RockingBlock::default() };
    let tilts = libm::asin(block.least_to_tilt() / 3.0) / block.base_frequency;
    for (name, run) in by_every_method(&block, 20.0) {
        let [first, .., last] = run.events() else { panic!("{name}") };
        assert!(first.after == Next::Mode(Mode::Rocks(Corner::Left)), "{name}");
        // Measured: 2.6e-15 s (tsit45).
        assert!((first.t - tilts).abs() < 2e-14, "{name}: {:e}", first.t - tilts);
        assert_eq!((run.events().len(), &last.after), (6, &Next::Stop), "{name}");
        // Measured: 1.9e-6 s (esdirk34 6.5e-6 s, tr_bdf2 7.0e-5 s).
        assert!((last.t - 4.556_352_399).abs() < 7e-4, "{name}: {}", last.t);
        let off = run.end.y[0] + block.overturned_at();
        assert!(off.abs() < 1e-14, "{name}: {off:e}");
    }
    let weak = RockingBlock { base_amplitude: 0.999 * block.least_to_tilt(), ..block };
    assert!(Run::by(&weak, "rk45", 1e-10, 20.0).events().is_empty());
}

#[test]
fn a_base_that_shakes_the_other_way_gives_the_mirrored_motion() {
    let block = RockingBlock { start_angle: 0.0, base_amplitude: 3.0, ..RockingBlock::default() };
    let mirrored = RockingBlock { base_amplitude: -3.0, ..block };
    let [a, b] = [block, mirrored].map(|block| Run::by(&block, "rk45", 1e-9, 20.0));
    let mirror = |mode: &Next<Mode>| match mode {
        Next::Mode(Mode::Rocks(corner)) => Next::Mode(Mode::Rocks(corner.other())),
        mode => *mode,
    };
    assert_eq!(a.events().len(), b.events().len());
    for (a, b) in a.events().iter().zip(b.events()) {
        assert_eq!(mirror(&a.after), b.after);
        // Measured: 2.1e-13 s.
        assert!((a.t - b.t).abs() < 2e-12, "{} {}", a.t, b.t);
    }
}

#[test]
fn a_corner_that_no_longer_presses_is_an_error() {
    // R θ̇²/g = 1.4.
    let block = RockingBlock { start_velocity: -4.1, ..RockingBlock::default() };
    let setting = setting("rk45", 1e-10);
    let mut trajectory = Trajectory::on(Grid::Steps);
    let run = integrate(&block, &setting, block.start(), 1.0, &mut trajectory);
    assert!(matches!(run.outcome, Err(Error::OutsideModel { .. })), "{:?}", run.outcome);
}

#[test]
fn a_block_too_squat_for_its_impacts_is_refused_before_it_moves() {
    // r = 1 − 3/2 sin²α is −0.44.
    let block = RockingBlock { half_width: 0.5, half_height: 0.1, ..RockingBlock::default() };
    let run = integrate(&block, &setting("rk45", 1e-10), block.start(), 1.0, &mut ());
    let error = run.outcome.unwrap_err();
    assert!(matches!(error, Error::Refused { .. }) && run.stats.work.n_rhs == 0, "{error}");
}

#[test]
fn the_normal_force_carries_the_weight_and_lifts_the_centre() {
    let block = RockingBlock { base_amplitude: 2.0, ..RockingBlock::default() };
    for (corner, theta, omega) in [(Corner::Right, 0.1, -0.5), (Corner::Left, -0.2, 0.3)] {
        let y = [theta, omega, 0.7];
        let mut dydt = [0.0; 3];
        block.rhs(Mode::Rocks(corner), 0.0, &y, &mut dydt);
        let tilted = Dual2_64::new(theta, omega, dydt[1]);
        let beta = -(tilted * corner.sign()) + block.slenderness();
        let height = beta.cos() * block.radius();
        let expected = block.mass * (block.gravity + height.v2);
        let site = usize::from(corner == Corner::Right);
        let touch = block.touch(&Mode::Rocks(corner), 0.0, &y, site).unwrap();
        // Measured: 2.2e-16.
        assert!((touch.force / expected - 1.0).abs() < 2e-15, "{touch:?} {expected}");
        let other = block.touch(&Mode::Rocks(corner), 0.0, &y, 1 - site).unwrap();
        assert!(other.depth < 0.0 && other.force == 0.0, "{other:?}");
    }
    let weight: f64 =
        (0..2).map(|k| block.touch(&Mode::AtRest, 0.0, &[0.0, 0.0, 0.7], k).unwrap().force).sum();
    assert!((weight - block.mass * block.gravity).abs() < 1e-11);
}

#[test]
fn guard_bounds_are_above_zero_at_rest_in_every_mode() {
    let block = RockingBlock::default();
    for mode in [Mode::AtRest, Mode::Rocks(Corner::Left), Mode::Rocks(Corner::Right)] {
        let mut bounds = [0.0; 3];
        block.guard_bounds(mode, 0.0, &[0.0; 3], &mut bounds);
        assert!(bounds.iter().all(|bound| *bound > 0.0), "{mode:?}: {bounds:?}");
    }
}

#[test]
fn the_energy_balances_with_what_the_impacts_take() {
    let free = RockingBlock::default();
    let own = balance(&free, "vern98", 1e-10, 7.0);
    assert!(own.work == 0.0 && own.dissipated > 0.0, "{own:?}");
    assert!(own.residual.abs() < 1e-8 * own.dissipated, "{own:?}");
    let shaken = RockingBlock { base_amplitude: 1.0, ..free };
    let own = balance(&shaken, "vern98", 1e-10, 4.0);
    assert!(own.work != 0.0 && own.residual.abs() < 1e-8 * own.dissipated, "{own:?}");
}

#[test]
fn a_block_that_topples_balances_by_what_moved_though_its_energy_is_below_zero() {
    let slenderness = RockingBlock::default().slenderness();
    let block = RockingBlock { start_angle: 2.5 * slenderness, ..RockingBlock::default() };
    let start = block.start();
    let mut record = EnergyBalance::new(&block, Events::Located, &start);
    let run = integrate(&block, &setting("radau5", 1e-12), start, 0.2, &mut record);
    assert!(record.at(&run.mode, run.t, &run.y).unwrap().kinetic < 0.0);
    assert_eq!(record.check.warnings(Some(1e-12)), []);
}
