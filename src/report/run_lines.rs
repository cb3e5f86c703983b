//! What `simulate` prints of a run.

use deltazero_study::digits::{as_meant, count_of};
use deltazero_study::errors::contact_summary::ContactSummary;
use deltazero_study::horizon::Horizon;
use deltazero_study::warning::place;

use super::run_record::{RunRecord, Simulated};

/// The run in a line, each of its parts in one or two, how far it is predictable.
pub fn run_lines(record: &RunRecord, parts: &[Simulated<'_>], is_interrupted: bool) -> String {
    let counts = &record.parts.counts;
    let mut text = format!(
        "{}: {}, {}, {} ({} rejected, {} retaken), {:.2} ms{}\n",
        record.parts.outcome,
        count_of(counts.n_events, "event"),
        count_of(counts.n_rhs, "right-hand side"),
        count_of(counts.n_accepted, "step"),
        counts.n_rejected,
        counts.n_retaken,
        1e3 * record.wall_s,
        match record.batch {
            n if n > 1 => format!(" ({n} parts at once)"),
            _ => String::new(),
        }
    );
    for part in parts {
        text += &part_line(part);
        text += &contact_line(part).unwrap_or_default();
    }
    text += &horizon_line(record.horizon_s, record.parts.error.is_some(), is_interrupted);
    match record.warnings.len() {
        0 => {}
        n => text += &format!("{}, in run.json\n", count_of(n, "warning")),
    }
    text
}

/// A part in a line: where it ended, in which mode, and how good its energy balance is.
fn part_line(Simulated { part, own, .. }: &Simulated<'_>) -> String {
    let name = match (part.name.as_str(), part.sites.len()) {
        ("", _) => String::new(),
        (name, 1) => format!("{name}: "),
        (name, n) => format!("{name} of {n} {}s: ", part.labels[0][0].0),
    };
    let t = own.run.t;
    let end = match own.stopped {
        Some(site) => {
            let place = match part.labels[site].first() {
                Some((label, value)) if part.sites.len() > 1 => format!("{label} {value} "),
                _ => String::new(),
            };
            format!("{place}{} at {t:.6} s, {}", part.end_name.words, own.end)
        }
        None => format!("{} at t = {t:e} s", own.end),
    };
    let energy = own.balance.map_or_else(String::new, |balance| {
        format!("; energy residual {:.1e} J of {:.1e} J of work", balance.residual, balance.work)
    });
    format!("{name}{end}, {}{energy}\n", own.run.mode)
}

/// The contacts of a part in a line; none where there are none.
fn contact_line(Simulated { own, .. }: &Simulated<'_>) -> Option<String> {
    let own = ContactSummary::of(own.contacts.iter().flatten().flatten());
    let (force, at) = own.peak_force_n.zip(own.peak_force_at_s)?;
    let speeds = own.smallest_impact_speed_m_s.zip(own.largest_impact_speed_m_s);
    // A contact without penetration has no rate of it.
    let speeds = speeds.filter(|(_, most)| *most > 0.0);
    let speeds = speeds.map_or_else(String::new, |(least, most)| {
        format!(", impacts at {least:.3e} to {most:.3e} m/s")
    });
    Some(format!(
        "  {}: peak force {force:.4e} N at {at:.6} s, deepest {:.3e} m{speeds}, impulse {:.4e} N s, \
         longest {:.3e} s\n",
        count_of(own.n, "contact"),
        own.deepest_m?,
        own.impulse_n_s,
        own.longest_s?
    ))
}

fn horizon_line(horizon: Option<Horizon>, has_failed: bool, is_interrupted: bool) -> String {
    match horizon {
        Some(Horizon::LostAt(t)) => format!("predictable up to {} s\n", as_meant(t)),
        Some(Horizon::WholeRun) if has_failed => "predictable as far as it came\n".to_owned(),
        Some(Horizon::WholeRun) => "predictable to its end\n".to_owned(),
        Some(Horizon::NotMeasured) if is_interrupted => "horizon not measured\n".to_owned(),
        Some(Horizon::NotMeasured) => {
            "horizon not measured: no tight run came to the end at a few times the work\n"
                .to_owned()
        }
        None => String::new(),
    }
}

/// The message of a failed run: where, in which mode, what to try.
pub fn failure(parts: &[Simulated<'_>]) -> String {
    let failed = parts.iter().find_map(|part| Some((part, part.failed()?)));
    let Some((Simulated { part, own, .. }, failed)) = failed else { return String::new() };
    let lines = own.failed_place.as_ref().map_or_else(String::new, |lines| format!("\n{lines}"));
    let (place, message) = (place(&part.name), failed.message);
    format!("{place}{message}; what was computed until then is written{lines}")
}
