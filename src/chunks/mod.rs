//! Many runs, kept on disk as they are made, in chunks: rows, then a line that tells whose they are and their checksum.
//!
//! ```text
//! DIR/chunks/0000012.rows     rows 12000 … 12999, whole
//! DIR/chunks/0000013.begun    the first rows of a chunk under way, where its runs are slow
//! ```
//!
//! Each is written under another name, put on the disk, and renamed, so a kill leaves it as it was. When the
//! command goes on, the last line of each chunk is read: that it is of these runs, of this number, of so many rows and bytes.
//! The checksum over all of it is verified when it is read, and when a begun one is taken up.
//!
//! What a run is and how its row is made is known to its [`Maker`] alone: a run of a [sweep](crate::sweep), or all contests on a
//! site of a [map](crate::study::contests).

mod work;

use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

pub use work::{Made, Maker, Work, work};

use crate::atomic_file::{self, FileError};

/// Longest last line.
const LONGEST_LINE: u64 = 512;

/// The chunks of the runs of one plan.
#[derive(Clone, Debug)]
pub struct Chunks {
    dir: PathBuf,
    /// The beginning of the hash of all that the rows follow from.
    hash: String,
    /// Number of runs.
    pub n_runs: u64,
    /// Runs of a chunk; the last one may have less.
    pub size: u64,
}

/// The rows of a chunk, or its first ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// Its lines.
    pub text: String,
    /// How many.
    pub n: u64,
    /// How many of runs that did not come to their end.
    pub failed: u64,
}

impl Chunks {
    /// Those in `dir` of the runs with this hash.
    pub fn new(dir: &Path, hash: &str, n_runs: u64, size: u64) -> Self {
        let hash = hash.chars().take(16).collect();
        Self { dir: dir.join("chunks"), hash, n_runs, size }
    }

    /// Where they are.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// How many there are when all is done.
    pub fn n(&self) -> u64 {
        self.n_runs.div_ceil(self.size)
    }

    /// The numbers of the runs of a chunk.
    pub fn runs(&self, chunk: u64) -> std::ops::Range<u64> {
        let first = chunk * self.size;
        first..(first + self.size).min(self.n_runs)
    }

    fn path(&self, chunk: u64, end: &str) -> PathBuf {
        self.dir.join(format!("{chunk:07}.{end}"))
    }

    /// Whether a chunk is there, by its last line and its length.
    pub fn is_there(&self, chunk: u64) -> bool {
        self.failed(chunk).is_some()
    }

    /// How many of its runs did not come to their end, if a chunk is there, by its last line and its length.
    pub fn failed(&self, chunk: u64) -> Option<u64> {
        self.last_line(chunk).ok().flatten()
    }

    fn last_line(&self, chunk: u64) -> io::Result<Option<u64>> {
        let Some((line, bytes)) = last_line(&self.path(chunk, "rows"))? else { return Ok(None) };
        let runs = self.runs(chunk);
        let told = self.parsed(&line, chunk, bytes);
        Ok(told.filter(|(n, _)| *n == runs.end - runs.start).map(|(_, failed)| failed))
    }

    /// Rows and failed ones that a last line tells of, if it is of this chunk and of so many bytes.
    fn parsed(&self, line: &str, chunk: u64, bytes: u64) -> Option<(u64, u64)> {
        let words: Vec<&str> = line.split(' ').collect();
        let [n, failed] = [words.get(3)?, words.get(5)?].map(|word| word.parse().ok());
        let (n, failed) = (n?, failed?);
        let (before, _) = line.rsplit_once(' ')?;
        (before == self.line(chunk, n, failed, bytes)).then_some((n, failed))
    }

    /// The last line without the checksum.
    fn line(&self, chunk: u64, n: u64, failed: u64, bytes: u64) -> String {
        let hash = &self.hash;
        format!("#chunk {chunk} rows {n} failed {failed} bytes {bytes} sweep {hash} sha256")
    }

