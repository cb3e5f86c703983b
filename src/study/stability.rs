//! Where does stability limit the step of rk4, and is it what binds it?

use deltazero_solvers::{Grid, Method, Outcome, System, Trajectory};
use deltazero_study::errors::worse;
use deltazero_study::run::{Accuracy, Braked, Limits, Price, Setting};
use deltazero_study::setting::Events;
use deltazero_study::work_precision::WorkPrecision;
use nalgebra::{Complex, Matrix6};
use serde::{Deserialize, Serialize};

use super::plan::sample_times;
use crate::config::Config;
use crate::model::{Block, Jointed as _, Joints, Mode, Part, State};
use crate::run::BlockTrajectory;

/// Tolerance of the run whose contacts are looked at, and whose states errors are measured against.
const RTOL: f64 = 1e-10;
/// Runs from an eighth of the limit to 2.8 times it, four to a factor of two.
const RUNS: std::ops::RangeInclusive<i32> = -12..=6;
const RUNS_PER_OCTAVE: f64 = 4.0;
/// Part of its size to which an eigenvalue's real part is known.
const RESOLUTION: f64 = 1e-9;
/// Radius within which every direction of the left half-plane is stable.
const SURELY_STABLE: f64 = 2.0;
/// Width of the search along a direction for the end of stability, and its bisections.
const STRIDE: f64 = 0.01;
const BISECTIONS: u32 = 40;

/// The stiffness of the contacts of one joint, over the study's samples in contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StiffnessRow {
    /// Joint, 1 or 2.
    pub joint: usize,
    /// Samples in contact.
    pub n_samples: usize,
    /// Least and largest natural frequency ω = √(K/m) of the undamped contact, m the effective mass
    /// along its normal: the largest eigenvalue of the Jacobian with D = 0 [rad/s].
    pub omega_rad_s: (f64, f64),
    /// Shortest time scale √(m/K) = 1/ω [s].
    pub time_scale_s: f64,
    /// Least limit of the step of rk4 by the damped spectrum [s].
    pub limit_s: f64,
}

/// A run of rk4 on one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepErrorRow {
    /// Joint, 1 or 2.
    pub joint: usize,
    /// Step [s].
    pub h_s: f64,
    /// Error `e` of the joint, if the run reached its end.
    pub e: Option<f64>,
    /// Events.
    pub n_events: usize,
}

/// Stability of rk4.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// One row a joint that comes into contact.
    pub stiffness: Vec<StiffnessRow>,
    /// Runs around the limit, joint by joint, by increasing step.
    pub runs: Vec<StepErrorRow>,
}

/// The largest stable step of rk4 for `ẏ = λ y`; none where the solution itself grows, or rests.
///
/// ```text
/// |R(hλ)| ≤ 1,   R(z) = 1 + z + z²/2 + z³/6 + z⁴/24
/// ```
///
/// `2√2/ω` for λ = iω, `2.785/|λ|` for λ < 0. E. Hairer, G. Wanner, *Solving Ordinary Differential
/// Equations II*, IV.2.
pub fn rk4_limit(lambda: Complex<f64>) -> Option<f64> {
    let size = libm::hypot(lambda.re, lambda.im);
    let is_stable = |radius: f64| {
        let z = lambda * (radius / size);
        let growth = z * (z * (z * (z / 4.0 + 1.0) / 3.0 + 1.0) / 2.0 + 1.0) + 1.0;
        growth.norm_sqr() <= 1.0 + RESOLUTION
    };
    if size == 0.0 || lambda.re > RESOLUTION * size {
        return None;
    }
    let mut stable = SURELY_STABLE;
    while is_stable(stable + STRIDE) {
        stable += STRIDE;
    }
    let mut unstable = stable + STRIDE;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (stable + unstable);
        if is_stable(middle) { stable = middle } else { unstable = middle }
    }
    Some(stable / size)
}

/// Eigenvalues of the Jacobian of `block` at `y`.
fn spectrum(block: &Block, mode: Mode, t: f64, y: &State<f64>) -> [Complex<f64>; 6] {
    let mut jacobian = Matrix6::zeros();
    block.jacobian(mode, t, y, |i, j, value| jacobian[(i, j)] = value);
    jacobian.complex_eigenvalues().into()
}

