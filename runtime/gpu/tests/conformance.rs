//! Every renderer draws what the reference draws.
#![allow(clippy::unwrap_used)]

#[path = "conformance/compare.rs"]
mod compare;
#[path = "conformance/views.rs"]
mod views;

use std::sync::Arc;

use cohabit_cdf::layout::Layout;
use cohabit_cdf::{Catalog, RoomId};
use cohabit_gpu::{Adapter, GpuRenderer, Wanted};
use cohabit_render::{Camera, CpuRenderer, MeshLibrary, Planes, Renderer, Scene, Shot, furnish};

use compare::{Difference, Picture};
use views::{office, viewpoints};

/// Each renderer passes each of these tests.
macro_rules! conformance {
    ($($test:ident),*) => {
        mod cpu {
            $(#[test]
            fn $test() {
                super::$test("cpu, three threads", Box::new(super::CpuRenderer::new(3)));
            })*
        }

        mod gpu {
            $(#[test]
            #[cfg_attr(not(vulkan), ignore = "needs a Vulkan driver")]
            fn $test() {
                super::$test("gpu", Box::new(super::gpu()));
            })*
        }
    };
}

conformance!(
    every_layout_from_every_room,
    pictures_for_people,
    states_lights_and_effects,
    only_what_is_wanted_is_written
);

/// One on any adapter.
fn gpu() -> GpuRenderer {
    let adapter = Adapter::find(Wanted::Any).unwrap();
    println!("on {}", adapter.describe());
    GpuRenderer::new(&adapter, 2).unwrap().on_loss(|loss| panic!("{loss}"))
}

fn meshes() -> (Catalog, Arc<MeshLibrary>) {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    (catalog, meshes)
}

/// Draws pictures with the reference and with a renderer, all at once, and compares them.
fn check(name: &str, renderer: &mut dyn Renderer, scene: &Scene, cameras: &[Camera]) -> Difference {
    let mut drawn: Vec<Picture> = cameras.iter().map(Picture::new).collect();
    let mut shots: Vec<Shot<'_>> = drawn
        .iter_mut()
        .zip(cameras)
        .map(|(picture, camera)| Shot { camera: *camera, planes: picture.planes() })
        .collect();
    renderer.render_all(scene, &mut shots);
    let mut reference = CpuRenderer::new(2);
    let mut worst = Difference::default();
    for (index, (camera, picture)) in cameras.iter().zip(&drawn).enumerate() {
        let mut expected = Picture::new(camera);
        reference.render(scene, camera, &mut expected.planes());
        let difference = picture.compare(&expected);
        assert!(
            difference.is_small(),
            "{name}, picture {index} ({}x{}): {difference:?}\n{camera:?}",
            camera.width,
            camera.height
        );
        worst = worst.max(difference);
    }
    worst
}

fn every_layout_from_every_room(name: &str, mut renderer: Box<dyn Renderer>) {
    let (catalog, meshes) = meshes();
    for id in Layout::builtin_ids() {
        let layout = Layout::builtin(&id).unwrap();
        let mut scene = Scene::new(Arc::clone(&meshes), &layout);
        scene.set_instances(&furnish(&catalog, &layout));
        // One large view of each room, and small ones from every other viewpoint.
        let large = viewpoints(&layout, [300, 300], false, 6);
        let small = viewpoints(&layout, [84, 84], false, 2);
        let worst = check(name, &mut *renderer, &scene, &[large, small].concat());
        println!("{name}, {id}: {worst:?}");
    }
}

fn pictures_for_people(name: &str, mut renderer: Box<dyn Renderer>) {
    let (catalog, meshes) = meshes();
    let layout = Layout::builtin("OfficeLayout1").unwrap();
    let scene = office(&catalog, &meshes, &layout);
    let mut cameras = viewpoints(&layout, [854, 480], true, 9);
    cameras.push(Camera::above(layout.bounds_m(), 0.8, 12.0));
    let worst = check(name, &mut *renderer, &scene, &cameras);
    println!("{name}: {worst:?}");
}

