//! The features of frames: what `meta/info.json` says of them.

use serde_json::{Map, Value, json};

use super::vectors;
use crate::native::Recipe;

/// Modalities, with the names of their features and their channels. Names with `observation` in front are what policies see.
pub(crate) const PICTURES: [(&str, &str, u32); 4] = [
    ("color", "observation.images.color", 3),
    ("depth", "observation.images.depth", 1),
    ("normals", "observation.images.normals", 3),
    ("ids", "observation.images.ids", 3),
];

/// The pictures that a data set has.
pub(crate) fn pictures(recipe: &Recipe) -> impl Iterator<Item = (&'static str, &'static str, u32)> {
    PICTURES.into_iter().filter(move |(modality, ..)| recipe.modalities.iter().any(|known| known == modality))
}

/// All features, in the order of the columns.
pub(crate) fn features(recipe: &Recipe, rooms: &[String]) -> Value {
    let one = |kind: &str| json!({ "dtype": kind, "shape": [1], "names": null });
    let vector = |names: Vec<String>| json!({ "dtype": "float32", "shape": [names.len()], "names": names });
    let [width, height] = recipe.size;
    let picture = |channels: u32| json!({ "dtype": "image", "shape": [height, width, channels], "names": ["height", "width", "channels"] });
    let mut all = Map::new();
    let mut add = |name: &str, feature: Value| drop(all.insert(name.to_owned(), feature));
    add("observation.state", vector(vectors::state_names(rooms)));
    add("action", vector(vectors::action_names()));
    pictures(recipe).for_each(|(_, name, channels)| add(name, picture(channels)));
    for (name, kind) in [
        ("next.done", "bool"),
        ("step.tick", "int64"),
        ("step.class", "int64"),
        ("step.object", "string"),
        ("step.instruction", "string"),
        ("step.status", "string"),
        ("step.line", "string"),
        ("timestamp", "float32"),
        ("frame_index", "int64"),
        ("episode_index", "int64"),
        ("index", "int64"),
        ("task_index", "int64"),
    ] {
        add(name, one(kind));
    }
    Value::Object(all)
}
