//! When does a joint without clearance reach 90°? By quadrature, without any integrator of motion.
//!
//! The pin is held, so a block has one degree of freedom and its energy is the work of its torque:
//!
//! ```text
//! ½ I(θ) θ̇² = M θ,   I = I_0 + I_c cos²θ
//! t(θ) = ∫₀^θ √(I(φ)/(2 M φ)) dφ = 2 ∫₀^√θ √(I(s²)/(2M)) ds
//! ```
//!
//! I is even: −M turns to −θ in the same time. At rest the integrand is singular as 1/√φ, which φ = s² takes away.
//! At 90° there is no singularity: I falls to I_0 > 0, a ninth (joint 1) or a fifth (joint 2) of its start. The inertia that
//! falls by five orders is that of a strut whose pin is free, [`BlockInertia::schur`](crate::model::inertia::BlockInertia::schur).

use deltazero_solvers::Method;
use deltazero_study::quadrature::GAUSS;
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;
use serde::{Deserialize, Serialize};

use crate::config::Config;
use crate::keys::Inertia;
use crate::model::struts::struts;
use crate::model::{Block, Body, Jointed as _};

/// 90° [rad].
pub const RIGHT_ANGLE: f64 = std::f64::consts::FRAC_PI_2;

/// Panels of the first sum, and of the last that is tried.
const PANELS: (u32, u32) = (8, 4096);
/// Method and relative tolerance of the runs to compare with.
const INTEGRATED_BY: (&str, f64) = ("vern98", 1e-12);
/// Runs to compare with last this many times the time by quadrature.
const MARGIN: f64 = 1.1;

/// Time of struts from rest at θ = 0 until the torque has turned them by `theta` [rad] with the pin held [s]; none without
/// a torque.
///
/// The Gauss rule on twice as many panels until a sum repeats itself to rounding.
pub fn time_to(block: &Block, theta: f64) -> Option<f64> {
    let Body::Struts(inertia) = &block.body else { return None };
    let torque = block.torque.abs();
    if torque == 0.0 {
        return None;
    }
    let integrand = |s: f64| {
        let (sin, cos) = libm::sincos(s * s);
        (inertia.about_pin(sin, cos) / (2.0 * torque)).sqrt()
    };
    let end = theta.sqrt();
    let sum = |panels: u32| {
        let h = end / f64::from(panels);
        let panel = |k: u32| -> f64 {
            let start = h * f64::from(k);
            GAUSS.iter().map(|(node, weight)| weight * integrand(start + node * h)).sum()
        };
        2.0 * h * (0..panels).map(panel).sum::<f64>()
    };
    let (mut panels, mut time) = (PANELS.0, sum(PANELS.0));
    while panels < PANELS.1 {
        panels *= 2;
        let finer = sum(panels);
        if (finer - time).abs() <= 4.0 * f64::EPSILON * finer {
            return Some(finer);
        }
        time = finer;
    }
    Some(time)
}

/// A joint without clearance, both ways.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IdealRow {
    /// Inertia of a strut about its centroid: `axial` or `transverse`.
    pub inertia: Inertia,
    /// Joint, 1 or 2.
    pub joint: usize,
    /// Time to 90° by quadrature [s].
    pub quadrature_s: Option<f64>,
    /// The same by an integrator [s].
    pub integrated_s: Option<f64>,
}

/// The time to 90° of both joints with both inertias.
pub fn ideal(config: &Config) -> Vec<IdealRow> {
    let mut rows = Vec::new();
    for inertia in [Inertia::Axial, Inertia::Transverse] {
        for block in &without_clearance(config, inertia) {
            let quadrature_s = time_to(block, RIGHT_ANGLE);
            let integrated_s = quadrature_s.and_then(|t| integrated(block, MARGIN * t));
            rows.push(IdealRow { inertia, joint: block.joint, quadrature_s, integrated_s });
        }
    }
    rows
}

/// The struts of `config` with this inertia, its pins held, its blocks ending at 90°.
pub(super) fn without_clearance(config: &Config, inertia: Inertia) -> [Block; 2] {
    let mut config = config.clone();
    config.strut.inertia = inertia;
    (config.bays, config.run.stop_at_90) = (1, true);
    for joint in &mut config.joints {
        joint.joint.clearance = 0.0;
    }
    struts(&config)
}

fn integrated(block: &Block, t_end: f64) -> Option<f64> {
    let (name, rtol) = INTEGRATED_BY;
    let method = Method::named(name)?;
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) };
    block.integrate(&setting, block.initial_state(), t_end, &mut ()).stopped_at()
}
