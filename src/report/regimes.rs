//! The map as CSV, and its finding in words.

use std::fmt::Write as _;

use deltazero_solvers::Method;
use deltazero_study::digits::{as_meant, count_of};
use deltazero_study::map::{CellStatus, Contested, Map, MapAxis, MapCell};
use deltazero_study::quantile::quantile;
use deltazero_study::selection::{CUT, EVENTS_FROM, Entry, FINAL, Failure, FailureKind, Standings};
use deltazero_study::setting::Events;

use crate::config::Config;
use crate::csv::{self, Column, exact, field, number};
use crate::figures::Drawing;
use crate::mechanisms::text::column_of;
use crate::study::regimes::{Cell, maps, of_map};

/// A time within this factor of the winner's is near it.
const NEAR: f64 = 1.3;

/// Columns of a contest.
const CONTEST: [Column<Contested>; 38] = [
    ("accuracy", |own| number(own.accuracy)),
    ("status", |own| own.status.name().to_owned()),
    ("t_end_s", |own| exact(own.t_end_s)),
    ("horizon_s", |own| exact(own.horizon_s)),
    ("n_events", |own| super::count(own.n_events)),
    ("method", |own| text_of(own.winner(), |entry| entry.method.clone())),
    ("events", |own| text_of(own.winner(), |entry| entry.events.to_string())),
    ("rtol", |own| exact(own.winner().and_then(|entry| entry.rtol))),
    ("step", |own| exact(own.winner().and_then(|entry| entry.step))),
    ("e", |own| text_of(own.winner(), |entry| number(entry.e))),
    ("e_least", |own| text_of(own.winner(), |entry| number(entry.e_spread[0]))),
    ("e_most", |own| text_of(own.winner(), |entry| number(entry.e_spread[1]))),
    ("missed", |own| text_of(own.winner(), |entry| entry.missed.to_string())),
    ("spurious", |own| text_of(own.winner(), |entry| entry.spurious.to_string())),
    ("wall_s", |own| wall_s(own.winner())),
    ("n_rhs", |own| text_of(own.winner(), |entry| entry.n_rhs.to_string())),
    ("n_accepted", |own| text_of(own.winner(), |entry| entry.n_accepted.to_string())),
    ("second", |own| text_of(own.second(), |entry| entry.method.clone())),
    ("second_events", |own| text_of(own.second(), |entry| entry.events.to_string())),
    ("second_wall_s", |own| wall_s(own.second())),
    ("explicit", |own| text_of(best_explicit(own), name)),
    ("explicit_wall_s", |own| wall_s(best_explicit(own))),
    ("implicit", |own| text_of(best_implicit(own), name)),
    ("implicit_wall_s", |own| wall_s(best_implicit(own))),
    ("located", |own| text_of(best_located(own), name)),
    ("located_wall_s", |own| wall_s(best_located(own))),
    ("blind", |own| text_of(best_blind(own), name)),
    ("blind_wall_s", |own| wall_s(best_blind(own))),
    ("auto_over_winner", |own| exact(own.auto_over_winner())),
    ("failures", failures),
    ("error", |own| field(own.error.as_deref().unwrap_or_default())),
    ("cpu_s", |own| cpu_s(own.winner())),
    ("second_cpu_s", |own| cpu_s(own.second())),
    ("within_noise", |own| {
        field(&own.within_noise().into_iter().map(name).collect::<Vec<_>>().join("; "))
    }),
    ("explicit_cpu_s", |own| cpu_s(best_explicit(own))),
    ("implicit_cpu_s", |own| cpu_s(best_implicit(own))),
    ("located_cpu_s", |own| cpu_s(best_located(own))),
    ("blind_cpu_s", |own| cpu_s(best_blind(own))),
];

/// `regimes.csv`: one row a cell.
pub fn csv(cells: &[Cell]) -> String {
    let mut csv = format!("reading,stiffness,damping_ratio,{}\n", csv::header(&CONTEST));
    for cell in cells {
        let Cell { reading, stiffness, damping_ratio, contest } = cell;
        let contest = csv::line(contest, &CONTEST);
        let _ = writeln!(csv, "{reading},{stiffness:e},{damping_ratio:e},{contest}");
    }
    csv
}

