//! A furnished office, and cameras in it.

use std::collections::HashMap;
use std::sync::Arc;

use cohabit_cdf::catalog::Receptacle;
use cohabit_cdf::layout::Layout;
use cohabit_cdf::{Catalog, ClassId, Color, Fluid, StateFlag, StateFlags};
use cohabit_render::{Camera, Instance, Look, MeshLibrary, Scene};

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
    /// Triangles of all its instances at the finest level, in all their states.
    pub triangles: usize,
    layout: Layout,
}

impl Office {
    /// The project's own plan with this id, furnished.
    pub fn new(id: &str, catalog: &Catalog, meshes: &Arc<MeshLibrary>) -> Self {
        let layout = Layout::builtin(id).expect("the plan is one of the project's own");
        let mut scene = Scene::new(Arc::clone(meshes), &layout);
        let instances = furnish(catalog, &layout);
        scene.set_instances(&instances);
        let count = |instance: &Instance| match instance.look {
            Look::Object(class) => meshes.triangles(class),
            _ => 0,
        };
        let triangles = instances.iter().map(count).sum();
        Self { id: id.to_owned(), scene, instances, triangles, layout }
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

/// The plan's placements, as the catalogue knows them; what stands on an anchor takes the next free one.
fn furnish(catalog: &Catalog, layout: &Layout) -> Vec<Instance> {
    let mut placed: HashMap<&str, ([f32; 3], f32, ClassId, usize)> = HashMap::new();
    let mut instances = Vec::new();
    for placement in &layout.placements {
        let Some(class) = catalog.class_of_instance(&placement.instance) else { continue };
        let mut at = placement.at_m;
        if let Some((origin, yaw, host, used)) = placement.on.as_deref().and_then(|on| placed.get_mut(on)) {
            if placement.anchor {
                let taken = *used;
                *used += 1;
                at = catalog.class(*host).receptacle.as_ref().and_then(|own| anchor(own, taken)).unwrap_or(at);
            }
            let (sin, cos) = yaw.sin_cos();
            at = [origin[0] + at[0] * cos - at[1] * sin, origin[1] + at[0] * sin + at[1] * cos, origin[2] + at[2]];
        }
        let yaw = placement.yaw_deg.to_radians();
        placed.insert(&placement.instance, (at, yaw, class, 0));
        instances.push(Instance {
            id: instances.len() as u32 + 1,
            look: Look::Object(class),
            position_m: at,
            rotation: [0.0, 0.0, (yaw * 0.5).sin(), (yaw * 0.5).cos()],
            scale: placement.scale,
            flags: StateFlags::default().with(StateFlag::Powered),
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: placement.room,
            visible: true,
        });
    }
    instances
}

fn anchor(receptacle: &Receptacle, mut index: usize) -> Option<[f32; 3]> {
    for surface in &receptacle.surfaces {
        let [columns, rows] = surface.anchors.map(|count| count as usize);
        if index < columns * rows {
            let share = |i: usize, n: usize| (i as f32 + 0.5) / n as f32 - 0.5;
            let [x, y, z] = surface.center_m;
            let (i, j) = (index % columns, index / columns);
            return Some([x + surface.size_m[0] * share(i, columns), y + surface.size_m[1] * share(j, rows), z]);
        }
        index -= columns * rows;
    }
    None
}
