use deltazero_solvers::{Grid, Trajectory};
use deltazero_study::energy_balance::EnergyBalance;
use deltazero_study::run::integrate;
use deltazero_study::setting::Events;
use num_dual::{Dual2_64, DualNum as _};

use super::*;
use crate::mechanisms::test_runs::{
    Run, assert_numbers, balance, by_every_method, distance, setting,
};

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

/// Measured: 2.1e-15.
const EXACT: f64 = 2e-14;

const OTHER: RockingBlock = RockingBlock {
    mass: 850.0,
    half_width: 0.25,
    half_height: 0.7,
    gravity: 9.7,
    restitution: None,
    base_amplitude: 2.1,
    base_frequency: 5.5,
    start_angle: 0.13,
    start_velocity: -0.6,
};

/// Rates, guards and their bounds, in roundings.
fn numbers(block: &RockingBlock, mode: Mode, y: [f64; 3]) -> [[f64; 3]; 3] {
    let [mut dydt, mut guards, mut bounds] = [[0.0; 3]; 3];
    block.rhs(mode, 0.0, &y, &mut dydt);
    block.guards(mode, 0.0, &y, &mut guards);
    block.guard_bounds(mode, 0.0, &y, &mut bounds);
    [dydt, guards, bounds.map(|bound| bound / ROUNDING)]
}

/// Depth, rate and force of a corner.
fn touch(block: &RockingBlock, mode: Mode, y: &[f64; 3], corner: Corner) -> [f64; 3] {
    let site = usize::from(corner == Corner::Right);
    let Touch { depth, rate, force } = block.touch(&mode, 0.0, y, site).unwrap();
    [depth, rate, force]
}

#[test]
fn its_lengths_and_scales_are_those_of_the_equations() {
    let own = [OTHER.radius(), OTHER.slenderness(), OTHER.frequency(), OTHER.velocity_ratio()];
    let expected = [
        0.743_303_437_365_925_3,
        0.343_023_940_420_703_4,
        3.128_480_326_395_924,
        0.830_316_742_081_448,
    ];
    assert_numbers("R, α, p, r", EXACT, &own, &expected);
    let own = [OTHER.overturned_at(), OTHER.least_to_tilt(), OTHER.unit_of_time()];
    let expected = [1.128_422_103_818_151_7, 3.464_285_714_285_714_3, 0.319_644_011_043_541_2];
    assert_numbers("α + π/4, g tan α, 1/p", EXACT, &own, &expected);
    let scales: Vec<f64> = OTHER.states().iter().map(|state| state.scale).collect();
    assert_numbers(
        "scales",
        EXACT,
        &scales,
        &[0.343_023_940_420_703_4, 1.073_143_649_088_978, 2.0 * PI],
    );
    assert_eq!(OTHER.groups().len(), 2);
    assert_eq!(OTHER.start(), [0.13, -0.6, 0.0]);
}

#[test]
fn a_block_on_its_right_corner_has_the_numbers_of_the_equations() {
    let (mode, y) = (Mode::Rocks(Corner::Right), [0.13, -0.6, 0.7]);
    let [rates, guards, bounds] = numbers(&OTHER, mode, y);
    assert_numbers("rates", EXACT, &rates, &[-0.6, -3.403_404_972_512_186_6, 5.5]);
    assert_numbers(
        "guards",
        EXACT,
        &guards,
        &[0.13, 0.998_422_103_818_151_7, 0.917_899_577_315_662_9],
    );
    let expected = [0.182_888_210_910_479_73, 1.128_422_103_818_151_7, 2.395_004_192_788_855_6];
    assert_numbers("bounds", EXACT, &bounds, &expected);
    let right = touch(&OTHER, mode, &y, Corner::Right);
    assert_numbers("right corner", EXACT, &right, &[0.0, 0.0, 7_568.082_014_967_64]);
    let left = touch(&OTHER, mode, &y, Corner::Left);
    let expected = [-0.064_817_071_309_847_43, 0.297_468_568_114_436_4, 0.0];
    assert_numbers("left corner", EXACT, &left, &expected);
    let energy = OTHER.energies(&mode, 0.0, &y).unwrap();
    assert_numbers(
        "energy",
        EXACT,
        &[energy.kinetic, energy.elastic],
        &[331.217_846_049_745_2, 0.0],
    );
    let power = OTHER.powers(&mode, 0.0, &y).unwrap().drive;
    assert_numbers("power", EXACT, &[power], &[501.255_148_598_805_74]);
}

