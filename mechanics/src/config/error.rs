//! What can be wrong with a configuration, in words that lead out.

use std::fmt;
use std::path::PathBuf;

/// Bytes of a row of `trajectory.csv`, about.
pub const ROW_BYTES: f64 = 200.0;

/// Where a value was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a file, counted from 1.
    Line {
        /// The file, as it was named by the user.
        file: Box<str>,
        /// The line.
        line: usize,
    },
    /// An argument of `--set`.
    Set(Box<str>),
    /// A key that varies from run to run: its value, or the argument that lets it vary.
    Varied(Box<str>),
    /// A configuration in JSON, as in `run.json`.
    Json,
    /// The table of defaults in this program.
    Default,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { file, line } => write!(f, "{file}:{line}"),
            Self::Set(argument) => write!(f, "--set {argument}"),
            Self::Varied(what) => f.write_str(what),
            Self::Json => f.write_str("configuration in JSON"),
            Self::Default => f.write_str("default configuration"),
        }
    }
}

/// Why a configuration is refused; the message is one line, but for that of a model file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file, as it was named by the user.
        path: PathBuf,
        /// What the operating system says.
        reason: Box<str>,
    },
    /// A model file that is none, or not with these values of its parameters; the message shows the lines.
    #[error("{report}")]
    Model {
        /// What is wrong, and where.
        report: Box<str>,
    },
    /// Not TOML, or not UTF-8.
    #[error("{place}: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// The parser's message.
        message: Box<str>,
    },
    /// An argument of `--set` that is no assignment.
    #[error("--set {argument}: expected key=value, such as contact.stiffness=1e9")]
    NoAssignment {
        /// The argument.
        argument: Box<str>,
    },
    /// A key that does not exist.
    #[error("{place}: unknown key \"{key}\"; {}", way_out(nearest.as_deref()))]
    UnknownKey {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The most similar key, if one is similar.
        nearest: Option<Box<str>>,
    },
    /// A name that is neither a parameter of the model nor a setting.
    #[error(
        "{place}: \"{key}\" is neither a parameter of the model nor a setting; {}",
        way_out_of_model(key, nearest.as_deref())
    )]
    NotOfModel {
        /// Where.
        place: Place,
        /// The name.
        key: Box<str>,
        /// The most similar one, if one is similar.
        nearest: Option<Box<str>>,
    },
    /// A state of the model.
    #[error(
        "{place}: \"{key}\" is a state of the model, and parameters are what is set; let a parameter be its start"
    )]
    StateOfModel {
        /// Where.
        place: Place,
        /// The state.
        key: Box<str>,
    },
    /// A key that exists, but not for one joint.
    #[error("{place}: {key} cannot differ for one joint; {CAN_DIFFER}")]
    NotPerJoint {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
    },
    /// A value of the wrong type.
    #[error("{place}: {key} = {value} is {found}: expected {expected}")]
    WrongType {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The value as given, shortened.
        value: Box<str>,
        /// Its type, with article.
        found: &'static str,
        /// What the key takes.
        expected: Box<str>,
    },
    /// A number outside its range; NaN and ±∞ are outside every range.
    #[error("{place}: {key} = {value} is out of range: {allowed}")]
    OutOfRange {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The value as given, shortened.
        value: Box<str>,
        /// Unit and range.
        allowed: Box<str>,
    },
    /// A word that the key does not know.
    #[error("{place}: {key} = {value} is unknown: {allowed}{}", did_you_mean(nearest.as_deref()))]
    UnknownWord {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The value as given, shortened.
        value: Box<str>,
        /// The words that it knows.
        allowed: Box<str>,
        /// The most similar word, if one is similar.
        nearest: Option<&'static str>,
    },
    /// A list that is too short or too long.
    #[error("{place}: {key} = {value} has {found} entries: expected {expected}")]
    WrongLength {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The value as given, shortened.
        value: Box<str>,
        /// Number of its entries.
        found: usize,
        /// What the key takes.
        expected: Box<str>,
    },
    /// A list of entries that must differ, and do not.
    #[error("{place}: {key} = {value} has {entry} twice: {LEAVE_ONE}")]
    Repeated {
        /// Where.
        place: Place,
        /// The key, from the root.
        key: Box<str>,
        /// The value as given, shortened.
        value: Box<str>,
        /// The entry.
        entry: Box<str>,
    },
    /// Blind runs alone where there are none.
    #[error("{place}: {key} asks for blind runs, but {reason}; {USE_LOCATED}")]
    NoBlindRuns {
        /// Where.
        place: Place,
        /// The key.
        key: &'static str,
        /// Why there are none.
        reason: Box<str>,
    },
    /// What a joint whose friction has bristles cannot have.
    #[error("{place}: {found} does not go with friction.law = lugre: {reason}")]
    NotWithBristles {
        /// Where it was given.
        place: Place,
        /// The other key with its value.
        found: Box<str>,
        /// Why not, and the way out.
        reason: &'static str,
    },
    /// What a mechanism cannot have.
    #[error("{place}: {found} does not go with {with}: {reason}")]
    NotInMechanism {
        /// Where the offending one of the two was given.
        place: Place,
        /// The key with its value.
        found: Box<str>,
        /// What it does not go with.
        with: Box<str>,
        /// Why not, and the way out.
        reason: Box<str>,
    },
    /// An output grid that no disk would hold.
    #[error(
        "{place}: run.sample = {sample:e} s up to run.t_end = {t_end:e} s makes {:.1e} rows of \
         trajectory.csv (one a joint: {joints}), {:.1e} bytes, at most {most:e} rows; {}",
        t_end / sample * *joints as f64,
        t_end / sample * *joints as f64 * ROW_BYTES,
        raise_sample(t_end * *joints as f64 / most)
    )]
    TooManySamples {
        /// Where the offending one of the two was given.
        place: Place,
        /// Distance of two samples \[s\].
        sample: f64,
        /// End of the run \[s\].
        t_end: f64,
        /// Number of joints.
        joints: usize,
        /// Largest number of rows.
        most: f64,
    },
    /// More fixed steps than a run can take.
    #[error(
        "{place}: solver.step = {step:e} s up to run.t_end = {t_end:e} s makes {:.1e} steps, at most \
         {most:e}; {RAISE_STEP}",
        t_end / step
    )]
    TooManySteps {
        /// Where the offending one of the two was given.
        place: Place,
        /// Step \[s\].
        step: f64,
        /// End of the run \[s\].
        t_end: f64,
        /// Largest number of steps.
        most: f64,
    },
    /// The table of keys and the types do not agree: a mistake in this program, excluded by a test.
    #[error("mistake in the table of keys, at {part}: {message}")]
    Table {
        /// Key or table.
        part: Box<str>,
        /// What does not fit.
        message: Box<str>,
    },
}