/// `map.csv`: one row a cell and an accuracy. A parameter of a model with the name of another column has its long name.
pub fn map_csv(map: &Map) -> String {
    let is_taken = |name: &str| CONTEST.iter().any(|(column, _)| *column == name);
    let own = |MapAxis { name, .. }: &MapAxis| field(&column_of(name, is_taken(name)));
    let names = map.axes.each_ref().map(own).join(",");
    let mut csv = format!("{names},{}\n", csv::header(&CONTEST));
    for MapCell { at: [x, y], contest } in &map.cells {
        let _ = writeln!(csv, "{x:e},{y:e},{}", csv::line(contest, &CONTEST));
    }
    csv
}

/// What `of` writes of a run; nothing where there is none.
fn text_of(entry: Option<&Entry>, of: fn(&Entry) -> String) -> String {
    entry.map_or_else(String::new, of)
}

fn wall_s(entry: Option<&Entry>) -> String {
    exact(entry.map(|entry| entry.wall_s))
}

fn cpu_s(entry: Option<&Entry>) -> String {
    exact(entry.and_then(|entry| entry.cpu_s))
}

/// The fastest explicit run.
fn best_explicit(contest: &Contested) -> Option<&Entry> {
    contest.best(|entry| !entry.implicit)
}

/// The fastest implicit run.
fn best_implicit(contest: &Contested) -> Option<&Entry> {
    contest.best(|entry| entry.implicit)
}

/// The fastest run that locates events.
fn best_located(contest: &Contested) -> Option<&Entry> {
    contest.best(|entry| entry.events == Events::Located)
}

/// The fastest blind run.
fn best_blind(contest: &Contested) -> Option<&Entry> {
    contest.best(|entry| entry.events == Events::Blind)
}

/// The methods that do not arrive, each with the kind of its failure.
fn failures(contest: &Contested) -> String {
    let failure = |failure: &Failure| {
        format!("{} {}: {}", failure.method, failure.events, failure.kind.name())
    };
    let all: Vec<String> = contest.standings.failures.iter().map(failure).collect();
    field(&all.join("; "))
}

/// What the map asks, and under which rules.
pub fn lead(config: &Config) -> String {
    let right = if config.contest.right_events {
        "Every event must be right, too".to_owned()
    } else {
        format!("From e ≤ {EVENTS_FROM:e} on every event of a located run must be right, too")
    };
    format!(
        "The fastest method and setting that reaches an accuracy e, over contact stiffness K and damping \
         ratio ζ, both joints, 0 to {} s, or half the time over which the motion is predictable, or {} \
         events where there are more. {right}. A run is cut at {CUT} times the least work, a blind one at {FINAL} \
         times that of the best that locates events.",
        config.run.t_end, config.regimes.max_events
    )
}

/// `regimes.md`: the finding, the figures, a table for each reading and accuracy.
pub fn markdown(config: &Config, cells: &[Cell], drawings: &[Drawing]) -> String {
    let mut text = format!("# Where does which method win?\n\n{}\n", lead(config));
    for (reading, accuracy) in maps(cells) {
        let own: Vec<&Cell> = of_map(cells, reading, accuracy);
        let _ = write!(
            text,
            "\n## Reading `{reading}`, e ≤ {accuracy:e}\n\n- {}\n\n{}",
            findings(&own).join("\n- "),
            table(&own)
        );
    }
    for drawing in drawings {
        let _ = write!(
            text,
            "\n![{}](figures/{}.png)\n\n{}\n",
            drawing.figure.title, drawing.name, drawing.caption
        );
    }
    text
}

fn name(entry: &Entry) -> String {
    format!("{} {}", entry.method, entry.events)
}

/// What follows from the cells of one map, a sentence or two each: where implicit wins, where locating events
/// pays, what `auto` costs, where nothing arrives, where noise leaves the winner open.
pub fn findings(cells: &[&Cell]) -> Vec<String> {
    let all = [implicit(cells), location(cells), auto(cells), nothing(cells)];
    all.into_iter().chain(noise(cells)).chain(cut_short(cells)).collect()
}

/// Where are runs compared over less than the introduction says, and why? None where they are not.
fn cut_short(cells: &[&Cell]) -> Option<String> {
    let why = |cell: &&Cell| Some(format!("{} ({})", place(cell), cell.cut_short()?));
    let places: Vec<String> = cells.iter().filter_map(why).collect();
    let n = count_of(places.len(), "cell");
    let is_any = !places.is_empty();
    is_any.then(|| format!("There is no reference to the end in {n}: {}.", places.join("; ")))
}

