//! Hysteresis damping and the restitution that it delivers.
//!
//! Under `F_N = F(δ) (1 + χ δ̇/δ̇₋)` a mass that meets the contact at the speed δ̇₋ leaves it at e' δ̇₋, and
//! from `m δ̈ = −F_N`, as `∫ F dδ` over the whole contact is zero,
//!
//! ```text
//! ∫ u du/(1 + χ u) = 0 over u = −e' … 1:      χ (1 + e') = ln[(1 + χ)/(1 − χ e')]
//! ```
//!
//! whatever F, the mass and the speed. So χ < 1/e', and the force never pulls in a free impact.

use deltazero_solvers::root::{Bracket, find_root};

/// `χ (1 + e) − ln[(1 + χ)/(1 − χ e)]`, zero where χ delivers e; falls with e.
fn excess(chi: f64, e: f64) -> f64 {
    chi * (1.0 + e) - libm::log1p(chi) + libm::log1p(-chi * e)
}

/// The χ that delivers `e`.
pub fn exact_factor(e: f64) -> f64 {
    if e >= 1.0 {
        return 0.0;
    }
    // Below the root by a factor of at least two: Hunt and Crossley's is too small for every e.
    let bracket = Bracket { above: 0.75 * (1.0 - e), below: 1.0 / e };
    find_root(|chi| excess(chi, e), bracket, f64::EPSILON * bracket.above)
}

/// The restitution e' that `χ ≥ 0` delivers.
pub fn delivered(chi: f64) -> f64 {
    if chi == 0.0 {
        return 1.0;
    }
    let bracket = Bracket { above: 0.0, below: (1.0 / chi).min(1.0) };
    find_root(|e| excess(chi, e), bracket, f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::ContactLaw;

    /// `χ` of the law called `word`.
    fn factor(word: &str, e: f64) -> f64 {
        ContactLaw::named(word).unwrap().hysteresis_factor(e).unwrap()
    }

    #[test]
    fn exact_restitution_delivers_what_is_asked() {
        for k in 1..100 {
            let e = f64::from(k) / 100.0;
            let error = delivered(exact_factor(e)) - e;
            // Measured: 8.7e-13, at 0.99, where both sides of the relation are 0.03 alike.
            assert!(error.abs() < 8e-12, "{e}: {error:e}");
        }
        assert_eq!(exact_factor(1.0), 0.0);
    }

    #[test]
    fn laws_that_are_right_for_a_small_loss_say_so() {
        // χ → 3(1 − e)/2 for e → 1; Lee and Wang have half of it, Gonthier 4/3, Flores 16/15.
        let e = 1.0 - 1e-6;
        let slope = |law| factor(law, e) / (1.5 * (1.0 - e));
        for (law, ratio) in [
            ("hunt_crossley", 1.0),
            ("herbert_mcwhannell", 1.0),
            ("lee_wang", 0.5),
            ("lankarani_nikravesh", 1.0),
            ("gonthier", 4.0 / 3.0),
            ("zhiying_qishao", 1.0),
            ("hu_guo", 1.0),
            ("flores", 16.0 / 15.0),
            ("carvalho_martins", 1.0),
        ] {
            assert!((slope(law) - ratio).abs() < 1e-5, "{law}: {}", slope(law));
        }
    }

    #[test]
    fn zhiying_and_qishao_have_a_factor_for_no_restitution() {
        let limit = 0.75 * libm::exp(2.0);
        // χ is 1 − 2e of its limit. Measured: 2.0e-9.
        assert!((factor("zhiying_qishao", 1e-9) / limit - 1.0).abs() < 1e-8);
        // Measured: 0.1787.
        assert!((delivered(limit) - 0.18).abs() < 0.005);
    }

    #[test]
    fn gonthier_and_carvalho_martins_meet_at_a_third() {
        let third = 1.0 / 3.0;
        let difference = factor("gonthier", third) - factor("carvalho_martins", third);
        assert!(difference.abs() < 1e-15);
    }
}