impl ConfigError {
    /// The line of a file that it is about, with the file and what is wrong there: the key, and the value as it is given.
    pub(super) fn line(&self) -> Option<(&str, usize, [&str; 2])> {
        let (place, key, value) = match self {
            Self::UnknownKey { place, key, .. }
            | Self::NotOfModel { place, key, .. }
            | Self::StateOfModel { place, key }
            | Self::NotPerJoint { place, key } => (place, &**key, ""),
            Self::WrongType { place, key, value, .. }
            | Self::OutOfRange { place, key, value, .. }
            | Self::UnknownWord { place, key, value, .. }
            | Self::WrongLength { place, key, value, .. }
            | Self::Repeated { place, key, value, .. } => (place, &**key, &**value),
            Self::NoBlindRuns { place, key, .. } => (place, *key, ""),
            Self::Syntax { place, .. }
            | Self::NotWithBristles { place, .. }
            | Self::NotInMechanism { place, .. }
            | Self::TooManySamples { place, .. }
            | Self::TooManySteps { place, .. } => (place, "", ""),
            _ => return None,
        };
        // Without the tables before it, and the number of an entry behind it.
        let key = key.rsplit('.').next().unwrap_or(key);
        let key = key.split('[').next().unwrap_or(key).trim_matches('\'');
        match place {
            Place::Line { file, line } => Some((file, *line, [key, value])),
            _ => None,
        }
    }

    /// The way out, with which its message ends; empty where it ends without.
    pub(super) fn way_out(&self) -> String {
        match self {
            Self::UnknownKey { nearest, .. } => way_out(nearest.as_deref()),
            Self::NotOfModel { key, nearest, .. } => way_out_of_model(key, nearest.as_deref()),
            Self::NotPerJoint { .. } => CAN_DIFFER.to_owned(),
            Self::WrongType { expected, .. } | Self::WrongLength { expected, .. } => {
                format!("expected {expected}")
            }
            Self::OutOfRange { allowed, .. } => allowed.to_string(),
            Self::UnknownWord { allowed, nearest, .. } => {
                format!("{allowed}{}", did_you_mean(*nearest))
            }
            Self::Repeated { .. } => LEAVE_ONE.to_owned(),
            Self::NoBlindRuns { .. } => USE_LOCATED.to_owned(),
            Self::NotWithBristles { reason, .. } => (*reason).to_owned(),
            Self::NotInMechanism { reason, .. } => reason.to_string(),
            Self::TooManySamples { t_end, joints, most, .. } => {
                raise_sample(t_end * *joints as f64 / most)
            }
            Self::TooManySteps { .. } => RAISE_STEP.to_owned(),
            _ => String::new(),
        }
    }
}

const CAN_DIFFER: &str = "only the keys of [joint], [contact] and [friction] can";
const LEAVE_ONE: &str = "leave one of them";
const USE_LOCATED: &str = "use events = \"located\"";
const RAISE_STEP: &str = "raise solver.step";

/// The end of the message on too many rows.
fn raise_sample(least: f64) -> String {
    format!("raise run.sample above {least:.2e} s")
}

/// The end of the message on an unknown name in a model.
fn way_out_of_model(key: &str, nearest: Option<&str>) -> String {
    match nearest {
        Some(name) => format!("did you mean \"{name}\"?"),
        None if key.contains('.') => "`deltazero config` lists every setting".to_owned(),
        None => "`deltazero model check FILE` lists the parameters".to_owned(),
    }
}

/// The end of the message on an unknown key.
fn way_out(nearest: Option<&str>) -> String {
    match nearest {
        Some(key) => format!("did you mean \"{key}\"?"),
        None => "`deltazero config` lists every key".to_owned(),
    }
}

/// The end of the message on an unknown word.
fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |word| format!("; did you mean \"{word}\"?"))
}
