//! Tools in other languages: a command each, which prints its runs and writes what they delivered.
//!
//! The command gets a folder as its last argument. A line of its output is
//!
//! ```text
//! run,tool,version,method,located|naive,rtol,n_rhs (or nothing),wall_ms,cpu_ms,repeats,file
//! failed,tool,version,method,located|naive,rtol,reason
//! skip,reason
//! ```
//!
//! and `file`, in that folder, holds what the run delivered, joint by joint in order of time:
//!
//! ```text
//! s,joint,X,Y,theta,X',Y',theta'     a sample, in the block's order of coordinates
//! e,joint,t,before,after             a mode change: 0 free, 1 and -1 the sign of v_T, 2 stick
//! ```

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use deltazero_study::run::ModeChange;

use crate::entry::{Entry, Handling, Label};
use crate::measure::{Effort, judged};
use crate::problem::{Problem, Track};
use crate::row::{Build, Row, Times};

/// Runs `command` and reads its rows; none, and a reason, where the tool is not there.
///
/// # Errors
/// Where the command fails, or a line or file is not as described.
pub(crate) fn rows(
    problem: &Problem,
    command: &str,
    build: Build,
    effort: Effort,
    folder: &Path,
) -> Result<Result<Vec<Row>, String>, Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut words = command.split_whitespace();
    let program = words.next().ok_or("an empty command")?;
    let mut command_line = Command::new(program);
    command_line.args(words).arg(folder).stderr(Stdio::inherit());
    // Seconds on the processor: for the repeats of a run, and for the longest run of a ladder.
    command_line.env("PEERS_BUDGET", effort.budget().as_secs_f64().to_string());
    command_line.env("PEERS_LONGEST", effort.longest.as_secs_f64().to_string());
    let output = command_line.output()?;
    if !output.status.success() {
        return Err(format!("{command}: {}", output.status).into());
    }
    let mut rows = Vec::new();
    for line in String::from_utf8(output.stdout)?.lines() {
        if let Some(reason) = line.strip_prefix("skip,") {
            return Ok(Err(reason.to_owned()));
        }
        rows.push(row(problem, line, build, folder).map_err(|error| format!("{line}: {error}"))?);
    }
    Ok(Ok(rows))
}

fn row(problem: &Problem, line: &str, build: Build, folder: &Path) -> Result<Row, Box<dyn Error>> {
    let fields: Vec<&str> = line.splitn(11, ',').collect();
    let [kind, tool, version, method, handling, rtol, rest @ ..] = fields.as_slice() else {
        return Err("too few fields".into());
    };
    let label = Label {
        tool: (*tool).to_owned(),
        version: (*version).to_owned(),
        method: (*method).to_owned(),
        handling: Handling::named(handling)?,
        rtol: rtol.parse()?,
    };
    let outcome = match (*kind, rest) {
        ("run", [n_rhs, wall_ms, cpu_ms, repeats, file]) => {
            let mut delivered = read(&std::fs::read_to_string(folder.join(file))?)?;
            delivered[0].n_rhs = if n_rhs.is_empty() { None } else { Some(n_rhs.parse()?) };
            delivered[1].n_rhs = delivered[0].n_rhs.map(|_| 0);
            let times = Times { wall_ms: wall_ms.parse()?, cpu_ms: cpu_ms.parse()? };
            judged(problem, &delivered, times, repeats.parse()?)
        }
        ("failed", reason) => Err(reason.join(";")),
        _ => return Err("neither run nor failed".into()),
    };
    Ok(Row { label, build, outcome })
}

fn read(text: &str) -> Result<[Track; 2], Box<dyn Error>> {
    let mut tracks = [Track::default(), Track::default()];
    for line in text.lines() {
        let (kind, rest) = line.split_once(',').ok_or("no comma")?;
        let numbers: Vec<f64> = rest.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let joint = |joint: f64| if joint == 1.0 { 0 } else { 1 };
        match (kind, numbers.as_slice()) {
            ("s", &[j, a, b, c, d, e, f]) => tracks[joint(j)].samples.push([a, b, c, d, e, f]),
            ("e", &[j, t, before, after]) => {
                let change = ModeChange::new(t, before as i8, after as i8);
                tracks[joint(j)].events.push(change);
            }
            _ => return Err(format!("neither sample nor event: {line}").into()),
        }
    }
    Ok(tracks)
}

/// The other side: writes measured `rows` of `entries` into `folder` and returns the lines that name
/// them. A build of this program with other flags hands over its runs in this way.
///
/// # Errors
/// Where the folder cannot be written.
pub(crate) fn hand_over(
    rows: &[Row],
    entries: &[Entry<'_>],
    folder: &Path,
) -> Result<String, Box<dyn Error>> {
    let mut lines = String::new();
    for row in rows {
        let Label { tool, version, method, handling, rtol } = &row.label;
        let (name, handling) =
            (format!("{tool}-{method}-{}-{rtol:e}", handling.name()), handling.name());
        match (&row.outcome, entries.iter().find(|entry| entry.label == row.label)) {
            (Ok(outcome), Some(entry)) => {
                std::fs::write(folder.join(&name), delivery(&(entry.run)()?)?)?;
                let n_rhs = outcome.n_rhs.map_or_else(String::new, |n| n.to_string());
                let (Times { wall_ms, cpu_ms }, repeats) = (outcome.times, outcome.repeats);
                writeln!(
                    lines,
                    "run,{tool},{version},{method},{handling},{rtol:e},{n_rhs},{wall_ms},{cpu_ms},{repeats},{name}"
                )?;
            }
            (Err(reason), _) => {
                let reason = reason.replace(['\n', ','], ";");
                writeln!(lines, "failed,{tool},{version},{method},{handling},{rtol:e},{reason}")?;
            }
            (Ok(_), None) => {}
        }
    }
    Ok(lines)
}

fn delivery(tracks: &[Track; 2]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for (track, joint) in tracks.iter().zip([1, 2]) {
        for [a, b, c, d, e, f] in &track.samples {
            writeln!(text, "s,{joint},{a:e},{b:e},{c:e},{d:e},{e:e},{f:e}")?;
        }
        for ModeChange { t, before, after, .. } in &track.events {
            writeln!(text, "e,{joint},{t:e},{before},{after}")?;
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_handed_over_is_read_back() {
        let event = ModeChange::new(0.25, 1, -1);
        let track = |x| Track { samples: vec![[x; 6]], events: vec![event], n_rhs: None };
        let tracks = [track(0.1), track(-1e-300)];
        let read = read(&delivery(&tracks).unwrap()).unwrap();
        for (a, b) in tracks.iter().zip(&read) {
            assert_eq!((&a.samples, &a.events), (&b.samples, &b.events));
        }
    }
}
