//! What is integrated: mechanisms with contacts, as problems of a [study](deltazero_study), and their configuration.
//!
//! The mechanism of the paper is a deployable strut bay with two joints; joint 1 carries (x01, y01, θ1), joint 2
//! (y02, z02, θ2), and the two share no term. In the coordinates (X, Y, θ) of one of them
//!
//! ```text
//! | M_x         0           S_x cos θ       | |Ẍ|   | S_x sin θ θ̇²           + Q_X |
//! | 0           M_y        −S_y sin θ       | |Ÿ| = | S_y cos θ θ̇²           + Q_Y |
//! | S_x cos θ  −S_y sin θ   I_0 + I_c cos²θ | |θ̈|   | I_c sin θ cos θ θ̇² + M + Q_θ |
//!
//! δ = √(X² + Y²) − c,   F_N = K δⁿ + D δ̇ in contact,   F_T = −sign(v_T) μ F_N or what v_T = 0 takes
//! ```
//!
//! with modes free, slip+, slip− and stick.
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
//! | [`keys`] | parameters with units and sources, the paper's Table 1 as the default |
//! | [`model`] | pins in bushes as hybrid systems, each a block, or a chain where there are several bays or bristles, with their laws; no time, no loop |
//! | [`mechanisms`] | the mechanisms, one a file: keys, problem, words |
//! | [`config`] | the configuration: keys and mechanism, read and checked |

pub mod config;
pub mod keys;
pub mod mechanisms;
pub mod model;
