//! The progress bar.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::Duration;

use deltazero_solvers::Stats;
use deltazero_study::run::Brake;
use deltazero_study::work_precision::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::say;

/// Work that is done before this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Steps between two looks at the clock: some hundred microseconds.
const STEPS_A_LOOK: u32 = 1024;

/// A time as one would say it.
pub(super) fn spoken(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 100.0 { format!("{seconds:.0} s") } else { format!("{:.0} min", seconds / 60.0) }
}

/// Stands between the time left and what was done last.
const LEFT: &str = " left: ";

/// A bar on standard error that appears once the work takes long; none where that is no terminal,
/// or by wish.
pub(super) struct Bar {
    bar: ProgressBar,
    quiet: bool,
}

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) =
            ProgressStyle::with_template("{elapsed:>4} {bar:20} {pos}/{len} {wide_msg}")
        {
            bar.set_style(style);
        }
        Self { bar, quiet }
    }

    pub(super) fn show(&self, progress: Progress) {
        match progress {
            Progress::Runs(n) => self.bar.set_length(n as u64),
            Progress::Row(_) => {}
            Progress::Left(left) => {
                let before = self.bar.message();
                let what = before.split_once(LEFT).map_or(before.as_str(), |(_, what)| what);
                self.bar.set_message(format!("some {}{LEFT}{what}", spoken(left)));
            }
            Progress::Done(what) => {
                self.bar.inc(1);
                self.bar.set_message(what);
            }
        }
        self.appear();
    }

    fn appear(&self) {
        if !self.quiet && self.bar.is_hidden() && self.bar.elapsed() >= PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }

    /// So many of so many are done; `what` is under way.
    pub(super) fn show_part(&self, n: usize, of: usize, what: String) {
        self.bar.set_length(of as u64);
        self.bar.set_position(n as u64);
        self.bar.set_message(what);
        self.appear();
    }

    /// Has the time go on while nothing is reported.
    pub(super) fn tick(&self) {
        self.bar.enable_steady_tick(PATIENCE);
    }

    /// Says a line on standard error, above the bar.
    pub(super) fn line(&self, text: &str) {
        if !self.quiet {
            self.bar.suspend(|| say(text));
        }
    }

    pub(super) fn say(&self, what: &'static str) {
        self.bar.set_message(what);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A bar for the time of one run, block after block, that appears once the run takes long.
pub(super) struct TimeBar {
    bar: ProgressBar,
    shown: Cell<bool>,
    quiet: bool,
}

impl TimeBar {
    pub(super) fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
        if let Ok(style) =
            ProgressStyle::with_template("{elapsed:>4} {bar:20} {percent}% {wide_msg}")
        {
            bar.set_style(style);
        }
        let shown = Cell::new(false);
        Self { bar, shown, quiet }
    }

    /// A brake that shows how far the part number `i` of `n`, called `name`, has come to `t_end` [s], and leaves
    /// the braking to another.
    pub(super) fn over<B: Brake>(
        &self,
        inner: B,
        (i, n): (usize, usize),
        name: &str,
        t_end: f64,
    ) -> TimeOf<'_, B> {
        TimeOf { bar: self, inner, i, n, name: name.to_owned(), t_end, steps: 0 }
    }

    /// Says what is done after the runs, where they took long.
    pub(super) fn say(&self, what: &'static str) {
        self.show(1.0, what.to_owned());
    }

    fn show(&self, part: f64, message: String) {
        if self.quiet || self.bar.elapsed() < PATIENCE {
            return;
        }
        if !self.shown.replace(true) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_message(message);
        self.bar.set_position((1000.0 * part) as u64);
    }
}

impl Drop for TimeBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// See [`TimeBar::over`].
pub(super) struct TimeOf<'a, B> {
    bar: &'a TimeBar,
    inner: B,
    i: usize,
    n: usize,
    name: String,
    t_end: f64,
    steps: u32,
}

impl<B: Brake> Brake for TimeOf<'_, B> {
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.steps = self.steps.wrapping_add(1);
        if self.steps.is_multiple_of(STEPS_A_LOOK) {
            let done = self.i as f64 + (t / self.t_end).clamp(0.0, 1.0);
            let message = format!("{} t = {t:.3e} s", self.name);
            self.bar.show(done / self.n as f64, message);
        }
        self.inner.step(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.inner.rejected(stats)
    }

    fn event(&mut self) -> ControlFlow<()> {
        self.inner.event()
    }
}
