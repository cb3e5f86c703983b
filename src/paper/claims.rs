//! What the paper says of its deployment, claim by claim, and what comes out under each reading.

mod list;
mod measures;

use serde::{Deserialize, Serialize};

pub use list::CLAIMS;

use super::deployment::{Course, TRANSIENT_S, under};
use super::torque_ratio::TorqueRatio;
use crate::config::Config;
use crate::keys::ReadingName;

/// A figure is reproduced within this part of it.
const CLOSE: f64 = 0.02;
/// A displacement is impossible if the contact force that it takes is so many times the paper's own.
const FAR_BEYOND: f64 = 100.0;
/// The paper's larger settled force [N].
pub const PAPER_FORCE: f64 = 0.48;
/// The paper's largest |x01| [m].
pub const PAPER_X01: f64 = 0.00054;
/// A best sine that explains less of the variance than this is none.
const SINUSOIDAL: f64 = 0.9;

/// Whether a claim holds under a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within 2 % of the paper's figure, equal to it in the digits printed, or on the side of a bound that
    /// the paper's words say.
    Reproduced,
    /// Not so.
    NotReproduced,
    /// The paper's own parameters rule it out.
    Impossible,
    /// A run that it is about ended early: by an error, or by the limit of its work.
    Undecided,
}

impl Verdict {
    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::NotReproduced => "not_reproduced",
            Self::Impossible => "impossible",
            Self::Undecided => "undecided",
        }
    }
}

/// A claim under a reading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimRow {
    /// Name of the claim.
    pub claim: String,
    /// The paper's figure; none where it says it in words.
    pub paper: Option<f64>,
    /// A reading, or `ideal` without clearance.
    pub reading: String,
    /// What comes out; none if it never happens, or is not defined or not known.
    pub measured: Option<f64>,
    /// Unit of both; `1` for ratios and counts.
    pub unit: String,
    /// Whether it holds.
    pub verdict: Verdict,
    /// From when on the digits of a joint that it is about are lost [s]; none where they are not.
    pub horizon_s: Option<f64>,
    /// By how much last-bit changes of the start move what comes out; none where nothing does, or one of them makes
    /// or unmakes it.
    #[serde(default)]
    pub moved: Option<f64>,
    /// Whether it hangs on motion beyond the horizon: without that something else comes out, of this run or of one
    /// from a start moved by its last bit.
    #[serde(default)]
    pub beyond_horizon: bool,
}

impl ClaimRow {
    /// Digits of what comes out, up to `most`, that last-bit changes of the start leave; at least one.
    pub fn digits(&self, most: usize) -> usize {
        match (self.beyond_horizon, self.measured, self.moved) {
            (false, ..) => most,
            (true, Some(value), Some(moved)) => digits(value, moved, most),
            (true, ..) => 1,
        }
    }
}

/// Digits of `value`, one to `most`, that a change by twice `moved` leaves.
pub fn digits(value: f64, moved: f64, most: usize) -> usize {
    let sure = -libm::log10(2.0 * moved / value.abs());
    // What is not a number, of zero over zero, has none that is sure.
    if sure >= most as f64 { most } else { sure.max(1.0) as usize }
}

/// When a claim holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Test {
    /// Equal to this figure, as the paper prints it.
    Is(&'static str),
    /// Within 2 % of 1, where the paper says it in words.
    IsOne,
    /// Equal to this pin displacement [m], as the paper prints it, unless that is impossible.
    Reaches(&'static str),
    /// At most this.
    AtMost(f64),
    /// More than this.
    Above(f64),
    /// Another torque ratio than the ideal one.
    IsNotIdeal,
}

/// A claim of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Its name.
    pub name: &'static str,
    /// What the paper says, and where.
    pub says: &'static str,
    /// What is measured, and when that counts as reproduced.
    pub measure: &'static str,
    /// Unit; `1` for ratios and counts.
    pub unit: &'static str,
    /// Joints that it is about.
    joints: &'static [usize],
    test: Test,
    is_ideal: bool,
    value: fn(&Deployment<'_>) -> Option<f64>,
}

impl Claim {
    /// The claim called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        CLAIMS.iter().find(|claim| claim.name == name)
    }
}

