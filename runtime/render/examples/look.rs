//! Pictures for modellers: a contact sheet of objects, or a view into a floor plan.
//!
//! ```text
//! look objects OUT.png CLASS...            each class in its usual state, open, on, broken, filled, ... where that shows
//! look bodies OUT.png                      the robot, a person, a note
//! look view OUT.png LAYOUT x y z yaw_deg pitch_deg [no-ceiling] [WxH] [planes] [time]
//! ```

use std::collections::HashMap;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::sync::Arc;

use cohabit_cdf::catalog::Receptacle;
use cohabit_cdf::layout::{Finish, Layout, Room};
use cohabit_cdf::model::{Drive, Material, Model, When};
use cohabit_cdf::{Catalog, ClassId, Color, Fluid, RoomId, StateFlag, StateFlags};
use cohabit_render::{Camera, CpuRenderer, Highlight, Instance, Look, MeshLibrary, Planes, Renderer, Scene};

/// Side of one picture of a contact sheet.
const CELL: u32 = 280;
/// Pictures in a row of a contact sheet.
const COLUMNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["objects", out, classes @ ..] if !classes.is_empty() => objects(out, classes),
        ["bodies", out] => bodies(out),
        ["view", out, layout, x, y, z, yaw, pitch, options @ ..] => {
            let place = [x, y, z, yaw, pitch].map(|text| text.parse::<f32>());
            let [x, y, z, yaw, pitch] = place;
            view(out, layout, [x?, y?, z?], yaw?.to_radians(), pitch?.to_radians(), options)
        }
        _ => Err("write: objects OUT.png CLASS... | bodies OUT.png | view OUT.png LAYOUT x y z yaw_deg pitch_deg \
                  [no-ceiling] [WxH] [planes] [time]"
            .into()),
    }
}

/// One picture of a contact sheet.
struct Pose {
    title: String,
    look: Look,
    flags: StateFlags,
    fluid: Fluid,
    color: Color,
    opened: f32,
    running: f32,
}

impl Pose {
    fn plain(title: &str, look: Look) -> Self {
        let flags = StateFlags::default().with(StateFlag::Powered);
        Self {
            title: title.to_owned(),
            look,
            flags,
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
        }
    }

    fn with(class: ClassId, title: &str, flag: StateFlag) -> Self {
        let plain = Self::plain(title, Look::Object(class));
        Self { flags: plain.flags.with(flag), ..plain }
    }
}

/// Every state of a class that its model shows.
fn poses(id: &str, class: ClassId, model: &Model) -> Vec<Pose> {
    let mut poses = vec![Pose::plain(id, Look::Object(class))];
    let has = |when: When| model.parts.iter().any(|part| part.when == Some(when));
    let moves = |drive: Drive| model.joints.iter().any(|joint| joint.driven_by == drive);
    if moves(Drive::Open) {
        poses.push(Pose { opened: 1.0, ..Pose::with(class, "open", StateFlag::Opened) });
    }
    if moves(Drive::On) || has(When::On) {
        poses.push(Pose { running: 1.0, ..Pose::with(class, "on", StateFlag::Toggled) });
    }
    let states = [
        (When::Broken, "broken", StateFlag::Broken),
        (When::Cereal, "cereal", StateFlag::Cereal),
        (When::Dirty, "dirty", StateFlag::Dirty),
        (When::Hot, "hot", StateFlag::Hot),
        (When::Cold, "cold", StateFlag::Cold),
        (When::Infected, "infected", StateFlag::Infected),
        (When::Cooked, "cooked", StateFlag::Cooked),
        (When::Eaten, "eaten", StateFlag::Eaten),
    ];
    poses
        .extend(states.into_iter().filter(|state| has(state.0)).map(|(_, title, flag)| Pose::with(class, title, flag)));
    if has(When::Filled) {
        poses.push(Pose { fluid: Fluid::Coffee, ..Pose::plain("coffee", Look::Object(class)) });
    }
    if has(When::Unpowered) {
        poses.push(Pose { flags: StateFlags::default(), ..Pose::plain("unpowered", Look::Object(class)) });
    }
    poses
}

