//! What is looked at, and from where.

use std::sync::Arc;

use cohabit_cdf::layout::Layout;
use cohabit_cdf::{Catalog, Color, Fluid, StateFlag};
use cohabit_render::{Camera, Highlight, Instance, Look, MeshLibrary, Scene, furnish};

/// Height of the eye, m.
const EYE_M: f32 = 1.3;

/// A camera at every `step`-th viewpoint of a layout.
pub fn viewpoints(layout: &Layout, [width, height]: [u32; 2], for_people: bool, step: usize) -> Vec<Camera> {
    let all = layout.viewpoints.iter().step_by(step);
    all.map(|viewpoint| Camera {
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

/// A layout in use: everything is in some state, somebody is there, and something is highlighted.
pub fn office(catalog: &Catalog, meshes: &Arc<MeshLibrary>, layout: &Layout) -> Scene {
    let mut scene = Scene::new(Arc::clone(meshes), layout);
    let mut instances = furnish(catalog, layout);
    for (index, instance) in instances.iter_mut().enumerate() {
        use_it(instance, index);
    }
    for (index, viewpoint) in layout.viewpoints.iter().step_by(3).enumerate() {
        instances.push(body(instances.len() as u32 + 1, index, viewpoint));
    }
    scene.set_instances(&instances);
    scene.set_time(400_000_000);
    scene.set_highlights(&[
        Highlight { id: 3, color: [255, 180, 0] },
        Highlight { id: instances.len() as u32, color: [0, 200, 255] },
    ]);
    scene
}

/// Puts an instance into a state that depends on its number.
fn use_it(instance: &mut Instance, index: usize) {
    const STATES: [StateFlag; 9] = [
        StateFlag::Toggled,
        StateFlag::Dirty,
        StateFlag::Cold,
        StateFlag::Hot,
        StateFlag::Infected,
        StateFlag::Broken,
        StateFlag::Cooked,
        StateFlag::Eaten,
        StateFlag::Cut,
    ];
    instance.flags = instance.flags.with(STATES[index % STATES.len()]);
    instance.opened = (index % 3) as f32 * 0.5;
    instance.running = (index % 2) as f32;
    instance.fluid = [Fluid::None, Fluid::Water, Fluid::Milk, Fluid::Coffee][index % 4];
    instance.color = [Color::Original, Color::Original, Color::Red, Color::Green, Color::Blue][index % 5];
}

/// The robot or a person, one and a half metres ahead of a viewpoint.
fn body(id: u32, index: usize, viewpoint: &cohabit_cdf::layout::Viewpoint) -> Instance {
    let yaw = viewpoint.yaw_deg.to_radians();
    let look = if index.is_multiple_of(3) {
        Look::Robot { head_pitch_rad: 0.2, arm: 0.7, holds: false, rolled_m: 0.3 }
    } else {
        Look::Person {
            outfit: index as u32,
            head_pitch_rad: 0.1,
            arm: 0.5,
            holds: true,
            walked_m: 0.4 * index as f32,
            pace: 1.0,
        }
    };
    Instance {
        id,
        look,
        position_m: [viewpoint.at_m[0] + 1.5 * yaw.cos(), viewpoint.at_m[1] + 1.5 * yaw.sin(), 0.0],
        rotation: [0.0, 0.0, ((yaw + 2.6) * 0.5).sin(), ((yaw + 2.6) * 0.5).cos()],
        scale: [1.0; 3],
        flags: cohabit_cdf::StateFlags::default(),
        fluid: Fluid::None,
        color: Color::Original,
        opened: 0.0,
        running: 0.0,
        room: viewpoint.room,
        visible: true,
    }
}
