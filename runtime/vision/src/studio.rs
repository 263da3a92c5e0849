//! Draws pictures of worlds; one for each worker.

use std::{collections::BTreeMap, path::Path, sync::Arc};

use cohabit_bus::message::Plane;
use cohabit_cdf::Layout;
use cohabit_demonstrate::write_plane;
use cohabit_engine::furnishings;
use cohabit_render::{Camera, CpuRenderer, Instance, MeshLibrary, Planes, Renderer as _, Scene};
use cohabit_world::World;

use crate::{error::VisionError, look};

/// The most scenes that are kept: each has some megabytes, and a world may have a thousand floor plans.
const MOST_SCENES: usize = 16;

/// The scenes of floor plans and the memory of one picture, kept from image to image.
pub(crate) struct Studio {
    meshes: Arc<MeshLibrary>,
    renderer: CpuRenderer,
    /// By the id of the floor plan.
    scenes: BTreeMap<String, Scene>,
    picture: Picture,
}

/// What a camera sees, each plane row-major `[height, width]`.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    pub size: [u32; 2],
    rgba: Vec<u8>,
    depth_m: Vec<f32>,
    normals: Vec<i8>,
    pub ids: Vec<u32>,
}

impl Studio {
    pub fn new(meshes: Arc<MeshLibrary>) -> Self {
        // One thread: images are made side by side.
        Self { meshes, renderer: CpuRenderer::new(1), scenes: BTreeMap::new(), picture: Picture::default() }
    }

    /// Draws what a camera sees of a world.
    pub fn shoot(&mut self, world: &World, camera: &Camera) -> &Picture {
        let layout = world.layout();
        self.make_room(layout);
        let Self { meshes, renderer, scenes, picture } = self;
        let scene = scenes.entry(layout.id.clone()).or_insert_with(|| Scene::new(Arc::clone(meshes), layout));
        let instances: Vec<Instance> = furnishings(world).collect();
        scene.set_instances(&instances);
        for room in &layout.rooms {
            scene.set_lights(room.id, world.room_lit(room.id));
        }
        picture.resize([camera.width, camera.height]);
        let mut planes = Planes {
            color: Some(&mut picture.rgba),
            depth_m: Some(&mut picture.depth_m),
            normals: Some(&mut picture.normals),
            ids: Some(&mut picture.ids),
        };
        renderer.render(scene, camera, &mut planes);
        picture
    }

    /// Forgets all scenes where there is no room for that of another floor plan: which are known changes no picture.
    fn make_room(&mut self, layout: &Layout) {
        if self.scenes.len() >= MOST_SCENES && !self.scenes.contains_key(&layout.id) {
            self.scenes.clear();
        }
    }
}

impl Picture {
    fn resize(&mut self, size: [u32; 2]) {
        let pixels = size[0] as usize * size[1] as usize;
        self.size = size;
        self.rgba.resize(pixels * 4, 0);
        self.depth_m.resize(pixels, 0.0);
        self.normals.resize(pixels * 4, 0);
        self.ids.resize(pixels, 0);
    }

    /// What it looks like.
    pub fn look(&self) -> u64 {
        look::look(&self.rgba, self.size)
    }

    /// Writes a file for each plane into a folder.
    pub fn write(&self, folder: &Path) -> Result<(), VisionError> {
        for plane in Plane::ALL {
            let bytes = match plane {
                Plane::Color => self.rgba.as_slice(),
                Plane::Depth => bytemuck::cast_slice(&self.depth_m),
                Plane::Normals => bytemuck::cast_slice(&self.normals),
                Plane::Ids => bytemuck::cast_slice(&self.ids),
            };
            write_plane(&folder.join(file_of(plane)), self.size, plane, bytes)?;
        }
        Ok(())
    }
}

/// What the file of a plane is called in the folder of its image.
pub(crate) const fn file_of(plane: Plane) -> &'static str {
    match plane {
        Plane::Color => "color.png",
        Plane::Depth => "depth.png",
        Plane::Normals => "normals.png",
        Plane::Ids => "ids.png",
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::{Catalog, Mission};
    use cohabit_render::Lens;

    use super::*;

    #[test]
    fn a_world_of_many_floor_plans_does_not_fill_the_memory() {
        let catalog = Arc::new(Catalog::builtin());
        let mut studio = Studio::new(Arc::new(MeshLibrary::build(&catalog).unwrap()));
        let camera = Camera::fixed(Lens::new(16, 16, 60.0).unwrap(), [4.0, 10.0, 1.6], 0.0, 0.0);
        let plan = Layout::builtin("OfficeLayout1").unwrap();
        for number in 0..20 {
            let layout = Layout { id: format!("Plan{number}"), ..plan.clone() };
            let mission = Mission { layout: layout.id.clone(), start_room: plan.rooms[0].id, ..Mission::default() };
            let world = World::new(Arc::clone(&catalog), Arc::new(layout), Arc::new(mission), 1).unwrap();
            studio.shoot(&world, &camera);
        }
        assert!(studio.scenes.len() <= 16, "{}", studio.scenes.len());
    }
}
