//! How far many short runs have come: rate, share, time left.

use std::io::{IsTerminal as _, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::progress::{Bar, spoken};

/// The bar is not drawn more often than this [ms].
const PAUSE: u64 = 200;
/// Where there is no terminal, a line is not written more often than this [ms].
const PAUSE_OF_LINES: u64 = 60_000;

/// Counts runs, and shows them.
pub(super) struct Meter {
    bar: Bar,
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

impl Meter {
    /// `known` of `of` runs are there; the others are made from now on.
    pub(super) fn new(quiet: bool, known: u64, of: u64) -> Self {
        let bar = Bar::new(quiet);
        bar.tick();
        let has_terminal = stderr().is_terminal();
        let (known, made) = (AtomicU64::new(known), AtomicU64::new(0));
        let due = AtomicU64::new(if has_terminal { PAUSE } else { PAUSE_OF_LINES });
        Self { bar, quiet, has_terminal, start: Instant::now(), known, made, of, due }
    }

    /// So many more were there before.
    pub(super) fn known(&self, n: u64) {
        self.known.fetch_add(n, Ordering::Relaxed);
    }

    /// One more was made.
    pub(super) fn made(&self) {
        self.made.fetch_add(1, Ordering::Relaxed);
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
        let (made, elapsed) = (self.made.load(Ordering::Relaxed), self.start.elapsed());
        let done = made + self.known.load(Ordering::Relaxed);
        let rate = made as f64 / elapsed.as_secs_f64();
        let left = Duration::try_from_secs_f64(self.of.saturating_sub(done) as f64 / rate);
        let left =
            left.map_or_else(|_| String::new(), |left| format!(", some {} left", spoken(left)));
        let text = format!("{rate:.0} runs/s{left}");
        if self.has_terminal {
            self.bar.show_part(done as usize, self.of as usize, text);
        } else {
            let share = 100.0 * done as f64 / self.of as f64;
            self.bar.line(&format!("{done} of {} runs ({share:.1} %), {text}", self.of));
        }
    }

    /// Says how fast it went.
    pub(super) fn end(self, threads: usize) {
        let (made, seconds) = (self.made.into_inner(), self.start.elapsed().as_secs_f64());
        let rate = made as f64 / seconds;
        let threads =
            if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") };
        self.bar.line(&format!("{made} runs in {seconds:.2} s: {rate:.0} runs/s on {threads}"));
    }
}
