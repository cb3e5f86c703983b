//! What becomes of the paper's deployment under each reading: the runs that its claims are judged by.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::Method;
use deltazero_study::parallel::in_parallel;
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;
use deltazero_study::work_precision::Progress;
use serde::{Deserialize, Serialize};

use super::claims::{ClaimRow, claims};
use super::deployment::{Course, RunRow, course, under};
use super::ideal::{IdealRow, ideal, without_clearance};
use super::torque_ratio::{TorqueRatio, torque_ratio};
use crate::config::Config;
use crate::keys::ReadingName;
use crate::model::Block;

/// Method and relative tolerance of the runs.
///
/// All ten to 90° take 0.5 s by vern98 at 1e-11, 0.7 s by dop853, 1.0 s by taylor; from 1e-9 on the times
/// at which AF arrives are equal to 1e-9 s.
const RUN_BY: (&str, f64) = ("vern98", 1e-12);

/// The paper's deployment under every reading, and its claims.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Audit {
    /// One row a claim and reading.
    pub rows: Vec<ClaimRow>,
    /// The joints without clearance, by quadrature and by integration.
    pub ideal: Vec<IdealRow>,
    /// The run of each joint under each reading, the ideal ones first.
    pub runs: Vec<RunRow>,
    /// Which torques bring both struts to 90° together.
    pub torque_ratio: TorqueRatio,
    /// Method and setting of the runs.
    pub method: String,
    /// Clearance of joint 1 [m].
    pub clearance_m: f64,
    /// How the joints move, in the order of `runs`; not kept in files.
    #[serde(skip)]
    pub courses: Vec<Course>,
}

impl Audit {
    /// The course of a joint under a reading, or without clearance.
    pub fn course(&self, reading: Option<ReadingName>, joint: usize) -> Option<&Course> {
        self.courses
            .iter()
            .find(|course| course.run.reading == reading && course.run.joint == joint)
    }

    /// What was found of a claim under a reading, or under `ideal`.
    pub fn row(&self, claim: &str, reading: &str) -> Option<&ClaimRow> {
        self.rows.iter().find(|row| row.claim == claim && row.reading == reading)
    }
}

/// Runs every reading to 90°, judges every claim and finds the torque ratios, on `threads` threads,
/// which change nothing else. The torques, struts, joints and `study.max_rhs` and `study.max_seconds` of `config` are used, no other key.
///
/// Once `stop` is set the result is worthless.
pub fn audit(
    config: &Config,
    threads: usize,
    stop: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Option<Audit> {
    let (name, rtol) = RUN_BY;
    let method = Method::named(name)?;
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) };
    let limits = crate::study::plan::limits(config, stop);
    let ideals = without_clearance(config, config.strut.inertia);
    let mut jobs: Vec<(Option<ReadingName>, Block)> = Vec::new();
    jobs.extend(ideals.into_iter().map(|block| (None, block)));
    for &reading in ReadingName::ALL {
        let blocks = under(config, reading);
        jobs.extend(blocks.into_iter().map(|block| (Some(reading), block)));
    }
    progress(Progress::Runs(jobs.len() + super::torque_ratio::jobs(config).len()));
    let courses = in_parallel(&jobs, threads, |(reading, block)| {
        let course = course(*reading, block, &setting, limits);
        let name = reading.map_or("ideal", ReadingName::name);
        progress(Progress::Done(format!("{name}, joint {}", block.joint)));
        course
    });
    let torque_ratio = torque_ratio(config, threads, limits, progress);
    let rows = claims(config, &courses, &torque_ratio);
    Some(Audit {
        rows,
        ideal: ideal(config),
        runs: courses.iter().map(|course| course.run.clone()).collect(),
        torque_ratio,
        method: setting.to_string(),
        clearance_m: config.joints[0].joint.clearance,
        courses,
    })
}
