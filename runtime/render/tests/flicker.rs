//! Nothing fights for pixels: while a camera moves slowly, no pixel goes from one instance to another and back again
//! on the same surface.
//!
//! A camera creeps by a millimetre and a hundredth of a degree or two a frame, always the same way, so that edges pass
//! over a pixel once. Where a pixel sees `A`, then `B`, then `A` again, `B` as far away as `A` and facing the same
//! way, two surfaces lie in one plane, and rounding alone decides which of them is seen.
//!
//! `cargo test --release -p cohabit-render --test flicker -- --ignored` looks from every viewpoint.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::sync::Arc;

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::{Layout, Viewpoint};
use cohabit_render::{Camera, CpuRenderer, Instance, Look, MeshLibrary, Planes, Renderer, Scene, furnish, gallery};

/// Pictures of one move.
const FRAMES: usize = 7;
/// How far the camera goes each frame, along each axis of the world, m.
const STEP_M: [f32; 3] = [0.0008, 0.0007, 0.0009];
/// How far it turns each frame: yaw, pitch.
const TURN_RAD: [f32; 2] = [0.000_35, 0.000_25];
/// Surfaces that are farther apart, m, or a thousandth of their distance, do not fight: one of them is in front.
const GAP_M: f32 = 0.0015;
/// Surfaces face the same way when their normals' product is at least this, of 127 squared.
const PARALLEL: i32 = 15_900;

/// How often two flicker in one move, at least, to count: once, rounding may do it where an edge lies along the move.
const LEAST: u32 = 2;

/// What one frame shows.
struct Frame {
    ids: Vec<u32>,
    depth_m: Vec<f32>,
    normals: Vec<i8>,
}

fn frame(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> Frame {
    let pixels = camera.pixels();
    let mut frame = Frame { ids: vec![0; pixels], depth_m: vec![0.0; pixels], normals: vec![0; pixels * 4] };
    let mut planes = Planes {
        ids: Some(&mut frame.ids),
        depth_m: Some(&mut frame.depth_m),
        normals: Some(&mut frame.normals),
        ..Planes::default()
    };
    renderer.render(scene, camera, &mut planes);
    frame
}

/// Where the camera is after so many frames.
fn moved(camera: &Camera, frames: usize) -> Camera {
    let steps = frames as f32;
    let position_m = [0, 1, 2].map(|axis| camera.position_m[axis] + STEP_M[axis] * steps);
    let (yaw_rad, pitch_rad) = (camera.yaw_rad + TURN_RAD[0] * steps, camera.pitch_rad + TURN_RAD[1] * steps);
    Camera { position_m, yaw_rad, pitch_rad, ..*camera }
}

/// Pixels that flicker during a move, by the two that fight for them.
fn fights(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> BTreeMap<[u32; 2], u32> {
    let frames: Vec<Frame> = (0..FRAMES).map(|at| frame(renderer, scene, &moved(camera, at))).collect();
    let mut found = BTreeMap::new();
    for three in frames.windows(3) {
        for pixel in 0..camera.pixels() {
            if let Some(pair) = fight(three, pixel) {
                *found.entry(pair).or_insert(0) += 1;
            }
        }
    }
    found.retain(|_, count: &mut u32| *count >= LEAST);
    found
}

/// The two that fight for a pixel in three frames.
fn fight(frames: &[Frame], pixel: usize) -> Option<[u32; 2]> {
    let [a, b, c] = [0, 1, 2].map(|at| frames[at].ids[pixel]);
    if a == b || a != c {
        return None;
    }
    let [first, second, third] = [0, 1, 2].map(|at| frames[at].depth_m[pixel]);
    let between = f32::midpoint(first, third);
    let normal = |at: usize| [0, 1, 2].map(|axis| i32::from(frames[at].normals[pixel * 4 + axis]));
    let facing: i32 = normal(0).into_iter().zip(normal(1)).map(|(a, b)| a * b).sum();
    let near = (second - between).abs() < GAP_M.max(between * 1e-3);
    (near && facing >= PARALLEL).then_some([a.min(b), a.max(b)])
}

fn camera(at: &Viewpoint, pitch_rad: f32, side_px: u32) -> Camera {
    Camera {
        position_m: [at.at_m[0], at.at_m[1], 1.3],
        yaw_rad: at.yaw_deg.to_radians(),
        pitch_rad,
        fov_y_rad: 60_f32.to_radians(),
        width: side_px,
        height: side_px,
        hide: None,
        for_people: false,
        ceiling: true,
    }
}

/// What stands in the id plane, in words.
fn name(catalog: &Catalog, instances: &[Instance], id: u32) -> String {
    match instances.iter().find(|instance| instance.id == id).map(|instance| instance.look) {
        Some(Look::Object(class)) => catalog.class(class).id.clone(),
        _ => format!("surface {:#x}", id),
    }
}

/// Looks round in floor plans, from every `step`-th viewpoint, with everything closed and with everything open.
fn look_round(step: usize, sides_px: &[u32]) -> String {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    let mut renderer = CpuRenderer::new(2);
    let mut text = String::new();
    // Mirrored plans are the same ones.
    for (index, id) in Layout::builtin_ids().iter().filter(|id| !id.ends_with("_mirror")).enumerate() {
        let layout = Layout::builtin(id).unwrap();
        let mut scene = Scene::new(Arc::clone(&meshes), &layout);
        let mut instances = furnish(&catalog, &layout);
        let mut found: BTreeMap<[u32; 2], (u32, String)> = BTreeMap::new();
        for opened in [0.0, 1.0] {
            instances.iter_mut().for_each(|instance| instance.opened = opened);
            scene.set_instances(&instances);
            let turn = index + opened as usize * 2;
            for at in layout.viewpoints.iter().skip(turn % step).step_by(step) {
                for side_px in sides_px {
                    for (pair, count) in fights(&mut renderer, &scene, &camera(at, -0.2, *side_px)) {
                        let known = found.entry(pair).or_default();
                        known.0 += count;
                        known.1 = format!("{:?} {}", at.room, at.number);
                    }
                }
            }
        }
        for ([a, b], (count, at)) in found {
            let [a, b] = [a, b].map(|id| name(&catalog, &instances, id));
            text.push_str(&format!("{id}: {a} and {b}: {count} pixels, last from {at}\n"));
        }
    }
    text
}

#[test]
fn no_instance_fights_another_in_any_floor_plan() {
    let found = look_round(5, &[300]);
    assert!(found.is_empty(), "\n{found}");
}

#[test]
#[ignore = "thorough: every viewpoint; for whoever changes floor plans"]
fn no_instance_fights_another_from_any_viewpoint() {
    let found = look_round(1, &[300, 84]);
    assert!(found.is_empty(), "\n{found}");
}

/// Every object on its floor, or as it hangs.
#[test]
fn no_object_fights_what_it_stands_on() {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    let (mut renderer, mut stage) = (CpuRenderer::new(2), gallery::stage(&meshes));
    let mut found = String::new();
    for class in catalog.class_ids() {
        let cell = gallery::cells(&meshes, &catalog, class).swap_remove(0);
        cell.enter(&mut stage);
        let front = Camera { for_people: false, ..cell.camera(128) };
        let count: u32 = fights(&mut renderer, &stage, &front).values().sum();
        if count > 0 {
            found.push_str(&format!("{}: {count} pixels\n", cell.label));
        }
    }
    assert!(found.is_empty(), "\n{found}");
}
