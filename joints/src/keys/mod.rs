//! The keys of a configuration: what a key is, the values that it takes, those that mechanisms share, and their tables as
//! types.
//!
//! A mechanism is made of [`Shared`] and of keys of its own; a configuration is both, read and checked.

mod defaults;
mod key;
mod kind;
mod range;
mod shared;
mod struts;
#[cfg(test)]
pub(crate) mod test_defaults;
mod words;

pub use defaults::COMMON;
pub use key::{DefaultValue, FINITE, JOINT_TABLES, JOINTS, Key, NOT_NEGATIVE, POSITIVE, one_joint};
pub use kind::{Kind, listing};
pub use range::{End, Range};
pub use shared::{
    Atol, Contact, Contest, Drive, Friction, Inertia, Joint, JointConfig, Regimes, Run, Shared,
    Solver, Strut, Study,
};
pub use struts::STRUTS;
pub use words::{AXES, Curvature, FrictionLaw, METHODS, ReadingName};
