//! Every furnished floor plan is drawn the same, however it is drawn.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::Layout;

use super::CpuRenderer;
use super::tests::picture;
use crate::camera::Camera;
use crate::furnish;
use crate::library::MeshLibrary;
use crate::scene::Scene;

/// Every so many-th viewpoint is looked from.
const STEP: usize = 9;

/// Has `check` look at cameras in a floor plan, with what the plan is called.
fn look_round(mut check: impl FnMut(&Scene, &Camera, &str)) {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    for (index, id) in Layout::builtin_ids().iter().enumerate() {
        let layout = Layout::builtin(id).unwrap();
        let mut scene = Scene::new(Arc::clone(&meshes), &layout);
        let mut instances = furnish(&catalog, &layout);
        // Open doors show the most.
        instances.iter_mut().step_by(2).for_each(|instance| instance.opened = 1.0);
        scene.set_instances(&instances);
        for at in layout.viewpoints.iter().skip(index % STEP).step_by(STEP) {
            let camera = Camera {
                position_m: [at.at_m[0], at.at_m[1], 1.3],
                yaw_rad: at.yaw_deg.to_radians(),
                pitch_rad: -0.15,
                fov_y_rad: 1.1,
                width: 150,
                height: 110,
                hide: None,
                for_people: index % 2 == 1,
                ceiling: true,
            };
            check(&scene, &camera, &format!("{id}, {:?} {}", at.room, at.number));
        }
    }
}

#[test]
fn the_same_bits_in_every_office() {
    let (mut one, mut four) = (CpuRenderer::new(1), CpuRenderer::new(4));
    let (mut narrow, mut everything) = (CpuRenderer::without_wide_vectors(), CpuRenderer::without_portals());
    look_round(|scene, camera, place| {
        let seen = picture(&mut one, scene, camera);
        assert!(seen == picture(&mut four, scene, camera), "{place}: with four threads");
        assert!(seen == picture(&mut narrow, scene, camera), "{place}: without wide vectors");
        let all = picture(&mut everything, scene, camera);
        assert!(seen == all, "{place}: with rooms out of sight");
        // Inside, something is seen everywhere: walls have no cracks.
        assert!(!seen.ids.contains(&0), "{place}: a hole");
    });
}
