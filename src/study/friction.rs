//! What does regularising friction cost or save, and what error does it bring?
//!
//! Table 1 in the reading `full`, where the pins stick: every regularised law at several speeds v_r, and
//! bristles of several stiffnesses σ0, by an explicit and an implicit method at one tolerance, against Coulomb's
//! friction with true stick.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Grid, Method};
use deltazero_study::Subject;
use deltazero_study::errors::{Largest, worse};
use deltazero_study::part::Start;
use deltazero_study::run::{Accuracy, Limits, PartRun, Price, Setting};
use deltazero_study::setting::Events;
use deltazero_study::trace::Trace;
use serde::Serialize;

use crate::config::{Config, ConfigError};
use crate::keys::FrictionLaw;

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

/// A subject, and the run of each of its parts.
type Ran = (Subject, Vec<(PartRun, Trace)>);

fn cost(
    (subject, reference): &Ran,
    law: FrictionLaw,
    softness: Softness,
) -> Result<Cost, ConfigError> {
    let runs = [run(law, softness, METHODS[0], RTOL)?.1, run(law, softness, METHODS[1], RTOL)?.1];
    let mut largest = Largest::default();
    let exact = || subject.parts.iter().zip(reference);
    exact().for_each(|(part, (_, trace))| part.measure(&trace.states, &mut largest));
    let mut e = 0.0;
    for ((part, (_, exact)), (_, own)) in exact().zip(&runs[0]) {
        let scale = part.error_scale(&largest);
        for (exact, own) in exact.states.iter().zip(&own.states) {
            // The deflection of bristles, which Coulomb's friction has not, comes last.
            e = worse(e, scale.error(own, exact));
        }
    }
    let work = |parts: &Vec<(PartRun, Trace)>| {
        let each = parts.iter().map(|(run, _)| run.outcome.is_ok().then_some(run.stats.work.n_rhs));
        each.sum()
    };
    let n_events = runs[0].iter().map(|(run, _)| run.stats.n_events).sum();
    Ok(Cost { law, softness, n_rhs: runs.each_ref().map(work), n_events, e })
}

fn run(law: FrictionLaw, softness: Softness, method: &str, rtol: f64) -> Result<Ran, ConfigError> {
    let mut sets = vec!["reading=full".to_owned(), format!("friction.law={law}")];
    sets.extend(softness.sets());
    let config = Config::load(None, &sets)?;
    let subject = config.mechanism.subject(&config);
    let method = Method::named(method)
        .ok_or(ConfigError::Table { part: "solver.method".into(), message: method.into() })?;
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) };
    let stop = AtomicBool::new(false);
    let mut watch = Limits::none(&stop).watch(Price::PLAIN);
    let grid = Grid::uniform(config.run.sample, T_END);
    let parts = subject.parts.iter();
    let runs = parts.map(|part| part.run(&setting, Start::Exact, T_END, &grid, &mut watch));
    let runs = runs.collect();
    Ok((subject, runs))
}
