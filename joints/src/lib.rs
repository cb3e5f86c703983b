//! Pins in bushes with clearance: what hangs on them and the laws of their contact, as problems of a
//! [study](deltazero_study), and the keys that they are made from.
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
//! use deltazero_joints::keys::{COMMON, DefaultValue};
//! use deltazero_joints::laws::elastic::Elastic;
//!
//! let stiffness = COMMON.iter().find(|key| key.path == "contact.stiffness").ok_or("no such key")?;
//! assert_eq!((stiffness.default, stiffness.unit), (DefaultValue::Toml("1e7"), "N/mⁿ"));
//! // K δⁿ of 1e7 N/m at a penetration of a micrometre.
//! assert_eq!(Elastic::power(1e7, 1.0).force(1e-6), 10.0);
//! # Ok::<(), &str>(())
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`keys`] | parameters with units and sources, the paper's Table 1 as the default |
//! | [`laws`] | laws of the normal force, for any contact |
//! | [`model`] | pins in bushes as hybrid systems, each a block, or a chain where there are several bays or bristles, with their laws; no time, no loop |

pub mod keys;
pub mod laws;
pub mod model;
