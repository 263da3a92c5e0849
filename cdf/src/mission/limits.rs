//! How large a mission may be. Checked before anything is made of its text, so that a file of any size is refused at once.
//!
//! The numbers in parentheses are the largest of about 400 missions made for the original game.

use std::{borrow::Cow, fmt};

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value, json};

use super::problem::Pointer;

/// Bytes of a mission's text (20 KB). All peers of a session and its log hold the text, the log several times.
pub const BYTES: usize = 1 << 20;
/// Objects and lists within each other (10). The reader and the goals go as deep as the file does; fifty negations within each
/// other are at 106.
const DEPTH: usize = 120;
/// Values in all (700): each costs some hundred bytes while a mission is read.
const VALUES: usize = 50_000;
/// Characters of a text (200): several printed pages, more than anybody reads from a note.
const TEXT: usize = 10_000;
/// Characters of a key (40), which is a word of the format or an instance id.
const KEY: usize = 256;
/// Keys of an object (12).
const KEYS: usize = 256;
/// Items of a list for which no other number is given (4).
const ITEMS: usize = 1000;

/// Lists with a number of their own.
const LISTS: [List; 6] = [
    // (42) The floor plans have places for some hundred objects, and each object is simulated.
    List { pointer: "/scene/required_objects", items: 1000, what: "objects" },
    // (3) The floor plans have eight to sixteen places for notes.
    List { pointer: "/scene/sticky_notes", items: 200, what: "notes" },
    // (4) Goals are judged at every tick, and people read them.
    List { pointer: "/task_goals", items: 200, what: "goals" },
    // (4) So are conditions.
    List { pointer: "/stateconditions", items: 500, what: "conditions" },
    // (1) Each portal has objects of its own behind it.
    List { pointer: "/pastPortals", items: 100, what: "portals to the past" },
    List { pointer: "/futurePortals", items: 100, what: "portals to the future" },
];

struct List {
    pointer: &'static str,
    items: usize,
    what: &'static str,
}

/// A limit that a mission's text exceeds: where, and what to do.
#[derive(Debug, Eq, PartialEq)]
pub(super) struct Exceeded {
    pub at: Pointer,
    pub message: String,
    pub remedy: String,
}

/// The first limit that `text` exceeds. What is no JSON exceeds none from there on.
pub(super) fn exceeded(text: &str) -> Option<Exceeded> {
    if text.len() > BYTES {
        return Some(Exceeded {
            at: Pointer::default(),
            message: format!("the mission has {} bytes", text.len()),
            remedy: format!("a mission has at most {BYTES}"),
        });
    }
    let mut scan = Scan { path: String::new(), depth: 0, values: 0, exceeded: None };
    // An error is a limit, which is noted, or a slip in the text, which its parser tells better.
    let _ = scan.deserialize(&mut serde_json::Deserializer::from_str(text));
    scan.exceeded
}

/// Goes through a JSON text and keeps nothing of it.
struct Scan {
    /// The JSON pointer of what is read now.
    path: String,
    depth: usize,
    values: usize,
    exceeded: Option<Exceeded>,
}

impl Scan {
    fn exceed<E: serde::de::Error>(&mut self, message: &str, remedy: String) -> E {
        let at = Pointer::of(self.path.clone());
        self.exceeded = Some(Exceeded { at, message: message.to_owned(), remedy });
        E::custom("a limit")
    }

    fn count<E: serde::de::Error>(&mut self) -> Result<(), E> {
        self.values += 1;
        if self.values > VALUES {
            return Err(self.exceed("the mission has too many values", format!("it has at most {VALUES} in all")));
        }
        Ok(())
    }

    fn enter<E: serde::de::Error>(&mut self) -> Result<usize, E> {
        self.depth += 1;
        if self.depth > DEPTH {
            let remedy = format!("objects and lists are at most {DEPTH} within each other");
            return Err(self.exceed("this is nested too deep", remedy));
        }
        Ok(self.path.len())
    }

    fn leave(&mut self, path: usize) {
        self.depth -= 1;
        self.path.truncate(path);
    }
}

