//! The JSON Schema of `study.toml`, made of the table of its keys.

use serde_json::{Map, Value, json};

use crate::shape::{Key, Kind, LONGEST_SECONDS, STUDY};

/// The JSON Schema (2020-12) of a study's file.
#[must_use]
pub fn schema() -> Value {
    let mut schema = table(STUDY);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("A study");
    schema
}

fn table(keys: &[Key]) -> Value {
    let mut properties = Map::new();
    for key in keys {
        let mut property = value(key.kind);
        property["description"] = json!(key.meaning);
        properties.insert(key.name.to_owned(), property);
    }
    let required: Vec<&str> = keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

fn value(kind: Kind) -> Value {
    let text = json!({ "type": "string", "pattern": "\\S" });
    match kind {
        Kind::Text => text,
        Kind::Texts => json!({ "type": "array", "items": text }),
        Kind::Boxes(keys) => json!({ "type": "array", "items": { "anyOf": [text, table(keys)] } }),
        Kind::Switch => json!({ "type": "boolean" }),
        Kind::Whole(most) => json!({ "type": "integer", "minimum": 0, "maximum": most }),
        Kind::Minutes => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Kind::Seconds => json!({ "type": "number", "exclusiveMinimum": 0, "maximum": LONGEST_SECONDS }),
        Kind::Share => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
        Kind::Numbers => json!({ "type": "array", "items": { "type": "integer" } }),
        Kind::OneOf(words) => json!({ "enum": words }),
        Kind::Settings => {
            let one = json!({ "type": ["string", "number", "boolean"] });
            let several = json!({ "type": "array", "items": one });
            json!({ "type": "object", "additionalProperties": { "anyOf": [one, several] } })
        }
        Kind::Table(keys) => table(keys),
        Kind::Tables(keys) => json!({ "type": "array", "items": table(keys), "minItems": 1 }),
    }
}
