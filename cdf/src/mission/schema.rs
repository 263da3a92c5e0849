//! The JSON Schema (draft 2020-12) of mission files, for editors and for those who generate missions.
//!
//! Made from the same types and tables that reading uses. It describes how missions are to be written; reading is more
//! generous, and checks more: that what is named is there, and that goals can be met. It states how large a mission may be
//! ([`limits`]).

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, generate::SchemaSettings, json_schema};
use serde_json::{Map, Value, json};

use super::{
    expression::KINDS,
    goals::ALWAYS_UNLOCKED,
    key::InitialKey,
    limits,
    raw::{Cdf, Loose, Scalar},
    scene::{LAYOUTS, MIRRORED},
};
use crate::{
    action::{Status, Verb},
    catalog::Catalog,
    flag_key::flag_keys,
    layout::Layout,
    state::{Color, Fluid},
};

/// The schema, with the classes of `catalog` as the objects there are.
#[must_use]
pub fn schema(catalog: &Catalog) -> Value {
    let generated = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Cdf>().to_value();
    // What it is comes first, for those who read it.
    let mut schema = Map::new();
    for key in ["$schema", "title", "description"] {
        schema.insert(key.to_owned(), generated[key].clone());
    }
    schema.insert("title".to_owned(), json!("Cohabit mission (CDF)"));
    for (key, value) in generated.as_object().into_iter().flatten().filter(|(key, _)| *key != "title") {
        schema.insert(key.clone(), value.clone());
    }
    if let Some(definitions) = schema.get_mut("$defs").and_then(Value::as_object_mut) {
        definitions.extend(vocabulary(catalog));
    }
    limits::state(&mut schema);
    Value::Object(schema)
}

/// The words of the format, and the shapes made of them.
fn vocabulary(catalog: &Catalog) -> Map<String, Value> {
    let classes: Vec<&str> = catalog.classes().iter().map(|class| class.id.as_str()).collect();
    let instance = format!("^$|^TAM_[0-9]+$|^({})(_.*)?\\*?$", classes.join("|"));
    let defined = [
        ("ObjectClass", words("A class of object.", classes)),
        ("Instance", pattern("An instance: a class and a number, such as `Bowl_01_1`.", &instance)),
        (
            "InstancePattern",
            pattern("An instance, or a beginning and `*` for any that begins so.", "^[A-Za-z][A-Za-z0-9_]*\\*?$"),
        ),
        ("Room", room_schema(catalog)),
        ("Layout", words("A layout.", layouts_known())),
        ("Fluid", words("What fills an object.", Fluid::ALL.iter().map(|fluid| fluid.name()))),
        ("Color", words("A colour.", Color::ALL.iter().map(|color| color.name()))),
        ("StateKey", words("The name of a state.", flag_keys())),
        ("InitialState", initial_state()),
        ("GoalState", goal_state()),
        ("Expression", expression_schema()),
        ("Expressions", expressions_schema()),
        ("Truth", truth_schema()),
        ("Integer", integer_schema()),
        (
            "Distance",
            json!({"description": "Metres.", "anyOf": [{"type": "number", "minimum": 0},
            {"type": "string", "pattern": "^\\s*[0-9.]+\\s*$"}]}),
        ),
        (
            "Verb",
            words("What can be done to an object.", Verb::ALL.iter().map(|verb| format!("{verb:?}").to_uppercase())),
        ),
        ("Status", words("What comes of a command.", Status::ALL.iter().map(|status| format!("{status:?}")))),
    ];
    defined.into_iter().map(|(name, schema)| (name.to_owned(), schema)).collect()
}

/// World packs have rooms of their own, so that any id or name may be right.
fn room_schema(catalog: &Catalog) -> Value {
    let known: Vec<&str> = catalog.rooms().all().iter().map(|room| room.id.id()).collect();
    let description = "A room of the world, by its id or its name.";
    json!({"description": description, "type": "string", "minLength": 1, "examples": known})
}

