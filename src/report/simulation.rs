//! The motion of a run as CSV.

use std::fmt::Write as _;
use std::io::{self, Write};

use deltazero_study::motion::Motion;
use deltazero_study::problem::Quantity;
use deltazero_study::simulation::{NamedChange, SiteMotion};

use crate::csv::{exact, field};

/// `trajectory.csv`: what tells the sites apart, time, mode and the columns of each; sites in their order.
///
/// # Errors
/// Those of `out`.
pub fn trajectory_csv(out: &mut dyn Write, sites: &[&SiteMotion]) -> io::Result<()> {
    let Some(first) = sites.first() else { return Ok(()) };
    let mut header = label_names(first);
    header.extend(["t_s".to_owned(), "mode".to_owned()]);
    header.extend(first.columns.iter().map(header_field));
    writeln!(out, "{}", header.join(","))?;
    let mut sites = sites.to_vec();
    sites.sort_by_key(|site| site.labels.iter().rev().map(|(_, value)| *value).collect::<Vec<_>>());
    for site in sites {
        let labels = labels(site);
        for (t, mode, values) in site.samples() {
            let values: Vec<String> = values.iter().map(finite).collect();
            writeln!(out, "{labels}{t:e},{},{}", field(mode), values.join(","))?;
        }
    }
    Ok(())
}

/// A number; nothing where it is none. A diverging state may be finite where its forces are not.
fn finite(x: &f64) -> String {
    exact(x.is_finite().then_some(*x))
}

/// `events.csv`: the mode changes, sorted by time, then by what tells the sites apart.
pub fn events_csv(sites: &[&SiteMotion]) -> String {
    let changes = |site: &&SiteMotion| -> Vec<(Vec<usize>, String, NamedChange)> {
        let place: Vec<usize> = site.labels.iter().map(|(_, value)| *value).collect();
        let labels = labels(site);
        site.changes.iter().map(|change| (place.clone(), labels.clone(), change.clone())).collect()
    };
    let mut rows: Vec<_> = sites.iter().flat_map(changes).collect();
    rows.sort_by(|a, b| a.2.t.total_cmp(&b.2.t).then_with(|| a.0.cmp(&b.0)));
    let mut header = sites.first().map_or_else(Vec::new, |site| label_names(site));
    header.extend(["t_s", "mode_before", "mode_after"].map(str::to_owned));
    let mut csv = header.join(",") + "\n";
    for (_, labels, NamedChange { t, before, after, .. }) in rows {
        let _ = writeln!(csv, "{labels}{t:e},{},{}", field(&before), field(&after));
    }
    csv
}

/// `motion.csv`: what the figures of the motion show, the whole run and what is zoomed in on; penetration and force where they are
/// known.
pub fn motion_csv(motion: &Motion) -> String {
    let first = &motion.zoom;
    let mut header = vec!["shown".to_owned()];
    header.extend(label_names(first));
    header.extend(["t_s".to_owned(), "mode".to_owned()]);
    header.extend(first.columns.iter().map(header_field));
    // Where the columns do not have them.
    let adds = ["delta_m", "f_n_n"].map(|name| !header.iter().any(|own| own == name));
    let names = ["delta_m", "f_n_n"].into_iter().zip(adds);
    header.extend(names.filter(|(_, adds)| *adds).map(|(name, _)| name.to_owned()));
    let mut csv = header.join(",") + "\n";
    let close =
        std::iter::once(("zoom", first)).chain(motion.detail.iter().map(|site| ("detail", site)));
    for (shown, site) in motion.sites.iter().map(|site| ("whole", site)).chain(close) {
        let labels = labels(site);
        for (i, (t, mode, values)) in site.samples().enumerate() {
            let touch = site.touches.get(i).map(|(_, touch)| *touch);
            let (depth, force) = (touch.map(|touch| touch.depth), touch.map(|touch| touch.force));
            let mut values: Vec<String> = values.iter().map(finite).collect();
            let more = [depth, force].into_iter().zip(adds).filter(|(_, adds)| *adds);
            values.extend(more.map(|(x, _)| x.as_ref().map_or_else(String::new, finite)));
            let _ = writeln!(csv, "{shown},{labels}{t:e},{},{}", field(mode), values.join(","));
        }
    }
    csv
}

/// What is above a column: the unit of a model is any text.
fn header_field(column: &Quantity) -> String {
    field(&column.header())
}

fn label_names(site: &SiteMotion) -> Vec<String> {
    site.labels.iter().map(|(name, _)| (*name).to_owned()).collect()
}

/// The leading fields of a row, each followed by a comma.
fn labels(site: &SiteMotion) -> String {
    site.labels.iter().map(|(_, value)| format!("{value},")).collect()
}
