//! Histogram of step sizes by mode, a panel a method.

use deltazero_plots::{Axis, Group, Histogram, Panel};
use deltazero_study::steps::step_histogram::BinRow;
use deltazero_study::steps::step_size::{ModeKind, StepHistory};

use super::{Drawing, LANDING, in_threes, kind_color, size_axis};

/// Step sizes of each method in flight, slip and stick, all joints together.
pub(super) fn drawing(histories: &[StepHistory], rows: &[BinRow]) -> Drawing {
    let methods: Vec<&[BinRow]> = rows.chunk_by(|a, b| a.method == b.method).collect();
    let most = rows.iter().map(|row| row.n_steps).max().unwrap_or(1) as f64;
    let kinds: Vec<ModeKind> =
        ModeKind::ALL.into_iter().filter(|kind| rows.iter().any(|row| row.kind == *kind)).collect();
    let panel = |own: &&[BinRow]| -> Panel {
        let mut bins: Vec<(f64, f64)> = own.iter().map(|row| row.h_s).collect();
        bins.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        bins.dedup();
        let count = |kind: ModeKind, bin: (f64, f64)| {
            let row = own.iter().find(|row| row.kind == kind && row.h_s == bin);
            row.map_or(0.0, |row| row.n_steps as f64)
        };
        let group = |&kind: &ModeKind| Group {
            label: kind.name().into(),
            color: kind_color(kind),
            counts: bins.iter().map(|&bin| count(kind, bin)).collect(),
        };
        Histogram {
            title: own[0].method.clone() + ", " + &own[0].setting,
            x: size_axis(histories),
            y: Axis::log("accepted steps").within(0.5, 2.0 * most),
            groups: kinds.iter().map(group).collect(),
            bins,
        }
        .into()
    };
    let panels: Vec<Panel> = methods.iter().map(panel).collect();
    let findings: Vec<String> = methods.iter().map(|own| finding(own)).collect();
    let caption = format!(
        "Accepted steps by size, in tenths of a decade; the settings are those of the \
         step sizes over time. The smallest steps of each method, a thousandth of them, and those that land on an \
         event in less than {LANDING:e} of the run, may lie left of what is shown. {}.",
        findings.join("; ")
    );
    let figure = in_threes("How large are the steps", panels);
    Drawing { name: "step_histogram", caption, figure }
}

/// The most frequent size of a method in each mode.
fn finding(own: &[BinRow]) -> String {
    let most = |kind: ModeKind| {
        let rows = || own.iter().filter(|row| row.kind == kind);
        let peak = rows().max_by_key(|row| row.n_steps)?;
        let sum: u64 = rows().map(|row| row.n_steps).sum();
        let h = libm::sqrt(peak.h_s.0 * peak.h_s.1);
        Some(format!("{sum} in {}, most near {h:.1e} s", kind.name()))
    };
    let kinds: Vec<String> = ModeKind::ALL.into_iter().filter_map(most).collect();
    format!("{}: {}", own[0].method, kinds.join(", "))
}
