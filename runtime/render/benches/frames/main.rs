//! How fast pictures are drawn: frames a second and CPU time a frame, over viewpoints of several furnished floor plans.
//!
//! ```text
//! cargo bench -p cohabit-render                    # measures
//! cargo bench -p cohabit-render -- quick           # measures less long
//! cargo bench -p cohabit-render -- save=FOLDER     # keeps pictures instead
//! cargo bench -p cohabit-render -- compare=FOLDER  # says by how much they differ now
//! cargo bench -p cohabit-render -- once            # draws each picture once in `counted`, for tools that count
//! ```

mod buffers;
mod keep;
mod machine;
mod office;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use cohabit_cdf::Catalog;
use cohabit_render::{Camera, CpuRenderer, MeshLibrary, Planes, Renderer, Scene, Shot};
use rustix::time::ClockId;

use buffers::Buffers;
use machine::cpu_time;
use office::Office;

/// The floor plans looked at.
const PLANS: [&str; 3] = ["OfficeLayout1", "OfficeLayout2", "OfficeLayout3"];
/// Every so many-th viewpoint is taken.
const STEP: usize = 7;

/// One kind of picture.
struct Kind {
    name: &'static str,
    size: [u32; 2],
    all_planes: bool,
    for_people: bool,
    repeats: u32,
}

const KINDS: [Kind; 5] = [
    Kind { name: "84x84, four modalities", size: [84, 84], all_planes: true, for_people: false, repeats: 60 },
    Kind { name: "300x300, four modalities", size: [300, 300], all_planes: true, for_people: false, repeats: 24 },
    Kind { name: "854x480, colour for people", size: [854, 480], all_planes: false, for_people: true, repeats: 6 },
    Kind { name: "1280x720, colour", size: [1280, 720], all_planes: false, for_people: false, repeats: 4 },
    Kind { name: "1280x720, colour for people", size: [1280, 720], all_planes: false, for_people: true, repeats: 4 },
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |key: &str| arguments.iter().find_map(|argument| argument.strip_prefix(key));
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).expect("the built-in catalogue has meshes"));
    let offices = PLANS.map(|id| Office::new(id, &catalog, &meshes));
    if let Some(folder) = value("save=") {
        return keep::save(Path::new(folder), &offices);
    }
    if let Some(folder) = value("compare=") {
        return keep::compare(Path::new(folder), &offices);
    }
    let only = value("only=");
    let kinds = KINDS.iter().filter(|kind| only.is_none_or(|only| kind.name.starts_with(only)));
    if arguments.iter().any(|argument| argument == "once") {
        return kinds.for_each(|kind| draw_once(kind, &offices));
    }
    tell_machine(&offices);
    let quick = arguments.iter().any(|argument| argument == "quick");
    for kind in kinds {
        println!("{}", kind.name);
        let repeats = if quick { kind.repeats.div_ceil(4) } else { kind.repeats };
        for (cameras, threads) in [(1, 1), (1, 2), (1, 4), (2, 1)] {
            measure(kind, repeats, &offices, cameras, threads);
        }
    }
}

fn tell_machine(offices: &[Office]) {
    println!("machine: {}", machine::describe());
    println!("version: cohabit-render {}", env!("CARGO_PKG_VERSION"));
    for office in offices {
        let count = office.instances.len();
        let triangles: usize = office.scene.soups(0).iter().map(|soup| soup.triangles.len()).sum();
        println!("plan: {}, {count} instances, {triangles} triangles at the finest level", office.id);
    }
    println!("mean over all viewpoints of the fastest frame there, and of the median one; shadows are on\n");
}

/// Draws from every viewpoint, with so many cameras at once, each drawn by so many threads.
fn measure(kind: &Kind, repeats: u32, offices: &[Office], cameras: usize, threads: usize) {
    let (mut walls, mut cpus) = (Vec::new(), Vec::new());
    for office in offices {
        for camera in office.cameras(kind.size[0], kind.size[1], kind.for_people, STEP) {
            let samples = draw_at_once(kind, repeats, &office.scene, &camera, cameras, threads);
            walls.push(spread(samples.iter().map(|sample| sample.0).collect()));
            cpus.push(spread(samples.iter().map(|sample| sample.1 / cameras as u32).collect()));
        }
    }
    let mean =
        |times: &[[f64; 2]], which: usize| times.iter().map(|time| time[which]).sum::<f64>() / times.len() as f64;
    let rate = |which: usize| 1e3 * cameras as f64 / mean(&walls, which);
    println!(
        "  {cameras} camera{} x {threads} thread{}: {:7.1} frames/s undisturbed, {:7.1} median; CPU {:.3} ms, {:.3} median",
        if cameras == 1 { " " } else { "s" },
        if threads == 1 { " " } else { "s" },
        rate(0),
        rate(1),
        mean(&cpus, 0),
        mean(&cpus, 1),
    );
}

/// Draws each picture twice, the second time in [`counted`].
fn draw_once(kind: &Kind, offices: &[Office]) {
    let mut renderer = CpuRenderer::new(1);
    let mut buffers = Buffers::new((kind.size[0] * kind.size[1]) as usize);
    for office in offices {
        for camera in office.cameras(kind.size[0], kind.size[1], kind.for_people, STEP) {
            renderer.render(&office.scene, &camera, &mut buffers.planes(kind.all_planes));
            counted(&mut renderer, &office.scene, &camera, &mut buffers.planes(kind.all_planes));
        }
    }
}

/// One picture, when everything it needs has been worked out before.
#[inline(never)]
fn counted(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
    renderer.render(scene, camera, planes);
}

/// The least of some times, and their median, ms.
fn spread(mut times: Vec<Duration>) -> [f64; 2] {
    times.sort_unstable();
    [times[0], times[times.len() / 2]].map(|time| time.as_secs_f64() * 1e3)
}

/// Wall time and CPU time of each of so many moments, at which so many cameras draw.
fn draw_at_once(
    kind: &Kind,
    moments: u32,
    scene: &Scene,
    camera: &Camera,
    cameras: usize,
    threads: usize,
) -> Vec<(Duration, Duration)> {
    let threads = threads * cameras;
    let clock = if threads == 1 { ClockId::ThreadCPUTime } else { ClockId::ProcessCPUTime };
    let mut renderer = CpuRenderer::new(threads);
    let mut buffers: Vec<_> = (0..cameras).map(|_| Buffers::new(camera.pixels())).collect();
    let mut moment = || {
        let planes = buffers.iter_mut().map(|own| own.planes(kind.all_planes));
        let mut shots: Vec<_> = planes.map(|planes| Shot { camera: *camera, planes }).collect();
        let (start, cpu) = (Instant::now(), cpu_time(clock));
        renderer.render_all(scene, &mut shots);
        (start.elapsed(), cpu_time(clock) - cpu)
    };
    // Patterns and occlusion are worked out when they are first seen.
    moment();
    std::iter::repeat_with(moment).take(moments as usize).collect()
}
