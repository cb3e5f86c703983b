//! Histogram of step sizes by mode, a panel a method.

use deltazero_plots::{Axis, Group, Histogram, Panel};
use deltazero_study::steps::step_histogram::BinRow;
use deltazero_study::steps::step_size::StepHistory;

use super::modes::{Look, look, looks, quoted};
use super::{Drawing, LANDING, in_threes, size_axis};

/// Step sizes of each method in flight, contact and stick, or in each mode that has a name; all joints together.
pub(super) fn drawing(histories: &[StepHistory], rows: &[BinRow]) -> Drawing {
    let methods: Vec<&[BinRow]> = rows.chunk_by(|a, b| a.method == b.method).collect();
    let most = rows.iter().map(|row| row.n_steps).max().unwrap_or(1) as f64;
    let modes = histories.first().map_or(&[][..], |history| &history.modes);
    let looks = looks(modes, rows.iter().map(|row| (row.mode.as_str(), row.kind)));
    let is_of = |row: &BinRow, own: &Look| look(modes, &row.mode, row.kind) == *own;
    let panel = |own: &&[BinRow]| -> Panel {
        let mut bins: Vec<(f64, f64)> = own.iter().map(|row| row.h_s).collect();
        bins.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        bins.dedup();
        let count = |look: &Look, bin: (f64, f64)| {
            let rows = own.iter().filter(|row| row.h_s == bin && is_of(row, look));
            rows.map(|row| row.n_steps as f64).sum()
        };
        let group = |look: &Look| Group {
            label: look.0.clone(),
            color: look.1,
            counts: bins.iter().map(|&bin| count(look, bin)).collect(),
        };
        Histogram {
            title: own[0].method.clone() + ", " + &own[0].setting,
            x: size_axis(histories),
            y: Axis::log("accepted steps").within(0.5, 2.0 * most),
            groups: looks.iter().map(group).collect(),
            bins,
        }
        .into()
    };
    let panels: Vec<Panel> = methods.iter().map(panel).collect();
    let finding = |own: &&[BinRow]| {
        let rows = |look| own.iter().filter(move |row| is_of(row, look));
        let name = |look: &Look| if modes.is_empty() { look.0.clone() } else { quoted([&look.0]) };
        let peaks = looks.iter().filter_map(|look| peak(rows(look), &name(look)));
        format!("{}: {}", own[0].method, peaks.collect::<Vec<_>>().join(", "))
    };
    let findings: Vec<String> = methods.iter().map(finding).collect();
    let caption = format!(
        "Accepted steps by size, in tenths of a decade; the settings are those of the \
         step sizes over time. The smallest steps of each method, a thousandth of them, and those that land on an \
         event in less than {LANDING:e} of the run, may lie left of what is shown. {}.",
        findings.join("; ")
    );
    let figure = in_threes("How large are the steps", panels);
    Drawing { name: "step_histogram", caption, figure }
}

/// How many steps these are in a mode, and their most frequent size.
fn peak<'a>(rows: impl Iterator<Item = &'a BinRow> + Clone, mode: &str) -> Option<String> {
    let peak = rows.clone().max_by_key(|row| row.n_steps)?;
    let sum: u64 = rows.map(|row| row.n_steps).sum();
    let h = libm::sqrt(peak.h_s.0 * peak.h_s.1);
    Some(format!("{sum} in {mode}, most near {h:.1e} s"))
}
