//! Which ratio M1 : M4 brings both struts to 90° at the same time?
//!
//! M1 stays as configured and M4 = M1/ratio, so that AB arrives at one time and AF later the larger the
//! ratio. Without clearance t ∝ 1/√M, both times are integrals (see [`ideal`](super::ideal)) and the ratio
//! is a closed form, `(M1/M4) (t_AB/t_AF)²` of any M4; with clearance it is the root of the difference of two
//! event times, each of a run of its own.

use deltazero_solvers::Method;
use deltazero_solvers::root::{Bracket, find_root};
use deltazero_study::parallel::in_parallel;
use deltazero_study::run::{Accuracy, Braked, Limits, Price, Setting};
use deltazero_study::setting::Events;
use deltazero_study::work_precision::Progress;
use serde::{Deserialize, Serialize};

use super::deployment::{patience, under};
use super::ideal::{RIGHT_ANGLE, time_to, without_clearance};
use crate::config::Config;
use crate::keys::{Inertia, ReadingName};
use crate::model::{Block, Jointed as _};

/// Method and relative tolerance of the runs; those of AF are good to 1e-9 s under `pin`, `full`, `cosine`.
const RUN_BY: (&str, f64) = ("vern98", 1e-9);
/// How exactly a ratio is found, relative to it: to the digits that the arrival of AB under `pin` has.
const PRECISION: f64 = 1e-7;
/// Ratios of the curve.
const RATIOS: (f64, f64) = (1.0, 10.0);
const N_RATIOS: u32 = 13;
/// First guess of a bracket around the ratio, as a factor both ways, and how often it is widened.
const BRACKET: f64 = 1.05;
const N_WIDENED: u32 = 12;
/// The ratios that were found, and how arrival times depend on the ratio.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TorqueRatio {
    /// M1 of the configuration, which stays [N m].
    pub m1: f64,
    /// One for each reading and inertia.
    pub curves: Vec<RatioCurve>,
}

/// The arrival of both struts with one reading and inertia.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RatioCurve {
    /// Reading; none without clearance.
    pub reading: Option<ReadingName>,
    /// Inertia of a strut about its centroid.
    pub inertia: Inertia,
    /// When AB reaches 90° [s]; none if it does not, or its run ends early.
    pub theta1_90_s: Option<f64>,
    /// M1/M4 that brings AF there at the same time; none where there is none.
    pub ratio: Option<f64>,
    /// M1/M4, and when AF reaches 90° with it [s]; empty under `centroid` and `printed`, whose bursts of force make it
    /// an accident.
    pub theta2_90: Vec<(f64, Option<f64>)>,
}

impl TorqueRatio {
    /// The curve of a reading with an inertia.
    pub fn curve(&self, reading: Option<ReadingName>, inertia: Inertia) -> Option<&RatioCurve> {
        self.curves.iter().find(|curve| curve.reading == reading && curve.inertia == inertia)
    }
}

/// Ratio and curve of each reading and inertia.
pub(super) fn torque_ratio(
    config: &Config,
    threads: usize,
    limits: Limits<'_>,
    progress: &(dyn Fn(Progress) + Sync),
) -> TorqueRatio {
    let curves = in_parallel(&jobs(config), threads, |&(reading, inertia)| {
        let curve = curve(config, reading, inertia, limits);
        let name = reading.map_or("ideal", ReadingName::name);
        progress(Progress::Done(format!("torque ratio, {name}")));
        curve
    });
    TorqueRatio { m1: config.drive.m1, curves }
}

/// What curves there are: without clearance and under every reading, axial, transverse and as configured.
pub(super) fn jobs(config: &Config) -> Vec<(Option<ReadingName>, Inertia)> {
    let mut inertias = vec![Inertia::Axial, Inertia::Transverse];
    if !inertias.contains(&config.strut.inertia) {
        inertias.push(config.strut.inertia);
    }
    let readings = || std::iter::once(None).chain(ReadingName::ALL.iter().copied().map(Some));
    inertias
        .into_iter()
        .flat_map(|inertia| readings().map(move |reading| (reading, inertia)))
        .collect()
}

