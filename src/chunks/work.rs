//! Chunks over threads.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use deltazero_study::parallel::on_threads;

use super::{Chunks, Rows};
use crate::atomic_file::FileError;

/// The rows of a chunk under way are not written more often than this.
const PAUSE: Duration = Duration::from_secs(10);

/// What makes runs, on one thread.
pub trait Maker {
    /// Makes the first few of `runs`, as many as are best made together, and adds a row of each to `rows`. Returns of each
    /// whether it came to its end. Once `is_over` says so, it makes no more than it has to, or none.
    fn some(
        &mut self,
        runs: Range<u64>,
        rows: &mut String,
        is_over: &dyn Fn() -> bool,
    ) -> Vec<bool>;
}

/// What is to be done.
pub struct Work<'a> {
    /// Where the rows go.
    pub chunks: &'a Chunks,
    /// Threads.
    pub threads: usize,
    /// Ends it after the runs that are under way; set by a file that cannot be written.
    pub stop: &'a AtomicBool,
    /// Told of what is done.
    pub made: &'a (dyn Fn(Made) + Sync),
}

/// What was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// A run; whether it came to its end.
    Run(bool),
    /// So many rows were there already, of a chunk that was begun.
    Known(u64),
}

/// A chunk that is whole.
type Whole = (u64, Rows);

/// Has the chunks of these numbers made, each thread by a `maker` of its own, or those up to a stop, of which the rows so far
/// are kept.
///
/// A thread takes one chunk after the other; a further thread writes them, so that no run waits for the disk.
///
/// # Errors
/// The first file that could not be written.
pub fn work<M: Maker>(
    work: &Work<'_>,
    numbers: &[u64],
    maker: impl Fn() -> M + Sync,
) -> Result<(), FileError> {
    let refused = Mutex::new(None);
    let written = std::thread::scope(|scope| {
        let (send, receive) = sync_channel(1);
        let writer = scope.spawn(|| write(work, receive));
        let init = || (maker(), send.clone());
        on_threads(numbers, work.threads, init, |(maker, send), _, chunk| {
            let made = make(work, maker, *chunk, send);
            if let (Err(error), Ok(mut first)) = (made, refused.lock()) {
                work.stop.store(true, Ordering::Relaxed);
                first.get_or_insert(error);
            }
        });
        drop(send);
        // The thread has no way to panic.
        writer.join().unwrap_or(Ok(()))
    });
    written.and(refused.into_inner().ok().flatten().map_or(Ok(()), Err))
}

/// Writes what comes.
fn write(work: &Work<'_>, receive: Receiver<Whole>) -> Result<(), FileError> {
    for (chunk, rows) in receive {
        let written = work.chunks.write(chunk, &rows);
        written.inspect_err(|_| work.stop.store(true, Ordering::Relaxed))?;
    }
    Ok(())
}

/// Makes the rest of a chunk.
fn make(
    work: &Work<'_>,
    maker: &mut impl Maker,
    chunk: u64,
    send: &SyncSender<Whole>,
) -> Result<(), FileError> {
    let is_over = || work.stop.load(Ordering::Relaxed);
    if is_over() {
        return Ok(());
    }
    let mut rows = work.chunks.read_begun(chunk)?.unwrap_or_default();
    (work.made)(Made::Known(rows.n));
    let (mut n_written, mut written) = (rows.n, Instant::now());
    let runs = work.chunks.runs(chunk);
    while runs.start + rows.n < runs.end && !is_over() {
        for is_ok in maker.some(runs.start + rows.n..runs.end, &mut rows.text, &is_over) {
            rows.n += 1;
            rows.failed += u64::from(!is_ok);
            (work.made)(Made::Run(is_ok));
        }
        if written.elapsed() >= PAUSE && runs.start + rows.n < runs.end {
            work.chunks.write_begun(chunk, &rows)?;
            (n_written, written) = (rows.n, Instant::now());
        }
    }
    if runs.start + rows.n == runs.end {
        // Where nobody receives any more, a file could not be written, which is told.
        let _ = send.send((chunk, rows));
    } else if rows.n > n_written {
        work.chunks.write_begun(chunk, &rows)?;
    }
    Ok(())
}
