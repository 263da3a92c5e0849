//! What a world pack has is drawn, and known by its ids.

#![allow(clippy::unwrap_used)]

use std::{collections::BTreeSet, sync::Arc};

use cohabit_bus::message::Thing;
use cohabit_cdf::{PackFile, WorldData, WorldPack, world_pack::template};
use cohabit_engine::{SessionPlan, furnishings};
use cohabit_render::{Camera, CpuRenderer, MeshLibrary, Planes, Renderer as _, Scene};

/// Pixels a metre of the floor plan: a wrench is some ten pixels long.
const PX_M: f32 = 50.0;
/// Height at which it is to scale, m.
const LEVEL_M: f32 = 0.8;

#[test]
fn objects_and_rooms_of_a_pack_are_drawn_with_their_ids() {
    let files = template("my-lab").into_iter();
    let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
    let world = WorldData::layered(vec![WorldPack::parse("my-lab", files.collect()).unwrap()]).unwrap();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    let plan = SessionPlan::new(name, text, Arc::clone(world.catalog()), 1).unwrap();
    let session = plan.build().unwrap();
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let mut scene = Scene::new(meshes, &plan.layout);
    scene.set_instances(&furnishings(&session).collect::<Vec<_>>());
    let camera = Camera::above(plan.layout.bounds_m(), LEVEL_M, PX_M);
    let mut ids = vec![0; camera.pixels()];
    let mut planes = Planes { color: None, depth_m: None, normals: None, ids: Some(&mut ids) };
    CpuRenderer::new(1).render(&scene, &camera, &mut planes);
    let seen: BTreeSet<u32> = ids.iter().copied().collect();
    for instance in ["Wrench_01_1", "Degreaser_01_1", "Desk_01_1"] {
        let object = session.find(instance).unwrap();
        assert!(seen.iter().any(|id| Thing::of_id(*id) == Thing::Object(object)), "{instance} is not to be seen");
    }
    for room in plan.layout.rooms.iter().map(|room| room.id) {
        let index = plan.catalog.room_index(room).unwrap();
        assert!(seen.iter().any(|id| Thing::of_id(*id) == Thing::Surface(index.into())), "{room:?} is not to be seen");
    }
}
