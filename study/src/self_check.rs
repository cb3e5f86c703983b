//! What a run tells of itself, without a reference: whether its energy balances, whether what only takes energy
//! gave some, and whether contacts stayed as shallow as their law asks.
//!
//! A speed beyond what the energy allows is a residual of the balance, too. Equations that feed energy in by themselves
//! have no balance to judge them by, only what damping gave and the penetration.

use crate::balance::Balance;
use crate::problem::Laws;
use crate::warning::{Code, Warning};

/// What the tolerance of a run explains of its energy: this many times the relative tolerance. Measured: up to 400
/// times, by bdf on the slider-crank (`docs/slider_crank/study.csv`).
const EXPLAINED: f64 = 1e4;
/// The least that is told: the balance of long steps is a quadrature, good to 4e-8 where a law is not smooth.
const LEAST: f64 = 1e-6;
/// What is told of any run, by a fixed step too.
const MOST: f64 = 0.1;

/// What was seen of the run of one part so far; see [`warnings`](Self::warnings).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfCheck {
    laws: Laws,
    /// Largest energy or work [J].
    scale: f64,
    /// Largest residual of the balance [J], and when [s].
    residual: (f64, f64),
    /// Energy that damping gave, and that friction gave [J].
    given: [f64; 2],
    /// Largest penetration, and when [s].
    depth: (f64, f64),
}

impl SelfCheck {
    /// Nothing seen yet of a run of a problem with these laws that starts with the energy `start` [J].
    pub fn of(laws: Laws, start: f64) -> Self {
        Self { laws, scale: start.abs(), residual: (0.0, 0.0), given: [0.0; 2], depth: (0.0, 0.0) }
    }

    /// Notes what damping and friction took over a part of a step [J].
    pub fn note_dissipation(&mut self, damping: f64, friction: f64) {
        for (given, took) in self.given.iter_mut().zip([damping, friction]) {
            if exceeds(0.0, took) {
                *given -= took;
            }
        }
    }

    /// Notes the balance at the end of a step, at `t` [s].
    pub fn note_balance(&mut self, t: f64, balance: &Balance) {
        // Of weight some may be below zero.
        let energy = balance.kinetic.abs() + balance.elastic.abs();
        self.scale = self.scale.max(energy).max(balance.work.abs());
        if exceeds(balance.residual.abs(), self.residual.0) {
            self.residual = (balance.residual.abs(), t);
        }
    }

    /// Notes the penetration of a contact at the end of a step, at `t` [s].
    pub fn note_penetration(&mut self, t: f64, depth: f64) {
        if exceeds(depth, self.depth.0) {
            self.depth = (depth, t);
        }
    }

    /// What to know of a run at the relative tolerance `rtol`, if it has one: an energy that does not balance
    /// (where it should), damping or friction that gave energy, each beyond what the tolerance explains; a penetration
    /// beyond the deepest that the laws hold for.
    pub fn warnings(&self, rtol: Option<f64>) -> Vec<Warning> {
        let explained = rtol.map_or(MOST, |rtol| (EXPLAINED * rtol).clamp(LEAST, MOST));
        let bound = if self.scale.is_nan() { 0.0 } else { explained * self.scale };
        let (scale, mut warnings) = (self.scale, Vec::new());
        let mut warn = |code, message| warnings.push(Warning { code, message });
        let (residual, t) = self.residual;
        if self.laws.balances && exceeds(residual, bound) {
            let message = format!(
                "the energy balance is off by {residual:.1e} J at t = {t:e} s, of {scale:.1e} J that moved: do not \
                 trust this run; take a tighter tolerance, a smaller step or another method"
            );
            warn(Code::Energy, message);
        }
        let givers = [
            ("the damping of the normal law", self.laws.damping_takes),
            ("friction", self.laws.friction_takes),
        ];
        for (given, (giver, is_told)) in self.given.into_iter().zip(givers) {
            if is_told && exceeds(given, bound) {
                let message = format!(
                    "{giver} gave {given:.1e} J, of {scale:.1e} J that moved, where it can only take: do not trust \
                     this run; locate events, or take a tighter tolerance"
                );
                warn(Code::Dissipation, message);
            }
        }
        let (depth, t) = self.depth;
        if let Some(deepest) = self.laws.deepest
            && exceeds(depth, deepest)
        {
            let message = format!(
                "a contact is {depth:.2e} m deep at t = {t:e} s, beyond the {deepest:e} m that there are: laws of \
                 contact hold for penetrations that are small beside it; take a stiffer contact"
            );
            warn(Code::Penetration, message);
        }
        warnings
    }
}

/// Whether `x` is above `bound`, as is what is not a number; nothing is above that.
fn exceeds(x: f64, bound: f64) -> bool {
    !bound.is_nan() && (x > bound || x.is_nan())
}
