//! The metadata of objects: all of them as a mission begins, and what has changed since.

use std::collections::BTreeMap;

use cohabit_cdf::{Color, Fluid, ObjectId, RoomId};
use cohabit_world::{ObjectView, World};
use serde::Serialize;

/// One object, as data sets have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectEntry {
    instance: String,
    class: String,
    room: RoomId,
    /// Its origin in the world, m.
    position_m: [f32; 3],
    /// World from object: x, y, z, w.
    rotation: [f32; 4],
    /// The instance id of what it is in or on.
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<String>,
    /// The body that holds it.
    #[serde(skip_serializing_if = "Option::is_none")]
    held_by: Option<u32>,
    /// The states that it is in.
    states: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fluid: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<&'static str>,
    /// Whether it is in something shut.
    hidden: bool,
}

/// What was last written of each object.
#[derive(Debug, Default)]
pub(crate) struct Objects(BTreeMap<ObjectId, ObjectEntry>);

impl Objects {
    /// What is not as it was last written, in order of ids, and the instance ids of what has left the world since.
    pub fn changed(&mut self, world: &World) -> (Vec<ObjectEntry>, Vec<String>) {
        let views = world.objects().filter(|view| world.exists(view.id));
        let now: BTreeMap<ObjectId, ObjectEntry> = views.map(|view| (view.id, ObjectEntry::of(world, &view))).collect();
        let gone = self.0.iter().filter(|(id, _)| !now.contains_key(*id)).map(|(_, entry)| entry.instance.clone());
        let gone = gone.collect();
        let changed = now.iter().filter(|(id, entry)| self.0.get(*id) != Some(*entry)).map(|(_, entry)| entry.clone());
        let changed = changed.collect();
        self.0 = now;
        (changed, gone)
    }
}

impl ObjectEntry {
    /// An object as it is now.
    #[must_use]
    pub fn of(world: &World, view: &ObjectView<'_>) -> Self {
        Self {
            instance: view.instance.to_owned(),
            class: world.catalog().class(view.class).id.clone(),
            room: view.room,
            position_m: view.position_m.to_array(),
            rotation: view.rotation.to_array(),
            parent: view.parent.and_then(|parent| world.object(parent)).map(|parent| parent.instance.to_owned()),
            held_by: view.held_by.map(|body| body.0),
            states: view.flags.iter().map(|flag| format!("{flag:?}")).collect(),
            fluid: (view.fluid != Fluid::None).then(|| view.fluid.name()),
            color: (view.color != Color::Original).then(|| view.color.name()),
            hidden: view.hidden,
        }
    }
}
