//! How far runs in chunks have come: rate, share, time left.

use std::io::{IsTerminal as _, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use deltazero::chunks::Made;
use deltazero_study::digits::count_of;

use super::progress::{Bar, spoken};

/// The bar is not drawn more often than this [ms].
const PAUSE: u64 = 200;
/// Where there is no terminal, a line is not written more often than this [ms].
const PAUSE_OF_LINES: u64 = 60_000;

/// Counts runs, and shows them.
pub(super) struct Meter<'a> {
    bar: Bar,
    /// What a run is called, of several.
    what: &'static str,
    /// The time left, where that does not follow from the rate.
    left: &'a (dyn Fn() -> Option<Duration> + Sync),
    quiet: bool,
    has_terminal: bool,
    start: Instant,
    /// Runs that were there before.
    known: AtomicU64,
    /// Runs made since the start.
    made: AtomicU64,
    of: u64,
    /// When it is next to be shown [ms from the start].
    due: AtomicU64,
}

impl<'a> Meter<'a> {
    /// `known` of `of` runs are there; `left` tells the time left of runs that differ much in length.
    pub(super) fn new(
        what: &'static str,
        (known, of): (u64, u64),
        left: &'a (dyn Fn() -> Option<Duration> + Sync),
        quiet: bool,
    ) -> Self {
        let bar = Bar::new(quiet);
        bar.tick();
        let has_terminal = stderr().is_terminal();
        let due = AtomicU64::new(if has_terminal { PAUSE } else { PAUSE_OF_LINES });
        let (known, made) = (AtomicU64::new(known), AtomicU64::new(0));
        let start = Instant::now();
        Self { bar, what, left, quiet, has_terminal, start, known, made, of, due }
    }

    /// Counts what was done.
    pub(super) fn count(&self, made: Made) {
        match made {
            Made::Known(n) => self.known.fetch_add(n, Ordering::Relaxed),
            Made::Run(_) => self.made.fetch_add(1, Ordering::Relaxed),
        };
        if self.quiet {
            return;
        }
        let (now, due) =
            (self.start.elapsed().as_millis() as u64, self.due.load(Ordering::Relaxed));
        let pause = if self.has_terminal { PAUSE } else { PAUSE_OF_LINES };
        let next = now + pause;
        let order = Ordering::Relaxed;
        if now >= due && self.due.compare_exchange(due, next, order, order).is_ok() {
            self.show();
        }
    }

    fn show(&self) {
        let made = self.made.load(Ordering::Relaxed);
        let done = made + self.known.load(Ordering::Relaxed);
        let per_second = made as f64 / self.start.elapsed().as_secs_f64();
        let at_rate =
            || Duration::try_from_secs_f64(self.of.saturating_sub(done) as f64 / per_second).ok();
        let left = (self.left)().or_else(at_rate);
        let left = left.map_or_else(String::new, |left| format!(", some {} left", spoken(left)));
        let text = format!("{}{left}", self.rate(per_second));
        if self.has_terminal {
            self.bar.show_part(done as usize, self.of as usize, text);
        } else {
            let share = 100.0 * done as f64 / self.of as f64;
            self.bar.line(&format!(
                "{done} of {} ({share:.1} %), {text}",
                count_of(self.of, self.what)
            ));
        }
    }

    /// Says how fast it went, if there was anything to be made.
    pub(super) fn end(self, threads: usize) {
        let (made, seconds) =
            (self.made.load(Ordering::Relaxed), self.start.elapsed().as_secs_f64());
        if made == 0 {
            return;
        }
        let rate = self.rate(made as f64 / seconds);
        let (made, threads) = (count_of(made, self.what), count_of(threads, "thread"));
        self.bar.line(&format!("{made} in {seconds:.2} s: {rate} on {threads}"));
    }

    fn rate(&self, per_second: f64) -> String {
        let digits = if per_second < 10.0 { 2 } else { 0 };
        format!("{per_second:.digits$} {}s/s", self.what)
    }
}