/// Where do the times not tell who wins? None where they do.
fn noise(cells: &[&Cell]) -> Option<String> {
    let open = |cell: &&Cell| {
        let near: Vec<String> = cell.within_noise().into_iter().map(name).collect();
        let winner = name(cell.winner()?);
        (!near.is_empty()).then(|| format!("{} ({winner} or {})", place(cell), near.join(", ")))
    };
    let places: Vec<String> = cells.iter().filter_map(open).collect();
    let is_any = !places.is_empty();
    is_any.then(|| {
        let n = count_of(places.len(), "cell");
        format!("The winner is within the noise of the times in {n}: {}.", places.join("; "))
    })
}

fn place(cell: &Cell) -> String {
    format!("K = {:e}, ζ = {}", cell.stiffness, cell.damping_ratio)
}

/// Where does implicit win, and by how much?
fn implicit(cells: &[&Cell]) -> String {
    let decided = cells.iter().filter(|cell| cell.winner().is_some()).count();
    let wins: Vec<&&Cell> =
        cells.iter().filter(|cell| cell.winner().is_some_and(|entry| entry.implicit)).collect();
    if wins.is_empty() {
        return format!("Implicit wins nowhere in {decided} cells.");
    }
    let by = |cell: &&&Cell| cell.explicit_over_implicit().unwrap_or(f64::INFINITY);
    let alone = wins.iter().filter(|cell| by(cell).is_infinite());
    let (mut cut, mut lost) = (0, 0);
    for cell in alone {
        let mut kinds = cell.standings.lost(false).map(|own| own.kind).collect::<Vec<_>>();
        kinds.dedup();
        match kinds[..] {
            [] => {}
            [FailureKind::Cut] => cut += 1,
            _ => lost += 1,
        }
    }
    let mut text = format!("Implicit wins in {} of {decided} cells: ", wins.len());
    let mut zetas: Vec<f64> = wins.iter().map(|cell| cell.damping_ratio).collect();
    zetas.sort_by(f64::total_cmp);
    zetas.dedup();
    let ranges: Vec<String> = zetas
        .iter()
        .map(|zeta| {
            let own = wins.iter().filter(|cell| cell.damping_ratio == *zeta);
            let list: Vec<String> = own.map(|cell| format!("{:e}", cell.stiffness)).collect();
            format!("at ζ = {zeta} for K = {}", list.join(", "))
        })
        .collect();
    text += &ranges.join("; ");
    let measured = wins.iter().filter(|cell| by(cell).is_finite());
    if let Some(most) = measured.max_by(|a, b| by(a).total_cmp(&by(b))) {
        let _ = write!(
            text,
            ". Where both arrive it is up to {:.1} times faster ({})",
            by(most),
            place(most)
        );
    }
    if cut > 0 {
        let _ = write!(
            text,
            ". In {cut} of them no explicit method that locates events comes within {CUT} times its work"
        );
    }
    if lost > 0 {
        let _ = write!(
            text,
            ". In {lost} of them no explicit method that locates events reaches it; `failures` says why"
        );
    }
    text + "."
}

/// Where does event location pay?
fn location(cells: &[&Cell]) -> String {
    let mut ratios: Vec<(f64, &&Cell)> =
        cells.iter().filter_map(|cell| Some((cell.blind_over_located()?, cell))).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let only = |events| {
        let other = if events == Events::Blind { Events::Located } else { Events::Blind };
        cells
            .iter()
            .filter(|cell| cell.best(|entry| entry.events == events).is_some())
            .filter(|cell| cell.best(|entry| entry.events == other).is_none())
            .count()
    };
    let mut text = String::new();
    if let (Some((least, at)), Some((most, best)), Some(median)) =
        (ratios.first(), ratios.last(), median(&ratios))
    {
        let pays = ratios.iter().filter(|(ratio, _)| *ratio > 1.0).count();
        let _ = write!(
            text,
            "Locating events pays in {pays} of {} cells where both arrive: best blind over best located takes {least:.2} ({}) \
             to {most:.2} ({}) times as long, median {median:.2}. ",
            ratios.len(),
            place(at),
            place(best)
        );
    }
    let is_blind = |cell: &&&Cell| {
        let Standings { entries, failures, .. } = &cell.standings;
        let tried =
            entries.iter().map(|own| own.events).chain(failures.iter().map(|own| own.events));
        tried.into_iter().any(|events| events == Events::Blind)
    };
    if cells.iter().find(is_blind).is_none() {
        return "No run is blind.".to_owned();
    }
    let (located, blind) = (only(Events::Located), only(Events::Blind));
    let _ = write!(
        text,
        "Only located runs arrive in {}, where a blind one is given up at {FINAL} times the work of the best of \
         them; only blind ones in {blind}.",
        count_of(located, "cell")
    );
    let wrong = cells
        .iter()
        .filter_map(|cell| cell.winner())
        .filter(|entry| entry.events == Events::Blind && entry.missed + entry.spurious > 0)
        .count();
    if wrong > 0 {
        let _ = write!(
            text,
            " In {} the winner is blind and has events wrong.",
            count_of(wrong, "cell")
        );
    }
    text
}

