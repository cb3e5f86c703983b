//! The one stopwatch: time on the wall, and of the processor.

use std::iter::Sum;
use std::ops::Add;
use std::time::{Duration, Instant};

/// What a piece of work took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Took {
    /// Time that went by.
    pub wall: Duration,
    /// Time of the processor in the thread that did it, which other work on the machine hardly prolongs; that on the
    /// wall where the system does not tell.
    pub cpu: Duration,
}

impl Took {
    /// A share of it, of `n` alike.
    pub fn share(self, n: usize) -> Self {
        let each = |time: Duration| time.div_f64(n.max(1) as f64);
        Self { wall: each(self.wall), cpu: each(self.cpu) }
    }
}

impl Add for Took {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { wall: self.wall + other.wall, cpu: self.cpu + other.cpu }
    }
}

impl Sum for Took {
    fn sum<I: Iterator<Item = Self>>(each: I) -> Self {
        each.fold(Self::default(), Add::add)
    }
}

/// A stopwatch that runs.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    cpu: Option<Duration>,
}

impl Stopwatch {
    /// Starts it; it is to be read by the same thread.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: of_thread() }
    }

    /// What went by since then.
    pub fn took(&self) -> Took {
        let (wall, now) = (self.wall.elapsed(), of_thread());
        let cpu = now.zip(self.cpu).and_then(|(now, then)| now.checked_sub(then));
        Took { wall, cpu: cpu.unwrap_or(wall) }
    }
}

/// Time of the processor in this thread, where the system tells.
#[cfg(any(
    target_os = "linux",
    target_os = "android",
    target_vendor = "apple",
    target_os = "freebsd",
    target_os = "dragonfly",
    target_os = "netbsd",
    target_os = "openbsd"
))]
fn of_thread() -> Option<Duration> {
    nix::time::ClockId::CLOCK_THREAD_CPUTIME_ID.now().ok().map(Duration::from)
}

#[cfg(not(any(
    target_os = "linux",
    target_os = "android",
    target_vendor = "apple",
    target_os = "freebsd",
    target_os = "dragonfly",
    target_os = "netbsd",
    target_os = "openbsd"
)))]
fn of_thread() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_thread_that_waits_takes_no_time_of_the_processor() {
        let watch = Stopwatch::start();
        std::thread::sleep(Duration::from_millis(50));
        let took = watch.took();
        assert!(took.wall >= Duration::from_millis(50), "{took:?}");
        // Measured: some 0.1 ms.
        assert!(took.cpu < Duration::from_millis(10), "{took:?}");
    }

    #[test]
    fn shares_add_up() {
        let took = Took { wall: Duration::from_millis(6), cpu: Duration::from_millis(4) };
        assert_eq!([took.share(2); 2].into_iter().sum::<Took>(), took);
    }
}