/// The limit of rk4 at the contacts of `config`, and runs of it around that limit; none without rk4
/// among the study's methods, or without a contact. Chains, and joints with bristles, are left out: their limit is
/// not of one spring.
pub fn stability(config: &Config, table: &WorkPrecision, limits: Limits<'_>) -> Option<Stability> {
    if !config.study.methods.iter().any(|name| name == "rk4") {
        return None;
    }
    let located = |name, accuracy| {
        let method = Method::named(name)?;
        Some(Setting { method, events: Events::Located, accuracy })
    };
    let tight = located("rk45", Accuracy::Rtol(RTOL, None))?;
    let times = sample_times(config);
    let run = |block: &Block, setting: &Setting| -> (BlockTrajectory, bool) {
        let mut watch = limits.watch(Price::of_setting(setting));
        let mut record = (Trajectory::on(Grid::Times(times.clone())), Braked(&mut watch));
        let (y0, t_end) = (block.initial_state(), config.run.t_end);
        let run = block.integrate(setting, y0, t_end, &mut record);
        (record.0, matches!(run.outcome, Ok(Outcome::Finished | Outcome::Stopped)))
    };
    let mut result = Stability::default();
    let mechanism = Joints::from(config);
    let theta = table.reference.largest().of("θ");
    for (part, known) in mechanism.parts.iter().zip(&table.reference.parts) {
        let Part::Block(block) = part else { continue };
        let (reference, _) = run(block, &tight);
        let Some(stiffness) = stiffness(block, &reference) else { continue };
        let scale = block.error_scale(theta);
        for k in RUNS {
            let h_s = stiffness.limit_s * libm::exp2(f64::from(k) / RUNS_PER_OCTAVE);
            let (own, is_whole) = run(block, &located("rk4", Accuracy::Step(h_s))?);
            let pairs = reference.samples.iter().zip(&own.samples);
            let within = pairs.filter(|(sample, _)| sample.t <= known.horizon_s);
            let e = within.map(|(a, b)| scale.error(&b.y, &a.y)).fold(0.0, worse);
            let (joint, n_events) = (block.joint, own.events.len());
            result.runs.push(StepErrorRow { joint, h_s, e: is_whole.then_some(e), n_events });
        }
        result.stiffness.push(stiffness);
    }
    (!result.stiffness.is_empty()).then_some(result)
}

/// The stiffness over the samples of a run in contact; none if there are none, or no step is unstable.
fn stiffness(block: &Block, run: &BlockTrajectory) -> Option<StiffnessRow> {
    let mut undamped = block.clone();
    undamped.normal = block.normal.undamped();
    let (mut n_samples, mut least, mut largest) = (0, f64::INFINITY, 0.0_f64);
    let mut limit_s = f64::INFINITY;
    for sample in run.samples.iter().filter(|sample| sample.mode.is_contact()) {
        let sizes = spectrum(&undamped, sample.mode, sample.t, &sample.y).map(|value| value.norm());
        let omega = sizes.into_iter().fold(0.0, f64::max);
        (least, largest) = (least.min(omega), largest.max(omega));
        let damped = spectrum(block, sample.mode, sample.t, &sample.y);
        limit_s = damped.into_iter().filter_map(rk4_limit).fold(limit_s, f64::min);
        n_samples += 1;
    }
    limit_s.is_finite().then_some(StiffnessRow {
        joint: block.joint,
        n_samples,
        omega_rad_s: (least, largest),
        time_scale_s: 1.0 / largest,
        limit_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Body;
    use crate::model::contact::Onset;

    #[test]
    fn the_limit_of_an_undamped_oscillator_is_two_root_two_over_omega() {
        for omega in [1.0, -4000.0] {
            let limit = rk4_limit(Complex::new(0.0, omega));
            let exact = 8_f64.sqrt() / libm::fabs(omega);
            // 7e-11: the resolution over the slope of |R|².
            assert!(limit.is_some_and(|h| (h / exact - 1.0).abs() < 2e-10), "{limit:?}");
        }
    }

    #[test]
    fn the_limit_of_a_damped_mode_is_where_the_factor_of_growth_is_one() {
        // Of z real: 1 + z/2 + z²/6 + z³/24 = 0, z = −2.785293563405282.
        let limit = rk4_limit(Complex::new(-50.0, 0.0));
        // 1.2e-10: the resolution over the slope of |R|².
        assert!(limit.is_some_and(|h| (50.0 * h / 2.785_293_563_405_282 - 1.0).abs() < 5e-10));
    }

    #[test]
    fn the_spectrum_of_a_contact_across_the_arm_is_that_of_a_linear_oscillator() {
        // At θ = 0 below the centre, Y is alone: M_y ÿ = −K δ − D δ̇.
        let block = &Joints::from(&Config::table1().unwrap()).blocks()[0].clone();
        let y = [0.0, -block.clearance - 1e-9, 0.0, 0.0, 0.0, 0.0];
        let Body::Struts(inertia) = &block.body else { panic!("joint 1 holds struts") };
        let (k, d, m) = (block.normal.elastic.slope(0.0), block.normal.damping, inertia.m_y);
        let (decay, omega) = (0.5 * d / m, (k / m).sqrt());
        let exact = Complex::new(-decay, (omega * omega - decay * decay).sqrt());
        let found = spectrum(block, Mode::SlipPlus(Onset::PLAIN), 0.0, &y);
        let distance = found.map(|value| (value - exact).norm() / omega);
        let nearest = distance.into_iter().fold(f64::INFINITY, f64::min);
        // Measured: 3.9e-12.
        assert!(nearest < 3e-11, "{nearest:e}");
        let limit = found.into_iter().filter_map(rk4_limit).fold(f64::INFINITY, f64::min);
        let expected = rk4_limit(exact).unwrap();
        // A little damping takes the limit beyond that of the undamped oscillator.
        assert!((limit / expected - 1.0).abs() < 1e-9 && limit * omega > 8_f64.sqrt());
    }

    #[test]
    fn what_grows_or_rests_by_itself_limits_no_step() {
        assert_eq!(rk4_limit(Complex::new(1e-3, 1.0)), None);
        assert_eq!(rk4_limit(Complex::new(0.0, 0.0)), None);
    }
}