fn layouts_known() -> Vec<String> {
    let plain = LAYOUTS.iter().map(|id| (*id).to_owned());
    let mirrored = LAYOUTS.iter().map(|id| format!("{id}{MIRRORED}"));
    let mut known: Vec<String> = plain.chain(mirrored).collect();
    known.extend(Layout::builtin_ids().into_iter().filter(|id| !LAYOUTS.contains(&id.trim_end_matches(MIRRORED))));
    known
}

fn words(description: &str, known: impl IntoIterator<Item = impl Into<Value>>) -> Value {
    let known: Vec<Value> = known.into_iter().map(Into::into).collect();
    json!({"description": description, "type": "string", "enum": known})
}

fn pattern(description: &str, pattern: &str) -> Value {
    json!({"description": description, "type": "string", "pattern": pattern})
}

fn defined(name: &str) -> Value {
    json!({"$ref": format!("#/$defs/{name}")})
}

fn truth_schema() -> Value {
    json!({
        "description": "True or false, also as a text.",
        "anyOf": [
            {"type": "boolean"},
            {"type": "string", "pattern": "^\\s*([Tt][Rr][Uu][Ee]|[Ff][Aa][Ll][Ss][Ee]|0|1)\\s*$"},
            {"enum": [0, 1]},
        ],
    })
}

fn integer_schema() -> Value {
    json!({
        "description": "A whole number, also as a text.",
        "anyOf": [{"type": "integer"}, {"type": "string", "pattern": "^\\s*[-+]?[0-9]+\\s*$"}],
    })
}

/// `{"isOpen": "true"}`, an item of an object's `state`.
fn initial_state() -> Value {
    let of_key = |key: &str| match InitialKey::of(key) {
        Some(InitialKey::Filled) => json!({"anyOf": [defined("Fluid"), defined("Truth")]}),
        Some(InitialKey::Circuit | InitialKey::GeneratesCircuit) => defined("Integer"),
        Some(InitialKey::Text) => json!({"description": "What a note says.", "type": ["string", "number"]}),
        _ => defined("Truth"),
    };
    let keys = InitialKey::names().chain(["Infected"]);
    let properties: Map<String, Value> = keys.map(|key| (key.to_owned(), of_key(key))).collect();
    json!({
        "description": "A state that the object starts with.",
        "type": "object",
        "minProperties": 1,
        "properties": properties,
        "additionalProperties": false,
    })
}

/// `{"Bowl_01_1": "isHot=true"}`, an item of a goal's `object_states`.
fn goal_state() -> Value {
    let flags: Vec<_> = flag_keys().chain(["Infected", "isEmpty"]).collect();
    let fluids: Vec<_> = Fluid::ALL.iter().map(|fluid| fluid.name()).collect();
    let colors: Vec<_> = Color::ALL.iter().map(|color| color.name()).collect();
    json!({
        "description": "What must hold of an instance.",
        "type": "object",
        "minProperties": 1,
        "propertyNames": defined("InstancePattern"),
        "additionalProperties": {"anyOf": [
            pattern("A state.", &format!("^({}) *= *(true|false|True|False)$", flags.join("|"))),
            pattern("What fills it.", &format!("^(isFilled|ContainsFluid) *= *({}|true|false)$", fluids.join("|"))),
            pattern("Its colour.", &format!("^ColorMetaDataChange *= *({})$", colors.join("|"))),
            pattern("What it contains.", "^Contains *= *[A-Za-z][A-Za-z0-9_]*\\*?$"),
            pattern("A condition of the mission.", "^[A-Za-z_][A-Za-z0-9_ ]* *= *(true|false|True|False)$"),
        ]},
    })
}

fn expression_schema() -> Value {
    let mut properties: Map<String, Value> =
        flag_keys().map(|key| (key.to_owned(), test("value", defined("Truth"), false))).collect();
    properties.extend(KINDS.iter().map(|kind| ((*kind).to_owned(), of_kind(kind))));
    properties.insert("message".to_owned(), json!({"type": ["string", "null"]}));
    json!({
        "description": "What must hold; several kinds at once count as all of them.",
        "type": "object",
        "minProperties": 1,
        "properties": properties,
        "additionalProperties": false,
    })
}

