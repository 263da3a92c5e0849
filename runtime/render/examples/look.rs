//! Pictures for modellers: contact sheets of objects in all their states, or a view into a floor plan.
//!
//! ```text
//! look objects OUT.png CLASS...            each class in every state that its properties allow
//! look count                               triangles of every class at each level: at once, and in all states
//! look bodies OUT.png                      the robot, people, a note, what is poured
//! look sheets OUT_FOLDER [NAME...]         every class, sheet by sheet; the sheets whose names begin so
//! look view OUT.png LAYOUT x y z yaw_deg pitch_deg [no-ceiling] [WxH] [planes] [time]
//! ```
//!
//! Pictures of sheets are `--cell PIXELS` wide and high. With `--catalog FOLDER` models are read from that copy of `cdf/catalog`, so that they can be changed without
//! building anything.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

use cohabit_cdf::layout::Layout;
use cohabit_cdf::{Catalog, ClassId, Color, Fluid, RoomId, StateFlags};
use cohabit_render::gallery::{self, Sheet};
use cohabit_render::{Camera, CpuRenderer, Highlight, Instance, Look, MeshLibrary, Planes, Renderer, Scene, furnish};

/// Side of one picture of a contact sheet, unless `--cell` says otherwise.
const CELL: &str = "260";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let catalog = match option(&mut arguments, "--catalog") {
        Some(folder) => catalog_in(Path::new(folder))?,
        None => Catalog::builtin(),
    };
    let cell_px: u32 = option(&mut arguments, "--cell").unwrap_or(CELL).parse()?;
    match arguments.as_slice() {
        ["objects", out, classes @ ..] if !classes.is_empty() => objects(&catalog, out, classes, cell_px),
        ["count"] => count(&catalog),
        ["bodies", out] => bodies(&catalog, out, cell_px),
        ["sheets", folder, names @ ..] => sheets(&catalog, folder, names, cell_px),
        ["view", out, layout, x, y, z, yaw, pitch, options @ ..] => {
            let place = [x, y, z, yaw, pitch].map(|text| text.parse::<f32>());
            let [x, y, z, yaw, pitch] = place;
            view(&catalog, out, layout, [x?, y?, z?], yaw?.to_radians(), pitch?.to_radians(), options)
        }
        _ => Err("write: objects OUT.png CLASS... | count | bodies OUT.png | sheets OUT_FOLDER [NAME...] | \
                  view OUT.png LAYOUT x y z yaw_deg pitch_deg [no-ceiling] [WxH] [planes] [time]"
            .into()),
    }
}

/// What follows an option, which is taken away with it.
fn option<'a>(arguments: &mut Vec<&'a str>, name: &str) -> Option<&'a str> {
    let at = arguments.iter().position(|argument| *argument == name).filter(|at| at + 1 < arguments.len())?;
    arguments.drain(at..at + 2).nth(1)
}

/// The catalogue whose files lie in the folders `objects` and `models`.
fn catalog_in(folder: &Path) -> Result<Catalog, Box<dyn Error>> {
    let files = |name: &str| -> Result<Vec<(String, String)>, Box<dyn Error>> {
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder.join(name))? {
            let path = entry?.path();
            files.push((path.display().to_string(), std::fs::read_to_string(&path)?));
        }
        files.sort();
        Ok(files)
    };
    let (objects, models) = (files("objects")?, files("models")?);
    Ok(Catalog::parse(&texts(&objects), &texts(&models))?)
}

fn texts(files: &[(String, String)]) -> Vec<(&str, &str)> {
    files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect()
}

fn objects(catalog: &Catalog, out: &str, classes: &[&str], cell_px: u32) -> Result<(), Box<dyn Error>> {
    let meshes = Arc::new(MeshLibrary::build(catalog)?);
    let mut cells = Vec::new();
    for id in classes {
        let class = catalog.find(id).ok_or_else(|| format!("the catalogue has no `{id}`"))?;
        let size = meshes.bounds(class).size();
        println!(
            "{id}: {:.3} x {:.3} x {:.3} m, {:?} triangles at once, {:?} in all",
            size.x,
            size.y,
            size.z,
            meshes.triangles_at_once(class),
            meshes.triangles_by_level(class)
        );
        cells.extend(gallery::cells(&meshes, catalog, class));
    }
    paint(out, &meshes, &Sheet { name: "objects".to_owned(), cells }, cell_px)
}

/// Writes for every class how many triangles it takes.
fn count(catalog: &Catalog) -> Result<(), Box<dyn Error>> {
    let meshes = MeshLibrary::build(catalog)?;
    for (index, class) in catalog.classes().iter().enumerate() {
        let id = ClassId(index as u16);
        println!("{} {:?} {:?}", class.id, meshes.triangles_at_once(id), meshes.triangles_by_level(id));
    }
    Ok(())
}

fn bodies(catalog: &Catalog, out: &str, cell_px: u32) -> Result<(), Box<dyn Error>> {
    let meshes = Arc::new(MeshLibrary::build(catalog)?);
    let sheet = gallery::sheets(&meshes, catalog).next().ok_or("there are no sheets")?;
    paint(out, &meshes, &sheet, cell_px)
}

fn sheets(catalog: &Catalog, folder: &str, names: &[&str], cell_px: u32) -> Result<(), Box<dyn Error>> {
    let meshes = Arc::new(MeshLibrary::build(catalog)?);
    std::fs::create_dir_all(folder)?;
    for sheet in gallery::sheets(&meshes, catalog) {
        if names.is_empty() || names.iter().any(|name| sheet.name.starts_with(name)) {
            paint(&format!("{folder}/{}.png", sheet.name), &meshes, &sheet, cell_px)?;
        }
    }
    Ok(())
}

fn paint(out: &str, meshes: &Arc<MeshLibrary>, sheet: &Sheet, cell_px: u32) -> Result<(), Box<dyn Error>> {
    let picture = sheet.paint(&mut CpuRenderer::new(2), meshes, cell_px);
    write(out, &picture.rgba, picture.width, picture.height)
}

fn view(
    catalog: &Catalog,
    out: &str,
    layout: &str,
    at: [f32; 3],
    yaw_rad: f32,
    pitch_rad: f32,
    options: &[&str],
) -> Result<(), Box<dyn Error>> {
    let start = std::time::Instant::now();
    let meshes = Arc::new(MeshLibrary::build(catalog)?);
    println!("meshes: {:?}", start.elapsed());
    let layout = Layout::builtin(layout)?;
    let mut scene = Scene::new(meshes, &layout);
    let mut instances = furnish(catalog, &layout);
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
            look: Look::Robot { head_pitch_rad: 0.1, arm: 0.3, holds: false, rolled_m: 0.0 },
            position_m: [x, y, 0.0],
            rotation: [0.0, 0.0, (turned * 0.5).sin(), (turned * 0.5).cos()],
            scale: [1.0; 3],
            flags: StateFlags::default(),
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: room.map_or(RoomId::HALLWAY, |room| room.id),
            visible: true,
        });
        scene.set_highlights(&[Highlight { id: 5000, color: [255, 190, 60] }]);
    }
    scene.set_instances(&instances);
    if options.contains(&"dark") {
        RoomId::BUILTIN.into_iter().for_each(|room| scene.set_lights(room, false));
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
