//! The page of a map: what follows, figures, every cell, how to redo it.

use deltazero_study::columns::Value;
use deltazero_study::digits::rounded_to;

use super::{Heading, Page, Part, Section, Table};
use crate::config::Config;
use crate::figures::Picture;
use crate::report::regimes::{findings, lead};
use crate::study::regimes::{Cell, maps, of_map};

/// The page of a map with its figures.
pub fn page(config: &Config, cells: &[Cell], pictures: Vec<Picture>) -> Page {
    let section = |title: &str, parts| Section { title: title.into(), parts };
    let mut follows = Vec::new();
    for (reading, accuracy) in maps(cells) {
        let own = findings(&of_map(cells, reading, accuracy));
        let name = format!("{reading}, e ≤ {accuracy:e}");
        follows.push((name, own.join(" ")));
    }
    Page {
        title: "Where does which method win?".into(),
        lead: lead(config),
        sections: vec![
            section("What follows", vec![Part::Facts(follows)]),
            section("Figures", pictures.into_iter().map(Part::Figure).collect()),
            section("Cells", vec![table(cells)]),
            section(
                "Redo it",
                vec![
                    Part::Text("With the configuration below as map.toml; times differ, winners that are far ahead do not:".into()),
                    Part::Code("deltazero regimes map.toml --out redone".into()),
                    Part::Folded("The configuration".into(), vec![Part::Code(config.to_toml())]),
                ],
            ),
        ],
    }
}

const COLUMNS: [(&str, &str); 13] = [
    ("reading", "where the contact forces enter"),
    ("K [N/m]", "contact stiffness"),
    ("ζ", "damping ratio"),
    ("e ≤", "the accuracy asked for"),
    ("to [s]", "the end of the runs compared"),
    ("events", "mode changes of the reference"),
    ("winner", "the fastest, or why there is none"),
    ("setting", "its tolerance or step"),
    ("time [ms]", "its shortest processor time"),
    ("within the noise", "who else may be the fastest, where the times do not tell"),
    ("second", "time of the second over that of the winner"),
    ("explicit / implicit", "time of the best explicit method over that of the best implicit one"),
    ("blind / located", "time of the best blind run over that of the best located one"),
];

fn table(cells: &[Cell]) -> Part {
    let columns = COLUMNS.map(|(name, about)| Heading { name: name.into(), about: about.into() });
    Part::Table(Table {
        caption: "Every cell; ratios are empty where one side does not arrive".into(),
        columns: columns.into(),
        rows: cells.iter().map(row).collect(),
    })
}

fn row(cell: &Cell) -> Vec<Value> {
    let first = cell.winner();
    let name =
        |entry: &deltazero_study::selection::Entry| format!("{} {}", entry.method, entry.events);
    let rounded = |x: Option<f64>| Value::Number(x.map(|x| rounded_to(x, 3)));
    vec![
        Value::Text(cell.reading.to_string()),
        Value::Number(Some(cell.stiffness)),
        Value::Number(Some(cell.damping_ratio)),
        Value::Number(Some(cell.accuracy)),
        Value::Number(cell.t_end_s),
        Value::Number(cell.n_events.map(|n| n as f64)),
        Value::Text(first.map_or_else(|| cell.status.name().to_owned(), name)),
        Value::Text(first.map_or_else(String::new, |entry| entry.setting())),
        rounded(first.map(|entry| 1e3 * entry.time_s())),
        Value::Text(cell.within_noise().into_iter().map(name).collect::<Vec<_>>().join(", ")),
        rounded(cell.margin()),
        rounded(cell.explicit_over_implicit()),
        rounded(cell.blind_over_located()),
    ]
}
