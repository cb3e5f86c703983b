//! The contacts of a site in a few numbers.

use serde::Serialize;

use super::contacts::Contact;
use crate::json_number;

/// The contacts of a site, or of several, in a few numbers; what there is none of is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ContactSummary {
    /// Number of contacts.
    pub n: usize,
    /// Largest F_N [N].
    #[serde(with = "json_number::maybe")]
    pub peak_force_n: Option<f64>,
    /// Time of the largest F_N [s].
    #[serde(with = "json_number::maybe")]
    pub peak_force_at_s: Option<f64>,
    /// Deepest penetration δ [m].
    #[serde(with = "json_number::maybe")]
    pub deepest_m: Option<f64>,
    /// Largest δ̇ at which one began, after a flight [m/s].
    #[serde(with = "json_number::maybe")]
    pub largest_impact_speed_m_s: Option<f64>,
    /// Smallest such δ̇ [m/s].
    #[serde(with = "json_number::maybe")]
    pub smallest_impact_speed_m_s: Option<f64>,
    /// `∫ F_N dt` of all contacts together [N s].
    #[serde(with = "json_number::one")]
    pub impulse_n_s: f64,
    /// Duration of the longest contact [s].
    #[serde(with = "json_number::maybe")]
    pub longest_s: Option<f64>,
}

impl ContactSummary {
    /// The summary of `contacts`.
    pub fn of<'a>(contacts: impl Iterator<Item = &'a Contact> + Clone) -> Self {
        let largest = |of: fn(&Contact) -> f64| contacts.clone().map(of).reduce(f64::max);
        let top = contacts.clone().max_by(|a, b| a.peak.total_cmp(&b.peak));
        let speeds = contacts.clone().filter_map(|contact| contact.impact_speed);
        Self {
            n: contacts.clone().count(),
            peak_force_n: top.map(|contact| contact.peak),
            peak_force_at_s: top.map(|contact| contact.peak_at),
            deepest_m: largest(|contact| contact.depth),
            largest_impact_speed_m_s: speeds.clone().reduce(f64::max),
            smallest_impact_speed_m_s: speeds.reduce(f64::min),
            impulse_n_s: contacts.clone().map(|contact| contact.impulse).fold(0.0, |a, b| a + b),
            longest_s: largest(|contact| contact.end - contact.begin),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_takes_the_extremes_of_all_contacts() {
        let contact = |begin: f64, peak, impact_speed| Contact {
            begin,
            end: begin + 0.25 * peak,
            impulse: 0.5,
            peak,
            peak_at: begin + 0.125,
            depth: 1e-7 * peak,
            impact_speed,
        };
        let contacts =
            [contact(0.0, 1.0, None), contact(1.0, 4.0, Some(2e-3)), contact(3.0, 2.0, Some(1e-3))];
        let expected = ContactSummary {
            n: 3,
            peak_force_n: Some(4.0),
            peak_force_at_s: Some(1.125),
            deepest_m: Some(4e-7),
            largest_impact_speed_m_s: Some(2e-3),
            smallest_impact_speed_m_s: Some(1e-3),
            impulse_n_s: 1.5,
            longest_s: Some(1.0),
        };
        assert_eq!(ContactSummary::of(contacts.iter()), expected);
        assert_eq!(ContactSummary::of([].iter()), ContactSummary::default());
    }

    #[test]
    fn a_force_without_bound_is_told_in_json() {
        let own = ContactSummary { peak_force_n: Some(f64::INFINITY), ..ContactSummary::default() };
        let json = serde_json::to_value(own).unwrap();
        assert_eq!((&json["peak_force_n"], &json["impulse_n_s"]), (&"inf".into(), &0.0.into()));
        assert!(json["deepest_m"].is_null());
    }
}
