//! A report as one HTML file that needs no other: style, script and figures are in it.
//!
//! A [`Page`] is a value; what it says is escaped by the macro that writes it. It loads nothing, which
//! its own content security policy enforces.

mod audit;
mod regimes;
mod study;
mod sweep;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use audit::page as audit_page;
pub use regimes::page as regimes_page;
pub use study::page as study_page;
pub use sweep::page as sweep_page;

use deltazero_study::columns::Value;

use crate::figures::Picture;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("sort.js");
/// Nothing from outside; style, script and images only out of the page itself.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";
/// An SVG beyond this size [bytes] stands in the page as its PNG, of half that size; the largest of the
/// default study, the steps of seven methods, has 580 kB.
const LARGEST_SVG: usize = 600_000;
/// Text in a table beyond this length [characters] is broken into lines.
const LONG_TEXT: usize = 40;

/// A report.
#[derive(Clone, Debug)]
pub struct Page {
    /// The question.
    pub title: String,
    /// What it is asked of.
    pub lead: String,
    /// The parts that the contents list.
    pub sections: Vec<Section>,
}

/// A part of a report with a heading.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What stands there.
    pub parts: Vec<Part>,
}

/// What a section is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// A paragraph.
    Text(String),
    /// Names and what they are.
    Facts(Vec<(String, String)>),
    /// A table.
    Table(Table),
    /// A figure with its caption; its files are expected in `figures/`.
    Figure(Picture),
    /// Commands or a file, as they are typed.
    Code(String),
    /// What is shown on demand, under this line, and in print.
    Folded(String, Vec<Part>),
}

/// A table whose headers sort it.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// One a column.
    pub columns: Vec<Heading>,
    /// As many values as columns in each.
    pub rows: Vec<Vec<Value>>,
}

/// The head of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    /// Name, with unit.
    pub name: String,
    /// What it means; may be empty.
    pub about: String,
}

impl Page {
    /// The file.
    pub fn html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        h1 { (self.title) }
                        p { (self.lead) }
                        nav aria-label="Contents" {
                            @for section in &self.sections {
                                a href={ "#" (anchor(&section.title)) } { (section.title) } " "
                            }
                        }
                    }
                    main {
                        @for section in &self.sections {
                            section id=(anchor(&section.title)) {
                                h2 { (section.title) }
                                @for part in &section.parts { (part.html()) }
                            }
                        }
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string() + "\n"
    }
}

impl Part {
    fn html(&self) -> Markup {
        match self {
            Self::Text(text) => html! { p { (text) } },
            Self::Facts(facts) => html! {
                dl {
                    @for (name, what) in facts { div { dt { (name) } dd { (what) } } }
                }
            },
            Self::Table(table) => table.html(),
            Self::Figure(picture) => figure(picture),
            Self::Code(text) => html! { pre tabindex="0" { code { (text) } } },
            Self::Folded(line, parts) => html! {
                details { summary { (line) } @for part in parts { (part.html()) } }
            },
        }
    }
}

impl Table {
    fn is_numeric(&self, column: usize) -> bool {
        let values = self.rows.iter().filter_map(|row| row.get(column));
        !self.rows.is_empty() && values.into_iter().all(is_number)
    }

    fn html(&self) -> Markup {
        html! {
            div.scroll tabindex="0" role="region" aria-label=(self.caption) {
                table.sorts style={ "--columns:" (self.columns.len()) } {
                    caption { span { (self.caption) } }
                    thead {
                        tr {
                            @for (i, column) in self.columns.iter().enumerate() {
                                th.number[self.is_numeric(i)] scope="col" title=[some(&column.about)] {
                                    (breakable(&column.name))
                                }
                            }
                        }
                    }
                    tbody {
                        @for row in &self.rows { tr { @for value in row { (cell(value)) } } }
                    }
                }
            }
        }
    }
}

/// A name that may be broken after its underscores.
fn breakable(name: &str) -> Markup {
    html! {
        @for (i, part) in name.split_inclusive('_').enumerate() { @if i > 0 { wbr; } (part) }
    }
}

/// Whether it is one, or a text that is one or nothing.
fn is_number(value: &Value) -> bool {
    match value {
        Value::Text(text) => text.is_empty() || text.parse::<f64>().is_ok(),
        _ => true,
    }
}

fn cell(value: &Value) -> Markup {
    match value {
        Value::Text(text) if is_number(value) => html! { td.number { (text) } },
        Value::Text(text) if text.chars().count() > LONG_TEXT => html! { td.long { (text) } },
        Value::Text(text) => html! { td { (text) } },
        Value::Number(x) => html! { td.number { (number(*x)) } },
        Value::Count(n) => html! { td.number { @if let Some(n) = n { (n) } } },
    }
}

/// The shortest of its exact forms and three digits; nothing for one that is not defined.
fn number(x: Option<f64>) -> String {
    let Some(x) = x.filter(|x| !x.is_nan()) else { return String::new() };
    let forms = [x.to_string(), format!("{x:e}"), format!("{x:.2e}")];
    forms.into_iter().min_by_key(String::len).unwrap_or_default()
}

fn figure(picture: &Picture) -> Markup {
    let file = format!("figures/{}", picture.name);
    html! {
        figure id=(picture.name) {
            h3 { (picture.title) }
            div.card { (image(picture)) }
            figcaption {
                (picture.caption) " "
                span.files { "Files: " a href={ (file) ".png" } { "PNG" } " " a href={ (file) ".svg" } { "SVG" } }
            }
        }
    }
}

fn image(picture: &Picture) -> Markup {
    if picture.svg.len() > LARGEST_SVG {
        let data = STANDARD.encode(&picture.png);
        return html! { img src={ "data:image/png;base64," (data) } alt=(picture.title); };
    }
    let label = html! { svg role="img" aria-label=(picture.title) {} }.into_string();
    let label = label.trim_end_matches("></svg>");
    PreEscaped(picture.svg.replacen("<svg", label, 1))
}

/// A heading as the target of a link.
fn anchor(title: &str) -> String {
    title.to_lowercase().replace(' ', "-")
}

fn some(text: &str) -> Option<&str> {
    (!text.is_empty()).then_some(text)
}
