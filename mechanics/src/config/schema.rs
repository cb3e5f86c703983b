//! The JSON Schema of the configuration, draft 2020-12.

use serde_json::{Map, Value, json};

use super::all_keys::{keys, tables};
use super::check::check;
use super::error::Place;
use super::toml_source;
use crate::keys::{DefaultValue, End, JOINT_TABLES, JOINTS, Key, Kind};

/// The JSON Schema of the configuration: what an editor needs to complete and check a file.
///
/// Every key with its type, range, default and description; no key is required, no other allowed.
pub fn json_schema() -> Value {
    let root = keys().filter(|key| key.table().is_none());
    let mut properties: Map<_, _> =
        root.map(|key| (key.name().to_owned(), key_schema(key, true))).collect();
    for table in tables() {
        properties.insert(table.to_owned(), table_schema(table, true));
    }
    for joint in JOINTS {
        let tables = JOINT_TABLES.map(|table| (table.to_owned(), table_schema(table, false)));
        let mut schema = object(Map::from_iter(tables));
        schema["description"] = format!("What differs for {joint}.").into();
        properties.insert(joint.to_owned(), schema);
    }
    let mut schema = object(properties);
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "deltazero configuration".into();
    schema
}

/// A table; without defaults where an absent key means the common value.
fn table_schema(table: &str, defaults: bool) -> Value {
    let own = keys().filter(|key| key.table() == Some(table));
    object(own.map(|key| (key.name().to_owned(), key_schema(key, defaults))).collect())
}

fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "additionalProperties": false, "properties": properties })
}

fn key_schema(key: &Key, default: bool) -> Value {
    let mut schema = kind_schema(&key.kind);
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    schema["description"] = format!("{}{unit} ({})", key.doc, key.source).into();
    if let (true, DefaultValue::Toml(text)) = (default, key.default)
        && let Ok(given) = toml_source::value(text, Place::Default)
        && let Ok(value) = check(&key.kind, key.path, key.unit, &given)
    {
        schema["default"] = value;
    }
    schema
}

/// The kind in JSON Schema, draft 2020-12.
fn kind_schema(kind: &Kind) -> Value {
    match kind {
        Kind::Number(range) => {
            let mut schema = json!({ "type": "number" });
            match range.low {
                End::Closed(x) => schema["minimum"] = x.into(),
                End::Open(x) => schema["exclusiveMinimum"] = x.into(),
                End::Free => {}
            }
            match range.high {
                End::Closed(x) => schema["maximum"] = x.into(),
                End::Open(x) => schema["exclusiveMaximum"] = x.into(),
                End::Free => {}
            }
            schema
        }
        Kind::Integer(low, high) => {
            json!({ "type": "integer", "minimum": low, "maximum": high })
        }
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Word(words) => json!({ "type": "string", "enum": words }),
        Kind::List(of) => json!({ "type": "array", "items": kind_schema(of), "minItems": 1 }),
        Kind::Set(of) => json!({
            "type": "array", "items": kind_schema(of), "minItems": 1, "uniqueItems": true
        }),
        Kind::OneOf(kinds) => {
            let kinds: Vec<_> = kinds.iter().map(kind_schema).collect();
            json!({ "anyOf": kinds })
        }
    }
}
