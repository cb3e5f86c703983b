//! Five text models in Rust, by `deltazero-solvers` and by the crate `diffsol`: `models-rust MODEL TIMES FOLDER` prints a line a run:
//! tool, method, tolerance, events, seconds on the processor (or what went wrong), file of the samples.

mod by_diffsol;
mod by_ours;
mod parameters;

use std::error::Error;
use std::path::Path;

use rustix::time::{ClockId, clock_gettime};

/// A ladder ends at its first run beyond this [s], as in `../run.py`.
const LONGEST: f64 = 20.0 / 3.0;
/// Repeats of each run.
const REPEATS: usize = 3;

/// What a run gives: the states at the sample times, one after the other, and the number of events.
type Delivered = (Vec<f64>, u64);

/// The tolerances of a ladder.
fn tolerances() -> impl Iterator<Item = String> {
    (3..=13).map(|k| format!("1e-{k}"))
}

/// Repeats the run of a model of `n` states, writes its samples and prints its line. Whether the ladder goes on.
fn tell(
    [tool, method, tolerance]: [&str; 3],
    n: usize,
    folder: &Path,
    run: impl FnMut() -> Result<Delivered, Box<dyn Error>>,
) -> Result<bool, Box<dyn Error>> {
    match measured(run) {
        Ok((least, (samples, n_events))) => {
            let path = folder.join(format!("{tool}-{method}-{tolerance}"));
            write(&path, &samples, n)?;
            println!("{tool},{method},{tolerance},{n_events},{least:.4e},{}", path.display());
            Ok(least <= LONGEST)
        }
        Err(error) => {
            let reason = error.to_string().replace([',', '\n'], ";");
            println!("{tool},{method},{tolerance},0,{reason},");
            Ok(true)
        }
    }
}

/// The least time of the repeats of a run [s], and what the last gave.
fn measured(
    mut run: impl FnMut() -> Result<Delivered, Box<dyn Error>>,
) -> Result<(f64, Delivered), Box<dyn Error>> {
    let (mut least, mut n) = (f64::INFINITY, 0);
    loop {
        let begin = processor_time();
        let delivered = run()?;
        least = least.min(processor_time() - begin);
        n += 1;
        if n == REPEATS || least > LONGEST {
            return Ok((least, delivered));
        }
    }
}

/// Writes samples of `n` states, a line each.
fn write(path: &Path, samples: &[f64], n: usize) -> std::io::Result<()> {
    let line = |y: &[f64]| y.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n";
    std::fs::write(path, samples.chunks(n).map(line).collect::<String>())
}

/// Time of this process on the processor [s].
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let [name, times, folder] = std::env::args()
        .skip(1)
        .collect::<Vec<_>>()
        .try_into()
        .map_err(|_| "MODEL TIMES FOLDER")?;
    let times: Vec<f64> =
        std::fs::read_to_string(times)?.lines().map(str::parse).collect::<Result<_, _>>()?;
    let folder = Path::new(&folder);
    by_ours::model(&name, &times, folder)?;
    by_diffsol::model(&name, &times, folder)
}
