//! All files of a study.

use deltazero_plots::Error;
use deltazero_study::Plan;
use deltazero_study::work_precision::WorkPrecision;

use super::{About, html, study_csv, study_markdown};
use crate::figures::{self, Drawing};
use crate::study::record::Provenance;

/// A file with its name, in which folders are named too.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Its name.
    pub name: String,
    /// What is in it.
    pub content: Vec<u8>,
}

impl File {
    /// A file of text.
    pub fn text(name: &str, text: String) -> Self {
        Self { name: name.to_owned(), content: text.into_bytes() }
    }
}

/// `study.csv`, `study.md`, `report.html`, and the figures with `figures/` before their names.
///
/// # Errors
/// Where a figure cannot be drawn, with its name.
pub fn study_files(
    about: &About,
    plan: &Plan,
    table: &WorkPrecision,
    provenance: &Provenance,
    drawings: &[Drawing],
) -> Result<Vec<File>, (&'static str, Error)> {
    let mut files = vec![File::text("study.csv", study_csv(about, table))];
    let mut pictures = Vec::new();
    for picture in figures::pictures(drawings)? {
        files.push(File::text(&format!("figures/{}.svg", picture.name), picture.svg.clone()));
        let (name, content) = (format!("figures/{}.png", picture.name), picture.png.clone());
        files.push(File { name, content });
        pictures.push(picture);
    }
    files.push(File::text("study.md", study_markdown(about, table, drawings)));
    let page = html::study_page(about, plan, table, provenance, pictures);
    files.push(File::text("report.html", page.html()));
    Ok(files)
}
