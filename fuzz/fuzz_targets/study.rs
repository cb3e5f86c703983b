//! `study.json`: refused, or the same when it is written and read again; what `report` says of it first.

#![no_main]

use deltazero::report::{About, answer, study_csv, study_markdown};
use deltazero::study::record::StudyRecord;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &[u8]| {
    let Ok(study) = serde_json::from_slice::<StudyRecord>(text) else { return };
    let written = study.to_json().to_string();
    let again: StudyRecord = serde_json::from_str(&written).expect("what was written");
    assert_eq!(again.to_json().to_string(), written);
    let about = About::of(&study.config);
    let _ = answer(&study.table);
    let _ = study_csv(&about, &study.table);
    let _ = study_markdown(&about, &study.table, &[]);
});
