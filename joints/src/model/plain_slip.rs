//! Slip of struts under the plain law: what most of a run is, and joints differ in by parameters alone.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;

use deltazero_solvers::Alike;
use deltazero_solvers::real::{Length, Over};

use super::block::Block;
use super::body::{Body, Held};
use super::inertia::BlockInertia;
use super::mode::{GUARD_CONTACT, GUARD_END, GUARD_UPPER, Mode, N_GUARDS, distance, rho_v_t};
use super::state::State;

/// A slip of struts under `F_N = K δ + D δ̇` with Coulomb's friction, all of it at the pin but for a torque of
/// friction. `C` are the constants of one joint, or of several at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainSlip<C = f64> {
    inertia: BlockInertia<C>,
    /// `c` [m].
    clearance: C,
    /// `K` [N/m].
    stiffness: C,
    /// `D` [N s/m].
    damping: C,
    /// `σ μ r` [m], σ the sign of v_T.
    friction_arm: C,
    /// `M` [N m].
    torque: C,
    /// `r` [m].
    pin_radius: C,
    /// `σ`.
    sigma: C,
    /// `(sgn M, π/2)` where the block ends at 90°, else `(0, 1)`: what that guard takes θ by, and from what.
    ends: [C; 2],
}

impl PlainSlip {
    /// Number of its parameters.
    pub(super) const N: usize = 17;

    /// The slip of `block` with v_T of the sign `sigma`.
    #[inline(always)]
    pub(super) fn new(block: &Block, inertia: &BlockInertia, stiffness: f64, sigma: f64) -> Self {
        let ends = if block.stop_at_90 { [block.turns(), FRAC_PI_2] } else { [0.0, 1.0] };
        Self {
            inertia: *inertia,
            clearance: block.clearance,
            stiffness,
            damping: block.normal.damping,
            friction_arm: sigma * block.mu * block.pin_radius,
            torque: block.torque,
            pin_radius: block.pin_radius,
            sigma,
            ends,
        }
    }

    /// Its parameters, in the order of its fields.
    pub(super) fn parameters(&self) -> [f64; Self::N] {
        let BlockInertia { m_x, m_y, per_mass: [per_x, per_y], p, q, j_0, j_c } = self.inertia;
        let [turns, end] = self.ends;
        let Self { clearance, stiffness, damping, friction_arm, torque, pin_radius, sigma, .. } =
            *self;
        [
            m_x,
            m_y,
            per_x,
            per_y,
            p,
            q,
            j_0,
            j_c,
            clearance,
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            turns,
            end,
        ]
    }
}

impl<C: Copy> PlainSlip<C> {
    /// Of its [parameters](PlainSlip::parameters).
    #[inline(always)]
    pub(super) fn of(parameters: &[C; PlainSlip::N]) -> Self {
        let [
            m_x,
            m_y,
            per_x,
            per_y,
            p,
            q,
            j_0,
            j_c,
            clearance,
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            turns,
            end,
        ] = *parameters;
        Self {
            inertia: BlockInertia { m_x, m_y, per_mass: [per_x, per_y], p, q, j_0, j_c },
            clearance,
            stiffness,
            damping,
            friction_arm,
            torque,
            pin_radius,
            sigma,
            ends: [turns, end],
        }
    }

    /// Writes the rates of `y`: those of the general law without its terms of zero, and without a branch among its
    /// operations, past which series are slower. The force on the pin is `−(F_N/ρ) d`, whose lever does not wait
    /// for it; F_N/ρ is known late, and so the second factor of each product.
    #[inline(always)]
    pub(super) fn rates<S: Over<C>>(&self, y: &State<S>, at: &Length<S>, dydt: &mut State<S>) {
        let delta = at.rho.value - self.clearance;
        let pull = -(delta * self.stiffness + at.rate * self.damping);
        let turning = self.inertia.turning([y[2], y[5]]);
        let moment = self.inertia.turning_moment(&turning) + self.torque;
        let per_rho = pull.over(&at.rho);
        let lever = turning.along[0] * y[0] + turning.along[1] * y[1];
        let moment = moment + pull * self.friction_arm - lever * per_rho;
        let a = self.inertia.motion(turning, [y[0] * per_rho, y[1] * per_rho], moment);
        // One by one: as an array they are copied through memory, and the next stage waits for that.
        (dydt[0], dydt[1], dydt[2]) = (y[3], y[4], y[5]);
        (dydt[3], dydt[4], dydt[5]) = (a[0], a[1], a[2]);
    }

