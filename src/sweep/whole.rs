//! Files that are there whole or not at all, also after the machine itself went down.
//!
//! Then the last ones may be gone, because their names were not on the disk yet; what is there is whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// What the name of an unfinished file ends with.
pub(super) const PARTIAL: &str = ".partial";

/// Tells the unfinished files of one process apart.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// Writes a file under a name of its own, has it put on the disk, and renames it.
///
/// # Errors
/// Those of the file system; the unfinished file is then removed.
pub fn write_by(
    path: &Path,
    content: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<()> {
    if let Some(dir) = path.parent() {
        fs::create_dir_all(dir)?;
    }
    let partial = partial(path);
    let written = || {
        let mut out = BufWriter::with_capacity(1 << 16, File::create(&partial)?);
        content(&mut out)?;
        out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&partial, path)
    };
    written().inspect_err(|_| drop(fs::remove_file(&partial)))
}

/// The same of what is in memory.
///
/// # Errors
/// As [`write_by`].
pub fn write(path: &Path, content: &[u8]) -> io::Result<()> {
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

/// Has the name of a file put on the disk, where the system can: before what it was made of is removed.
///
/// # Errors
/// Those of the file system.
pub(super) fn sync_dir(path: &Path) -> io::Result<()> {
    match path.parent() {
        Some(dir) if cfg!(unix) => {
            let dir = if dir.as_os_str().is_empty() { Path::new(".") } else { dir };
            File::open(dir)?.sync_all()
        }
        _ => Ok(()),
    }
}
