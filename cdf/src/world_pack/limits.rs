//! What no pack may have: paths out of its folder, numbers that are none, sizes that no office has.

use serde::de::DeserializeOwned;
use toml::{Table, Value};

use super::{PackError, PackFile, rooms::is_color};
use crate::{
    catalog::{Catalog, ObjectClass, files},
    layout::{Finish, Layout, Room},
    model::{Model, Part, Shape, check_mesh},
    nearest::did_you_mean,
};

/// The largest number: of metres, kilograms or degrees.
const LARGEST: f64 = 10_000.0;
/// The longest text, bytes.
const LONGEST_TEXT: usize = 4096;
/// The longest list.
const LONGEST_LIST: usize = 4096;
/// The most classes of a pack; class numbers have 16 bits.
const MOST_CLASSES: usize = 2048;
/// The largest object, m.
const LARGEST_OBJECT_M: f32 = 10.0;
/// The heaviest, kg.
const HEAVIEST_KG: f32 = 5000.0;
/// The most anchors along a side of a surface.
const MOST_ANCHORS: u32 = 32;
/// The most shapes of a model, repeated ones counted each.
const MOST_SHAPES: u32 = 4096;
/// The most triangles of a model's meshes, repeated and mirrored ones counted each.
const MOST_MESH_TRIANGLES: usize = 20_000;
/// The most things that a floor plan places.
const MOST_PLACEMENTS: usize = 2000;
/// The longest side of a floor plan, m: the floor is kept as a grid.
const LONGEST_PLAN_M: f32 = 100.0;
/// The largest factor by which a placed thing is scaled.
const LARGEST_SCALE: f32 = 20.0;

/// Reads a file's text.
pub(super) fn read<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, PackError> {
    toml::from_str(text).map_err(|source| PackError::Syntax { file: file.to_owned(), source: Box::new(source) })
}

/// Only what lies in the folder is of the pack.
pub(super) fn check_path(root: &str, path: &str) -> Result<(), PackError> {
    let leads_out = path.split('/').any(|part| part.is_empty() || part == "." || part == "..");
    if leads_out || path.contains(['\\', '\0']) {
        let reason = format!("`{path}` is no path within the pack");
        return Err(PackError::at(root, "", reason, "name files by their folders alone, such as objects/things.toml"));
    }
    Ok(())
}

/// All numbers are numbers, and neither lists nor texts go on for ever.
pub(super) fn check_numbers(file: &str, text: &str) -> Vec<PackError> {
    let mut errors = Vec::new();
    match read::<Table>(file, text) {
        Ok(table) => walk(file, "", &Value::Table(table), &mut errors),
        Err(error) => errors.push(error),
    }
    errors
}

fn walk(file: &str, at: &str, value: &Value, errors: &mut Vec<PackError>) {
    let mut fault = |reason: String, remedy: String| errors.push(PackError::at(file, at, reason, &remedy));
    match value {
        Value::Float(number) if !number.is_finite() || number.abs() > LARGEST => {
            fault(format!("{number} is out of range"), format!("write a number from -{LARGEST} to {LARGEST}"));
        }
        Value::Integer(number) if number.unsigned_abs() > LARGEST as u64 => {
            fault(format!("{number} is out of range"), format!("write a number from -{LARGEST} to {LARGEST}"));
        }
        Value::String(text) if text.len() > LONGEST_TEXT => {
            fault(format!("a text of {} bytes", text.len()), format!("at most {LONGEST_TEXT}"));
        }
        Value::Array(list) if list.len() > LONGEST_LIST => {
            fault(format!("a list of {} items", list.len()), format!("at most {LONGEST_LIST}"));
        }
        Value::Array(list) => {
            for (index, item) in list.iter().enumerate() {
                walk(file, &format!("{at}[{index}]"), item, errors);
            }
        }
        Value::Table(table) => {
            for (key, item) in table {
                let at = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                walk(file, &at, item, errors);
            }
        }
        _ => {}
    }
}

/// Classes are of sizes that things have.
pub(super) fn check_objects(files: &[(String, String)]) -> Vec<PackError> {
    let mut errors = Vec::new();
    for (count, (file, class)) in (1..).zip(files::objects(texts(files), &mut errors, read)) {
        check_object(file, &class, &mut errors);
        if count > MOST_CLASSES {
            let at = format!("object `{}`: id", class.id);
            let remedy = format!("at most {MOST_CLASSES} in a pack");
            errors.push(PackError::at(file, &at, "it is one class too many".to_owned(), &remedy));
            return errors;
        }
    }
    errors
}

