//! Penetration and normal force over time, with a zoom on one impact.

use deltazero_plots::{Axis, Band, Figure, Level, LineChart, Panel, Series, Size};
use deltazero_study::motion::Motion;
use deltazero_study::simulation::SiteMotion;

use super::Drawing;

/// Name of its files.
pub(super) const NAME: &str = "gap_and_force";

/// A unit of penetration, and how many of it are a metre.
type Unit = (&'static str, f64);

/// Colours of penetration, force and contact.
const DELTA: usize = 0;
const FORCE: usize = 1;
const CONTACT: usize = 2;

/// A site at one time: [s], [m], [N].
type Point = (f64, f64, f64);

/// δ and, where a contact lasts, F_N of the first site: the whole run on the left, one impact on the right; none where its
/// contact is not told.
pub(super) fn drawing(motion: &Motion) -> Option<Drawing> {
    let whole = points(motion.sites.first()?);
    let zoom = points(&motion.zoom);
    if whole.is_empty() || zoom.is_empty() {
        return None;
    }
    let (title, shown) = match (motion.flight, &motion.stay) {
        (Some(_), _) => ("one flight and impact", "one flight and the impact after it"),
        (None, Some(_)) => {
            ("one stay", "one stay in a mode and what follows, for there is no flight")
        }
        (None, None) => ("the start", "the start, for there is no flight"),
    };
    let most = |of: fn(&Point) -> f64| whole.iter().map(of).fold(0.0_f64, f64::max);
    let (deepest, widest, hardest) = (most(|p| p.1), most(|p| -p.1), most(|p| p.2));
    // A gap a hundred times as wide as the deepest penetration is what is seen; else the penetration is.
    let seen = if widest > 100.0 * deepest { widest } else { deepest };
    let unit = match seen {
        1.0.. => ("m", 1.0),
        1e-3.. => ("mm", 1e3),
        1e-6.. => ("µm", 1e6),
        _ => ("nm", 1e9),
    };
    let mut panels = vec![
        delta_panel("whole run", unit, &whole, Vec::new()),
        delta_panel(title, unit, &zoom, contact_bands(&motion.zoom)),
    ];
    let mut sites = motion.sites.iter().take(1).chain([&motion.zoom]);
    let lasts = sites.any(|site| site.touches.iter().any(|(is_contact, _)| *is_contact));
    if lasts {
        panels.push(force_panel(&whole, Vec::new()));
        panels.push(force_panel(&zoom, contact_bands(&motion.zoom)));
    }
    let (and_force, largest, shaded) = match lasts {
        true => (
            " and normal force F_N",
            format!(", largest force {hardest:.2} N"),
            "; shaded: contact",
        ),
        false => ("", String::new(), "; no contact lasts"),
    };
    let name = &motion.zoom.name;
    let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
    let caption = format!(
        "Penetration δ (below zero the gap){and_force}{of}, by {}. Deepest {deepest:.2e} m, widest gap {widest:.2e} m{largest} \
         among the points shown. Right: {shown}{shaded}.",
        motion.method
    );
    let figure = Figure {
        title: format!("Contact and separation{of}"),
        rows: if lasts { 2 } else { 1 },
        cols: 2,
        panels,
        size: Size { width: 1100, height: if lasts { 720 } else { 400 } },
        ..Figure::default()
    };
    Some(Drawing { name: NAME, caption, figure })
}

/// Time, penetration and force at each sample of a site.
fn points(site: &SiteMotion) -> Vec<Point> {
    let pairs = site.times.iter().zip(&site.touches);
    pairs.map(|(t, (_, touch))| (*t, touch.depth, touch.force)).collect()
}

fn delta_panel(title: &str, (unit, per_metre): Unit, rows: &[Point], bands: Vec<Band>) -> Panel {
    let points = rows.iter().map(|(t, depth, _)| (*t, per_metre * depth)).collect();
    LineChart {
        title: title.into(),
        x: Axis::linear("t [s]"),
        y: Axis::linear(format!("penetration δ [{unit}]")),
        series: vec![Series::line("", DELTA, points)],
        levels: vec![Level { y: 0.0, label: String::new() }],
        bands,
        ..LineChart::default()
    }
    .into()
}

fn force_panel(rows: &[Point], bands: Vec<Band>) -> Panel {
    let points = rows.iter().map(|(t, _, force)| (*t, *force)).collect();
    LineChart {
        x: Axis::linear("t [s]"),
        y: Axis::linear("normal force F_N [N]"),
        series: vec![Series::line("", FORCE, points)],
        bands,
        ..LineChart::default()
    }
    .into()
}

/// The parts of the zoom in contact.
fn contact_bands(zoom: &SiteMotion) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    let mut was_contact = false;
    for (t, (is_contact, _)) in zoom.times.iter().zip(&zoom.touches) {
        match bands.last_mut() {
            Some(band) if was_contact => band.x.1 = *t,
            _ if *is_contact => {
                bands.push(Band { x: (*t, *t), color: CONTACT, label: "contact".into() });
            }
            _ => {}
        }
        was_contact = *is_contact;
    }
    bands.retain(|band| band.x.1 > band.x.0);
    bands
}
