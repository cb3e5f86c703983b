//! A recommendation as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use deltazero_study::recommend::Recommendation;
use deltazero_study::selection::Entry;

/// Columns of a terminal.
const WIDTH: usize = 80;
/// Lines of the ranking.
const SHOWN: usize = 8;

/// The answer for machines: the keys of the interface and no other.
pub fn json(answer: &Recommendation) -> Value {
    let first = answer.first();
    let mut all = entry(first, answer.accuracy, &answer.reason);
    let rivals = answer.standings.entries.iter().skip(1);
    let runners_up: Vec<Value> =
        rivals.map(|rival| entry(Some(rival), answer.accuracy, &distance(first, rival))).collect();
    all["runners_up"] = json!(runners_up);
    all["warnings"] = json!(answer.warnings);
    all
}

fn entry(entry: Option<&Entry>, accuracy: f64, reason: &str) -> Value {
    json!({
        "method": entry.map(|entry| &entry.method),
        "events": entry.map(|entry| entry.events),
        "rtol": entry.and_then(|entry| entry.rtol),
        "step": entry.and_then(|entry| entry.step),
        "accuracy": accuracy,
        "expected_e": entry.map(|entry| entry.e),
        "expected_e_spread": entry.map(|entry| entry.e_spread),
        "expected_wall_s": entry.map(|entry| entry.wall_s),
        "expected_cpu_s": entry.and_then(|entry| entry.cpu_s),
        "reason": reason,
    })
}

/// How far a runner-up is behind, and what it is if it is `auto`.
fn distance(first: Option<&Entry>, rival: &Entry) -> String {
    let halves = rival.implicit_steps().map_or_else(String::new, |halves| format!("; {halves}"));
    first.map_or_else(String::new, |first| {
        let near = if rival.is_within_noise_of(first) { ", within the noise" } else { "" };
        format!(
            "{:.2} times the time of {} {}{near}{halves}",
            rival.time_s() / first.time_s(),
            first.method,
            first.events
        )
    })
}

/// The answer for readers.
pub fn text(answer: &Recommendation) -> String {
    let mut text = String::new();
    let asked = format!("e <= {:e} over {} s", answer.accuracy, answer.t_end);
    match answer.first() {
        None => text += &wrapped(&format!("{asked}: none. {}.", answer.reason), ""),
        Some(first) => {
            let _ = write!(
                text,
                "{asked}: {} {}, {}\n\n[solver]\nmethod = \"{}\"\nevents = \"{}\"\n",
                first.method,
                first.events,
                first.setting(),
                first.method,
                first.events
            );
            for (key, value) in [("rtol", first.rtol), ("step", first.step)] {
                if let Some(value) = value {
                    let _ = writeln!(text, "{key} = {value:e}");
                }
            }
            let [least, most] = first.e_spread;
            let _ = write!(
                text,
                "\nexpected: e = {:.1e} ({least:.1e} to {most:.1e} beside it), {} ms, n_rhs = {}\n",
                first.e,
                milliseconds(first.time_s()),
                first.n_rhs
            );
            text += &wrapped(&format!("why: {}.", answer.reason), "     ");
            text += &ranking(answer, first);
        }
    }
    let failures = &answer.standings.failures;
    if !failures.is_empty() {
        let list: Vec<String> = failures
            .iter()
            .map(|failure| {
                format!("{} {} ({})", failure.method, failure.events, failure.kind.name())
            })
            .collect();
        text += &wrapped(&format!("\nnot reached by: {}", list.join(", ")), "  ");
    }
    for warning in &answer.warnings {
        text += &wrapped(&format!("warning ({}): {}", warning.code.name(), warning.message), "  ");
    }
    text
}

fn ranking(answer: &Recommendation, first: &Entry) -> String {
    let mut text = String::from(
        "\nmethod    events   setting          e        time [ms]  to first  wrong events\n",
    );
    let entries = &answer.standings.entries;
    let mut halves = String::new();
    for entry in entries.iter().take(SHOWN) {
        if let Some(own) = entry.implicit_steps() {
            let _ = writeln!(halves, "{} {}: {own}", entry.method, entry.events);
        }
        let _ = writeln!(
            text,
            "{:<9} {:<8} {:<15}  {:<7.1e}  {:>9}  {:>8.2}  {:>12}",
            entry.method,
            entry.events.name(),
            entry.setting(),
            entry.e,
            milliseconds(entry.time_s()),
            entry.time_s() / first.time_s(),
            entry.missed + entry.spurious,
        );
    }
    if entries.len() > SHOWN {
        let _ = writeln!(text, "and {} more", entries.len() - SHOWN);
    }
    text + &of_work(&entries[..entries.len().min(SHOWN)]) + &halves
}

/// Which of these entries are in the order of their work, where some are; the others are in that of their time.
fn of_work(entries: &[Entry]) -> String {
    let untimed: Vec<String> = entries
        .iter()
        .filter(|entry| !entry.timed)
        .map(|entry| format!("{} {}", entry.method, entry.events))
        .collect();
    if untimed.is_empty() {
        return String::new();
    }
    wrapped(&format!("not timed in turns, in the order of work: {}", untimed.join(", ")), "  ")
}

fn milliseconds(time_s: f64) -> String {
    format!("{:.2}", 1e3 * time_s)
}

/// Text in lines of at most [`WIDTH`] columns, all but the first begun with `indent`.
fn wrapped(text: &str, indent: &str) -> String {
    let mut out = String::new();
    for paragraph in text.split('\n') {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if line.chars().count() + 1 + word.chars().count() > WIDTH && !line.trim().is_empty() {
                out += &line;
                out.push('\n');
                line = indent.to_owned();
            } else if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        out += &line;
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranked(method: &str, timed: bool) -> Entry {
        let entry = json!({
            "method": method, "events": "located", "rtol": 1e-6, "step": null, "e": 1e-7,
            "e_spread": [1e-7, 1e-7], "missed": 0, "spurious": 0, "implicit": true, "n_rhs": 10,
            "n_accepted": 5, "mean_step_s": 0.1, "bound_by_stability": false, "work": 100.0,
            "wall_s": 1e-3, "grazes": false, "timed": timed,
        });
        serde_json::from_value(entry).unwrap()
    }

    #[test]
    fn those_that_are_not_in_the_order_of_time_are_named() {
        let all = [ranked("dop853", true), ranked("rk43", false), ranked("radau5", false)];
        assert_eq!(of_work(&all[..1]), "");
        let told = "not timed in turns, in the order of work: rk43 located, radau5 located\n";
        assert_eq!(of_work(&all), told);
    }

    #[test]
    fn lines_are_wrapped_at_the_width_of_a_terminal() {
        let long = "word ".repeat(40);
        let text = wrapped(&long, "  ");
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("  word")), "{text}");
        assert_eq!(text.split_whitespace().count(), 40);
    }
}
