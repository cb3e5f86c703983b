//! `deltazero plot`.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use deltazero::atomic_file;
use deltazero::figures::Drawing;
use deltazero::figures::sweep::{self, Asked, PlotError};
use deltazero::sweep::results::{Results, ResultsError};
use deltazero::sweep::sobol::Sobol;
use serde_json::json;

use super::{Failure, print, say};

#[derive(Args)]
#[command(group = ArgGroup::new("what").required(true).args(["x", "sobol"]))]
pub(super) struct PlotArgs {
    /// Directory of a finished sweep
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Column of runs.csv to the right; a wrong name lists them
    #[arg(long, value_name = "COL")]
    x: Option<String>,
    /// Column upwards
    #[arg(long, value_name = "COL")]
    y: Option<String>,
    /// Column that gives the colour
    #[arg(long, value_name = "COL")]
    color: Option<String>,
    /// Main and total Sobol indices of a column, of a plan with sampling = "saltelli"
    #[arg(long, value_name = "COL", conflicts_with_all = ["y", "color"])]
    sobol: Option<String>,
    /// Write FILE-STEM.png and FILE-STEM.svg; the default is a name of the columns in DIR/figures. One that ends with / is a
    /// directory for files of that name
    #[arg(long, value_name = "FILE-STEM")]
    out: Option<PathBuf>,
    /// No messages but errors
    #[arg(long)]
    quiet: bool,
    /// Print caption, files and indices as JSON
    #[arg(long)]
    json: bool,
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        match error {
            PlotError::Results(
                ResultsError::Row { .. } | ResultsError::Order { .. } | ResultsError::Length { .. },
            )
            | PlotError::Drawing(_) => Self::Run(error.to_string()),
            _ => Self::Usage(error.to_string()),
        }
    }
}

pub(super) fn run(args: &PlotArgs) -> Result<(), Failure> {
    let results = Results::open(&args.dir).map_err(PlotError::from)?;
    let (drawing, sobol, name) = match (&args.sobol, &args.x) {
        (Some(column), _) => {
            let sobol = Sobol::of(&results, column).map_err(PlotError::from)?;
            (sweep::sobol::drawing(&sobol)?, Some(sobol), sweep::sobol::file_name(column))
        }
        (None, x) => {
            let x = x.as_deref().unwrap_or_default();
            let asked = Asked { x, y: args.y.as_deref(), color: args.color.as_deref() };
            (sweep::drawing(&results, asked)?, None, asked.file_name())
        }
    };
    let stem = match &args.out {
        None => args.dir.join("figures").join(name),
        Some(dir) if has_no_name(dir) => dir.join(name),
        Some(stem) => stem.clone(),
    };
    let files = write(&drawing, &stem)?;
    let [png, svg] = files.each_ref().map(|path| path.display().to_string());
    if args.json {
        let record = json!({
            "kind": drawing.name, "caption": drawing.caption, "files": [png, svg], "sobol": sobol,
        });
        print(&format!("{record:#}\n"))?;
    } else {
        let table = sobol.as_ref().map(sweep::sobol::table).unwrap_or_default();
        print(&format!("{table}{}\n", drawing.caption))?;
    }
    if !args.quiet {
        say(&format!("{} written: {png}, {svg}", drawing.name));
    }
    Ok(())
}

/// Whether a path does not end with the name of a file: `s3/`, `..`.
fn has_no_name(path: &Path) -> bool {
    let path_bytes = path.as_os_str().as_encoded_bytes();
    path.file_name().is_none_or(|name| !path_bytes.ends_with(name.as_encoded_bytes()))
}

/// Draws both files, then writes each whole.
fn write(drawing: &Drawing, stem: &Path) -> Result<[PathBuf; 2], Failure> {
    let picture = drawing.picture().map_err(PlotError::from)?;
    let named = |end: &str| {
        let mut path = stem.as_os_str().to_owned();
        path.push(end);
        PathBuf::from(path)
    };
    let files = [named(".png"), named(".svg")];
    for (path, content) in files.iter().zip([&picture.png[..], picture.svg.as_bytes()]) {
        atomic_file::write(path, content)?;
    }
    Ok(files)
}
