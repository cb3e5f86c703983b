//! Files that are there whole or not at all, also after the machine itself went down.
//!
//! Then the last ones may be gone, because their names were not on the disk yet; what is there is whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// What the name of an unfinished file ends with.
const PARTIAL: &str = ".deltazero.partial";

/// Tells the unfinished files of one process apart.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// What the file system refused.
#[derive(Debug, thiserror::Error)]
#[error("cannot {doing} {}: {source}", path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// `write`, `read` or `remove`.
    pub doing: &'static str,
    /// What the operating system says.
    pub source: io::Error,
}

impl FileError {
    /// That of doing something with the file `path`.
    pub fn of(path: &Path, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self { path: path.to_owned(), doing, source }
    }
}

/// Writes a file under a name of its own, has it put on the disk, and renames it.
///
/// # Errors
/// Those of the file system; the unfinished file is then removed.
pub fn write_by(
    path: &Path,
    content: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), FileError> {
    let partial = partial(path);
    let written = || {
        if let Some(dir) = path.parent() {
            fs::create_dir_all(dir)?;
        }
        let mut out = BufWriter::with_capacity(1 << 16, File::create(&partial)?);
        content(&mut out)?;
        out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&partial, path)
    };
    written().inspect_err(|_| drop(fs::remove_file(&partial))).map_err(FileError::of(path, "write"))
}

/// The same of what is in memory.
///
/// # Errors
/// As [`write_by`].
pub fn write(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_by(path, |out| out.write_all(content))
}

/// A name that no other process has at the same time, also on another machine: by number and time.
fn partial(path: &Path) -> PathBuf {
    let (process, n) = (std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let now = now.map_or(0, |now| now.subsec_nanos());
    let mut name = path.to_owned().into_os_string();
    name.push(format!(".{process}-{n}-{now}{PARTIAL}"));
    name.into()
}

/// Removes what writing left behind that was killed, in `dir` and the folders in it. A folder that has a file of the
/// name `lock` is left alone: another command may be writing into it.
pub fn sweep_up(dir: &Path, lock: &str) {
    let entries = |dir: &Path| fs::read_dir(dir).into_iter().flatten().flatten();
    let is_own = |path: &PathBuf| path.is_dir() && !path.join(lock).exists();
    let folders = entries(dir).map(|entry| entry.path()).filter(is_own);
    for dir in folders.chain([dir.to_owned()]) {
        for entry in entries(&dir) {
            if entry.file_name().to_string_lossy().ends_with(PARTIAL) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}

/// Has the name of a file put on the disk, where the system can: before what it was made of is removed.
///
/// # Errors
/// Those of the file system.
pub(crate) fn sync_dir(path: &Path) -> Result<(), FileError> {
    match path.parent() {
        Some(dir) if cfg!(unix) => {
            let dir = if dir.as_os_str().is_empty() { Path::new(".") } else { dir };
            let synced = File::open(dir).and_then(|dir| dir.sync_all());
            synced.map_err(FileError::of(path, "write"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_kill_left_behind_is_swept_up_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        write(&path("figures/cost.svg"), b"whole").unwrap();
        let kept = ["run.json", "mine.partial", "figures/mine.1-2-3.partial", "figures/cost.svg"];
        kept.iter().for_each(|name| write(&path(name), b"").unwrap());
        let left = [partial(&path("run.json")), partial(&path("figures/cost.svg"))];
        left.iter().for_each(|path| fs::write(path, "torn").unwrap());
        sweep_up(dir.path(), "lock");
        assert!(left.iter().all(|path| !path.exists()), "{left:?}");
        assert!(kept.iter().all(|name| path(name).exists()));
        sweep_up(&path("nowhere"), "lock");
    }

    #[test]
    fn a_folder_with_a_lock_of_its_own_is_not_swept_up_with_the_one_around_it() {
        let dir = tempfile::tempdir().unwrap();
        let inner = dir.path().join("sweep");
        write(&inner.join("lock"), b"").unwrap();
        let unfinished = partial(&inner.join("runs.csv"));
        fs::write(&unfinished, "being written").unwrap();
        sweep_up(dir.path(), "lock");
        assert!(unfinished.exists());
        sweep_up(&inner, "lock");
        assert!(!unfinished.exists());
    }
}
