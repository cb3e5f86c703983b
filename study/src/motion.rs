//! The motion of a subject as a figure shows it: the whole run, and one flight with the impact after it.

use deltazero_solvers::Method;

use crate::part::{Part, Subject, counted};
use crate::run::{Accuracy, Limits, ModeChange, Price, Setting};
use crate::setting::Events;
use crate::simulation::SiteMotion;

/// Tolerance of the run that is shown: beyond what a picture can tell.
const RTOL: f64 = 1e-10;
/// Points over the whole run, and over the zoom.
const POINTS: u32 = 4000;
const ZOOM_POINTS: u32 = 1000;
/// Time shown before and after the flight that is zoomed in on, in flights.
const MARGIN: f64 = 0.6;
/// Zoom of a run without a flight, as a fraction of it.
const FIRST_PART: f64 = 0.02;

/// The motion of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The whole run: the first site of each part.
    pub sites: Vec<SiteMotion>,
    /// The first of them around its first flight: the end of a contact, the flight, and the contact after it; the first
    /// part of the run if there is none.
    pub zoom: SiteMotion,
    /// When that flight begins and ends [s], if there is one.
    pub flight: Option<(f64, f64)>,
    /// How it was computed.
    pub method: String,
}

impl Motion {
    /// The motion of `subject` to `t_end` by `rk45` located at rtol 1e-10; none of a subject without parts.
    pub fn new(subject: &Subject, t_end: f64, limits: Limits<'_>) -> Option<Self> {
        let method = Method::named("rk45")?;
        let setting =
            Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(RTOL, None) };
        let run = |part: &Part, times: &[f64], t_end: f64| {
            let mut watch = limits.watch(Price::of_setting(&setting));
            part.motion(&setting, times, t_end, &mut watch)
        };
        let spacing = t_end / f64::from(POINTS);
        let times: Vec<f64> = (1..=POINTS).map(|k| (spacing * f64::from(k)).min(t_end)).collect();
        let sites: Vec<_> =
            subject.parts.iter().filter_map(|part| run(part, &times, t_end)).collect();
        let (part, first) = (subject.parts.first()?, sites.first()?);
        let changes: Vec<ModeChange> = first.changes.iter().map(|change| change.by_code).collect();
        let flight = first_flight(counted(&changes, part.starts_on_surface))
            .or_else(|| first_flight(&sampled(first)));
        let (from, to) = flight.map_or((0.0, FIRST_PART * t_end), |flight| around(flight, t_end));
        let spacing = (to - from) / f64::from(ZOOM_POINTS);
        let times: Vec<f64> = (0..=ZOOM_POINTS).map(|k| from + spacing * f64::from(k)).collect();
        let mut zoom = run(part, &times, to)?;
        zoom.changes.retain(|change| from <= change.t && change.t <= to);
        let method = setting.to_string();
        Some(Self { zoom, flight, method, sites })
    }
}

/// Where a site is in contact and where not, from its samples alone: events of other sites change that too.
fn sampled(site: &SiteMotion) -> Vec<ModeChange> {
    let contact = |i: usize| i8::from(site.touches[i].0);
    let change = |i: usize| ModeChange::new(site.times[i], contact(i - 1), contact(i));
    let all = (1..site.touches.len()).map(change);
    all.filter(|change| change.before != change.after).collect()
}

/// The first flight from one event to the next, if there is one.
fn first_flight(events: &[ModeChange]) -> Option<(f64, f64)> {
    let flight = events.windows(2).find(|pair| pair[0].after == 0 && pair[1].before == 0)?;
    Some((flight[0].t, flight[1].t))
}

/// From before a flight to after it.
fn around((from, to): (f64, f64), t_end: f64) -> (f64, f64) {
    let margin = MARGIN * (to - from);
    ((from - margin).max(0.0), (to + 2.0 * margin).min(t_end))
}
