//! How a reference was made, and how good it is.

use serde::{Deserialize, Serialize};

use crate::balance::Balance;
use crate::digits::{as_meant, in_short, rounded_to};
use crate::errors::Largest;
use crate::json_number;
use crate::setting::chooses;
use crate::warning::Warning;

/// What is said where a part has no sample by which runs could be compared.
const NO_SAMPLE: &str = "a part has no sample between its start and its end or horizon, so e is not defined; shorten run.sample, or start it where it does not end at once";

/// The scale of a group of states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleSummary {
    /// Name of the group; with its part where parts have it by different scales.
    pub group: String,
    /// Unit of its states.
    pub unit: String,
    /// The scale, in that unit.
    pub scale: f64,
    /// Whether it is the largest length that the group takes.
    pub is_largest: bool,
}

/// The reference of one site, in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiteSummary {
    /// Its name.
    pub name: String,
    /// Events that runs are compared by.
    pub n_events: usize,
    /// Impulse of its contacts [N s], where there are any.
    pub impulse_n_s: Option<f64>,
}

/// The reference of one part, in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartSummary {
    /// Its name.
    pub name: String,
    /// The time up to which it is predictable [s].
    pub horizon_s: f64,
    /// The end of its run [s].
    pub t_end_s: f64,
    /// Its sites.
    pub sites: Vec<SiteSummary>,
}

/// How a reference was made, and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSummary {
    /// The method and setting of the reference run.
    pub method: String,
    /// The method and setting of the run that tells its error.
    pub check: String,
    /// Its error: the largest `e` between both, within the horizon; not a number where a part has no sample there.
    #[serde(with = "json_number::one")]
    pub agreement: f64,
    /// The error of its event times: the largest difference between both, within the horizon [s]; none
    /// where their sequences differ.
    #[serde(default, with = "json_number::maybe")]
    pub event_time_agreement_s: Option<f64>,
    /// What errors are measured in.
    pub scales: Vec<ScaleSummary>,
    /// Part by part.
    pub parts: Vec<PartSummary>,
    /// Energy balance, all parts together, where it is known.
    pub energy: Option<Balance>,
    /// What its runs tell of themselves.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

impl ReferenceSummary {
    /// Whether the reference is good enough to tell which runs reach an error `e`.
    pub fn can_decide(&self, e: f64) -> bool {
        self.unsound().is_none() && self.agreement <= 0.1 * e
    }

    /// Whether the method called `name` is another than it was made and checked by, as `auto` may not be.
    pub fn is_made_without(&self, name: &str) -> bool {
        let words = [&self.method, &self.check].map(|text| text.split([' ', ':']));
        !chooses(name) && words.into_iter().flatten().all(|word| word != name)
    }

    /// The warning by which its runs are wrong, if they are.
    fn unsound(&self) -> Option<&Warning> {
        self.warnings.iter().find(|warning| warning.code.is_of_a_wrong_run())
    }

    /// Why it does not decide on some error, in words.
    pub fn undecided(&self) -> String {
        match self.unsound() {
            Some(warning) => {
                format!("the reference is wrong, by its own account: {}", warning.message)
            }
            None if self.agreement.is_nan() => NO_SAMPLE.to_owned(),
            None => format!("the reference is good to {:.1e}", self.agreement),
        }
    }

    /// Its own error to two digits; a dash where it is not defined.
    pub fn own_error(&self) -> String {
        if self.agreement.is_nan() { "–".to_owned() } else { format!("{:.1e}", self.agreement) }
    }

    /// Those of the `warnings` of another run that are its own: that it is wrong, or what the reference does not have,
    /// as what both have is the motion's.
    pub fn not_shared(&self, mut warnings: Vec<Warning>) -> Vec<Warning> {
        let is_shared =
            |warning: &Warning| self.warnings.iter().any(|own| own.code == warning.code);
        warnings.retain(|warning| warning.code.is_of_a_wrong_run() || !is_shared(warning));
        warnings
    }

    /// The sites of all parts.
    pub fn sites(&self) -> impl Iterator<Item = &SiteSummary> {
        self.parts.iter().flat_map(|part| &part.sites)
    }

    /// What `e` is, in words: `larger of |Δ pin|/1e-4 m and |Δ angle|/0.0202 rad`.
    pub fn measure(&self) -> String {
        let group = |own: &ScaleSummary| {
            let unit = if own.unit.is_empty() { String::new() } else { format!(" {}", own.unit) };
            format!("|Δ {}|/{}{unit}", own.group, in_short(rounded_to(own.scale, 4)))
        };
        let groups: Vec<String> = self.scales.iter().map(group).collect();
        match groups.split_last() {
            Some((last, rest)) if !rest.is_empty() => {
                let size = if rest.len() == 1 { "larger" } else { "largest" };
                format!("{size} of {} and {last}", rest.join(", "))
            }
            _ => groups.concat(),
        }
    }

    /// The largest lengths that groups are measured by.
    pub fn largest(&self) -> Largest {
        let own = self.scales.iter().filter(|scale| scale.is_largest);
        Largest::known(own.map(|scale| (scale.group.clone(), scale.scale)))
    }

    /// The horizon of each part [s].
    pub fn horizons(&self) -> String {
        let horizons = self.parts.iter().map(|part| as_meant(part.horizon_s));
        horizons.collect::<Vec<_>>().join(" and ")
    }

    /// What it cannot serve for, a sentence each.
    pub fn limits(&self) -> Vec<String> {
        let mut limits = Vec::new();
        limits.extend(self.warnings.iter().map(|warning| warning.message.clone()));
        if self.agreement.is_nan() {
            limits.push(NO_SAMPLE.to_owned());
        }
        if self.agreement > 1e-10 {
            let good = self.agreement;
            limits.push(format!(
                "the reference is good to e = {good:.1e}: it decides nothing below ten times that"
            ));
        }
        if self.event_time_agreement_s.is_none() {
            limits.push("its two runs differ in their events: missed, spurious and event times are doubtful".into());
        }
        for PartSummary { name, horizon_s, t_end_s, .. } in &self.parts {
            if horizon_s < t_end_s {
                let name = if name.is_empty() { "the motion" } else { name };
                let horizon_s = as_meant(*horizon_s);
                limits.push(format!(
                    "{name} is predictable up to {horizon_s} s of {t_end_s} s: beyond, only the number of events, impulse and dissipation are compared"
                ));
            }
        }
        limits
    }
}