fn objects(out: &str, classes: &[&str]) -> Result<(), Box<dyn Error>> {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    let mut all = Vec::new();
    for id in classes {
        let class = catalog.find(id).ok_or_else(|| format!("the catalogue has no `{id}`"))?;
        let size = meshes.bounds(class).size();
        println!("{id}: {:.3} x {:.3} x {:.3} m, {} triangles", size.x, size.y, size.z, meshes.triangles(class));
        all.extend(poses(id, class, catalog.model(class)));
    }
    sheet(out, &meshes, &all)
}

fn bodies(out: &str) -> Result<(), Box<dyn Error>> {
    let meshes = Arc::new(MeshLibrary::build(&Catalog::builtin())?);
    let all = [
        Pose::plain("robot", Look::Robot { head_pitch_rad: 0.0, arm: 0.0 }),
        Pose::plain("robot up", Look::Robot { head_pitch_rad: 0.4, arm: 1.0 }),
        Pose::plain("robot down", Look::Robot { head_pitch_rad: -0.5, arm: 0.5 }),
        Pose::plain("human", Look::Human { arm: 0.0 }),
        Pose::plain("human arm", Look::Human { arm: 1.0 }),
        Pose::plain("note", Look::Note {}),
    ];
    sheet(out, &meshes, &all)
}

fn sheet(out: &str, meshes: &Arc<MeshLibrary>, poses: &[Pose]) -> Result<(), Box<dyn Error>> {
    let rows = poses.len().div_ceil(COLUMNS);
    let columns = poses.len().min(COLUMNS);
    let (width, height) = (columns * CELL as usize, rows * CELL as usize);
    let mut picture = vec![255_u8; width * height * 4];
    let mut renderer = CpuRenderer::new(2);
    for (index, pose) in poses.iter().enumerate() {
        println!("row {} column {}: {}", index / COLUMNS + 1, index % COLUMNS + 1, pose.title);
        let cell = portrait(&mut renderer, meshes, pose);
        let (left, top) = (index % COLUMNS * CELL as usize, index / COLUMNS * CELL as usize);
        for (row, line) in cell.chunks(CELL as usize * 4).enumerate() {
            let start = ((top + row) * width + left) * 4;
            picture[start..start + line.len()].copy_from_slice(line);
        }
    }
    write(out, &picture, width as u32, height as u32)
}