    /// The guards: `π/2 − sgn(M) θ`, `δ` and `σ ρ v_T`.
    #[inline(always)]
    pub(super) fn guards<S: Over<C>>(&self, y: &State<S>, at: &Length<S>) -> [S; N_GUARDS] {
        let mut g = [S::cst(1.0); N_GUARDS];
        g[GUARD_END] = -(y[2] * self.ends[0] - self.ends[1]);
        g[GUARD_CONTACT] = at.rho.value - self.clearance;
        g[GUARD_UPPER] = rho_v_t(y, at.rho.value, self.pin_radius) * self.sigma;
        g
    }

    /// Writes both, at one distance.
    #[inline(always)]
    pub(super) fn rates_with_guards<S: Over<C>>(
        &self,
        y: &State<S>,
        dydt: &mut State<S>,
        g: &mut [S; N_GUARDS],
    ) {
        let at = distance(y);
        self.rates(y, &at, dydt);
        *g = self.guards(y, &at);
    }
}

impl Block {
    /// The plain slip that `mode` is, guards and all, if it is one.
    #[inline(always)]
    pub(super) fn plain_slip(&self, mode: Mode) -> Option<PlainSlip> {
        match (&self.body, self.plain_stiffness, mode.sigma()) {
            (Body::Struts(inertia), Some(stiffness), Some(sigma))
                if self.has_product(Held::Struts(inertia)) =>
            {
                Some(PlainSlip::new(self, inertia, stiffness, sigma))
            }
            _ => None,
        }
    }
}

impl Alike for Block {
    type Parameters<C: Copy + Debug> = [C; PlainSlip::N];

    fn parameters(&self, mode: &Mode) -> Option<[f64; PlainSlip::N]> {
        self.plain_slip(*mode).map(|slip| slip.parameters())
    }

    #[inline(always)]
    fn rhs_of<S: Over<C>, C: Copy + Debug>(
        parameters: &[C; PlainSlip::N],
        _t: S,
        y: &State<S>,
        dydt: &mut State<S>,
    ) {
        let slip = PlainSlip::of(parameters);
        slip.rates(y, &distance(y), dydt);
    }

    #[inline(always)]
    fn guards_of<S: Over<C>, C: Copy + Debug>(
        parameters: &[C; PlainSlip::N],
        _t: S,
        y: &State<S>,
        g: &mut [S; N_GUARDS],
    ) {
        let slip = PlainSlip::of(parameters);
        *g = slip.guards(y, &distance(y));
    }

