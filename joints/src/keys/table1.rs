//! Table 1 of the paper for tests of joints.

use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::{COMMON, DefaultValue, JointConfig, ReadingName, Shared};

/// What belongs to the mechanism of the struts alone.
const STRUTS: &str = r#"
[strut]
length = 2.5
density = 7800.0
radius = 0.005
inertia = "axial"
[drive]
m1 = 1.0
m4 = 0.3
"#;

/// Table 1, and every key that mechanisms share at its default.
pub(crate) fn table1() -> Shared {
    let lines = COMMON.iter().filter_map(|key| match key.default {
        DefaultValue::Toml(default) => Some(format!("{} = {default}\n", key.path)),
        DefaultValue::Absent(_) => None,
    });
    let all: Table = (lines.collect::<String>() + STRUTS).parse().unwrap();
    let joint = JointConfig {
        joint: read(&all["joint"]),
        contact: read(&all["contact"]),
        friction: read(&all["friction"]),
    };
    Shared {
        reading: ReadingName::Pin,
        bays: 1,
        strut: read(&all["strut"]),
        drive: read(&all["drive"]),
        joints: [joint.clone(), joint],
        run: read(&all["run"]),
        solver: read(&all["solver"]),
        study: read(&all["study"]),
        contest: read(&all["contest"]),
        regimes: read(&all["regimes"]),
    }
}

fn read<T: DeserializeOwned>(value: &Value) -> T {
    value.clone().try_into().unwrap()
}
