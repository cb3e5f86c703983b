//! Independent jobs on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::Builder;

/// Cores of the machine.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Does each of `jobs`, in their order, on at most `threads` threads; `work` has what `init` made for its thread, and the
/// number of its job.
///
/// The thread that calls is one of them; where the system starts no further one, there are fewer.
pub fn on_threads<J: Sync, S>(
    jobs: &[J],
    threads: usize,
    init: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize, &J) + Sync,
) {
    let next = AtomicUsize::new(0);
    let all = || {
        let mut own = init();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(i) else { break };
            work(&mut own, i, job);
        }
    };
    let more = threads.min(jobs.len()).saturating_sub(1);
    std::thread::scope(|scope| {
        let started = (0..more).map(|_| Builder::new().spawn_scoped(scope, all));
        let _ = started.take_while(Result::is_ok).count();
        all();
    });
}

/// What `work` makes of each of `jobs`, on at most `threads` threads, in the order of the jobs.
pub fn in_parallel<J: Sync, T: Send>(
    jobs: &[J],
    threads: usize,
    work: impl Fn(&J) -> T + Sync,
) -> Vec<T> {
    let places: Vec<Mutex<Option<T>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    on_threads(
        jobs,
        threads,
        || (),
        |(), i, job| {
            let result = work(job);
            if let Some(Ok(mut place)) = places.get(i).map(Mutex::lock) {
                *place = Some(result);
            }
        },
    );
    places.into_iter().filter_map(|place| place.into_inner().ok().flatten()).collect()
}