impl<'de> DeserializeSeed<'de> for &mut Scan {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.count::<D::Error>()?;
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for &mut Scan {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<(), E> {
        if is_longer(text, TEXT) {
            return Err(self.exceed("the text is too long", format!("a text has at most {TEXT} characters")));
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let own = self.enter::<A::Error>()?;
        let known = LISTS.iter().find(|list| list.pointer == self.path);
        let (most, what) = known.map_or((ITEMS, "items"), |list| (list.items, list.what));
        for index in 0.. {
            self.path.push_str(&format!("/{index}"));
            if list.next_element_seed(&mut *self)?.is_none() {
                break;
            }
            self.path.truncate(own);
            if index >= most {
                return Err(self.exceed("the list is too long", format!("it has at most {most} {what}")));
            }
        }
        self.leave(own);
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let own = self.enter::<A::Error>()?;
        let mut keys = 0;
        while let Some(key) = map.next_key::<Cow<'_, str>>()? {
            keys += 1;
            if keys > KEYS {
                return Err(self.exceed("the object has too many keys", format!("an object has at most {KEYS}")));
            }
            if is_longer(&key, KEY) {
                return Err(self.exceed("a key is too long", format!("a key has at most {KEY} characters")));
            }
            self.path.push_str(Pointer::default().key(&key).as_str());
            map.next_value_seed(&mut *self)?;
            self.path.truncate(own);
        }
        self.leave(own);
        Ok(())
    }
}

fn is_longer(text: &str, most: usize) -> bool {
    text.len() > most && text.chars().nth(most).is_some()
}

/// Writes the limits into a schema of missions.
pub(super) fn state(schema: &mut Map<String, Value>) {
    // What the words of JSON Schema cannot say.
    let summary = json!({"bytes": BYTES, "depth": DEPTH, "values": VALUES});
    let words = format!(
        " At most {BYTES} bytes of UTF-8, {VALUES} values in all, {DEPTH} objects and lists within each other (`x-limits`)."
    );
    if let Some(Value::String(description)) = schema.get_mut("description") {
        description.push_str(&words);
    }
    bound_all(schema, ITEMS);
    schema.insert("x-limits".to_owned(), summary);
}

/// Bounds all that this schema and those in it describe; `items` is for the lists that it describes itself.
fn bound_all(schema: &mut Map<String, Value>, items: usize) {
    bound(schema, items);
    for (key, inner) in schema {
        match inner {
            // The names of fields and definitions are no words of the schema.
            Value::Object(fields) if matches!(key.as_str(), "properties" | "$defs") => {
                for (name, field) in fields {
                    let list = LISTS.iter().find(|list| list.pointer.ends_with(&format!("/{name}")));
                    bound_value(field, list.map_or(ITEMS, |list| list.items));
                }
            }
            inner => bound_value(inner, if key == "anyOf" { items } else { ITEMS }),
        }
    }
}

fn bound_value(value: &mut Value, items: usize) {
    match value {
        Value::Object(schema) => bound_all(schema, items),
        Value::Array(schemas) => schemas.iter_mut().for_each(|schema| bound_value(schema, items)),
        _ => {}
    }
}

fn bound(schema: &mut Map<String, Value>, items: usize) {
    let is_of = |wanted: &str| match schema.get("type") {
        Some(Value::String(one)) => one == wanted,
        Some(Value::Array(several)) => several.iter().any(|one| one == wanted),
        _ => false,
    };
    let listed = schema.contains_key("enum");
    let bounds = [("array", "maxItems", items), ("string", "maxLength", TEXT), ("object", "maxProperties", KEYS)];
    let bounds: Vec<_> =
        bounds.into_iter().filter(|(kind, ..)| is_of(kind) && !(listed && *kind == "string")).collect();
    for (kind, word, most) in bounds {
        schema.entry(word).or_insert_with(|| json!(most));
        if kind == "object" {
            schema.entry("propertyNames").or_insert_with(|| json!({"maxLength": KEY}));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: Option<(&str, &str)>) {
        let found = exceeded(text);
        let found = found.as_ref().map(|limit| (limit.at.as_str(), limit.message.as_str()));
        assert_eq!(found, expected);
    }

    fn list(of: &str, items: usize) -> String {
        format!("[{}]", vec![of; items].join(","))
    }

    #[test]
    fn what_is_at_its_limit_passes_and_what_is_beyond_is_told_with_its_place() {
        let long = "the list is too long";
        for (key, before, after, most) in [
            ("required_objects", "{\"scene\":{", "}}", 1000),
            ("sticky_notes", "{\"scene\":{", "}}", 200),
            ("task_goals", "{", "}", 200),
            ("stateconditions", "{", "}", 500),
            ("pastPortals", "{", "}", 100),
            ("anything", "{", "}", ITEMS),
        ] {
            let text = |items| format!("{before}\"{key}\":{}{after}", list("{}", items));
            let pointer = if before.contains("scene") { format!("/scene/{key}") } else { format!("/{key}") };
            check(&text(most), None);
            check(&text(most + 1), Some((&pointer, long)));
        }
        let text = |characters| format!("{{\"a\":[\"{}\"]}}", "ы".repeat(characters));
        check(&text(TEXT), None);
        check(&text(TEXT + 1), Some(("/a/0", "the text is too long")));
        let key = |characters| format!("{{\"a\":{{\"{}\":1}}}}", "k".repeat(characters));
        check(&key(KEY), None);
        check(&key(KEY + 1), Some(("/a", "a key is too long")));
        let keys = |count| {
            let keys: Vec<_> = (0..count).map(|key| format!("\"{key}\":0")).collect();
            format!("{{\"a/b\":{{{}}}}}", keys.join(","))
        };
        check(&keys(KEYS), None);
        check(&keys(KEYS + 1), Some(("/a~1b", "the object has too many keys")));
        let nested = |depth| format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        check(&nested(DEPTH), None);
        check(&nested(DEPTH + 1), Some((&"/0".repeat(DEPTH), "this is nested too deep")));
        check(&"[".repeat(100_000), Some((&"/0".repeat(DEPTH), "this is nested too deep")));
        let values = list(&list("0", 999), 50);
        check(&values, Some(("/49/998", "the mission has too many values")));
        let bytes = |spaces| format!("{}{{}}", " ".repeat(spaces));
        check(&bytes(BYTES - 2), None);
        check(&bytes(BYTES - 1), Some(("", "the mission has 1048577 bytes")));
    }

    #[test]
    fn what_is_no_json_exceeds_nothing() {
        for text in ["", "{", "{\"a\": [1, 2", "nonsense", "[1] [2]"] {
            check(text, None);
        }
    }
}