/// One object on the floor of an empty room, filling the picture.
fn portrait(renderer: &mut CpuRenderer, meshes: &Arc<MeshLibrary>, pose: &Pose) -> Vec<u8> {
    let (low, high) = match pose.look {
        Look::Object(class) => {
            let bounds = meshes.bounds(class);
            (bounds.min.to_array(), bounds.max.to_array())
        }
        Look::Note {} => ([0.0, -0.05, 0.0], [0.01, 0.05, 0.1]),
        Look::Robot { .. } => ([-0.25, -0.28, 0.0], [0.25, 0.28, 1.36]),
        Look::Human { .. } => ([-0.15, -0.28, 0.0], [0.25, 0.28, 1.78]),
    };
    let mut scene = Scene::new(Arc::clone(meshes), &studio());
    scene.set_instances(&[Instance {
        id: 1,
        look: pose.look,
        position_m: [0.0, 0.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        scale: [1.0; 3],
        flags: pose.flags,
        fluid: pose.fluid,
        color: pose.color,
        opened: pose.opened,
        running: pose.running,
        room: RoomId::Lab1,
        visible: true,
    }]);
    let middle: [f32; 3] = std::array::from_fn(|axis| (low[axis] + high[axis]) * 0.5);
    let radius = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f32>().sqrt() * 0.5;
    let fov_y_rad = 0.6_f32;
    let grown = if pose.opened > 0.0 { 1.35 } else { 1.0 };
    let distance = (radius * grown / (fov_y_rad * 0.5).sin()).max(0.08);
    let (yaw, pitch) = (0.62_f32, -0.42_f32);
    let back = [pitch.cos() * yaw.cos(), -pitch.cos() * yaw.sin(), -pitch.sin()];
    let camera = Camera {
        position_m: std::array::from_fn(|axis| middle[axis] + back[axis] * distance),
        yaw_rad: std::f32::consts::PI - yaw,
        pitch_rad: pitch,
        fov_y_rad,
        width: CELL,
        height: CELL,
        hide: None,
        for_people: true,
        ceiling: false,
    };
    let mut color = vec![0; camera.pixels() * 4];
    renderer.render(&scene, &camera, &mut Planes { color: Some(&mut color), ..Planes::default() });
    color
}

fn studio() -> Layout {
    let finish = |color: &str| Finish { material: Material::Plain, color: color.to_owned() };
    let room = Room {
        id: RoomId::Lab1,
        rects_m: vec![[-40.0, -40.0, 40.0, 40.0]],
        floor: finish("#b9b6ae"),
        wall: finish("#c8c6be"),
        wainscot: None,
        circuit: 1,
    };
    Layout {
        id: "studio".to_owned(),
        wall_height_m: 6.0,
        rooms: vec![room],
        openings: Vec::new(),
        placements: Vec::new(),
        viewpoints: Vec::new(),
        note_places: Vec::new(),
    }
}

/// The layout's placements, as the catalogue knows them; what stands on an anchor takes the next free one.
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
        let on = StateFlags::default().with(StateFlag::Powered);
        instances.push(Instance {
            id: instances.len() as u32 + 1,
            look: Look::Object(class),
            position_m: at,
            rotation: [0.0, 0.0, (yaw * 0.5).sin(), (yaw * 0.5).cos()],
            scale: placement.scale,
            flags: on,
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

fn view(
    out: &str,
    layout: &str,
    at: [f32; 3],
    yaw_rad: f32,
    pitch_rad: f32,
    options: &[&str],
) -> Result<(), Box<dyn Error>> {
    let catalog = Catalog::builtin();
    let start = std::time::Instant::now();
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    println!("meshes: {:?}", start.elapsed());
    let layout = Layout::builtin(layout)?;
    let mut scene = Scene::new(meshes, &layout);
    let mut instances = furnish(&catalog, &layout);
    if options.contains(&"robot") {
        let (sin, cos) = yaw_rad.sin_cos();
        let turned = yaw_rad + 2.4;
        let [x, y] = [at[0] + 2.2 * cos, at[1] + 2.2 * sin];
        let room = layout
            .rooms
            .iter()
            .find(|room| room.rects_m.iter().any(|rect| rect[0] < x && x < rect[2] && rect[1] < y && y < rect[3]));
        instances.push(Instance {
            id: 5000,
            look: Look::Robot { head_pitch_rad: 0.1, arm: 0.3 },
            position_m: [x, y, 0.0],
            rotation: [0.0, 0.0, (turned * 0.5).sin(), (turned * 0.5).cos()],
            scale: [1.0; 3],
            flags: StateFlags::default(),
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: room.map_or(RoomId::Hallway, |room| room.id),
            visible: true,
        });
        scene.set_highlights(&[Highlight { id: 5000, color: [255, 190, 60] }]);
    }
    scene.set_instances(&instances);
    if options.contains(&"dark") {
        RoomId::ALL.into_iter().for_each(|room| scene.set_lights(room, false));
    }
    let size = options
        .iter()
        .find_map(|option| option.split_once('x')?.0.parse().ok().zip(option.split_once('x')?.1.parse().ok()));
    let (width, height) = size.unwrap_or((960, 540));
    let camera = Camera {
        position_m: at,
        yaw_rad,
        pitch_rad,
        fov_y_rad: 60_f32.to_radians(),
        width,
        height,
        hide: None,
        for_people: !options.contains(&"plain"),
        ceiling: !options.contains(&"no-ceiling"),
    };
    let pixels = camera.pixels();
    let (mut color, mut depth_m) = (vec![0; pixels * 4], vec![0.0; pixels]);
    let (mut normals, mut ids) = (vec![0; pixels * 4], vec![0; pixels]);
    let mut renderer = CpuRenderer::new(2);
    let mut planes = Planes {
        color: Some(&mut color),
        depth_m: Some(&mut depth_m),
        normals: Some(&mut normals),
        ids: Some(&mut ids),
    };
    renderer.render(&scene, &camera, &mut planes);
    if options.contains(&"time") {
        time(&scene, &camera);
    }
    if options.contains(&"planes") {
        return write_planes(
            out,
            &camera,
            [&color, &depth_picture(&depth_m), &normal_picture(&normals), &id_picture(&ids)],
        );
    }
    write(out, &color, width, height)
}

/// How long a picture takes, on one thread and on two, with and without colour.
fn time(scene: &Scene, camera: &Camera) {
    let pixels = camera.pixels();
    let (mut color, mut depth_m) = (vec![0; pixels * 4], vec![0.0; pixels]);
    let (mut normals, mut ids) = (vec![0; pixels * 4], vec![0; pixels]);
    for threads in [1, 2] {
        let mut renderer = CpuRenderer::new(threads);
        for what in ["colour", "all planes", "no colour"] {
            let mut best = std::time::Duration::MAX;
            for _ in 0..40 {
                let start = std::time::Instant::now();
                let mut planes = Planes::default();
                if what != "no colour" {
                    planes.color = Some(&mut color);
                }
                if what != "colour" {
                    planes.depth_m = Some(&mut depth_m);
                    planes.normals = Some(&mut normals);
                    planes.ids = Some(&mut ids);
                }
                renderer.render(scene, camera, &mut planes);
                best = best.min(start.elapsed());
            }
            println!("{threads} threads, {what}: {best:?}");
        }
    }
}

fn depth_picture(depth_m: &[f32]) -> Vec<u8> {
    let grey = |depth: f32| (255.0 - (depth * 25.0).min(255.0)) as u8;
    depth_m.iter().flat_map(|depth| [grey(*depth), grey(*depth), grey(*depth), 255]).collect()
}

fn normal_picture(normals: &[i8]) -> Vec<u8> {
    normals
        .as_chunks::<4>()
        .0
        .iter()
        .flat_map(|[x, y, z, _]| {
            let byte = |c: i8| (i16::from(c) + 128) as u8;
            [byte(*x), byte(*y), byte(*z), 255]
        })
        .collect()
}

fn id_picture(ids: &[u32]) -> Vec<u8> {
    ids.iter()
        .flat_map(|id| {
            let hash = id.wrapping_mul(0x9E37_79B1).rotate_left(11).wrapping_mul(0x85EB_CA77);
            let [r, g, b, _] = if *id == 0 { [0; 4] } else { hash.to_be_bytes() };
            [r, g, b, 255]
        })
        .collect()
}

fn write_planes(out: &str, camera: &Camera, pictures: [&[u8]; 4]) -> Result<(), Box<dyn Error>> {
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut all = Vec::with_capacity(width * height * 16);
    for pair in pictures.chunks(2) {
        for row in 0..height {
            for picture in pair {
                all.extend_from_slice(&picture[row * width * 4..(row + 1) * width * 4]);
            }
        }
    }
    write(out, &all, camera.width * 2, camera.height * 2)
}

fn write(path: &str, rgba: &[u8], width: u32, height: u32) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(rgba)?;
    println!("wrote {path}");
    Ok(())
}
