//! `runs.csv` of all chunks, one after the other.

use std::io::{self, Write};
use std::path::Path;

use super::runner::OK;
use crate::atomic_file::{self, FileError};
use crate::chunks::{Chunks, Rows};
use crate::csv::fields;

/// Failed runs that are told of one by one.
const TOLD: usize = 3;

/// A run that did not come to its end.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Failed {
    /// Its number.
    pub run: u64,
    /// Why.
    pub error: String,
}

/// What the chunks are joined to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Joined {
    /// Chunks that are not as they were written; where there is one, nothing was written.
    pub altered: Vec<u64>,
    /// Runs that did not come to their end.
    pub failed: u64,
    /// The first of them.
    pub first_failed: Vec<Failed>,
    /// Length of the file.
    pub bytes: u64,
}

/// Writes all chunks to `path` after `header`; `n_keys` is the number of columns between `run` and `status`. Each chunk is
/// verified, and in memory alone.
///
/// # Errors
/// A chunk that cannot be read, or a file that cannot be written.
pub fn join(
    chunks: &Chunks,
    header: &str,
    n_keys: usize,
    path: &Path,
) -> Result<Joined, FileError> {
    let mut joined = Joined { bytes: header.len() as u64, ..Joined::default() };
    let mut unread = None;
    let written = atomic_file::write_by(path, |out| {
        out.write_all(header.as_bytes())?;
        for chunk in 0..chunks.n() {
            match chunks.read(chunk) {
                Ok(Some(rows)) => add(&mut joined, &rows, n_keys, out)?,
                Ok(None) => joined.altered.push(chunk),
                Err(error) => {
                    unread = Some(error);
                    break;
                }
            }
        }
        // What is not whole is not given its name.
        if joined.altered.is_empty() && unread.is_none() {
            Ok(())
        } else {
            Err(io::Error::other(""))
        }
    });
    match (unread, written) {
        (Some(error), _) => Err(error),
        (None, Err(error)) if joined.altered.is_empty() => Err(error),
        (None, Err(_)) => Ok(joined),
        (None, Ok(())) => atomic_file::sync_dir(path).map(|()| joined),
    }
}

fn add(joined: &mut Joined, rows: &Rows, n_keys: usize, out: &mut dyn Write) -> io::Result<()> {
    if !joined.altered.is_empty() {
        return Ok(());
    }
    joined.failed += rows.failed;
    joined.bytes += rows.text.len() as u64;
    if rows.failed > 0 && joined.first_failed.len() < TOLD {
        let failed = rows.text.lines().filter_map(|row| failed(row, n_keys));
        joined.first_failed.extend(failed.take(TOLD - joined.first_failed.len()));
    }
    out.write_all(rows.text.as_bytes())
}

/// The run of a row whose status is not [`OK`].
fn failed(row: &str, n_keys: usize) -> Option<Failed> {
    let mut fields = fields(row);
    let run = fields.next()?.parse().ok()?;
    let error = fields.nth(n_keys)?;
    (error != OK).then(|| Failed { run, error: error.into_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_run_is_told_by_its_number_and_status() {
        let row = "17,1e7,\"a,b\",\"step fell below 1e-16 s, in \"\"slip+\"\"\",,";
        let error = "step fell below 1e-16 s, in \"slip+\"".to_owned();
        assert_eq!(failed(row, 2), Some(Failed { run: 17, error }));
        assert_eq!(failed("18,1e7,b,ok,,", 2), None);
    }

    #[test]
    fn an_altered_chunk_is_named_and_nothing_is_written() {
        let dir = tempfile::tempdir().unwrap();
        let chunks = Chunks::new(dir.path(), "0123456789abcdef", 4, 2);
        let rows = |first: u64| Rows {
            text: format!("{first},ok\n{},no step\n", first + 1),
            n: 2,
            failed: 1,
        };
        chunks.write(0, &rows(0)).unwrap();
        chunks.write(1, &rows(2)).unwrap();
        let path = dir.path().join("runs.csv");
        let joined = join(&chunks, "run,status\n", 0, &path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "run,status\n0,ok\n1,no step\n2,ok\n3,no step\n");
        assert_eq!((joined.failed, joined.bytes), (2, text.len() as u64));
        assert_eq!(joined.first_failed[1], Failed { run: 3, error: "no step".to_owned() });
        std::fs::remove_file(&path).unwrap();
        let of_chunk = chunks.dir().join("0000001.rows");
        let altered = std::fs::read_to_string(&of_chunk).unwrap().replace("3,no step", "3,ok step");
        std::fs::write(&of_chunk, altered).unwrap();
        assert!(chunks.is_there(1));
        assert_eq!(join(&chunks, "run,status\n", 0, &path).unwrap().altered, [1]);
        assert!(!path.exists());
    }
}