fn texts(files: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> {
    files.iter().map(|(file, text)| (file.as_str(), text.as_str()))
}

fn check_object(file: &str, class: &ObjectClass, errors: &mut Vec<PackError>) {
    let mut fault = |at: &str, reason: String, remedy: String| {
        errors.push(PackError::at(file, &format!("object `{}`: {at}", class.id), reason, &remedy));
    };
    if class.id.is_empty() || !class.id.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        fault("id", "it is no id".to_owned(), "write letters, digits and `_`".to_owned());
    }
    if !class.size_m.iter().all(|side| *side > 0.0 && *side <= LARGEST_OBJECT_M) {
        let remedy = format!("each side is above 0 m, and at most {LARGEST_OBJECT_M} m");
        fault("size_m", format!("{:?} is no size", class.size_m), remedy);
    }
    if class.mass_kg <= 0.0 || class.mass_kg > HEAVIEST_KG {
        let remedy = format!("it is above 0 kg, and at most {HEAVIEST_KG} kg");
        fault("mass_kg", format!("{} is no mass", class.mass_kg), remedy);
    }
    if let Some(tint) = class.tint.as_deref().filter(|tint| !is_color(tint)) {
        fault("tint", format!("`{tint}` is no colour"), "write it as #rrggbb".to_owned());
    }
    let surfaces = class.receptacle.iter().flat_map(|receptacle| &receptacle.surfaces);
    if !surfaces.flat_map(|surface| surface.anchors).all(|count| (1..=MOST_ANCHORS).contains(&count)) {
        let remedy = format!("from 1 to {MOST_ANCHORS} along each side");
        fault("receptacle", "its anchors are none, or too many".to_owned(), remedy);
    }
}

/// Models are of as many shapes as can be drawn.
pub(super) fn check_models(files: &[(String, String)]) -> Vec<PackError> {
    let mut errors = Vec::new();
    for (file, model) in files::models(texts(files), &mut errors, read) {
        let counts = model.parts.iter().map(|part| part.repeat.as_ref().map_or(1, |repeat| repeat.count));
        let shapes = counts.fold(0_u32, u32::saturating_add);
        if shapes == 0 || shapes > MOST_SHAPES {
            let at = format!("model `{}`: part", model.id);
            let remedy = format!("from 1 to {MOST_SHAPES}, repeated ones counted each");
            errors.push(PackError::at(file, &at, format!("{shapes} shapes"), &remedy));
        }
        check_colors(file, &model, &mut errors);
        check_meshes(file, &model, &mut errors);
    }
    errors
}

/// Parts have colours, or those of what they are a part of: where one is none, nothing could be drawn.
fn check_colors(file: &str, model: &Model, errors: &mut Vec<PackError>) {
    for (number, part) in (1..).zip(&model.parts) {
        if !matches!(part.color.as_str(), "tint" | "fluid") && !is_color(&part.color) {
            let at = format!("model `{}`: part {number}: color", model.id);
            let reason = format!("`{}` is no colour", part.color);
            errors.push(PackError::at(file, &at, reason, "write it as #rrggbb, `tint` or `fluid`"));
        }
    }
}

/// Meshes have the points that their triangles name, and a model has as many triangles as can be drawn.
fn check_meshes(file: &str, model: &Model, errors: &mut Vec<PackError>) {
    let mut count = 0_usize;
    for (number, part) in (1..).zip(&model.parts) {
        let Shape::Mesh { points, triangles, smooth_deg } = &part.shape else { continue };
        count = count.saturating_add(triangles.len().saturating_mul(copies(part)));
        if let Err(error) = check_mesh(points, triangles, *smooth_deg) {
            let at = format!("model `{}`: part {number}", model.id);
            errors.push(PackError::at(file, &at, error.to_string(), &error.remedy()));
        }
    }
    if count > MOST_MESH_TRIANGLES {
        let at = format!("model `{}`: part", model.id);
        let remedy = format!("at most {MOST_MESH_TRIANGLES}, repeated and mirrored ones counted each");
        errors.push(PackError::at(file, &at, format!("{count} triangles of meshes"), &remedy));
    }
}