fn is_drawn(reading: Option<ReadingName>) -> bool {
    !matches!(reading, Some(ReadingName::Centroid | ReadingName::Printed))
}

fn curve(
    config: &Config,
    reading: Option<ReadingName>,
    inertia: Inertia,
    limits: Limits<'_>,
) -> RatioCurve {
    let arrivals = Arrivals::new(config, reading, inertia, limits);
    let (low, high) = RATIOS;
    let at = |k: u32| low * libm::pow(high / low, f64::from(k) / f64::from(N_RATIOS - 1));
    let points = if is_drawn(reading) { N_RATIOS } else { 0 };
    RatioCurve {
        reading,
        inertia,
        theta1_90_s: arrivals.theta1_90_s,
        ratio: arrivals.ratio(),
        theta2_90: (0..points).map(at).map(|ratio| (ratio, arrivals.theta2_90(ratio))).collect(),
    }
}

/// When both struts of one reading arrive.
struct Arrivals<'a> {
    blocks: [Block; 2],
    is_ideal: bool,
    limits: Limits<'a>,
    theta1_90_s: Option<f64>,
}

impl<'a> Arrivals<'a> {
    fn new(
        config: &Config,
        reading: Option<ReadingName>,
        inertia: Inertia,
        limits: Limits<'a>,
    ) -> Self {
        let mut config = config.clone();
        config.strut.inertia = inertia;
        let blocks = match reading {
            None => without_clearance(&config, inertia),
            Some(reading) => under(&config, reading),
        };
        let own = Self { blocks, is_ideal: reading.is_none(), limits, theta1_90_s: None };
        Self { theta1_90_s: own.reached_90(&own.blocks[0]), ..own }
    }

    fn reached_90(&self, block: &Block) -> Option<f64> {
        if self.is_ideal {
            return time_to(block, RIGHT_ANGLE);
        }
        let (name, rtol) = RUN_BY;
        let (events, accuracy) = (Events::Located, Accuracy::Rtol(rtol, None));
        let setting = Setting { method: Method::named(name)?, events, accuracy };
        let mut watch = self.limits.watch(Price::of_setting(&setting));
        block
            .integrate(&setting, block.initial_state(), patience(block), &mut Braked(&mut watch))
            .stopped_at()
    }

    /// When AF reaches 90° with M4 = M1/`ratio` [s].
    fn theta2_90(&self, ratio: f64) -> Option<f64> {
        let [ab, af] = &self.blocks;
        let mut driven = af.clone();
        driven.torque = ab.torque / ratio;
        self.reached_90(&driven)
    }

    fn ratio(&self) -> Option<f64> {
        let [ab, af] = &self.blocks;
        let theta1_90 = self.theta1_90_s?;
        let own = (ab.torque / af.torque).abs();
        // AF arrives as √ratio, nearly.
        let ahead = theta1_90 / self.theta2_90(own)?;
        let guess = own * ahead * ahead;
        let earlier = |ratio: f64| self.theta2_90(ratio).map_or(f64::NAN, |t| theta1_90 - t);
        let (mut low, mut high) = (guess / BRACKET, guess * BRACKET);
        for _ in 0..N_WIDENED {
            let (at_low, at_high) = (earlier(low), earlier(high));
            if at_low > 0.0 && at_high <= 0.0 {
                let bracket = Bracket { above: low, below: high };
                return Some(find_root(earlier, bracket, PRECISION * guess));
            }
            if !at_low.is_finite() || !at_high.is_finite() {
                return None;
            }
            if at_low <= 0.0 {
                low /= BRACKET;
            }
            if at_high > 0.0 {
                high *= BRACKET;
            }
        }
        None
    }
}