#[test]
fn a_block_on_its_left_corner_has_the_numbers_of_the_equations() {
    let (mode, y) = (Mode::Rocks(Corner::Left), [-0.21, -0.4, 2.9]);
    let [rates, guards, bounds] = numbers(&OTHER, mode, y);
    assert_numbers("rates", EXACT, &rates, &[-0.4, 0.795_649_401_080_505_4, 5.5]);
    assert_numbers(
        "guards",
        EXACT,
        &guards,
        &[0.21, 0.918_422_103_818_151_7, 0.979_761_073_174_817],
    );
    let expected = [0.310_546_798_491_092_5, 1.128_422_103_818_151_7, 2.856_482_253_447_726_7];
    assert_numbers("bounds", EXACT, &bounds, &expected);
    let left = touch(&OTHER, mode, &y, Corner::Left);
    assert_numbers("left corner", EXACT, &left, &[0.0, 0.0, 8_078.130_048_326_367]);
    let right = touch(&OTHER, mode, &y, Corner::Right);
    let expected = [-0.104_229_949_923_049_8, -0.195_606_182_944_829_65, 0.0];
    assert_numbers("right corner", EXACT, &right, &expected);
    let energy = OTHER.energies(&mode, 0.0, &y).unwrap();
    assert_numbers("energy", EXACT, &[energy.kinetic], &[352.986_726_221_527_7]);
    let power = OTHER.powers(&mode, 0.0, &y).unwrap().drive;
    assert_numbers("power", EXACT, &[power], &[125.852_311_081_390_85]);
}

#[test]
fn a_block_at_rest_has_the_numbers_of_the_equations() {
    let (mode, y) = (Mode::AtRest, [0.0, 0.0, 0.7]);
    let [rates, guards, bounds] = numbers(&OTHER, mode, y);
    assert_eq!(rates, [0.0, 0.0, 5.5]);
    assert_numbers("guards", EXACT, &guards, &[4.817_142_857_484_865, 2.111_428_571_086_563, 1.0]);
    let tilts = 7.034_285_714_285_714;
    assert_numbers("bounds", EXACT, &bounds, &[tilts, tilts, 1.0]);
    let [left, right] = [Corner::Left, Corner::Right].map(|at| touch(&OTHER, mode, &y, at));
    assert_numbers("left corner", EXACT, &left, &[0.0, 0.0, 5_732.400_000_406_99]);
    assert_numbers("right corner", EXACT, &right, &[0.0, 0.0, 2_512.599_999_593_01]);
    assert_eq!(OTHER.energies(&mode, 0.0, &y), Some(Energy::default()));
    assert_eq!(OTHER.powers(&mode, 0.0, &y), Some(Power::default()));
}

#[test]
fn each_guard_is_of_the_corner_that_it_moves() {
    let (left, right) = (Mode::Rocks(Corner::Left), Mode::Rocks(Corner::Right));
    let site = |mode: Mode, guard: usize| OTHER.site_name(OTHER.site_of_guard(&mode, guard));
    // Rocking, the other corner lands; the corner that carries stops to press, or the block falls over it.
    for (mode, carrier, other) in
        [(left, "left corner", "right corner"), (right, "right corner", "left corner")]
    {
        assert_eq!([0, 1, 2].map(|guard| site(mode, guard)), [other, carrier, carrier]);
    }
    assert_eq!([0, 1].map(|guard| site(Mode::AtRest, guard)), ["left corner", "right corner"]);
    for (mode, roles) in [
        (left, [Role::Contact, Role::Free]),
        (right, [Role::Free, Role::Contact]),
        (Mode::AtRest, [Role::Contact, Role::Contact]),
    ] {
        assert_eq!([0, 1].map(|site| OTHER.role(&mode, site)), roles, "{mode:?}");
        assert_eq!(OTHER.takes_energy(&mode, &Mode::AtRest), mode != Mode::AtRest);
    }
    let names = [left, right, Mode::AtRest].map(|mode| format!("{mode:?}"));
    assert_eq!(names, ["on the left corner", "on the right corner", "at rest"]);
}

#[test]
fn the_start_tells_the_corner_and_none_is_rest() {
    let mode = |theta: f64, omega: f64| OTHER.initial_mode(0.0, &[theta, omega, 0.0]);
    assert!(mode(0.1, -1.0) == Mode::Rocks(Corner::Right));
    assert!(mode(-0.1, 1.0) == Mode::Rocks(Corner::Left));
    assert!(mode(0.0, 1.0) == Mode::Rocks(Corner::Right));
    assert!(mode(0.0, -1.0) == Mode::Rocks(Corner::Left));
    assert!(mode(0.0, 0.0) == Mode::AtRest);
    let plastic = RockingBlock { restitution: Some(0.0), ..OTHER };
    let mut y = [1e-17, -0.3, 0.7];
    let next = plastic.transition(Mode::Rocks(Corner::Right), GUARD_GROUND, 0.0, &mut y);
    assert_eq!((next, y), (Next::Mode(Mode::AtRest), [0.0, 0.0, 0.7]));
}