fn copies(part: &Part) -> usize {
    let repeated = part.repeat.map_or(1, |repeat| usize::try_from(repeat.count).unwrap_or(usize::MAX));
    repeated.saturating_mul(if part.mirror.is_some() { 2 } else { 1 })
}

/// A floor plan is sound, and each of its rooms has a way into it.
pub(super) fn check_plan(file: &str, plan: &Layout, catalog: &Catalog) -> Vec<PackError> {
    let errors = check_shape(file, plan);
    // Ways are looked for in plans alone that are sound else: the floor is a grid.
    if !errors.is_empty() {
        return errors;
    }
    let without = plan.rooms_without_a_way(catalog);
    without.iter().map(|one| PackError::at(file, "room", one.to_string(), &one.remedy())).collect()
}

/// A floor plan has rooms, and is of a size that is walked in.
pub(super) fn check_shape(file: &str, plan: &Layout) -> Vec<PackError> {
    let mut errors = Vec::new();
    let mut fault = |at: &str, reason: String, remedy: &str| errors.push(PackError::at(file, at, reason, remedy));
    if plan.rooms.is_empty() {
        fault("room", "there is none".to_owned(), "write at least one, or name a `base`");
        return errors;
    }
    for room in &plan.rooms {
        let at = format!("room `{}`: rects_m", room.id.id());
        if room.rects_m.is_empty() {
            fault(&at, "there is none".to_owned(), "write [west, south, east, north]");
        }
        for rect in room.rects_m.iter().filter(|rect| rect[2] <= rect[0] || rect[3] <= rect[1]) {
            fault(&at, format!("{rect:?} has no inside"), "write [west, south, east, north]");
        }
    }
    let [west, south, east, north] = plan.bounds_m();
    if east - west > LONGEST_PLAN_M || north - south > LONGEST_PLAN_M {
        let reason = format!("the plan is {} m by {} m", east - west, north - south);
        fault("room", reason, &format!("at most {LONGEST_PLAN_M} m along each side"));
    }
    if !(2.0..=6.0).contains(&plan.wall_height_m) {
        fault("wall_height_m", format!("{} m", plan.wall_height_m), "from 2 to 6 m");
    }
    if plan.placements.len() > MOST_PLACEMENTS {
        fault("placement", format!("{} things", plan.placements.len()), &format!("at most {MOST_PLACEMENTS}"));
    }
    let is_scale = |factor: &f32| *factor > 0.0 && *factor <= LARGEST_SCALE;
    for placement in plan.placements.iter().filter(|placement| !placement.scale.iter().all(is_scale)) {
        let at = format!("placement `{}`: scale", placement.instance);
        let reason = format!("{:?} is no scale", placement.scale);
        fault(&at, reason, &format!("above 0, and at most {LARGEST_SCALE}"));
    }
    errors.extend(plan.rooms.iter().flat_map(|room| check_finishes(file, room)));
    errors
}

/// Floors and walls have colours: what is none would be drawn grey without a word.
fn check_finishes(file: &str, room: &Room) -> Vec<PackError> {
    let all = [("floor", Some(&room.floor)), ("wall", Some(&room.wall)), ("wainscot", room.wainscot.as_ref())];
    let said = all.into_iter().filter_map(|(part, finish)| Some((part, finish?)));
    let wrong = said.filter(|(_, finish)| !is_color(&finish.color));
    let error = |(part, finish): (&str, &Finish)| {
        let at = format!("room `{}`: {part}.color", room.id.id());
        PackError::at(file, &at, format!("`{}` is no colour", finish.color), "write it as #rrggbb")
    };
    wrong.map(error).collect()
}

/// What is said in missions is of missions that there are.
pub(super) fn check_scripts(root: &str, files: &[PackFile]) -> Vec<PackError> {
    let named = |ending: &'static str| {
        let paths = files.iter().filter_map(|file| file.path.strip_prefix("missions/"));
        paths.filter_map(move |path| path.strip_suffix(ending))
    };
    let error = |script: &str| {
        let file = format!("{root}/missions/{script}.script");
        let remedy = did_you_mean(script, named(".json"));
        let remedy = remedy.unwrap_or_else(|| "give it the name of the mission in which it is said".to_owned());
        PackError::at(&file, "", format!("there is no mission `{script}.json` beside it"), &remedy)
    };
    named(".script").filter(|script| named(".json").all(|mission| mission != *script)).map(error).collect()
}
