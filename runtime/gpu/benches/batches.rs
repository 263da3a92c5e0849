//! How many pictures a second come out of one process, for one camera and for many at once: all four modalities, shadows
//! on, over the viewpoints of a furnished floor plan.
//!
//! ```text
//! cargo bench -p cohabit-gpu                 # on the best adapter there is, also one in software
//! cargo bench -p cohabit-gpu -- reference    # on the CPU renderer
//! cargo bench -p cohabit-gpu -- quick        # measures less long
//! ```

use std::sync::Arc;
use std::time::{Duration, Instant};

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::Layout;
use cohabit_gpu::{Adapter, GpuRenderer, Wanted};
use cohabit_render::{Camera, CpuRenderer, MeshLibrary, Planes, Renderer, Scene, Shot, furnish};

/// The floor plan looked at.
const PLAN: &str = "OfficeLayout1";
/// Height of the robot's eye, m.
const EYE_M: f32 = 1.3;
const SIZES: [[u32; 2]; 3] = [[84, 84], [300, 300], [1280, 720]];
const CAMERAS: [usize; 3] = [1, 64, 1024];
/// What would take longer is not measured.
const PATIENCE: Duration = Duration::from_secs(30);
/// Bytes of a pixel of all modalities.
const PIXEL_BYTES: u64 = 16;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut renderer: Box<dyn Renderer> = if has("reference") {
        println!("drawing on: the CPU, {threads} threads");
        Box::new(CpuRenderer::new(threads))
    } else {
        match Adapter::find(Wanted::Any).and_then(|adapter| GpuRenderer::new(&adapter, threads)) {
            Ok(gpu) => {
                println!("drawing on: {}", gpu.describe());
                Box::new(gpu.on_loss(|loss| println!("from here on the CPU drew: {loss}")))
            }
            Err(error) => return println!("nothing to measure: {error}"),
        }
    };
    println!("machine: {}, {threads} cores", processor());
    println!("versions: cohabit-gpu {}, wgpu {}", env!("CARGO_PKG_VERSION"), wgpu_version());
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).expect("the built-in catalogue has meshes"));
    let layout = Layout::builtin(PLAN).expect("the plan is one of the project's own");
    let mut scene = Scene::new(meshes, &layout);
    let instances = furnish(&catalog, &layout);
    scene.set_instances(&instances);
    println!("plan: {PLAN}, {} instances; four modalities, shadows are on\n", instances.len());
    let least = Duration::from_millis(if has("quick") { 300 } else { 3000 });
    for size in SIZES {
        let mut frame = Duration::ZERO;
        for count in CAMERAS {
            let bytes = count as u64 * u64::from(size[0]) * u64::from(size[1]) * PIXEL_BYTES;
            if bytes > free_bytes() / 2 {
                println!("{}x{}, {count} cameras: skipped, their pictures need {} MB", size[0], size[1], bytes >> 20);
                continue;
            }
            if frame * count as u32 > PATIENCE {
                println!("{}x{}, {count} cameras: skipped, they would take minutes", size[0], size[1]);
                continue;
            }
            frame = measure(&mut *renderer, &scene, &layout, size, count, least);
        }
    }
}

/// So many cameras, spread over all viewpoints, each looking another way.
fn cameras(layout: &Layout, [width, height]: [u32; 2], count: usize) -> Vec<Camera> {
    let viewpoints = &layout.viewpoints;
    (0..count)
        .map(|index| {
            let viewpoint = &viewpoints[index * 7 % viewpoints.len()];
            Camera {
                position_m: [viewpoint.at_m[0], viewpoint.at_m[1], EYE_M],
                yaw_rad: viewpoint.yaw_deg.to_radians() + 0.37 * (index / viewpoints.len()) as f32,
                pitch_rad: -0.2,
                fov_y_rad: 60_f32.to_radians(),
                width,
                height,
                hide: None,
                for_people: false,
                ceiling: true,
            }
        })
        .collect()
}

/// The planes of one picture.
struct Room {
    color: Vec<u8>,
    depth_m: Vec<f32>,
    normals: Vec<i8>,
    ids: Vec<u32>,
}

fn measure(
    renderer: &mut dyn Renderer,
    scene: &Scene,
    layout: &Layout,
    size: [u32; 2],
    count: usize,
    least: Duration,
) -> Duration {
    // One camera alone goes from viewpoint to viewpoint.
    let all = cameras(layout, size, count.max(16));
    let pixels = all[0].pixels();
    let mut rooms: Vec<Room> = (0..count)
        .map(|_| Room {
            color: vec![0; pixels * 4],
            depth_m: vec![0.0; pixels],
            normals: vec![0; pixels * 4],
            ids: vec![0; pixels],
        })
        .collect();
    let mut draw = |first: usize| {
        let mut shots: Vec<Shot<'_>> = rooms
            .iter_mut()
            .enumerate()
            .map(|(index, room)| Shot {
                camera: all[(first + index) % all.len()],
                planes: Planes {
                    color: Some(&mut room.color),
                    depth_m: Some(&mut room.depth_m),
                    normals: Some(&mut room.normals),
                    ids: Some(&mut room.ids),
                },
            })
            .collect();
        let began = Instant::now();
        renderer.render_all(scene, &mut shots);
        began.elapsed()
    };
    // Patterns, occlusion and shaders are worked out when they are first needed.
    let warm_up = if count == 1 { all.len() } else { 1 };
    for first in 0..warm_up {
        draw(first);
    }
    let (mut spent, mut batches) = (Duration::ZERO, 0);
    while spent < least || batches < 3 {
        spent += draw(batches);
        batches += 1;
    }
    let rate = (batches * count) as f64 / spent.as_secs_f64();
    let each = spent.as_secs_f64() * 1e3 / batches as f64;
    let s = if count == 1 { "" } else { "s" };
    println!("{}x{}, {count} camera{s}: {rate:9.1} frames/s ({each:.2} ms for all)", size[0], size[1]);
    spent / (batches * count) as u32
}

/// The version that this was built with.
fn wgpu_version() -> &'static str {
    let lock = include_str!("../../../Cargo.lock");
    let after = lock.split_once("name = \"wgpu\"\nversion = \"").map_or("unknown\"", |(_, after)| after);
    after.split('"').next().unwrap_or("unknown")
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text.lines().find_map(|line| line.strip_prefix("model name"));
    model.unwrap_or(": unknown").trim_start_matches([' ', '\t', ':']).to_owned()
}

/// Memory that is free, as far as the system tells.
fn free_bytes() -> u64 {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kilobytes.map_or(8 << 30, |kilobytes| kilobytes << 10)
}
