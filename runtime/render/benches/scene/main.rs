//! What a scene costs before its first picture, and what it holds: time and bytes of meshes, of what makes them look
//! good, and of each floor plan.
//!
//! ```text
//! cargo bench -p cohabit-render --bench scene
//! ```
//!
//! Bytes are those that are asked of the allocator and not given back; times are the least of a few runs.

mod bytes;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::{Layout, Viewpoint};
use cohabit_render::{Camera, CpuRenderer, Instance, MeshLibrary, Planes, Renderer, Scene, furnish};

use bytes::Counted;

#[global_allocator]
static ALLOCATOR: Counted = Counted;

/// How often each thing is measured.
const RUNS: usize = 5;
/// Height of the robot's eye, m.
const EYE_M: f32 = 1.3;

fn main() {
    println!("{:<34}{:>10}{:>10}", "", "ms", "MiB");
    let (catalog, ms, held) = measure(RUNS, Catalog::builtin);
    say("catalogue", ms, held);
    let (meshes, ms, meshes_mib) = measure(RUNS, || MeshLibrary::build(&catalog).expect("the catalogue has meshes"));
    say("meshes of all models", ms, meshes_mib);
    let meshes = Arc::new(meshes);
    // Once: what is painted stays.
    let ((), ms, baked_mib) = measure(1, || meshes.bake_all(&AtomicBool::new(false)));
    say("occlusion and patterns, all", ms, baked_mib);
    let mut most_mib: f64 = 0.0;
    for id in Layout::builtin_ids() {
        most_mib = most_mib.max(office(&id, &catalog, &meshes));
    }
    println!("\nall models and the largest plan: {:.1} MiB", meshes_mib + baked_mib + most_mib);
    cold(&catalog);
}

fn say(what: &str, ms: f64, mebibytes: f64) {
    println!("{what:<34}{ms:>10.2}{mebibytes:>10.2}");
}

/// What a floor plan takes and holds once all models are baked; returns the latter, MiB.
fn office(id: &str, catalog: &Catalog, meshes: &Arc<MeshLibrary>) -> f64 {
    println!("{id}");
    let before = bytes::held();
    let (layout, ms, held) = measure(RUNS, || Layout::builtin(id).expect("the plan is the project's own"));
    say("  plan read", ms, held);
    let (instances, ms, held) = measure(RUNS, || furnish(catalog, &layout));
    say("  furnished", ms, held);
    let (mut scene, empty_ms, held) = measure(RUNS, || Scene::new(Arc::clone(meshes), &layout));
    say("  scene of the empty office", empty_ms, held);
    let ((), placed_ms, held) = measure(1, || scene.set_instances(&instances));
    say("  everything placed", placed_ms, held);
    let mut renderer = CpuRenderer::new(2);
    let (first, first_ms, held) = measure(1, || frame(&mut renderer, &scene, &layout.viewpoints[0]));
    say("  first picture, with shadows", first_ms, held);
    let (second, ms, _) = measure(RUNS, || frame(&mut renderer, &scene, &layout.viewpoints[0]));
    say("  next picture", ms, 0.0);
    drop((first, second));
    let all_mib = mebibytes(before);
    say("  built, to the first picture", empty_ms + placed_ms + first_ms, all_mib);
    all_mib
}

/// What the first picture waits for when nothing is there yet.
fn cold(catalog: &Catalog) {
    let layout = Layout::builtin("OfficeLayout1").expect("the plan is the project's own");
    let instances: Vec<Instance> = furnish(catalog, &layout);
    let start = Instant::now();
    let meshes = Arc::new(MeshLibrary::build(catalog).expect("the catalogue has meshes"));
    let mut scene = Scene::new(meshes, &layout);
    scene.set_instances(&instances);
    drop(frame(&mut CpuRenderer::new(2), &scene, &layout.viewpoints[0]));
    let ms = start.elapsed().as_secs_f64() * 1e3;
    println!("from the catalogue to the first picture, nothing baked but patterns: {ms:.1} ms");
}

/// Colour, 300x300, seen from a viewpoint.
fn frame(renderer: &mut CpuRenderer, scene: &Scene, at: &Viewpoint) -> Vec<u8> {
    let camera = Camera {
        position_m: [at.at_m[0], at.at_m[1], EYE_M],
        yaw_rad: at.yaw_deg.to_radians(),
        pitch_rad: -0.2,
        fov_y_rad: 60_f32.to_radians(),
        width: 300,
        height: 300,
        hide: None,
        for_people: false,
        ceiling: true,
    };
    let mut color = vec![0; camera.pixels() * 4];
    renderer.render(scene, &camera, &mut Planes { color: Some(&mut color), ..Planes::default() });
    color
}

/// What was made at last, the least time it took, ms, and what it holds, MiB.
fn measure<T>(runs: usize, mut make: impl FnMut() -> T) -> (T, f64, f64) {
    let mut least_ms = f64::MAX;
    for _ in 1..runs {
        let start = Instant::now();
        let made = make();
        least_ms = least_ms.min(start.elapsed().as_secs_f64() * 1e3);
        drop(made);
    }
    let (before, start) = (bytes::held(), Instant::now());
    let made = make();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    (made, ms.min(least_ms), mebibytes(before))
}

/// Held now and not `before`.
fn mebibytes(before: usize) -> f64 {
    (bytes::held() as f64 - before as f64) / f64::from(1 << 20)
}
