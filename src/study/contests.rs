//! The contests of a map as runs in [chunks](crate::chunks): a row a site, with its contests as JSON.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use deltazero_study::Subject;
use deltazero_study::map::{Contested, MapPlan, contested};
use serde_json::json;

use crate::atomic_file::FileError;
use crate::chunks::{Chunks, Maker, Rows};

/// Runs the contests of sites, each the only run of its chunk.
pub struct Contests<'a> {
    /// What is studied on the site of a number.
    pub subject: &'a (dyn Fn(u64) -> Subject + Sync),
    /// What every contest has.
    pub plan: &'a MapPlan,
    /// Breaks a contest off, of which nothing is then kept.
    pub stop: &'a AtomicBool,
    /// Told of each site that is done, and what it took.
    pub done: &'a (dyn Fn(u64, Duration) + Sync),
}

impl Maker for Contests<'_> {
    fn some(&mut self, runs: Range<u64>, rows: &mut String, _: &dyn Fn() -> bool) -> Vec<bool> {
        let start = Instant::now();
        let contests = contested((self.subject)(runs.start), self.plan, self.stop);
        if self.stop.load(Ordering::Relaxed) {
            return Vec::new();
        }
        rows.push_str(&row(&contests));
        (self.done)(runs.start, start.elapsed());
        vec![true]
    }
}

fn row(contests: &[Contested]) -> String {
    format!("{}\n", json!(contests))
}

/// Keeps contests that an earlier version kept elsewhere.
///
/// # Errors
/// They cannot be written.
pub fn keep(chunks: &Chunks, site: u64, contests: &[Contested]) -> Result<(), FileError> {
    chunks.write(site, &Rows { text: row(contests), n: 1, failed: 0 })
}

/// The contests of every site, those that are kept.
///
/// # Errors
/// They cannot be read.
pub fn kept(chunks: &Chunks) -> Result<Vec<Option<Vec<Contested>>>, FileError> {
    let of_site = |site| {
        let rows = chunks.read(site)?;
        Ok(rows.and_then(|rows| serde_json::from_str(&rows.text).ok()))
    };
    (0..chunks.n()).map(of_site).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::study::regimes::{map_plan, sites};

    #[test]
    fn contests_are_kept_to_the_bit_and_what_is_broken_off_is_not() {
        let sets =
            ["run.t_end=0.03", "contest.methods=[\"rk45\", \"radau5\"]", "contest.repeats=1"];
        let config = Config::load(None, &sets.map(str::to_owned)).unwrap();
        let (site, plan) = (sites(&config)[0], map_plan(&config));
        let subject = |_| site.subject(&config);
        let stop = AtomicBool::new(false);
        let contests = contested(subject(0), &plan, &stop);
        assert!(contests.iter().any(|own| own.winner().is_some()), "{contests:?}");
        let dir = tempfile::tempdir().unwrap();
        let chunks = Chunks::new(dir.path(), "0123456789abcdef", 2, 1);
        keep(&chunks, 1, &contests).unwrap();
        assert_eq!(kept(&chunks).unwrap(), [None, Some(contests)]);
        stop.store(true, Ordering::Relaxed);
        let done = |_, _| panic!("nothing is done");
        let mut maker = Contests { subject: &subject, plan: &plan, stop: &stop, done: &done };
        let mut rows = String::new();
        assert_eq!(maker.some(0..1, &mut rows, &|| true), [false; 0]);
        assert_eq!(rows, "");
    }
}