    /// The rows of a chunk, its checksum verified; none where it is not there, or is not as it was written.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(&self, chunk: u64) -> Result<Option<Rows>, FileError> {
        let runs = self.runs(chunk);
        let rows = self.read_from(&self.path(chunk, "rows"), chunk)?;
        Ok(rows.filter(|rows| rows.n == runs.end - runs.start))
    }

    /// The first rows of a chunk that was begun.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn read_begun(&self, chunk: u64) -> Result<Option<Rows>, FileError> {
        self.read_from(&self.path(chunk, "begun"), chunk)
    }

    fn read_from(&self, path: &Path, chunk: u64) -> Result<Option<Rows>, FileError> {
        let bytes = match fs::read(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(FileError::of(path, "read"))?,
        };
        Ok(String::from_utf8(bytes).ok().and_then(|text| self.verified(text, chunk)))
    }

    fn verified(&self, mut text: String, chunk: u64) -> Option<Rows> {
        let at = text.strip_suffix('\n')?.rfind('\n').map_or(0, |at| at + 1);
        let (rows, line) = text.split_at(at);
        let line = line.trim_end_matches('\n');
        let (n, failed) = self.parsed(line, chunk, at as u64)?;
        let (before, sum) = line.rsplit_once(' ')?;
        if sum != checksum(rows, before) {
            return None;
        }
        text.truncate(at);
        Some(Rows { text, n, failed })
    }

    /// Writes a chunk that is whole, and removes what was there of it before.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, chunk: u64, rows: &Rows) -> Result<(), FileError> {
        self.write_to(&self.path(chunk, "rows"), chunk, rows)?;
        let _ = fs::remove_file(self.path(chunk, "begun"));
        Ok(())
    }

    /// Writes the first rows of a chunk.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn write_begun(&self, chunk: u64, rows: &Rows) -> Result<(), FileError> {
        self.write_to(&self.path(chunk, "begun"), chunk, rows)
    }

    fn write_to(&self, path: &Path, chunk: u64, rows: &Rows) -> Result<(), FileError> {
        let Rows { text, n, failed } = rows;
        let line = self.line(chunk, *n, *failed, text.len() as u64);
        let sum = checksum(text, &line);
        atomic_file::write_by(path, |out| {
            out.write_all(text.as_bytes())?;
            writeln!(out, "{line} {sum}")
        })
    }

    /// Removes a chunk that is not as it was written.
    pub fn remove(&self, chunk: u64) {
        let _ = fs::remove_file(self.path(chunk, "rows"));
    }

    /// Removes the chunks of these runs, also those that were begun, and their folder if nothing else is in it. What
    /// another command keeps there stays, and so does a file that is no chunk.
    ///
    /// # Errors
    /// They cannot be removed.
    pub fn clear(&self) -> Result<(), FileError> {
        let own = format!(" sweep {} sha256 ", self.hash);
        for entry in fs::read_dir(&self.dir).into_iter().flatten().flatten() {
            let path = entry.path();
            if is_name_of_chunk(&entry.file_name().to_string_lossy())
                && let Ok(Some((line, _))) = last_line(&path)
                && line.starts_with("#chunk ")
                && line.contains(&own)
            {
                fs::remove_file(&path).map_err(FileError::of(&path, "remove"))?;
            }
        }
        // The file system refuses a folder that has files.
        let _ = fs::remove_dir(&self.dir);
        Ok(())
    }
}

/// Whether a file may be a chunk by its name: `0000012.rows`, `0000012.begun`.
fn is_name_of_chunk(name: &str) -> bool {
    name.split_once('.').is_some_and(|(number, end)| {
        let is_number = number.len() == 7 && number.bytes().all(|byte| byte.is_ascii_digit());
        is_number && ["rows", "begun"].contains(&end)
    })
}

