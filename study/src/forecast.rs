//! How long is left of jobs that differ much in length: expected beforehand, corrected by those that are done.

use std::time::Duration;

/// From this part of the work on what is done tells of what is left.
const TELLING: f64 = 0.02;

/// What jobs are expected to take, in the order in which they are begun.
#[derive(Clone, Debug)]
pub struct Forecast {
    /// Expected time of each job [s], and whether it is done.
    jobs: Vec<(f64, bool)>,
    /// Jobs at a time.
    threads: usize,
    /// Expected time of the jobs that are done [s].
    expected: f64,
    /// Time that they took [s].
    took: f64,
}

impl Forecast {
    /// The forecast of jobs that are begun in this order on `threads`, each expected to take so long [s].
    pub fn new(expected: Vec<f64>, threads: usize) -> Self {
        let jobs = expected.into_iter().map(|expected| (expected, false)).collect();
        Self { jobs, threads: threads.max(1), expected: 0.0, took: 0.0 }
    }

    /// The job at this place is done, and took so long.
    pub fn done(&mut self, place: usize, took: Duration) {
        let Some((expected, is_done)) = self.jobs.get_mut(place) else { return };
        if !std::mem::replace(is_done, true) {
            self.expected += *expected;
            self.took += took.as_secs_f64();
        }
    }

    /// The job at this place was done before: it tells nothing of the others.
    pub fn known(&mut self, place: usize) {
        if let Some((_, is_done)) = self.jobs.get_mut(place) {
            *is_done = true;
        }
    }

    /// Whether enough is done to tell by: a fiftieth of what is expected.
    pub fn tells(&self) -> bool {
        let all: f64 = self.jobs.iter().map(|(expected, _)| expected).sum();
        self.expected >= TELLING * all
    }

    /// The time left: that of all that is not done, each begun on the thread that is free first, by what was expected
    /// times what the others took more.
    ///
    /// A job under way counts as a whole.
    pub fn left(&self) -> Duration {
        let mut busy = vec![0.0_f64; self.threads];
        for (expected, _) in self.jobs.iter().filter(|(_, is_done)| !is_done) {
            if let Some(first) = busy.iter_mut().min_by(|a, b| a.total_cmp(b)) {
                *first += expected;
            }
        }
        let longer = if self.expected > 0.0 { self.took / self.expected } else { 1.0 };
        let left = longer * busy.into_iter().fold(0.0, f64::max);
        Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(forecast: &Forecast) -> f64 {
        forecast.left().as_secs_f64()
    }

    #[test]
    fn the_time_left_is_that_of_the_thread_which_is_busy_longest() {
        assert_eq!(seconds(&Forecast::new(vec![3.0, 2.0, 2.0], 1)), 7.0);
        assert_eq!(seconds(&Forecast::new(vec![3.0, 2.0, 2.0], 2)), 4.0);
        assert_eq!(seconds(&Forecast::new(vec![8.0, 2.0, 2.0], 2)), 8.0);
        assert_eq!(seconds(&Forecast::new(Vec::new(), 2)), 0.0);
    }

    #[test]
    fn jobs_that_were_done_before_correct_nothing() {
        let mut forecast = Forecast::new(vec![4.0, 2.0, 2.0], 1);
        forecast.known(0);
        assert_eq!(seconds(&forecast), 4.0);
        assert!(!forecast.tells());
    }

    #[test]
    fn jobs_that_are_done_correct_what_is_expected_of_the_others() {
        let mut forecast = Forecast::new(vec![4.0, 2.0, 2.0], 1);
        forecast.done(0, Duration::from_secs(12));
        assert_eq!(seconds(&forecast), 12.0);
        assert!(forecast.tells());
        forecast.done(0, Duration::from_secs(99));
        forecast.done(2, Duration::from_secs(6));
        assert_eq!(seconds(&forecast), 6.0);
        forecast.done(1, Duration::from_secs(6));
        assert_eq!(seconds(&forecast), 0.0);
    }
}
