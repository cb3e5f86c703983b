//! Whether a change of the code is on: the one whose number stands in `MUTANT`. Where `MUTANTS_REACHED` names a file instead, no
//! change is on, and the number of each that was asked for is added there, once by each process: a test may start others.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use std::sync::{LazyLock, Mutex};

/// The numbers of changes lie below this one.
const MOST: usize = 1 << 16;
const UNREAD: u32 = u32::MAX;
const RECORDED: u32 = u32::MAX - 1;
const NONE: u32 = u32::MAX - 2;

static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
static SEEN: [AtomicBool; MOST] = [const { AtomicBool::new(false) }; MOST];
static REACHED: LazyLock<Mutex<Option<File>>> = LazyLock::new(|| {
    let open = |path| OpenOptions::new().create(true).append(true).open(path);
    let file = std::env::var_os("MUTANTS_REACHED")
        .map(|path| open(path).expect("a file for what is reached"));
    Mutex::new(file)
});

/// Whether change `id` is on.
#[inline]
pub fn on(id: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    active == id || (active >= RECORDED && look(id))
}

#[cold]
fn look(id: u32) -> bool {
    if ACTIVE.load(Relaxed) == UNREAD {
        let wanted =
            std::env::var("MUTANT").ok().map(|text| text.parse().expect("a number in MUTANT"));
        let recorded = std::env::var_os("MUTANTS_REACHED").map(|_| RECORDED);
        ACTIVE.store(wanted.or(recorded).unwrap_or(NONE), Relaxed);
    }
    let active = ACTIVE.load(Relaxed);
    if active == RECORDED && !SEEN[id as usize].swap(true, Relaxed) {
        if let Some(file) = REACHED.lock().expect("no thread fails here").as_mut() {
            file.write_all(format!("{id}\n").as_bytes()).expect("space for what is reached");
        }
    }
    active == id
}
