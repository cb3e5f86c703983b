//! The orbit of each pin inside its clearance circle.

use deltazero_plots::{Axis, Circle, Figure, Orbit, Panel, Series, Size};
use deltazero_study::motion::Motion;
use deltazero_study::simulation::SiteMotion;

use super::Drawing;

/// Name of its files.
pub(super) const NAME: &str = "orbit";

/// Columns of the pin's displacement in its bush.
const PIN: [&str; 2] = ["d1", "d2"];

/// The orbit of each pin in its bush, scaled to µm; none of a motion without pins. `clearances` are those of the joints,
/// in their order.
pub(super) fn drawing(motion: &Motion, clearances: &[f64]) -> Option<Drawing> {
    let orbits = motion.sites.iter().zip(clearances);
    let panels =
        orbits.map(|(site, clearance)| panel(site, *clearance)).collect::<Option<Vec<_>>>()?;
    if panels.is_empty() {
        return None;
    }
    let share = |site: &SiteMotion| -> String {
        let free = site.touches.iter().filter(|(is_contact, _)| !is_contact).count();
        let share = 100.0 * free as f64 / site.touches.len().max(1) as f64;
        format!("{share:.1} % of the time in {}", site.name)
    };
    let with_contact = motion.sites.iter().filter(|site| !site.touches.is_empty());
    let shares: Vec<String> = with_contact.map(share).collect();
    let mut caption = format!("Orbit of the pin centres in their bushes, {}.", motion.method);
    if !shares.is_empty() {
        let shares = shares.join(" and ");
        caption += &format!(" The pin is free {shares}; else it rolls and slips along the bush.");
    }
    let figure = Figure {
        title: "Pin orbits".into(),
        rows: 1,
        cols: panels.len(),
        panels,
        size: Size { width: 1100, height: 600 },
        ..Figure::default()
    };
    Some(Drawing { name: NAME, caption, figure })
}

fn panel(site: &SiteMotion, clearance: f64) -> Option<Panel> {
    let place = |name| site.columns.iter().position(|column| column.name == name);
    let [x, y] = [place(PIN[0])?, place(PIN[1])?];
    let points = site.samples().map(|(_, _, row)| (1e6 * row[x], 1e6 * row[y])).collect();
    let (center, label) = ((0.0, 0.0), "clearance circle".to_owned());
    let orbit = Orbit {
        title: site.name.clone(),
        x: Axis::linear("d1 [µm]"),
        y: Axis::linear("d2 [µm]"),
        curves: vec![Series::line("pin centre", 0, points)],
        circle: (clearance > 0.0).then_some(Circle { center, radius: 1e6 * clearance, label }),
    };
    Some(orbit.into())
}
