//! The paper's deployable struts: a side frame with clearance in two root joints, or a chain of bays.

use std::sync::Arc;

use deltazero_study::setting::Digits;
use deltazero_study::warning::Warning;

use super::in_words::{fact, joint, joint_warnings, no_blind_joints};
use super::{Entry, Mechanism, Misfit};
use crate::keys::{ReadingName, STRUTS, Shared};
use crate::model::struts::struts;
use crate::model::{Joints, Part};

/// Its line in the list.
pub(super) const STRUT: Entry = Entry {
    name: "strut",
    about: "the paper's deployable struts: two root joints with clearance, or a chain of bays",
    keys: STRUTS,
    uses: &[
        "joint",
        "contact",
        "friction",
        "run.stop_at_90",
        "regimes.stiffness",
        "regimes.damping_ratio",
        "regimes.readings",
    ],
    defaults: &[],
    has_two_joints: true,
    read: |_| Ok(Arc::new(Struts)),
};

/// The struts; their parameters are tables of [`Config`].
struct Struts;

impl Mechanism for Struts {
    fn joints(&self, shared: &Shared) -> Joints {
        let [one, two] = struts(shared);
        Joints { parts: vec![Part::of(one, shared.bays as usize), Part::of(two, 1)] }
    }

    fn n_sites(&self, shared: &Shared) -> usize {
        shared.bays as usize + 1
    }

    fn n_tolerances(&self) -> usize {
        6
    }

    fn check(&self, shared: &Shared) -> Result<(), Misfit> {
        check_chain(shared)
    }

    fn title(&self, shared: &Shared) -> String {
        match shared.bays {
            1 => format!("Reading `{}`", shared.reading),
            bays => format!("Reading `{}`, {bays} bays", shared.reading),
        }
    }

    fn lead(&self) -> &str {
        "A pin rattles in a bush with clearance: free flight, then contact through a stiff spring, with friction; each \
         change is an event, the zero crossing of the penetration δ."
    }

    fn facts(&self, shared: &Shared) -> Vec<(String, String)> {
        let [one, two] = &shared.joints;
        let mut facts = vec![fact("Reading", shared.reading.name())];
        if shared.bays > 1 {
            facts.push(fact("Bays", shared.bays.to_string()));
        }
        facts.extend([
            fact("Time", format!("0 to {} s", shared.run.t_end)),
            fact("Torques", format!("M1 = {} N m, M4 = {} N m", shared.drive.m1, shared.drive.m4)),
        ]);
        if one == two {
            facts.push(fact("Both joints", joint(one)));
        } else {
            facts.extend([fact("Joint 1", joint(one)), fact("Joint 2", joint(two))]);
        }
        facts
    }

    fn leading(&self, shared: &Shared) -> Vec<(&'static str, &'static str, String)> {
        vec![("reading", "reading of the paper", shared.reading.to_string())]
    }

    fn warnings(&self, shared: &Shared) -> Vec<Warning> {
        let [one, two] = &shared.joints;
        if one == two {
            return joint_warnings("both joints", one);
        }
        let mut warnings = joint_warnings("joint 1", one);
        warnings.extend(joint_warnings("joint 2", two));
        warnings
    }

    fn no_blind_runs(&self, shared: &Shared) -> Option<String> {
        let chain = || (shared.bays > 1).then(|| "the blind baseline is built for one bay".into());
        no_blind_joints(&shared.joints, chain)
    }
}

/// What a chain of several bays cannot have.
fn check_chain(shared: &Shared) -> Result<(), Misfit> {
    let refused = |key, found: String, reason| Err(Misfit { key, found, against: "bays", reason });
    if shared.bays == 1 {
        return Ok(());
    }
    if shared.reading != ReadingName::Pin {
        let reason = "friction as a force couples the sticks of neighbours, and a force at the centroid has no \
                      reaction at the bush; use reading = \"pin\"";
        return refused("reading", shared.reading.to_string(), reason);
    }
    let others = |readings: &&Vec<ReadingName>| readings.iter().any(|r| *r != ReadingName::Pin);
    if shared.regimes.readings.as_ref().filter(others).is_some() {
        let reason = "a chain is one of reading \"pin\"; use regimes.readings = [\"pin\"]";
        return refused("regimes.readings", "others than pin".to_owned(), reason);
    }
    if shared.joints[0].joint.clearance == 0.0 {
        let reason =
            "pins that are held couple the accelerations of all bays; use a clearance above zero";
        return refused("joint.clearance", "0".to_owned(), reason);
    }
    if shared.study.reference == Digits::Extended {
        let reason = "extended precision is built for one bay; use study.reference = \"double\"";
        return refused("study.reference", shared.study.reference.to_string(), reason);
    }
    Ok(())
}
