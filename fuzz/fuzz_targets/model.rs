//! A model in TOML: its complaint names a place in the text; what is read compiles again at its own values.

#![no_main]

use deltazero_text::ModelFile;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match ModelFile::parse("model.toml", text) {
        Ok(model) => {
            let own = model.parameters().iter().map(|own| (own.name.clone(), own.value));
            let own: Vec<_> = own.collect();
            assert!(model.models(&own).is_ok());
            model.warnings().iter().for_each(|warning| assert!(!warning.to_string().is_empty()));
        }
        Err(report) => {
            assert!(text.get(report.span()).is_some(), "{report}");
            let _ = report.line_and_column();
        }
    }
});
