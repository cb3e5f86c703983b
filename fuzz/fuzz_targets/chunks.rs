//! A chunk of runs as it may be found: any bytes, or one that was written and then altered. It is as it was written, or it is
//! not there.

#![no_main]

use std::fs;

use deltazero::chunks::{Chunks, Rows};
use deltazero_fuzz::{file, path};
use libfuzzer_sys::fuzz_target;

const HASH: &str = "0123456789abcdef";
const WHOLE: &str = "chunks/0000001.rows";
const BEGUN: &str = "chunks/0000001.begun";

fn rows() -> Rows {
    Rows { text: "3,ok,1e0\n4,\"no step, at all\",\n5,ok,2e0\n".to_owned(), n: 3, failed: 1 }
}

/// A chunk that was written, with bytes of it changed, cut off or added: position, what, position, what, …
fn altered(whole: &[u8], changes: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_owned();
    for change in changes.chunks_exact(3) {
        let at = usize::from(change[0]) % (bytes.len() + 1);
        match change[1] % 3 {
            0 => bytes.truncate(at),
            1 => bytes.insert(at, change[2]),
            _ => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte = change[2]),
        }
    }
    bytes
}

fuzz_target!(|input: &[u8]| {
    let chunks = Chunks::new(&path(""), HASH, 9, 3);
    chunks.write(1, &rows()).expect("a chunk");
    let whole = fs::read(path(WHOLE)).expect("a chunk");
    let found = match input.split_first() {
        Some((0, changes)) => altered(&whole, changes),
        Some((_, bytes)) => bytes.to_owned(),
        None => Vec::new(),
    };
    file(WHOLE, &found);
    file(BEGUN, &found);
    let _ = chunks.failed(1);
    for read in [chunks.read(1), chunks.read_begun(1)] {
        let read = read.expect("a file that is there");
        assert!(read.is_none() || (found == whole && read == Some(rows())));
    }
});