/// One reading's deployment beside the ideal one.
#[derive(Clone, Copy)]
struct Deployment<'a> {
    config: &'a Config,
    own: [&'a Course; 2],
    ideal: [&'a Course; 2],
    ratio: Option<f64>,
    ideal_ratio: Option<f64>,
}

/// Every claim under every reading that it is about.
pub(super) fn claims(
    config: &Config,
    courses: &[Course],
    torque_ratio: &TorqueRatio,
) -> Vec<ClaimRow> {
    let pair = |reading: Option<ReadingName>| -> Option<[&Course; 2]> {
        let of = |joint| courses.iter().find(|c| c.run.reading == reading && c.run.joint == joint);
        Some([of(1)?, of(2)?])
    };
    let ratio = |reading| torque_ratio.curve(reading, config.strut.inertia)?.ratio;
    let Some(ideal) = pair(None) else { return Vec::new() };
    let deployments = |reading| {
        let (ratio, ideal_ratio) = (ratio(reading), ratio(None));
        let own = Deployment { config, own: pair(reading)?, ideal, ratio, ideal_ratio };
        Some((own.nudged(), own))
    };
    let mut rows = Vec::new();
    for claim in CLAIMS {
        let about = |reading: &Option<ReadingName>| reading.is_none() == claim.is_ideal;
        let readings = std::iter::once(None).chain(ReadingName::ALL.iter().copied().map(Some));
        let row = |reading| {
            let (nudged, own) = deployments(reading)?;
            Some(claim.row(reading, &own, &nudged))
        };
        rows.extend(readings.filter(about).filter_map(row));
    }
    rows
}

impl<'a> Deployment<'a> {
    /// What there is of its courses up to these times [s].
    fn until(&self, times: [Option<f64>; 2]) -> [Course; 2] {
        [0, 1].map(|i| match times[i] {
            Some(t) => self.own[i].cut(t),
            None => self.own[i].clone(),
        })
    }

    /// The same from starts moved by their last bit.
    fn nudged(&self) -> Vec<Deployment<'a>> {
        let [one, two] = self.own;
        let pairs = one.nudged.iter().zip(&two.nudged);
        let time = |course: &Course| course.run.reached_90_s;
        pairs
            .map(|(a, b)| {
                // M1/M4 goes with the square of the time that AB takes.
                let moved = time(a).zip(time(one)).map_or(1.0, |(a, t)| (a / t) * (a / t));
                Deployment { own: [a, b], ratio: self.ratio.map(|ratio| ratio * moved), ..*self }
            })
            .collect()
    }
}

impl Claim {
    fn row(
        &self,
        reading: Option<ReadingName>,
        of: &Deployment<'_>,
        nudged: &[Deployment<'_>],
    ) -> ClaimRow {
        let is_whole = self.joints.iter().all(|joint| of.own[joint - 1].run.error.is_none());
        let value =
            |of: &Deployment<'_>| (self.value)(of).filter(|value| is_whole && value.is_finite());
        let measured = value(of);
        let apart = nudged.iter().map(|other| match (measured, value(other)) {
            (Some(own), Some(other)) => (other - own).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        });
        let moved = apart.fold(0.0, f64::max);
        let hangs = |all: &Deployment<'_>| {
            let until = all.until(of.own.map(|course| course.run.horizon_s));
            let [one, two] = &until;
            let ratio = all.ratio.filter(|_| one.run.reached_90_s.is_some());
            value(&Deployment { own: [one, two], ratio, ..*all }) != value(all)
        };
        let beyond_horizon = std::iter::once(of).chain(nudged).any(hangs);
        let horizons = self.joints.iter().filter_map(|joint| of.own.get(joint - 1)?.run.horizon_s);
        ClaimRow {
            claim: self.name.to_owned(),
            paper: self.test.figure().and_then(|figure| figure.parse().ok()),
            reading: reading.map_or("ideal", ReadingName::name).to_owned(),
            measured,
            unit: self.unit.to_owned(),
            verdict: match self.test.verdict(measured, of) {
                Verdict::Impossible => Verdict::Impossible,
                _ if !is_whole => Verdict::Undecided,
                verdict => verdict,
            },
            horizon_s: horizons.reduce(f64::min),
            moved: measured.and(moved.is_finite().then_some(moved)),
            beyond_horizon,
        }
    }
}

