//! What does regularising friction cost or save, and what error does it bring?
//!
//! Table 1 in the reading `full`, where the pins stick: every regularised law at several speeds v_r, and
//! bristles of several stiffnesses σ0, by an explicit and an implicit method at one tolerance, against Coulomb's
//! friction with true stick.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Grid, Method};
use serde::Serialize;

use crate::config::{Config, ConfigError, Events, FrictionLaw};
use crate::metrics::{ErrorScale, sample_error, worse};
use crate::model::Mechanism;
use crate::run::{Accuracy, Limits, Run, Setting};

/// Tolerance of the runs that are compared, and of Coulomb's that they are compared with.
pub const RTOL: f64 = 1e-6;
const REFERENCE_RTOL: f64 = 1e-11;
/// End of the runs [s].
pub const T_END: f64 = 2.0;
/// Regularisation speeds [m/s].
const SPEEDS: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Stiffnesses of bristles [1/m].
const STIFFNESSES: [f64; 5] = [1e3, 1e4, 1e5, 1e6, 1e7];
/// The methods: explicit, implicit.
pub const METHODS: [&str; 2] = ["rk45", "rodas5p"];

/// How near a law is to Coulomb's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Softness {
    /// v_r [m/s] of a regularised law.
    pub speed: Option<f64>,
    /// σ0 [1/m] of bristles, which slide at the coefficient of the others.
    pub stiffness: Option<f64>,
}

impl Softness {
    /// The keys that set it.
    fn sets(self) -> Vec<String> {
        let speed = self.speed.map(|v| format!("friction.regularisation_speed={v:e}"));
        let stiffness = self.stiffness.map(|s| format!("friction.bristle_stiffness={s:e}"));
        // No more friction at rest than in motion.
        let static_coefficient = "friction.static_coefficient=0.1".to_owned();
        speed.into_iter().chain(stiffness).chain([static_coefficient]).collect()
    }
}

/// One law at one softness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// The law.
    pub law: FrictionLaw,
    /// How near it is to Coulomb's.
    #[serde(flatten)]
    pub softness: Softness,
    /// Evaluations of the right-hand side, by the methods in turn; none for a run that failed.
    pub n_rhs: [Option<u64>; 2],
    /// Events, of the first.
    pub n_events: u64,
    /// Its error `e` against Coulomb's friction.
    pub e: f64,
}

/// Coulomb's friction, every regularised law by decreasing speed, and bristles by growing stiffness.
///
/// # Errors
/// A configuration that is refused: a mistake in this program, excluded by a test.
pub fn costs() -> Result<Vec<Cost>, ConfigError> {
    let coulomb = Softness::default();
    let reference = run(FrictionLaw::Coulomb, coulomb, METHODS[0], REFERENCE_RTOL)?;
    let mut costs = vec![cost(&reference, FrictionLaw::Coulomb, coulomb)?];
    for law in [FrictionLaw::Tanh, FrictionLaw::Ambrosio, FrictionLaw::Threlfall] {
        for speed in SPEEDS {
            let softness = Softness { speed: Some(speed), ..coulomb };
            costs.push(cost(&reference, law, softness)?);
        }
    }
    for stiffness in STIFFNESSES {
        let softness = Softness { stiffness: Some(stiffness), ..coulomb };
        costs.push(cost(&reference, FrictionLaw::Lugre, softness)?);
    }
    Ok(costs)
}

fn cost(
    (mechanism, reference): &(Mechanism, Run),
    law: FrictionLaw,
    softness: Softness,
) -> Result<Cost, ConfigError> {
    let runs = [run(law, softness, METHODS[0], RTOL)?.1, run(law, softness, METHODS[1], RTOL)?.1];
    let samples = reference.trajectories.iter().flat_map(|trajectory| &trajectory.samples);
    let theta = samples.fold(0.0_f64, |most, sample| most.max(sample.y[2].abs()));
    let mut e = 0.0;
    let pairs = reference.trajectories.iter().zip(&runs[0].trajectories);
    for (block, (exact, own)) in mechanism.blocks().into_iter().zip(pairs) {
        let scale = ErrorScale::of(block, theta);
        for (exact, own) in exact.samples.iter().zip(&own.samples) {
            e = worse(e, sample_error(&own.y, &exact.y, scale));
        }
    }
    let work = |run: &Run| run.error().is_none().then(|| run.stats().work.n_rhs);
    let n_rhs = runs.each_ref().map(work);
    Ok(Cost { law, softness, n_rhs, n_events: runs[0].stats().n_events, e })
}

fn run(
    law: FrictionLaw,
    softness: Softness,
    method: &str,
    rtol: f64,
) -> Result<(Mechanism, Run), ConfigError> {
    let mut sets = vec!["reading=full".to_owned(), format!("friction.law={law}")];
    sets.extend(softness.sets());
    let config = Config::load(None, &sets)?;
    let mechanism = Mechanism::new(&config);
    let method = Method::named(method)
        .ok_or(ConfigError::Table { part: "solver.method".into(), message: method.into() })?;
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) };
    let stop = AtomicBool::new(false);
    let limits = Limits::none(&stop);
    let run =
        Run::new(&mechanism, &setting, T_END, &Grid::uniform(config.run.sample, T_END), limits);
    Ok((mechanism, run))
}
