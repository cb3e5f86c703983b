//! What restitution does a law deliver that is asked for e?
//!
//! A pin meets its bush head on, without drive and friction, and is followed by `dop853` until it leaves: one
//! degree of freedom of the very mechanism, `M_y δ̈ = −F_N`.

use std::ops::ControlFlow;

use deltazero_solvers::{Event, Method, Needs, Next, Record};
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;
use serde::Serialize;

use crate::config::{Config, ConfigError};
use crate::laws::ContactLaw;
use crate::laws::hysteresis::delivered;
use crate::model::{Block, Jointed as _, Joints, Mode};

/// Speed of the impact [m/s]; what is delivered does not depend on it.
const SPEED: f64 = 0.01;
const RTOL: f64 = 1e-10;
/// A delivered restitution is held to be near the requested one within this.
pub const NEAR: f64 = 0.05;

/// The restitutions asked for: 0.05, 0.10 … 0.95.
pub fn requested() -> impl Iterator<Item = f64> {
    (1..20).map(|k| f64::from(k) / 20.0)
}

/// One impact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Impact {
    /// Restitution asked for.
    pub requested: f64,
    /// Restitution delivered, by simulation.
    pub delivered: f64,
    /// The same by the closed relation.
    pub closed: f64,
}

/// The impacts of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Delivery {
    /// The law.
    pub law: &'static ContactLaw,
    /// Its impacts, by increasing restitution.
    pub impacts: Vec<Impact>,
    /// From this request on the delivered restitution stays within [`NEAR`] of it; none where it never does.
    pub near_from: Option<f64>,
}

/// The impacts of every law with hysteresis.
///
/// # Errors
/// A configuration that is refused: a mistake in this program, excluded by a test.
pub fn deliveries() -> Result<Vec<Delivery>, ConfigError> {
    let laws = ContactLaw::ALL.iter().filter(|law| law.has_memory());
    laws.map(delivery).collect()
}

fn delivery(law: &'static ContactLaw) -> Result<Delivery, ConfigError> {
    let impact = |e: f64| {
        let closed = law.hysteresis_factor(e).map_or(f64::NAN, delivered);
        Ok(Impact { requested: e, delivered: simulated(law, e)?, closed })
    };
    let impacts = requested().map(impact).collect::<Result<Vec<_>, ConfigError>>()?;
    let is_near = |impact: &&Impact| (impact.delivered - impact.requested).abs() <= NEAR;
    let near_from = impacts.iter().rev().take_while(is_near).last().map(|i| i.requested);
    Ok(Delivery { law, impacts, near_from })
}

/// The restitution of an impact under `law`; not a number where the pin does not leave.
fn simulated(law: &ContactLaw, e: f64) -> Result<f64, ConfigError> {
    let law = format!("contact.law={law}");
    let e = format!("contact.restitution={e}");
    let sets = [law, e, "drive.m1=0".to_owned(), "friction.coefficient=0".to_owned()];
    let block = Joints::from(&Config::load(None, &sets)?).blocks()[0].clone();
    let Some(method) = Method::named("dop853") else { return Ok(f64::NAN) };
    let accuracy = Accuracy::Rtol(RTOL, None);
    let mut start = block.initial_state();
    start[4] = -SPEED;
    let mut leaves = Leaves { speed: f64::NAN };
    let setting = Setting { method, events: Events::Located, accuracy };
    block.integrate(&setting, start, 1.0, &mut leaves);
    Ok(leaves.speed / SPEED)
}

/// Ends a run where its pin leaves the contact, with its speed [m/s].
struct Leaves {
    speed: f64,
}

impl Record<Block> for Leaves {
    fn event(&mut self, event: &Event<'_, Block>) -> ControlFlow<()> {
        if event.after == Next::Mode(Mode::Apart) {
            self.speed = event.y[4];
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_delivers_what_its_closed_relation_says() {
        let deliveries = deliveries().unwrap();
        let n = ContactLaw::ALL.iter().filter(|law| law.has_memory()).count();
        assert!(n > 0 && deliveries.len() == n, "{} of {n}", deliveries.len());
        for Delivery { law, impacts, .. } in deliveries {
            for Impact { requested, delivered, closed } in impacts {
                let error = (delivered - closed).abs();
                // Measured: 5.7e-10, of the stiffest; 2.3e-11 of the others.
                assert!(error < 1e-6, "{law} at {requested}: {delivered}, not {closed}");
            }
        }
    }
}