/// The last line of a file without its end, and the bytes before it; none where the line has no end.
fn last_line(path: &Path) -> io::Result<Option<(String, u64)>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LONGEST_LINE)))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end)?;
    let Some(line) = end.strip_suffix(b"\n") else { return Ok(None) };
    let line = &line[line.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1)..];
    let bytes = length - line.len() as u64 - 1;
    Ok(Some((String::from_utf8_lossy(line).into_owned(), bytes)))
}

/// SHA-256 of rows and the line after them, in hexadecimal.
fn checksum(rows: &str, line: &str) -> String {
    let digest = Sha256::new().chain_update(rows).chain_update(line).finalize();
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Rows {
        Rows { text: "10,ok\n11,failed\n12,ok\n".to_owned(), n: 3, failed: 1 }
    }

    #[test]
    fn a_chunk_is_read_back_and_one_that_is_not_whole_is_not_there() {
        let dir = tempfile::tempdir().unwrap();
        let chunks = Chunks::new(dir.path(), "0123456789abcdef0123", 33, 3);
        assert_eq!((chunks.n(), chunks.runs(10)), (11, 30..33));
        assert!(!chunks.is_there(4));
        chunks.write(4, &rows()).unwrap();
        assert!(chunks.is_there(4) && !chunks.is_there(5));
        assert_eq!(chunks.read(4).unwrap(), Some(rows()));
        let path = dir.path().join("chunks/0000004.rows");
        let whole = fs::read(&path).unwrap();
        // Torn at any byte it is not there; altered at any byte it is not read.
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(!chunks.is_there(4), "{length}");
            assert_eq!(chunks.read(4).unwrap(), None, "{length}");
        }
        for at in 0..whole.len() {
            let mut altered = whole.clone();
            altered[at] ^= 1;
            fs::write(&path, &altered).unwrap();
            assert_eq!(chunks.read(4).unwrap(), None, "{at}");
        }
    }

    #[test]
    fn a_chunk_of_other_runs_or_of_another_number_is_not_there() {
        let dir = tempfile::tempdir().unwrap();
        let chunks = Chunks::new(dir.path(), "0123456789abcdef0123", 33, 3);
        chunks.write(4, &rows()).unwrap();
        let other = Chunks::new(dir.path(), "1123456789abcdef0123", 33, 3);
        assert!(!other.is_there(4) && other.read(4).unwrap().is_none());
        fs::rename(dir.path().join("chunks/0000004.rows"), dir.path().join("chunks/0000005.rows"))
            .unwrap();
        assert!(!chunks.is_there(5) && chunks.read(5).unwrap().is_none());
    }

    #[test]
    fn the_first_rows_of_a_chunk_are_taken_up() {
        let dir = tempfile::tempdir().unwrap();
        let chunks = Chunks::new(dir.path(), "0123456789abcdef0123", 100, 10);
        assert_eq!(chunks.read_begun(1).unwrap(), None);
        chunks.write_begun(1, &rows()).unwrap();
        assert_eq!(chunks.read_begun(1).unwrap(), Some(rows()));
        assert!(!chunks.is_there(1));
    }

    #[test]
    fn clearing_removes_the_chunks_of_these_runs_and_no_other_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join("chunks").join(name);
        let chunks = Chunks::new(dir.path(), "0123456789abcdef0123", 33, 3);
        let other = Chunks::new(dir.path(), "1123456789abcdef0123", 33, 3);
        chunks.clear().unwrap();
        chunks.write(4, &rows()).unwrap();
        chunks.write_begun(5, &rows()).unwrap();
        other.write(7, &rows()).unwrap();
        let named = ["mine.txt", "0000008.rows", "0000004.rows.bak"];
        named.iter().for_each(|name| fs::write(path(name), "mine\n").unwrap());
        chunks.clear().unwrap();
        assert!(!path("0000004.rows").exists() && !path("0000005.begun").exists());
        assert!(other.is_there(7) && named.iter().all(|name| path(name).exists()));
        named.iter().for_each(|name| fs::remove_file(path(name)).unwrap());
        other.clear().unwrap();
        assert!(!chunks.dir().exists());
    }
}
