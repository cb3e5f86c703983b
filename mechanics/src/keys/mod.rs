//! The keys of a configuration: what a key is, the values that it takes, those that mechanisms share, and their tables as
//! types.
//!
//! [Mechanisms](crate::mechanisms) are made of [`Shared`] and of keys of their own; a [configuration](crate::config) is
//! both, read and checked.

mod common;
mod key;
mod kind;
mod range;
mod shared;
mod words;

pub(crate) use common::COMMON;
pub use key::{DefaultValue, FINITE, JOINT_TABLES, JOINTS, Key, NOT_NEGATIVE, POSITIVE, one_joint};
pub use kind::Kind;
pub(crate) use kind::listing;
pub use range::{End, Range};
pub use shared::{
    Atol, Contact, Contest, Drive, Friction, Inertia, Joint, JointConfig, Regimes, Run, Shared,
    Solver, Strut, Study,
};
pub use words::{AXES, ContactLaw, Curvature, FrictionLaw, METHODS, ReadingName};
