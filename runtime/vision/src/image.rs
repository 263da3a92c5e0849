//! One image in its folder: four pictures, the state of the scene, and a record with its annotations.

use std::{
    fs,
    path::{Path, PathBuf},
};

use cohabit_bus::message::{Plane, Thing};
use cohabit_cdf::RoomId;
use cohabit_demonstrate::ObjectEntry;
use cohabit_engine::object_instance_id;
use cohabit_render::Camera;
use cohabit_world::{ObjectView, World};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::{
    categories::category_id,
    dropped::Dropped,
    error::{VisionError, at},
    mask::Mask,
    studio::file_of,
};

/// Images of one folder: so many that no file system minds.
const IMAGES_A_FOLDER: usize = 1000;
const RECORD: &str = "image.json";
const SCENE: &str = "scene.json";

/// All that the files of a whole data set say of one image.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct ImageRecord {
    /// Its number, from 0.
    pub id: usize,
    pub width: u32,
    pub height: u32,
    pub floor_plan: String,
    pub room: RoomId,
    /// Which of the draws of its seed it is, from 0.
    pub draw: u32,
    /// What it looks like.
    pub look: u64,
    pub dropped: Dropped,
    /// Things in it that have no annotation because they have too few pixels.
    pub small_things: u32,
    pub annotations: Vec<Annotation>,
}

/// One thing in an image.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) struct Annotation {
    /// Its id in the picture of ids.
    pub instance_id: u32,
    pub instance: String,
    pub category_id: u32,
    pub bbox: [u32; 4],
    pub area: u32,
    /// Compressed runs.
    pub counts: String,
}

/// The annotations of the things among masks, and how many things have too few pixels for one.
pub(crate) fn annotate(world: &World, masks: &[Mask], min_pixels: u32) -> (Vec<Annotation>, u32) {
    let (mut annotations, mut small) = (Vec::new(), 0);
    for Mask { id, bbox, area, rle } in masks {
        let Thing::Object(object) = Thing::of_id(*id) else { continue };
        let Some(view) = world.object(object) else { continue };
        if *area < min_pixels {
            small += 1;
            continue;
        }
        annotations.push(Annotation {
            instance_id: *id,
            instance: view.instance.to_owned(),
            category_id: category_id(view.class),
            bbox: *bbox,
            area: *area,
            counts: rle.compressed(),
        });
    }
    (annotations, small)
}

/// The state of a scene: the camera, the lamps, and every object of the room or in the picture.
pub(crate) fn scene(world: &World, room: RoomId, camera: &Camera, masks: &[Mask]) -> Value {
    let mut rooms: Vec<RoomId> = world.layout().rooms.iter().map(|room| room.id).collect();
    rooms.sort();
    let lights: Map<String, Value> =
        rooms.into_iter().map(|room| (room.to_string(), world.room_lit(room).into())).collect();
    let is_seen = |id: u32| masks.binary_search_by_key(&id, |mask| mask.id).is_ok();
    let entry = |view: ObjectView<'_>| {
        let id = object_instance_id(view.id);
        let seen = is_seen(id);
        let is_wanted = world.exists(view.id) && (seen || view.room == room);
        is_wanted.then(|| json!({ "instance_id": id, "seen": seen, "state": ObjectEntry::of(world, &view) }))
    };
    let objects: Vec<Value> = world.objects().filter_map(entry).collect();
    json!({
        "floor_plan": &world.layout().id,
        "room": room.id(),
        "camera": {
            "position_m": camera.position_m,
            "yaw_rad": camera.yaw_rad,
            "pitch_rad": camera.pitch_rad,
            "fov_y_rad": camera.fov_y_rad,
            "width": camera.width,
            "height": camera.height,
        },
        "lights": lights,
        "objects": objects,
    })
}

/// Where an image is in a data set, with slashes whatever the system.
pub(crate) fn folder_of(id: usize) -> String {
    format!("images/{:04}/{id:07}", id / IMAGES_A_FOLDER)
}

/// The files of an image: its pictures, its state, its record.
pub(crate) fn files() -> impl Iterator<Item = &'static str> {
    Plane::ALL.into_iter().map(file_of).chain([SCENE, RECORD])
}

/// Writes the state and, last, the record of an image.
pub(crate) fn write(folder: &Path, scene: &Value, record: &ImageRecord) -> Result<(), VisionError> {
    let path = folder.join(SCENE);
    fs::write(&path, format!("{scene}\n")).map_err(at(&path))?;
    let path = folder.join(RECORD);
    let text = serde_json::to_string(record).map_err(|error| at(&path)(error.into()))?;
    fs::write(&path, format!("{text}\n")).map_err(at(&path))
}

/// The record of an image; none if the image is not there, or not all of it.
pub(crate) fn read(folder: &Path) -> Result<Option<ImageRecord>, VisionError> {
    if !files().all(|file| folder.join(file).is_file()) {
        return Ok(None);
    }
    let path = folder.join(RECORD);
    let text = fs::read_to_string(&path).map_err(at(&path))?;
    let read = serde_json::from_str(&text);
    read.map(Some).map_err(|error| VisionError::Damaged { path: PathBuf::from(folder), reason: error.to_string() })
}

/// Bytes of an image's files.
pub(crate) fn bytes(folder: &Path) -> Result<u64, VisionError> {
    let length = |file: &str| {
        let path = folder.join(file);
        fs::metadata(&path).map(|file| file.len()).map_err(at(&path))
    };
    files().map(length).sum()
}
