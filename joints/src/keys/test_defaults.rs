//! The defaults of all keys as values, for tests of joints.

use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::{COMMON, DefaultValue, JointConfig, STRUTS, Shared};

/// What a configuration of the struts shares with others, every key at its default.
pub(crate) fn table1() -> Shared {
    let lines = COMMON.iter().chain(STRUTS).filter_map(|key| match key.default {
        DefaultValue::Toml(default) => Some(format!("{} = {default}\n", key.path)),
        DefaultValue::Absent(_) => None,
    });
    let all: Table = lines.collect::<String>().parse().unwrap();
    let joint = JointConfig {
        joint: read(&all["joint"]),
        contact: read(&all["contact"]),
        friction: read(&all["friction"]),
    };
    Shared {
        reading: read(&all["reading"]),
        bays: read(&all["bays"]),
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
