//! The tests of the workspace, with what each of them reaches.

use std::collections::BTreeSet;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::Failure;
use crate::build::Program;

/// One test.
#[derive(Deserialize, Serialize)]
pub struct Test {
    program: PathBuf,
    package: PathBuf,
    name: String,
    /// What it takes without a change.
    pub time: Duration,
    reached: BTreeSet<usize>,
}

/// How a test ended.
#[derive(PartialEq)]
pub enum Ended {
    Passed,
    Failed,
    Late,
}

/// All tests of one change take at most this long together. Longer ones are left out: what only they see counts as missed.
pub const BUDGET: Duration = Duration::from_secs(20);

/// What a test may take beyond ten times what it takes without a change: an endless loop is a change that is seen.
const PATIENCE: Duration = Duration::from_secs(10);

impl Test {
    /// Whether it runs the code of a change.
    pub fn reaches(&self, id: usize) -> bool {
        self.reached.contains(&id)
    }

    /// Whether a change is seen by it.
    pub fn judge(&self, id: usize) -> Result<Ended, Failure> {
        self.run(("MUTANT", &id.to_string()), PATIENCE + 10 * self.time)
    }

    /// Runs it with one variable set, for so long at most.
    fn run(&self, variable: (&str, &str), limit: Duration) -> Result<Ended, Failure> {
        // A change may ask for all memory. What is left behind when this program is broken off ends by itself.
        let mut child = Command::new("sh")
            .args(["-c", "ulimit -v 4000000; ulimit -t 600; exec \"$@\"", "sh"])
            .arg(&self.program)
            .args(["--exact", &self.name, "--test-threads=1"])
            .env(variable.0, variable.1)
            .env("RUST_BACKTRACE", "0")
            .current_dir(&self.package)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .process_group(0)
            .spawn()?;
        let begin = Instant::now();
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok(if status.success() { Ended::Passed } else { Ended::Failed });
            }
            if begin.elapsed() > limit {
                // With what it has started.
                let group = format!("-{}", child.id());
                Command::new("kill").args(["-KILL", "--", &group]).status()?;
                child.wait()?;
                return Ok(Ended::Late);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// All tests of these programs that pass in time, the shortest first, each run once to see what it reaches. They are kept in the part's tests.json.
pub fn recorded(programs: &[Program], part: &Path) -> Result<Vec<Test>, Failure> {
    let kept = part.join("tests.json");
    if let Ok(text) = std::fs::read(&kept) {
        return Ok(serde_json::from_slice(&text)?);
    }
    let mut todo = Vec::new();
    for (program, package) in programs {
        let listed = Command::new(program)
            .args(["--list", "--format", "terse"])
            .current_dir(package)
            .output()?;
        for line in String::from_utf8(listed.stdout)?.lines() {
            let Some(name) = line.strip_suffix(": test") else { continue };
            let (program, package, name) = (program.clone(), package.clone(), name.to_owned());
            todo.push(Test {
                program,
                package,
                name,
                time: Duration::ZERO,
                reached: BTreeSet::new(),
            });
        }
    }
    let (todo, done) = (Mutex::new(todo), Mutex::new(Vec::new()));
    on_all_processors(|thread| {
        let reached = part.join(format!("reached.{thread}"));
        while let Some(mut test) = todo.lock().map_err(|_| "a thread failed")?.pop() {
            let _ = std::fs::remove_file(&reached);
            let begin = Instant::now();
            let ended = test.run(("MUTANTS_REACHED", &reached.display().to_string()), BUDGET)?;
            test.time = begin.elapsed();
            if ended != Ended::Passed {
                let how = if ended == Ended::Failed { "fails" } else { "takes long" };
                println!("left out, {how} without a change: {}", test.name);
                continue;
            }
            let text = std::fs::read_to_string(&reached).unwrap_or_default();
            test.reached = text.lines().map(str::parse).collect::<Result<_, _>>()?;
            done.lock().map_err(|_| "a thread failed")?.push(test);
        }
        Ok(())
    })?;
    let mut tests = done.into_inner().map_err(|_| "a thread failed")?;
    tests.sort_by(|a, b| (a.time, &a.name).cmp(&(b.time, &b.name)));
    std::fs::write(kept, serde_json::to_vec(&tests)?)?;
    Ok(tests)
}

/// Runs a function on as many threads as there are processors, with the number of each.
pub fn on_all_processors(
    work: impl Fn(usize) -> Result<(), Failure> + Sync,
) -> Result<(), Failure> {
    let threads = std::thread::available_parallelism()?.get();
    std::thread::scope(|scope| {
        let work = &work;
        let running: Vec<_> =
            (0..threads).map(|thread| scope.spawn(move || work(thread))).collect();
        running.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread failed")?)
    })
}
