//! A tool's method at one setting, ready to run; and the ladder of settings.

use std::error::Error;

use deltazero::model::{Block, State};

use crate::problem::Track;

/// What a run does with events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Handling {
    /// Modes frozen within a step, guards located, restart.
    Located,
    /// The right-hand side branches on the state.
    Naive,
}

impl Handling {
    /// As the tables write it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Located => "located",
            Self::Naive => "naive",
        }
    }

    /// The one called `name`.
    ///
    /// # Errors
    /// Where there is none.
    pub(crate) fn named(name: &str) -> Result<Self, Box<dyn Error>> {
        [Self::Located, Self::Naive]
            .into_iter()
            .find(|handling| handling.name() == name)
            .ok_or_else(|| format!("neither located nor naive: {name}").into())
    }
}

/// What a run is called.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    /// Tool.
    pub(crate) tool: String,
    /// Its version.
    pub(crate) version: String,
    /// Method.
    pub(crate) method: String,
    /// What it does with events.
    pub(crate) handling: Handling,
    /// Relative tolerance, or the step of a method that has it fixed [s].
    pub(crate) rtol: f64,
}

impl Label {
    /// Whether it differs from `other` in the tolerance or step alone.
    pub(crate) fn same_ladder(&self, other: &Self) -> bool {
        self.tool == other.tool && self.method == other.method && self.handling == other.handling
    }
}

/// A run that can be made as often as wished.
type Run<'a> = Box<dyn Fn() -> Result<[Track; 2], Box<dyn Error>> + 'a>;

/// A tool's method at one setting.
pub(crate) struct Entry<'a> {
    /// What it is.
    pub(crate) label: Label,
    /// What is timed.
    pub(crate) run: Run<'a>,
    /// What sees the mode changes where the timed run cannot.
    pub(crate) see_events: Option<Run<'a>>,
}

impl<'a> Entry<'a> {
    /// An entry whose run sees its mode changes itself.
    pub(crate) fn new(
        (tool, version): (&str, &str),
        (method, handling): (&str, Handling),
        rtol: f64,
        run: impl Fn() -> Result<[Track; 2], Box<dyn Error>> + 'a,
    ) -> Self {
        let label = Label {
            tool: tool.to_owned(),
            version: version.to_owned(),
            method: method.to_owned(),
            handling,
            rtol,
        };
        Self { label, run: Box::new(run), see_events: None }
    }
}

/// The ladder of relative tolerances: quarters of a decade from 1e-3 to 1e-13, rounded to two digits.
pub(crate) fn ladder() -> impl Iterator<Item = f64> {
    let decade = |k: u32| {
        [format!("1e-{k}")]
            .into_iter()
            .chain(["5.6", "3.2", "1.8"].map(move |x| format!("{x}e-{}", k + 1)))
    };
    (3..=13).flat_map(decade).filter_map(|text| text.parse().ok()).take(41)
}

/// Absolute tolerances: `rtol` times the scale of each state.
pub(crate) fn atol(block: &Block, rtol: f64) -> State<f64> {
    block.scale().map(|scale| rtol * scale)
}

/// The absolute tolerance of tools that take one for all states: `rtol` times the clearance, the
/// smallest scale but one.
pub(crate) fn scalar_atol(block: &Block, rtol: f64) -> f64 {
    rtol * block.clearance
}
