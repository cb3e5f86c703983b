//! What restitution does a law deliver that is asked for e?
//!
//! A pin meets its bush head on, without drive and friction, and is followed by `dop853` until it leaves: one
//! degree of freedom of the very mechanism, `M_y δ̈ = −F_N`.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Method, Needs, Next, Record};
use deltazero_study::run::{Accuracy, Setting, integrate};
use deltazero_study::setting::Events;
use deltazero_study::warning::{Code, Warning};
use serde::Serialize;

use crate::config::{Config, ConfigError, ContactLaw, JointConfig, MechanismName};
use crate::model::restitution::{delivered, hysteresis_factor};
use crate::model::{Block, Mechanism, Mode};

/// Speed of the impact [m/s]; what is delivered does not depend on it.
const SPEED: f64 = 0.01;
const RTOL: f64 = 1e-10;
/// A delivered restitution is held to be near the requested one within this.
pub const NEAR: f64 = 0.05;
/// A restitution that is further off than this from the one asked for is warned of.
const TOLD: f64 = 0.01;

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
    pub law: ContactLaw,
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
    laws.map(|&law| delivery(law)).collect()
}

fn delivery(law: ContactLaw) -> Result<Delivery, ConfigError> {
    let impact = |e: f64| {
        let closed = hysteresis_factor(law, e).map_or(f64::NAN, delivered);
        Ok(Impact { requested: e, delivered: simulated(law, e)?, closed })
    };
    let impacts = requested().map(impact).collect::<Result<Vec<_>, ConfigError>>()?;
    let is_near = |impact: &&Impact| (impact.delivered - impact.requested).abs() <= NEAR;
    let near_from = impacts.iter().rev().take_while(is_near).last().map(|i| i.requested);
    Ok(Delivery { law, impacts, near_from })
}

/// The restitution of an impact under `law`; not a number where the pin does not leave.
fn simulated(law: ContactLaw, e: f64) -> Result<f64, ConfigError> {
    let law = format!("contact.law={law}");
    let e = format!("contact.restitution={e}");
    let sets = [law, e, "drive.m1=0".to_owned(), "friction.coefficient=0".to_owned()];
    let block = Mechanism::new(&Config::load(None, &sets)?).blocks()[0].clone();
    let Some(method) = Method::named("dop853") else { return Ok(f64::NAN) };
    let accuracy = Accuracy::Rtol(RTOL, None);
    let mut start = block.initial_state();
    start[4] = -SPEED;
    let mut leaves = Leaves { speed: f64::NAN };
    let setting = Setting { method, events: Events::Located, accuracy };
    integrate(&block, &setting, start, 1.0, &mut leaves);
    Ok(leaves.speed / SPEED)
}

/// Ends a run where its pin leaves the contact, with its speed [m/s].
struct Leaves {
    speed: f64,
}

impl Record<Block> for Leaves {
    fn step(&mut self, _: &Accepted<'_, Block>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

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

/// Warnings of contact laws that deliver another restitution than `config` asks for.
pub fn warnings(config: &Config) -> Vec<Warning> {
    let of = |joint: &JointConfig| Some(joint).filter(|j| j.joint.clearance > 0.0).and_then(off);
    let [one, two] = config.joints.each_ref().map(of);
    let about = |joints: &str, what: Option<String>| {
        let message = format!("{joints}: {}", what?);
        Some(Warning { code: Code::Restitution, message })
    };
    match config.mechanism {
        MechanismName::SliderCrank => about("the joint", one).into_iter().collect(),
        MechanismName::Strut if one == two => about("both joints", one).into_iter().collect(),
        MechanismName::Strut => {
            [about("joint 1", one), about("joint 2", two)].into_iter().flatten().collect()
        }
    }
}

/// What a joint is asked for and what its law delivers, where these differ by more than [`TOLD`].
fn off(JointConfig { contact, .. }: &JointConfig) -> Option<String> {
    let (law, asked) = (contact.law, contact.restitution);
    let delivered = delivered(hysteresis_factor(law, asked)?);
    let elastic = match law {
        ContactLaw::LankaraniNikraveshCylinder => ", on K δⁿ in the place of its cylinders,",
        _ => "",
    };
    ((delivered - asked).abs() > TOLD).then(|| {
        format!(
            "contact.law = {law} is asked for a restitution of {asked} and delivers {delivered:.3}; \
             exact_restitution{elastic} delivers what is asked"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn messages(sets: &[&str]) -> Vec<String> {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let warnings = warnings(&Config::load(None, &sets).unwrap());
        assert!(warnings.iter().all(|warning| warning.code == Code::Restitution));
        warnings.into_iter().map(|warning| warning.message).collect()
    }

    #[test]
    fn a_law_that_delivers_another_restitution_is_told_with_both_numbers() {
        let lankarani = "contact.law=lankarani_nikravesh";
        assert_eq!(
            messages(&[lankarani, "contact.restitution=0.6"]),
            [
                "both joints: contact.law = lankarani_nikravesh is asked for a restitution of 0.6 and \
              delivers 0.756; exact_restitution delivers what is asked"
            ]
        );
        let one = messages(&["joint2.contact.law=flores", "contact.restitution=0.3"]);
        assert!(one.len() == 1 && one[0].starts_with("joint 2: contact.law = flores"), "{one:?}");
        let both = messages(&[lankarani, "joint2.contact.law=lee_wang"]);
        assert_eq!(both.len(), 2);
        let crank = messages(&["mechanism=slider-crank", "contact.restitution=0.6"]);
        assert!(crank.len() == 1 && crank[0].starts_with("the joint: "), "{crank:?}");
        let cylinder =
            messages(&["contact.law=lankarani_nikravesh_cylinder", "contact.restitution=0.5"]);
        assert!(cylinder[0].contains("exact_restitution, on K δⁿ"), "{cylinder:?}");
    }

    #[test]
    fn a_law_without_restitution_or_with_the_right_one_is_not_told() {
        for law in ["power", "johnson", "exact_restitution"] {
            let law = format!("contact.law={law}");
            assert_eq!(messages(&[&law, "contact.restitution=0.3"]), Vec::<String>::new());
        }
        // χ of Hunt and Crossley delivers 0.952 for 0.95; a joint without clearance has no impact.
        for other in ["contact.restitution=0.95", "joint.clearance=0"] {
            let sets = ["contact.law=hunt_crossley", "contact.restitution=0.6", other];
            assert_eq!(messages(&sets), Vec::<String>::new());
        }
    }

    #[test]
    fn every_law_delivers_what_its_closed_relation_says() {
        let deliveries = deliveries().unwrap();
        assert_eq!(deliveries.len(), 10);
        for Delivery { law, impacts, .. } in deliveries {
            for Impact { requested, delivered, closed } in impacts {
                let error = (delivered - closed).abs();
                // Measured: 5.7e-10, of the stiffest; 2.3e-11 of the others.
                assert!(error < 1e-6, "{law} at {requested}: {delivered}, not {closed}");
            }
        }
    }
}