/// The median of the ratios of cells.
fn median(ratios: &[(f64, &&Cell)]) -> Option<f64> {
    quantile(&mut ratios.iter().map(|(ratio, _)| *ratio).collect::<Vec<_>>(), 0.5)
}

/// What does it cost to leave the choice to `auto`?
fn auto(cells: &[&Cell]) -> String {
    let mut ratios: Vec<(f64, &&Cell)> =
        cells.iter().filter_map(|cell| Some((cell.auto_over_winner()?, cell))).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let decided = cells.iter().filter(|cell| cell.winner().is_some()).count();
    let (Some(median), Some((most, at))) = (median(&ratios), ratios.last()) else {
        let chooses = |own: &Failure| Method::named(&own.method).is_some_and(Method::chooses);
        let took_part = |cell: &&Cell| cell.standings.failures.iter().any(chooses);
        return match decided == 0 || cells.iter().any(took_part) {
            true => "`auto` reaches it nowhere.".to_owned(),
            false => "`auto` did not take part.".to_owned(),
        };
    };
    let near = ratios.iter().filter(|(ratio, _)| *ratio <= NEAR).count();
    let mut text = format!(
        "`auto` takes at most {NEAR} times as long as the winner in {near} of {decided} cells, median \
         {median:.2}, at most {most:.2} ({}); in {} it does not arrive.",
        place(at),
        decided - ratios.len()
    );
    let is_alone = |cell: &&&Cell| cell.winner().is_some_and(Entry::is_auto);
    let alone: Vec<String> = cells
        .iter()
        .filter(is_alone)
        .map(|cell| {
            let halves = cell.winner().and_then(Entry::implicit_steps);
            format!("{}{}", place(cell), halves.map_or_else(String::new, |own| format!(", {own}")))
        })
        .collect();
    if !alone.is_empty() {
        let _ = write!(
            text,
            " It alone arrives in {}, where neither explicit nor implicit wins: {}.",
            count_of(alone.len(), "cell"),
            alone.join("; ")
        );
    }
    text
}

/// Where does nothing reach the accuracy, and why?
fn nothing(cells: &[&Cell]) -> String {
    let lost: Vec<String> = cells
        .iter()
        .filter(|cell| cell.winner().is_none())
        .map(|cell| {
            let why = match cell.status {
                CellStatus::Ok | CellStatus::None => "every candidate fails".to_owned(),
                status => {
                    let horizon = cell.horizon_s.map(|t| format!(", horizon {} s", as_meant(t)));
                    format!("{}{}", status.name(), horizon.unwrap_or_default())
                }
            };
            format!("{} ({why})", place(cell))
        })
        .collect();
    if lost.is_empty() {
        "Nothing is out of reach: every cell has a winner.".to_owned()
    } else {
        format!("Nothing reaches it in {}: {}.", count_of(lost.len(), "cell"), lost.join("; "))
    }
}

