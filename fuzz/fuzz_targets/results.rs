//! A finished sweep as `plot` reads it: `sweep.json`, a line of its own with `===`, then `runs.csv`.

#![no_main]

use deltazero::figures::sweep::{Asked, drawing};
use deltazero::sweep::results::Results;
use deltazero::sweep::sobol::Sobol;
use deltazero_fuzz::{file, path};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (record, rows) = text.split_once("\n===\n").unwrap_or((text, ""));
    file("sweep.json", record.as_bytes());
    file("runs.csv", rows.as_bytes());
    let Ok(results) = Results::open(&path("")) else { return };
    let columns: Vec<&str> = rows.lines().next().unwrap_or("").split(',').collect();
    let column = |i: usize| columns.get(i).copied();
    let x = column(1).unwrap_or("run");
    for (y, color) in
        [(None, None), (column(2), None), (column(2), column(3)), (column(3), column(4))]
    {
        match drawing(&results, Asked { x, y, color }) {
            Ok(drawing) => drop(drawing.picture()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    let _ = Sobol::of(&results, column(4).unwrap_or("run"));
});
