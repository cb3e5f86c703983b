//! The map of joints: the contest over a grid of contact stiffness × damping × accuracy, and of readings of the paper.
//!
//! That of two parameters of any model is [`deltazero_study::map`].

use std::ops::Deref;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use deltazero_study::Subject;
use deltazero_study::forecast::Forecast;
use deltazero_study::map::{Contested, MapPlan, contested};
use serde::{Deserialize, Serialize};

use super::plan::{rules, sample_times};
use crate::config::Config;
use crate::keys::ReadingName;
use crate::model::inertia::BlockInertia;

/// The trial before the map runs this part of the time …
const TRIAL_PART: f64 = 0.02;
/// … but at least this long [s], or no pin has left its bush.
const TRIAL_LEAST_S: f64 = 0.02;
/// A preview runs no longer than this [s].
const QUICK_T_END: f64 = 0.25;

/// One cell of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Reading of the paper.
    pub reading: ReadingName,
    /// Contact stiffness K [N/mⁿ].
    pub stiffness: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// The contest there.
    #[serde(flatten)]
    pub contest: Contested,
}

impl Deref for Cell {
    type Target = Contested;

    fn deref(&self) -> &Contested {
        &self.contest
    }
}

/// One problem of the map; its cells differ in accuracy alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Reading of the paper.
    pub reading: ReadingName,
    /// Contact stiffness K [N/mⁿ].
    pub stiffness: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
}

impl Site {
    /// `D = 2ζ√(K m_ref)` [N s/m], m_ref the mass M_y of joint 1's struts 1, 2, 5 and 6 (6.126 kg).
    fn damping(&self, config: &Config) -> f64 {
        let m_ref = BlockInertia::joint_1(&config.strut).m_y;
        2.0 * self.damping_ratio * (self.stiffness * m_ref).sqrt()
    }

    /// `config` with this reading, stiffness and damping at both joints.
    fn config(&self, config: &Config) -> Config {
        let damping = self.damping(config);
        let mut own = config.clone();
        own.reading = self.reading;
        for joint in &mut own.joints {
            joint.contact.stiffness = self.stiffness;
            joint.contact.damping = damping;
        }
        own
    }

    /// What is studied there.
    pub fn subject(&self, config: &Config) -> Subject {
        let own = self.config(config);
        own.mechanism.subject(&own)
    }

    /// Its contests among `cells`, one an accuracy, if all are there.
    pub fn contests(&self, config: &Config, cells: &[Cell]) -> Option<Vec<Contested>> {
        let own = |e| cells.iter().find(|cell| self.holds(cell) && cell.accuracy == e);
        config.regimes.accuracy.iter().map(|e| Some(own(*e)?.contest.clone())).collect()
    }

    fn holds(&self, cell: &Cell) -> bool {
        self.reading == cell.reading
            && self.stiffness == cell.stiffness
            && self.damping_ratio == cell.damping_ratio
    }
}

impl std::fmt::Display for Site {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, K = {:e}, ζ = {}", self.reading, self.stiffness, self.damping_ratio)
    }
}

/// The problems of a map: reading by reading, stiffness by stiffness.
pub fn sites(config: &Config) -> Vec<Site> {
    let grid = &config.regimes;
    let readings = grid.readings.clone().unwrap_or_else(|| vec![config.reading]);
    let mut sites = Vec::new();
    for reading in readings {
        for &stiffness in &grid.stiffness {
            for &damping_ratio in &grid.damping_ratio {
                sites.push(Site { reading, stiffness, damping_ratio });
            }
        }
    }
    sites
}

/// The preview of a map: every third stiffness, every second damping ratio, at most 0.25 s.
pub fn quick(config: &Config) -> Config {
    let mut quick = config.clone();
    let thin = |list: &[f64], n: usize| list.iter().copied().step_by(n).collect();
    quick.regimes.stiffness = thin(&config.regimes.stiffness, 3);
    quick.regimes.damping_ratio = thin(&config.regimes.damping_ratio, 2);
    quick.run.t_end = config.run.t_end.min(QUICK_T_END);
    quick
}

