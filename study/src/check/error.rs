//! What a problem says of itself that does not fit together.

use deltazero_solvers::contracts::Breach;

/// Why a problem cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// It has no states.
    #[error("the problem has no states; System::dim is 0")]
    NoStates,
    /// It names more or fewer states than it has.
    #[error("the problem names {named} states and has {dim}; Problem::states must name each")]
    StatesDiffer {
        /// Names.
        named: usize,
        /// States.
        dim: usize,
    },
    /// It starts with more or fewer states than it has.
    #[error("the problem starts with {given} states and has {dim}; Problem::start must give each")]
    StartDiffers {
        /// States of the start.
        given: usize,
        /// States.
        dim: usize,
    },
    /// A scale is zero, negative or not a number.
    #[error("the scale of {item} is {scale}; it must be above zero")]
    Scale {
        /// State or group.
        item: String,
        /// Its scale.
        scale: f64,
    },
    /// A group of states is empty, or has a state that does not exist.
    #[error("group {group} has the states {states:?}; the problem has {dim}, from 0")]
    Group {
        /// Its name.
        group: String,
        /// Its states.
        states: Vec<usize>,
        /// States of the problem.
        dim: usize,
    },
    /// No group, so that there is no error.
    #[error("the problem has no groups of states to measure errors by; see Problem::groups")]
    NoGroups,
    /// A site that does not exist.
    #[error("{item} is of site {site}; the problem has {n_sites}, from 0")]
    Site {
        /// Group or guard.
        item: String,
        /// Its site.
        site: usize,
        /// Sites of the problem.
        n_sites: usize,
    },
    /// A site has more or fewer columns than values.
    #[error(
        "site {site} has {named} columns by Problem::columns and {given} values by Problem::rows; each column must have one"
    )]
    ColumnsDiffer {
        /// The site.
        site: usize,
        /// Columns.
        named: usize,
        /// Values.
        given: usize,
    },
    /// A number at the start is none.
    #[error("{item} is {value} at the start")]
    NotFinite {
        /// State, column, force, energy or power.
        item: String,
        /// Its value.
        value: f64,
    },
    /// A mode is contact, and no force is given.
    #[error(
        "mode {mode}, met at t = {t} s, is a contact by Problem::role at site {site}, but Problem::touch gives no force \
         there; give one, or none in any mode and let Problem::tells_forces be false"
    )]
    NoForce {
        /// When the mode was met [s].
        t: f64,
        /// The mode.
        mode: String,
        /// The site.
        site: usize,
    },
    /// A force is given in one mode or at one site, and not at the start or at another site.
    #[error(
        "Problem::touch gives a force in mode {mode}, met at t = {t} s, at site {site}, and none at the start at site {silent}; \
         give it in every mode and at every site, zero where it is no contact"
    )]
    ForceInPart {
        /// When the mode was met [s].
        t: f64,
        /// The mode.
        mode: String,
        /// The site.
        site: usize,
        /// A site without at the start.
        silent: usize,
    },
    /// What it says in a later mode does not fit together.
    #[error("in mode {mode}, met at t = {t} s: {error}")]
    InMode {
        /// When the mode was met [s].
        t: f64,
        /// The mode.
        mode: String,
        /// What does not.
        error: Box<Self>,
    },
    /// The model does not keep what it promises so that it runs faster.
    #[error("in mode {mode}, at t = {t} s: {breach}")]
    Contract {
        /// When [s].
        t: f64,
        /// The mode.
        mode: String,
        /// What it does not keep.
        breach: Box<Breach>,
    },
    /// Energies are given, and no powers.
    #[error(
        "Problem::energies gives energies at the start, but Problem::powers no powers; give both"
    )]
    NoPowers,
    /// The end is not after the start.
    #[error("the end of the run is {t_end} s; it must be a time after the start, which is at 0 s")]
    End {
        /// The end [s].
        t_end: f64,
    },
}