/// Winner, setting, time and margin of each cell.
fn table(cells: &[&Cell]) -> String {
    let mut zetas: Vec<f64> = Vec::new();
    let mut stiffnesses: Vec<f64> = Vec::new();
    for cell in cells {
        if !zetas.contains(&cell.damping_ratio) {
            zetas.push(cell.damping_ratio);
        }
        if !stiffnesses.contains(&cell.stiffness) {
            stiffnesses.push(cell.stiffness);
        }
    }
    let mut text = String::from("| K [N/m] |");
    for zeta in &zetas {
        let _ = write!(text, " ζ = {zeta} |");
    }
    text += "\n|---|";
    text += &"---|".repeat(zetas.len());
    text.push('\n');
    for stiffness in &stiffnesses {
        let _ = write!(text, "| {stiffness:e} |");
        for zeta in &zetas {
            let cell = cells
                .iter()
                .find(|cell| cell.stiffness == *stiffness && cell.damping_ratio == *zeta);
            let entry = cell.and_then(|cell| cell.winner().map(|entry| (cell, entry)));
            let _ = match (entry, cell) {
                (Some((cell, entry)), _) => write!(
                    text,
                    " {}, {}, {:.2} ms{} |",
                    name(entry),
                    entry.setting(),
                    1e3 * entry.time_s(),
                    cell.margin().map_or_else(String::new, |margin| format!(", × {margin:.2}"))
                ),
                (None, Some(cell)) => write!(text, " {} |", cell.status.name()),
                (None, None) => write!(text, " |"),
            };
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::keys::ReadingName;

    /// A cell that an implicit method wins, in which explicit ones fail so.
    fn cell(failures: &[(FailureKind, Events)]) -> Cell {
        let entry = json!({
            "method": "radau5", "events": "located", "rtol": 1e-6, "step": null, "e": 1e-7,
            "e_spread": [1e-7, 1e-7], "missed": 0, "spurious": 0, "implicit": true, "n_rhs": 10,
            "n_accepted": 5, "mean_step_s": 0.1, "bound_by_stability": false, "work": 100.0,
            "wall_s": 1e-3, "grazes": false, "timed": true,
        });
        let failure = |(kind, events): &(FailureKind, Events)| Failure {
            method: "rk45".to_owned(),
            events: *events,
            implicit: false,
            kind: *kind,
            message: String::new(),
            mean_step_s: Some(1e-5),
        };
        let standings = Standings {
            entries: vec![serde_json::from_value(entry).unwrap()],
            failures: failures.iter().map(failure).collect(),
            n_trials: 1,
        };
        let contest = Contested {
            accuracy: 1e-6,
            status: CellStatus::Ok,
            error: None,
            t_end_s: Some(1.0),
            horizon_s: None,
            n_events: Some(3),
            standings,
        };
        Cell { reading: ReadingName::Pin, stiffness: 1e9, damping_ratio: 1.0, contest }
    }

    #[test]
    fn no_two_columns_of_a_map_have_one_name() {
        let axes = ["K", "e"].map(|name| MapAxis::new(name, "", &[1.0, 2.0]));
        let csv = map_csv(&Map { axes, cells: Vec::new() });
        let names: Vec<&str> = csv.trim_end().split(',').collect();
        assert_eq!(names[..3], ["K", "parameters.e", "accuracy"]);
        let distinct: std::collections::BTreeSet<&&str> = names.iter().collect();
        assert_eq!(distinct.len(), names.len(), "{csv}");
    }

    #[test]
    fn each_column_of_a_contest_is_explained() {
        let page = include_str!("../../docs/results.md");
        let table =
            &page[page.find("### `regimes.csv`").unwrap()..page.find("## Warnings").unwrap()];
        for (column, _) in CONTEST {
            assert!(table.contains(&format!("`{column}`")), "{column}");
        }
    }

    #[test]
    fn why_no_explicit_method_arrives_is_told_by_its_failures() {
        use FailureKind::{Cut, EventsWrong};
        let told = |failures: &[(FailureKind, Events)]| implicit(&[&cell(failures)]);
        let cut = told(&[(Cut, Events::Located), (EventsWrong, Events::Blind)]);
        assert!(cut.ends_with(
            "In 1 of them no explicit method that locates events comes within 10 times its work."
        ));
        let wrong = told(&[(Cut, Events::Located), (EventsWrong, Events::Located)]);
        assert!(wrong.ends_with("reaches it; `failures` says why."), "{wrong}");
        // Of what takes no part nothing is said.
        assert!(told(&[]).ends_with("for K = 1e9."), "{}", told(&[]));
    }

    #[test]
    fn cells_that_no_reference_is_of_to_the_end_are_told_with_the_reason() {
        let mut cell = cell(&[]);
        assert!(!findings(&[&cell]).concat().contains("no reference"));
        cell.contest.error = Some("no reference: dop853 stopped".to_owned());
        let told = "There is no reference to the end in 1 cell: K = 1e9, ζ = 1 (compared to 1 s; beyond: no \
                    reference: dop853 stopped).";
        assert_eq!(findings(&[&cell]).last().map(String::as_str), Some(told));
    }
}
