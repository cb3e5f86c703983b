//! What does the pin do: its gap, its forces, its orbit in the bush.

use deltazero_solvers::{Grid, Method, Trajectory};
use deltazero_study::Problem;
use deltazero_study::part::counted;
use deltazero_study::run::{Accuracy, Braked, Limits, ModeChange, Price, Setting, integrate};
use deltazero_study::setting::Events;
use serde::{Deserialize, Serialize};

use crate::config::Config;
use crate::model::{Jointed, Mechanism, Part};
use crate::run::{JointHistory, JointSample, histories};

/// Tolerance of the run that is shown: beyond what a picture can tell.
const RTOL: f64 = 1e-10;
/// Points over the whole run, and over the zoom.
const POINTS: u32 = 4000;
const ZOOM_POINTS: u32 = 1000;
/// Time shown before and after the flight that is zoomed in on, in flights.
const MARGIN: f64 = 0.6;
/// Zoom of a run without a flight, as a fraction of it.
const FIRST_PART: f64 = 0.02;

/// A joint at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionRow {
    /// Joint, 1 or 2.
    pub joint: usize,
    /// Time [s].
    pub t_s: f64,
    /// Mode: 0 free, ±1 slip, 2 stick.
    pub mode: i8,
    /// Pin displacement, x01 or y02 [m].
    pub d1_m: f64,
    /// Pin displacement, y01 or z02 [m].
    pub d2_m: f64,
    /// Penetration δ; below zero the gap [m].
    pub delta_m: f64,
    /// Normal force F_N [N].
    pub f_n_n: f64,
    /// Friction force F_T [N].
    pub f_t_n: f64,
}

/// A slider at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SliderRow {
    /// Time [s].
    pub t_s: f64,
    /// Angle of the crank [rad].
    pub crank_rad: f64,
    /// Acceleration of the slider [m/s²].
    pub slider_m_s2: f64,
    /// The same without clearance [m/s²].
    pub ideal_m_s2: f64,
}

/// The motion of a mechanism.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// The whole run, joint by joint; of several bays that at the root.
    pub rows: Vec<MotionRow>,
    /// The slider over the whole run, where there is one.
    pub slider: Vec<SliderRow>,
    /// Joint 1 around its first flight: the end of a contact, the flight, and the contact after it;
    /// the first part of the run if there is none.
    pub zoom: Vec<MotionRow>,
    /// Whether the zoom is on a flight.
    pub zooms_on_flight: bool,
    /// Mode changes of joint 1 within the zoom: time [s], code of the mode after.
    pub zoom_modes: Vec<(f64, i8)>,
    /// Clearance of each joint [m].
    pub clearance_m: Vec<f64>,
    /// How it was computed.
    pub method: String,
}

/// The motion of `config` by `rk45` located at rtol 1e-10, and a zoom on the first flight of
/// joint 1 after its start (the first part of the run if there is none).
pub fn motion(config: &Config, limits: Limits<'_>) -> Option<Motion> {
    let method = Method::named("rk45")?;
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(RTOL, None) };
    let mechanism = Mechanism::new(config);
    let t_end = config.run.t_end;
    let method = setting.to_string();
    let shown = Shown { setting, limits };
    let spacing = t_end / f64::from(POINTS);
    let times: Vec<f64> = (1..=POINTS).map(|k| (spacing * f64::from(k)).min(t_end)).collect();
    let parts = mechanism.parts.iter();
    let histories: Vec<_> = parts.flat_map(|part| shown.run(part, &times, t_end)).collect();
    let root = histories.first()?;
    let flight = flight_window(&counted(&root.changes, root.block.starts_on_surface()), t_end);
    let (from, to) = flight.unwrap_or((0.0, FIRST_PART * t_end));
    let spacing = (to - from) / f64::from(ZOOM_POINTS);
    let times: Vec<f64> = (0..=ZOOM_POINTS).map(|k| from + spacing * f64::from(k)).collect();
    let zoom = shown.run(mechanism.parts.first()?, &times, to);
    let inside = root.changes.iter().filter(|event| from <= event.t && event.t <= to);
    Some(Motion {
        rows: histories.iter().flat_map(rows_of).collect(),
        slider: histories.iter().flat_map(slider_rows_of).collect(),
        zoom: zoom.iter().flat_map(rows_of).collect(),
        zooms_on_flight: flight.is_some(),
        zoom_modes: inside.map(|event| (event.t, event.after)).collect(),
        clearance_m: mechanism.blocks().iter().map(|block| block.clearance).collect(),
        method,
    })
}

/// How the runs are made that are shown.
struct Shown<'a> {
    setting: Setting,
    limits: Limits<'a>,
}

impl Shown<'_> {
    /// The history of a part at `times`; of several bays that at the root.
    fn run<'p>(&self, part: &'p Part, times: &[f64], t_end: f64) -> Vec<JointHistory<'p>> {
        match part {
            Part::Block(block) => self.history(block, times, t_end),
            Part::Chain(chain) => self.history(chain, times, t_end),
        }
    }

    fn history<'p, P: Jointed>(
        &self,
        part: &'p P,
        times: &[f64],
        t_end: f64,
    ) -> Vec<JointHistory<'p>> {
        let mut watch = self.limits.watch(Price::of_setting(&self.setting));
        let mut record = (Trajectory::on(Grid::Times(times.to_vec())), Braked(&mut watch));
        integrate(part, &self.setting, part.start(), t_end, &mut record);
        histories(part, &record.0, 1)
    }
}

/// From before the first flight to after it, if there is one.
fn flight_window(events: &[ModeChange], t_end: f64) -> Option<(f64, f64)> {
    let flight = events.windows(2).find(|pair| pair[0].after == 0 && pair[1].before == 0)?;
    let margin = MARGIN * (flight[1].t - flight[0].t);
    Some(((flight[0].t - margin).max(0.0), (flight[1].t + 2.0 * margin).min(t_end)))
}

fn slider_rows_of(joint: &JointHistory<'_>) -> Vec<SliderRow> {
    let row = |sample: &JointSample| {
        let slider = joint.block.slider(sample.mode, &sample.y, sample.forces)?;
        Some(SliderRow {
            t_s: sample.t,
            crank_rad: sample.y[2],
            slider_m_s2: slider.acceleration,
            ideal_m_s2: slider.ideal_acceleration,
        })
    };
    joint.samples.iter().filter_map(row).collect()
}

fn rows_of(joint: &JointHistory<'_>) -> Vec<MotionRow> {
    let row = |sample: &JointSample| {
        let [d1_m, d2_m, ..] = sample.y;
        MotionRow {
            joint: joint.block.joint,
            t_s: sample.t,
            mode: sample.mode.code(),
            d1_m,
            d2_m,
            delta_m: joint.block.pose(&sample.y).delta,
            f_n_n: sample.forces.normal,
            f_t_n: sample.forces.tangential,
        }
    };
    joint.samples.iter().map(row).collect()
}