impl Test {
    /// The paper's figure as it prints it.
    fn figure(self) -> Option<&'static str> {
        match self {
            Self::Is(figure) | Self::Reaches(figure) => Some(figure),
            Self::IsOne | Self::AtMost(_) | Self::Above(_) | Self::IsNotIdeal => None,
        }
    }

    fn verdict(self, measured: Option<f64>, of: &Deployment<'_>) -> Verdict {
        if let Self::Reaches(figure) = self
            && is_impossible(figure, of.config)
        {
            return Verdict::Impossible;
        }
        let holds = |value: f64| match self {
            Self::Is(figure) | Self::Reaches(figure) => is_figure(figure, value),
            Self::IsOne => (value - 1.0).abs() <= CLOSE,
            Self::AtMost(bound) => value <= bound,
            Self::Above(bound) => value > bound,
            Self::IsNotIdeal => {
                of.ideal_ratio.is_some_and(|ideal| (value / ideal - 1.0).abs() > CLOSE)
            }
        };
        if measured.is_some_and(holds) { Verdict::Reproduced } else { Verdict::NotReproduced }
    }
}

/// Whether `value` is the printed `figure`: within 2 % of it, or equal in its digits.
fn is_figure(figure: &str, value: f64) -> bool {
    let decimals = figure.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let is_close =
        figure.parse::<f64>().is_ok_and(|paper| (value - paper).abs() <= CLOSE * paper.abs());
    is_close || format!("{value:.decimals$}") == figure
}

/// Whether a displacement of the pin of joint 1 takes a contact force far beyond the paper's own.
fn is_impossible(figure: &str, config: &Config) -> bool {
    figure.parse::<f64>().is_ok_and(|d| contact_at(d, config).0 > FAR_BEYOND * PAPER_FORCE)
}

/// Contact force [N] and elastic energy [J] with the pin of joint 1 at rest, displaced by `d` [m]; both without bound where the law
/// of the contact ends before.
pub fn contact_at(d: f64, config: &Config) -> (f64, f64) {
    let [block, _] = under(config, ReadingName::Pin);
    let delta = (d - config.joints[0].joint.clearance).max(0.0);
    let elastic = &block.normal.elastic;
    if elastic.deepest().is_some_and(|deepest| delta > deepest) {
        return (f64::INFINITY, f64::INFINITY);
    }
    (elastic.force(delta), elastic.energy(delta))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_reproduced_within_two_percent_or_in_its_digits() {
        for (figure, value) in [("13.5", 13.3975), ("9", 9.06), ("0.4", 0.356), ("0.0001", 1.01e-4)]
        {
            assert!(is_figure(figure, value), "{figure} {value}");
        }
        for (figure, value) in [("13.5", 13.22), ("9", 7.81), ("0.48", 0.44), ("0.00054", 5.0e-4)] {
            assert!(!is_figure(figure, value), "{figure} {value}");
        }
    }

    #[test]
    fn a_value_has_the_digits_that_its_changes_leave_and_at_least_one() {
        // Twice 7e-3 s of 11.8 s is 1.2e-3, twice 0.17 of 8.7 is 0.04, twice 24 of 32 is more than all of it.
        for (value, moved, n) in [
            (11.82, 7e-3, 2),
            (8.748e-4, 1.7e-5, 1),
            (32.06, 24.0, 1),
            (13.5, 1e-6, 4),
            (0.0, 0.0, 1),
        ] {
            assert_eq!(digits(value, moved, 4), n, "{value} {moved}");
        }
    }

    #[test]
    fn the_displacement_of_the_paper_is_impossible_with_its_own_clearance_only() {
        let mut config = Config::table1().unwrap();
        assert!(is_impossible("0.00054", &config));
        assert!((contact_at(PAPER_X01, &config).0 - 4400.0).abs() < 1e-9);
        assert!(!is_impossible("0.000054", &config));
        config.joints[0].joint.clearance = 1e-3;
        assert!(!is_impossible("0.00054", &config));
    }

    #[test]
    fn the_force_of_a_displacement_is_that_of_the_contact_law() {
        let of = |sets: &[&str]| {
            let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
            contact_at(PAPER_X01, &Config::load(None, &sets).unwrap())
        };
        // F = (π/2) L E* δ √(δ/(2(ΔR + δ))) of Liu, by hand some 4.8 N.
        let (force, _) = of(&["contact.law=liu", "contact.young_modulus=1e6"]);
        assert!((force - 4.8).abs() < 0.2, "{force}");
        let (force, energy) = of(&["contact.law=johnson", "contact.length=1e-4"]);
        assert!(force.is_infinite() && energy.is_infinite(), "{force} {energy}");
    }
}
