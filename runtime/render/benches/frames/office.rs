//! A furnished office, and cameras in it.

use std::sync::Arc;

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::Layout;
use cohabit_render::{Camera, Instance, MeshLibrary, Scene, furnish};

/// Height of the robot's eye, m.
const EYE_M: f32 = 1.3;

/// One floor plan with everything that stands in it.
pub struct Office {
    /// The plan's id.
    pub id: String,
    /// What there is to see.
    pub scene: Scene,
    /// What stands in it.
    pub instances: Vec<Instance>,
    layout: Layout,
}

impl Office {
    /// The project's own plan with this id, furnished.
    pub fn new(id: &str, catalog: &Catalog, meshes: &Arc<MeshLibrary>) -> Self {
        let layout = Layout::builtin(id).expect("the plan is one of the project's own");
        let mut scene = Scene::new(Arc::clone(meshes), &layout);
        let instances = furnish(catalog, &layout);
        scene.set_instances(&instances);
        Self { id: id.to_owned(), scene, instances, layout }
    }

    /// A camera at every `step`-th of its viewpoints.
    pub fn cameras(&self, width: u32, height: u32, for_people: bool, step: usize) -> Vec<Camera> {
        let viewpoints = self.layout.viewpoints.iter().step_by(step);
        viewpoints
            .map(|viewpoint| Camera {
                position_m: [viewpoint.at_m[0], viewpoint.at_m[1], EYE_M],
                yaw_rad: viewpoint.yaw_deg.to_radians(),
                pitch_rad: -0.2,
                fov_y_rad: 60_f32.to_radians(),
                width,
                height,
                hide: None,
                for_people,
                ceiling: true,
            })
            .collect()
    }
}
