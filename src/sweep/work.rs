//! The chunks of a sweep over threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use deltazero_study::parallel::on_threads;

use super::chunks::{Chunks, Rows};
use super::{Runner, Sweep};
use crate::whole::FileError;

/// The rows of a chunk under way are not written more often than this.
const PAUSE: Duration = Duration::from_secs(10);

/// What is to be done.
pub struct Work<'a> {
    /// Of which sweep.
    pub sweep: &'a Sweep,
    /// Where its rows go.
    pub chunks: &'a Chunks,
    /// Threads.
    pub threads: usize,
    /// Ends it after the runs that are under way; those that are begun together may take two seconds.
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

/// Makes the chunks of these numbers, or those up to a stop, of which the rows so far are kept.
///
/// A thread takes one chunk after the other; a further thread writes them, so that no run waits for the disk.
///
/// # Errors
/// The first file that could not be written; the threads then end as at a stop.
pub fn work(work: &Work<'_>, numbers: &[u64]) -> Result<(), FileError> {
    let (failed, refused) = (AtomicBool::new(false), Mutex::new(None));
    let written = std::thread::scope(|scope| {
        let (send, receive) = sync_channel(1);
        let writer = scope.spawn(|| write(work.chunks, receive, &failed));
        let init = || (work.sweep.runner(), send.clone());
        on_threads(numbers, work.threads, init, |(runner, send), _, chunk| {
            let made = make(work, runner, *chunk, &failed, send);
            if let (Err(error), Ok(mut first)) = (made, refused.lock()) {
                failed.store(true, Ordering::Relaxed);
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
fn write(chunks: &Chunks, receive: Receiver<Whole>, failed: &AtomicBool) -> Result<(), FileError> {
    for (chunk, rows) in receive {
        chunks.write(chunk, &rows).inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
    }
    Ok(())
}

/// Makes the rest of a chunk.
fn make(
    work: &Work<'_>,
    runner: &mut Runner<'_>,
    chunk: u64,
    failed: &AtomicBool,
    send: &SyncSender<Whole>,
) -> Result<(), FileError> {
    let is_over = || work.stop.load(Ordering::Relaxed) || failed.load(Ordering::Relaxed);
    if is_over() {
        return Ok(());
    }
    let mut rows = work.chunks.read_begun(chunk)?.unwrap_or_default();
    (work.made)(Made::Known(rows.n));
    let (mut n_written, mut written) = (rows.n, Instant::now());
    let runs = work.chunks.runs(chunk);
    while runs.start + rows.n < runs.end && !is_over() {
        for is_ok in runner.some(runs.start + rows.n..runs.end, &mut rows.text, &is_over) {
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