/// Shown how far something has come: so many of so many.
pub type Shown<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What these sites will take, begun in this order: from short runs at both ends of the stiffness, every damping ratio,
/// interpolated by a power law between them. None once `stop` is set; `shown` hears of each short run.
pub fn estimate(
    config: &Config,
    missing: &[Site],
    stop: &AtomicBool,
    shown: Shown<'_>,
) -> Option<Forecast> {
    let mut short = config.clone();
    short.run.t_end = (TRIAL_PART * config.run.t_end).max(TRIAL_LEAST_S).min(config.run.t_end);
    let times = config.run.t_end / short.run.t_end;
    let stiffness = || missing.iter().map(|site| site.stiffness);
    let (low, high) =
        (stiffness().fold(f64::INFINITY, f64::min), stiffness().fold(0.0_f64, f64::max));
    let mut ratios: Vec<f64> = missing.iter().map(|site| site.damping_ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let trials: Vec<(f64, f64)> =
        ratios.iter().flat_map(|&ratio| [(ratio, low), (ratio, high)]).collect();
    let mut measured: Vec<f64> = Vec::new();
    for (n, &(damping_ratio, stiffness)) in trials.iter().enumerate() {
        shown(n, trials.len());
        let start = Instant::now();
        let site = Site { stiffness, damping_ratio, ..*missing.first()? };
        contested(site.subject(&short), &map_plan(&short), stop);
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        measured.push(start.elapsed().as_secs_f64());
    }
    shown(trials.len(), trials.len());
    let expected = |site: &Site| {
        let ratio = ratios.iter().position(|ratio| *ratio == site.damping_ratio)?;
        let (soft, stiff) = (measured.get(2 * ratio)?, measured.get(2 * ratio + 1)?);
        let part =
            if high > low { libm::log(site.stiffness / low) / libm::log(high / low) } else { 0.0 };
        Some(times * soft * libm::pow(stiff / soft, part))
    };
    let expected = missing.iter().map(|site| expected(site).unwrap_or(0.0)).collect();
    Some(Forecast::new(expected, config.regimes.threads))
}

/// The cells of `sites` that have contests, accuracy by accuracy.
pub fn cells(config: &Config, sites: &[Site], contests: &[Option<Vec<Contested>>]) -> Vec<Cell> {
    let cell = |i: usize, site: &Site, own: &Option<Vec<Contested>>| {
        let Site { reading, stiffness, damping_ratio } = *site;
        let contest = own.as_ref()?.get(i)?.clone();
        Some(Cell { reading, stiffness, damping_ratio, contest })
    };
    let pairs = || sites.iter().zip(contests);
    let of_accuracy =
        |i: usize| pairs().filter_map(move |(site, contests)| cell(i, site, contests));
    (0..config.regimes.accuracy.len()).flat_map(of_accuracy).collect()
}

/// The maps that the cells make up: a reading and an accuracy each.
pub fn maps(cells: &[Cell]) -> Vec<(ReadingName, f64)> {
    let mut maps = Vec::new();
    for cell in cells {
        let own = (cell.reading, cell.accuracy);
        if !maps.contains(&own) {
            maps.push(own);
        }
    }
    maps
}

/// The cells of one map.
pub fn of_map(cells: &[Cell], reading: ReadingName, accuracy: f64) -> Vec<&Cell> {
    cells.iter().filter(|cell| cell.reading == reading && cell.accuracy == accuracy).collect()
}

/// What every contest of a map has.
pub fn map_plan(config: &Config) -> MapPlan {
    MapPlan {
        t_end: config.run.t_end,
        times: sample_times(config),
        accuracies: config.regimes.accuracy.clone(),
        rules: rules(config),
        max_events: config.regimes.max_events,
        max_rhs: config.study.max_rhs,
        max_seconds: config.study.max_seconds,
    }
}