/// The schema of an expression of a kind that is no flag.
fn of_kind(kind: &str) -> Value {
    match kind {
        "AND" | "OR" | "NOT" => defined("Expressions"),
        "Contains" => test("contains", defined("InstancePattern"), true),
        "isFilledWith" => test("fluid", defined("Fluid"), true),
        "isFilled" => test("value", json!({"anyOf": [defined("Fluid"), defined("Truth")]}), true),
        "CanBeSeen" => test("distance", defined("Distance"), true),
        "IsInRange" => test("value", defined("Distance"), true),
        "ColorMetaDataChange" => test("colorvalue", defined("Color"), true),
        "DinoFed" => test("isFed", defined("Truth"), false),
        _ => test("value", defined("Truth"), false),
    }
}

/// An expression that looks at a target.
fn test(argument: &str, schema: Value, needed: bool) -> Value {
    let mut required = vec!["target"];
    if needed {
        required.push(argument);
    }
    json!({
        "type": "object",
        "required": required,
        "properties": {"target": defined("InstancePattern"), "message": {"type": "string"}, argument: schema},
    })
}

fn expressions_schema() -> Value {
    let several = json!({"type": "array", "minItems": 1, "items": defined("Expression")});
    json!({
        "description": "The expressions that are combined.",
        "anyOf": [
            {"type": "object", "required": ["expressions"], "properties": {"expressions": several}},
            {"type": "object", "required": ["expression"], "properties": {"expression": defined("Expression")}},
            several,
            defined("Expression"),
        ],
    })
}

impl<T: JsonSchema> JsonSchema for Loose<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        or_null(generator.subschema_for::<T>().to_value())
    }
}

impl JsonSchema for Scalar {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Scalar".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"type": ["string", "number", "boolean"]})
    }
}

/// Null is as good as nothing.
fn or_null(schema: Value) -> Schema {
    json_schema!({"anyOf": [schema, {"type": "null"}]})
}

/// An empty text is as good as nothing too.
fn or_blank(schema: &Value) -> Schema {
    json_schema!({"anyOf": [schema, {"const": ""}, {"type": "null"}]})
}

fn list(items: &Value) -> Schema {
    or_null(json!({"type": "array", "items": items}))
}

/// Declares the schemas that fields of a mission file have, by name.
macro_rules! field_schemas {
    ($($name:ident => $schema:expr,)*) => {
        $(pub(super) fn $name(_: &mut SchemaGenerator) -> Schema {
            $schema
        })*
    };
}

field_schemas! {
    text => or_null(json!({"type": ["string", "number", "boolean"]})),
    truth => or_blank(&defined("Truth")),
    integer => or_blank(&defined("Integer")),
    integers => list(&defined("Integer")),
    instance => or_null(defined("Instance")),
    class => or_blank(&json!({"anyOf": [defined("ObjectClass"), defined("Instance")]})),
    room => or_null(defined("Room")),
    rooms => or_null(json!({"anyOf": [{"type": "array", "items": defined("Room")}, defined("Room")]})),
    layout => or_blank(&defined("Layout")),
    layouts => list(&defined("Layout")),
    colors => or_null(json!({"anyOf": [{"type": "array", "items": defined("Color")}, defined("Color")]})),
    relation => or_blank(&json!({"enum": ["and", "or", "AND", "OR"]})),
    activation => or_blank(&json!({"anyOf": [{"enum": [ALWAYS_UNLOCKED, "StickyNote"]}, defined("Instance")]})),
    initial_states => list(&defined("InitialState")),
    goal_states => list(&defined("GoalState")),
    location => or_null(json!({
        "type": "array",
        "maxItems": 1,
        "items": {
            "type": "object",
            "propertyNames": defined("Instance"),
            "additionalProperties": {"enum": ["in", "on", "In", "On"]},
        },
    })),
    expression => or_null(defined("Expression")),
    occasion => or_null(json!({"type": ["object", "string"]})),
    portal_status => or_blank(&json!({"anyOf": [defined("Truth"), {"type": "string"}]})),
    portals => list(&json!({"type": ["string", "object"]})),
    items => list(&json!({"type": ["string", "object"]})),
}
