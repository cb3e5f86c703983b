//! The directory of results: one configuration's, each file whole or not at all.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use deltazero::atomic_file::{self, FileError};
use deltazero::figures::{self, Drawing, Picture};
use deltazero_study::reference::RECIPE;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::Failure;

/// Files that carry the hash of what they are results of.
const OWNERS: [&str; 6] =
    ["study.json", "run.json", "regimes.json", "audit.json", "map.json", "sweep.json"];

/// Where figures are.
pub(super) const FIGURES: &str = "figures";

/// The file that a command holds a lock on while it writes into a directory. It stays there: were it removed, two
/// commands could each hold a lock on a file of that name.
const LOCK: &str = ".deltazero-lock";

/// A directory for the results of one configuration, which no other command writes into as long as this lives.
pub(super) struct Output {
    dir: PathBuf,
    /// Released with the process, however that ends.
    _locks: Vec<File>,
    /// The hash of command and configuration.
    pub(super) hash: String,
}

/// SHA-256 of a command and its configuration, in hexadecimal.
pub(super) fn hash(command: &str, config: &Value) -> String {
    let digest = Sha256::digest(format!("{command} {config}"));
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Output {
    /// Opens `dir` for the results that `hash` names, and makes it if there is none.
    ///
    /// # Errors
    /// [`Failure::Usage`] if it is no directory, cannot be written, is being written by another command, or (without
    /// `force`) holds other results.
    pub(super) fn open(dir: &Path, hash: String, force: bool) -> Result<Self, Failure> {
        Self::opened(dir, hash, force, alone)
    }

    /// The same for one part of the results, beside which others are written by other processes.
    ///
    /// # Errors
    /// As [`open`](Self::open) without force; also where the same part is being written.
    pub(super) fn open_part(dir: &Path, hash: String, part: &str) -> Result<Self, Failure> {
        let own = format!("{LOCK}-{part}");
        let locks = |dir: &Path| {
            Ok(vec![lock(dir, LOCK, File::try_lock_shared)?, lock(dir, &own, File::try_lock)?])
        };
        Self::opened(dir, hash, false, locks)
    }

    fn opened(
        dir: &Path,
        hash: String,
        force: bool,
        locks: impl FnOnce(&Path) -> Result<Vec<File>, Failure>,
    ) -> Result<Self, Failure> {
        let refuse = |why: String| Failure::Usage(format!("{}: {why}", dir.display()));
        if dir.exists() && !dir.is_dir() {
            return Err(refuse("is a file, not a directory; name another with --out".into()));
        }
        fs::create_dir_all(dir)
            .map_err(|error| refuse(format!("cannot make the directory: {error}")))?;
        let output = Self { dir: dir.to_owned(), _locks: locks(dir)?, hash };
        let holds_results = OWNERS.iter().any(|owner| dir.join(owner).exists());
        // Two commands may share a directory, once the second was forced into it.
        let own = OWNERS.iter().any(|owner| output.own(owner).is_some());
        if holds_results && !own && !force {
            return Err(refuse(
                "holds results of another configuration; name another directory with --out, or \
                 overwrite them with --force"
                    .into(),
            ));
        }
        Ok(output)
    }

    /// The directory of finished results, whatever they are of.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is none, it cannot be written, or is being written by another command.
    pub(super) fn existing(dir: &Path) -> Result<Self, Failure> {
        if !dir.is_dir() {
            let why = "is no directory; name the DIR of a study or of a sweep";
            return Err(Failure::Usage(format!("{}: {why}", dir.display())));
        }
        Ok(Self { dir: dir.to_owned(), _locks: alone(dir)?, hash: String::new() })
    }

    /// A JSON file of an earlier run of the same configuration.
    pub(super) fn own(&self, name: &str) -> Option<Value> {
        self.read(name).filter(|value| hash_of(value) == Some(&self.hash))
    }

    /// A JSON file, whatever it is of.
    pub(super) fn read(&self, name: &str) -> Option<Value> {
        serde_json::from_slice(&self.bytes(name)?).ok()
    }

    /// A file of an earlier run, if it is there and can be read.
    pub(super) fn bytes(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.dir.join(name)).ok()
    }

    /// Removes what a command wrote for another configuration, before it writes its own: its record, the files beside it, and
    /// figures by their names. Where there is no such record, files of these names may be a user's own.
    pub(super) fn remove_of_another(
        &self,
        record: &str,
        files: &[&str],
        figures: &[&str],
    ) -> Result<(), Failure> {
        if self.bytes(record).is_none() || self.own(record).is_some() {
            return Ok(());
        }
        self.remove(figures.iter().flat_map(|name| figure_files(name)))?;
        self.remove(files.iter().chain([&record]).map(|name| (*name).to_owned()))
    }

    /// Removes the files of these names, those that are there.
    pub(super) fn remove(&self, names: impl IntoIterator<Item = String>) -> Result<(), Failure> {
        for path in names.into_iter().map(|name| self.dir.join(name)) {
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(FileError::of(&path, "remove")(error).into());
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes a file, whole or not at all.
    pub(super) fn write(&self, name: &str, content: &[u8]) -> Result<(), Failure> {
        self.write_by(name, |out| out.write_all(content))
    }

    /// Writes a record.
    pub(super) fn write_json(&self, name: &str, record: &Value) -> Result<(), Failure> {
        self.write(name, format!("{record:#}\n").as_bytes())
    }

    /// Writes what need not fit into memory.
    pub(super) fn write_by(
        &self,
        name: &str,
        content: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), Failure> {
        Ok(atomic_file::write_by(&self.dir.join(name), content)?)
    }

    /// Draws figures, as SVG and PNG into `figures/`.
    pub(super) fn draw(&self, drawings: &[Drawing]) -> Result<Vec<Picture>, Failure> {
        let pictures =
            figures::pictures(drawings).map_err(|(name, error)| cannot_draw(name, &error))?;
        pictures.iter().try_for_each(|picture| self.write_picture(picture))?;
        Ok(pictures)
    }

    /// Draws a figure, as SVG and PNG of this name into `figures/`.
    pub(super) fn draw_as(&self, name: &str, drawing: &Drawing) -> Result<Picture, Failure> {
        let picture = drawing.picture().map_err(|error| cannot_draw(name, &error))?;
        let picture = Picture { name: name.to_owned(), ..picture };
        self.write_picture(&picture)?;
        Ok(picture)
    }

    fn write_picture(&self, Picture { name, svg, png, .. }: &Picture) -> Result<(), Failure> {
        let [svg_name, png_name] = figure_files(name);
        self.write(&svg_name, svg.as_bytes())?;
        self.write(&png_name, png)
    }

    /// Where it is.
    pub(super) fn path(&self) -> std::path::Display<'_> {
        self.dir.display()
    }
}

/// The files of a figure, as SVG and PNG.
fn figure_files(name: &str) -> [String; 2] {
    ["svg", "png"].map(|end| format!("{FIGURES}/{name}.{end}"))
}

/// The failure of a figure.
pub(super) fn cannot_draw(name: &str, error: &deltazero_plots::Error) -> Failure {
    Failure::Run(format!("cannot draw {name}: {error}"))
}

/// The lock of a command that alone writes into `dir`; what an earlier one left unfinished is removed.
fn alone(dir: &Path) -> Result<Vec<File>, Failure> {
    let locks = vec![lock(dir, LOCK, File::try_lock)?];
    atomic_file::sweep_up(dir, LOCK);
    Ok(locks)
}

/// A lock on the right to write into `dir`, held on the file `name` in it.
fn lock(
    dir: &Path,
    name: &str,
    try_lock: fn(&File) -> Result<(), TryLockError>,
) -> Result<File, Failure> {
    let refuse = |why: String| Failure::Usage(format!("{}: {why}", dir.display()));
    let file = File::create(dir.join(name))
        .map_err(|error| refuse(format!("cannot write there: {error}")))?;
    match try_lock(&file) {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(refuse(
            "another deltazero is writing there; wait for its end, or name another directory with --out".into(),
        )),
        // A file system that knows no locks keeps two commands apart no more than before.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(refuse(format!("cannot lock {name}: {error}"))),
    }
}

/// Whether a record is of this version of the program and by its recipe, so that its numbers still hold.
pub(super) fn is_current(record: &Value) -> bool {
    let version = record.get("version").and_then(Value::as_str);
    let recipe = record.get("recipe").and_then(Value::as_u64);
    version == Some(env!("CARGO_PKG_VERSION")) && recipe == Some(u64::from(RECIPE))
}

fn hash_of(value: &Value) -> Option<&str> {
    value.get("hash")?.as_str()
}