    #[inline(always)]
    fn rhs_with_guards_of<S: Over<C>, C: Copy + Debug>(
        parameters: &[C; PlainSlip::N],
        _t: S,
        y: &State<S>,
        dydt: &mut State<S>,
        g: &mut [S; N_GUARDS],
    ) {
        PlainSlip::of(parameters).rates_with_guards(y, dydt, g);
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::System;
    use deltazero_solvers::contracts::check;
    use num_dual::Dual64;

    use super::*;
    use crate::keys::test_defaults::table1;
    use crate::model::contact::Onset;
    use crate::model::struts::struts;

    #[test]
    fn plain_accelerations_are_the_general_ones() {
        let config = table1();
        for block in &struts(&config) {
            let y = [3e-5, -9.9e-5, 0.02, 2e-3, -1e-3, 0.3];
            let (posture, pose) = (block.body.held().at(&y), block.pose(&y));
            for mode in [Mode::SlipPlus(Onset::PLAIN), Mode::SlipMinus(Onset::PLAIN)] {
                let forces = block.forces(mode, &y, &pose);
                let general = block.accelerations(&y, &posture, &pose, forces);
                let mut dydt = [0.0; 6];
                block.rhs(mode, 0.0, &y, &mut dydt);
                assert!(block.plain_stiffness.is_some());
                for (plain, general) in dydt[3..].iter().zip(general) {
                    // Measured: 2.3e-16.
                    assert!((plain / general - 1.0).abs() < 1e-15, "{plain}, {general}");
                }
            }
        }
    }

    #[test]
    fn rates_with_guards_are_both_and_begin_with_the_rates() {
        let mut config = table1();
        for adhesion in [true, false] {
            config.joints.iter_mut().for_each(|joint| joint.contact.adhesion = adhesion);
            for block in &struts(&config) {
                let y = [3e-5, -9.9e-5, 0.02, 2e-3, -1e-3, 0.3];
                let slips = [Mode::SlipPlus(Onset::PLAIN), Mode::SlipMinus(Onset::PLAIN)];
                for mode in slips.into_iter().chain([Mode::Apart, Mode::Stick(Onset::PLAIN)]) {
                    assert_eq!(check(block, &mode, 0.0, &y), Ok(()), "{mode}");
                    let (mut dydt, mut g) = ([0.0; 6], [0.0; N_GUARDS]);
                    let shares = block.rhs_with_guards(mode, 0.0, &y, &mut dydt, &mut g);
                    assert_eq!(shares, adhesion && mode.sigma().is_some(), "{mode}");
                }
            }
        }
    }

    #[test]
    fn a_plain_slip_is_that_of_its_parameters_to_the_bit() {
        let bits = |each: &[Dual64]| -> Vec<_> {
            each.iter().map(|x| [x.re.to_bits(), x.eps.to_bits()]).collect()
        };
        let mut config = table1();
        for stop_at_90 in [true, false] {
            config.run.stop_at_90 = stop_at_90;
            for block in &struts(&config) {
                for (k, mode) in [Mode::SlipPlus(Onset::PLAIN), Mode::SlipMinus(Onset::PLAIN)]
                    .into_iter()
                    .enumerate()
                {
                    let parameters = block.parameters(&mode).unwrap();
                    for i in 0..100 {
                        // Around the bush, up to and past 90°.
                        let (s, c) = (0.7 * f64::from(i) + k as f64).sin_cos();
                        let re =
                            [1e-4 * s, -1e-4 * c, 0.02 * f64::from(i), 2e-3 * c, -1e-3, 0.3 * s];
                        let y = re.map(|x| Dual64::new(x, 0.3 * x + 1e-3));
                        let (mut own, mut of) =
                            ([Dual64::from_re(0.0); 6], [Dual64::from_re(0.0); 6]);
                        block.rhs(mode, Dual64::from_re(0.0), &y, &mut own);
                        Block::rhs_of(&parameters, Dual64::from_re(0.0), &y, &mut of);
                        assert_eq!(bits(&own), bits(&of), "{mode}");
                        let rates = of;
                        let (mut own, mut of) =
                            ([Dual64::from_re(0.0); N_GUARDS], [Dual64::from_re(0.0); N_GUARDS]);
                        block.guards(mode, Dual64::from_re(0.0), &y, &mut own);
                        Block::guards_of(&parameters, Dual64::from_re(0.0), &y, &mut of);
                        let mut rates_with = [Dual64::from_re(0.0); 6];
                        let mut with_rates = [Dual64::from_re(0.0); N_GUARDS];
                        let t = Dual64::from_re(0.0);
                        Block::rhs_with_guards_of(
                            &parameters,
                            t,
                            &y,
                            &mut rates_with,
                            &mut with_rates,
                        );
                        assert_eq!(bits(&rates), bits(&rates_with), "{mode}");
                        assert_eq!(bits(&of), bits(&with_rates), "{mode}");
                        // A rate of zero may have the other sign.
                        let both =
                            own.map(|g| [g.re, g.eps]).into_iter().zip(of.map(|g| [g.re, g.eps]));
                        assert!(both.into_iter().all(|(own, of)| own == of), "{mode}");
                    }
                }
                for mode in [Mode::Apart, Mode::Stick(Onset::PLAIN), Mode::Relaxing(Onset::PLAIN)] {
                    assert_eq!(block.parameters(&mode), None, "{mode}");
                }
            }
        }
        config.joints[0].contact.adhesion = false;
        config.joints[1].contact.exponent = 1.5;
        for block in &struts(&config) {
            assert_eq!(block.parameters(&Mode::SlipPlus(Onset::PLAIN)), None);
        }
    }
}