fn states_lights_and_effects(name: &str, mut renderer: Box<dyn Renderer>) {
    let (catalog, meshes) = meshes();
    for id in ["OfficeLayout2", "OfficeLayout3"] {
        let layout = Layout::builtin(id).unwrap();
        let mut scene = office(&catalog, &meshes, &layout);
        let cameras = viewpoints(&layout, [300, 300], false, 5);
        let worst = check(name, &mut *renderer, &scene, &cameras);
        println!("{name}, {id}, all states: {worst:?}");
        // What changed is seen, and what is hidden is not.
        scene.set_time(700_000_000);
        for (index, room) in RoomId::BUILTIN.into_iter().enumerate() {
            scene.set_lights(room, index.is_multiple_of(2));
        }
        let hiding: Vec<Camera> = cameras.iter().map(|camera| Camera { hide: Some(5), ..*camera }).collect();
        let worst = check(name, &mut *renderer, &scene, &hiding);
        println!("{name}, {id}, later, half of the lamps off: {worst:?}");
    }
}

fn only_what_is_wanted_is_written(name: &str, mut renderer: Box<dyn Renderer>) {
    let (catalog, meshes) = meshes();
    let layout = Layout::builtin("OfficeLayout1").unwrap();
    let scene = office(&catalog, &meshes, &layout);
    let camera = viewpoints(&layout, [100, 60], false, 1)[3];
    let mut all = Picture::new(&camera);
    renderer.render(&scene, &camera, &mut all.planes());
    let mut ids = vec![7; camera.pixels()];
    let mut depth_m = vec![7.0; camera.pixels()];
    renderer.render(&scene, &camera, &mut Planes { ids: Some(&mut ids), ..Planes::default() });
    renderer.render(&scene, &camera, &mut Planes { depth_m: Some(&mut depth_m), ..Planes::default() });
    assert_eq!((ids, depth_m), (all.ids.clone(), all.depth_m.clone()), "{name}");
    renderer.render(&scene, &camera, &mut Planes::default());
    let none = Camera { width: 0, ..camera };
    renderer.render(&scene, &none, &mut Planes { ids: Some(&mut []), ..Planes::default() });
}

#[test]
#[cfg_attr(not(vulkan), ignore = "needs a Vulkan driver")]
fn a_thousand_cameras_at_once() {
    let mut gpu = gpu();
    let (catalog, meshes) = meshes();
    let layout = Layout::builtin("OfficeLayout3").unwrap();
    let scene = office(&catalog, &meshes, &layout);
    let all = viewpoints(&layout, [84, 84], false, 1);
    let cameras: Vec<Camera> = (0..1024)
        .map(|index| {
            let camera = all[index % all.len()];
            Camera { yaw_rad: camera.yaw_rad + 0.37 * (index / all.len()) as f32, ..camera }
        })
        .collect();
    let mut drawn: Vec<Vec<u32>> = cameras.iter().map(|camera| vec![0; camera.pixels()]).collect();
    let mut shots: Vec<Shot<'_>> = cameras
        .iter()
        .zip(&mut drawn)
        .map(|(camera, ids)| Shot { camera: *camera, planes: Planes { ids: Some(ids), ..Planes::default() } })
        .collect();
    gpu.render_all(&scene, &mut shots);
    for index in (0..1024).step_by(93) {
        let mut alone = vec![0; cameras[index].pixels()];
        gpu.render(&scene, &cameras[index], &mut Planes { ids: Some(&mut alone), ..Planes::default() });
        let others = alone.iter().zip(&drawn[index]).filter(|(a, b)| a != b).count();
        assert!(others * 200 < alone.len(), "picture {index} differs in {others} pixels when it is drawn alone");
        assert!(alone.iter().any(|id| *id != 0), "picture {index} shows something");
    }
}

#[test]
#[cfg_attr(not(vulkan), ignore = "needs a Vulkan driver")]
fn a_lost_device_is_replaced_by_the_reference() {
    let gpu = gpu();
    let (tell, told) = std::sync::mpsc::channel();
    let mut gpu = gpu.on_loss(move |loss| tell.send(loss.to_string()).unwrap());
    let (catalog, meshes) = meshes();
    let layout = Layout::builtin("OfficeLayout1").unwrap();
    let scene = office(&catalog, &meshes, &layout);
    let camera = viewpoints(&layout, [84, 84], false, 1)[0];
    let (mut before, mut after, mut expected) = (Picture::new(&camera), Picture::new(&camera), Picture::new(&camera));
    gpu.render(&scene, &camera, &mut before.planes());
    gpu.lose();
    for _ in 0..2 {
        gpu.render(&scene, &camera, &mut after.planes());
    }
    CpuRenderer::new(1).render(&scene, &camera, &mut expected.planes());
    assert!(after == expected && gpu.loss().is_some());
    let told: Vec<String> = told.try_iter().collect();
    assert!(told.len() == 1 && told[0].contains(gpu.describe()), "told {told:?}");
}
