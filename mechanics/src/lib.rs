//! What is integrated: mechanisms with contacts, as problems of a [study](deltazero_study), and their configuration.
//!
//! The mechanism of the paper is a deployable strut bay with two [joints](deltazero_joints).
//!
//! ```
//! use deltazero_mechanics::config::{Config, ConfigError};
//! use deltazero_mechanics::model::Joints;
//!
//! let config = Config::load(None, &["contact.stiffness=1e8".to_owned()])?;
//! assert_eq!(Joints::from(&config).parts.len(), 2);
//! assert_eq!(config.mechanism.subject(&config).parts.len(), 2);
//! # Ok::<(), ConfigError>(())
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`keys`], [`laws`], [`model`] | those of the [joints](deltazero_joints) |
//! | [`mechanisms`] | the mechanisms, one a file: keys, problem, words |
//! | [`config`] | the configuration: keys and mechanism, read and checked |

pub mod config;
pub mod mechanisms;

pub use deltazero_joints::{keys, laws, model};
