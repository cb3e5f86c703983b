//! What is chosen about a run: a method, what it does with events, how accurate it is asked to be.

use std::fmt;
use std::sync::Arc;

use deltazero_solvers::Method;
use serde::{Deserialize, Serialize};

/// What a method does with events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Events {
    /// The mode is frozen within a step, and a step ends on every event.
    Located,
    /// The baseline: every evaluation reads its mode off the state.
    Blind,
}

impl Events {
    /// Every value.
    pub const ALL: &'static [Self] = &[Self::Located, Self::Blind];
    /// The words for them, in the same order.
    pub const WORDS: &'static [&'static str] = &["located", "blind"];

    /// The word that files use for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Located => "located",
            Self::Blind => "blind",
        }
    }
}

impl fmt::Display for Events {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The numbers that a reference is computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Digits {
    /// f64.
    Double,
    /// Pairs of f64: 31 digits.
    Extended,
}

impl Digits {
    /// Every value.
    pub const ALL: &'static [Self] = &[Self::Double, Self::Extended];
    /// The words for them, in the same order.
    pub const WORDS: &'static [&'static str] = &["double", "extended"];

    /// The word that files use for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Double => "double",
            Self::Extended => "extended",
        }
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Absolute tolerance.
#[derive(Clone, Debug, PartialEq)]
pub enum Atol {
    /// The same number for every state, in that state's unit.
    Same(f64),
    /// One for each state; see [`Problem::spread`](crate::Problem::spread).
    Each(Arc<[f64]>),
}

/// How accurate a method is asked to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Accuracy {
    /// Relative tolerance, and absolute tolerances if not `rtol` times the scale of each state.
    Rtol(f64, Option<Atol>),
    /// Fixed step [s].
    Step(f64),
}

impl Accuracy {
    /// The accuracy of a row of a table, with a tolerance or a step; none where it has neither.
    pub fn of_columns(rtol: Option<f64>, step: Option<f64>, atol: Option<Atol>) -> Option<Self> {
        rtol.map(|rtol| Self::Rtol(rtol, atol)).or(step.map(Self::Step))
    }
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rtol(rtol, _) => write!(f, "rtol {rtol:e}"),
            Self::Step(step) => write!(f, "h {step:e} s"),
        }
    }
}

/// A method with all that is chosen about it.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The method.
    pub method: &'static Method,
    /// What it does with events.
    pub events: Events,
    /// Its tolerance or step.
    pub accuracy: Accuracy,
}

impl PartialEq for Setting {
    fn eq(&self, other: &Self) -> bool {
        let Self { method, events, accuracy } = self;
        (method.name, events, accuracy) == (other.method.name, &other.events, &other.accuracy)
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.method.name, self.events, self.accuracy)
    }
}

impl Setting {
    /// The relative tolerance, where it has one.
    pub fn rtol(&self) -> Option<f64> {
        match self.accuracy {
            Accuracy::Rtol(rtol, _) => Some(rtol),
            Accuracy::Step(_) => None,
        }
    }

    /// The fixed step [s], where it has one.
    pub fn step(&self) -> Option<f64> {
        match self.accuracy {
            Accuracy::Rtol(..) => None,
            Accuracy::Step(step) => Some(step),
        }
    }
}

/// Whether the method called `name` is one that chooses between explicit and implicit as it goes.
pub(crate) fn chooses(name: &str) -> bool {
    Method::named(name).is_some_and(Method::chooses)
}
