//! Looks at floor plans while they are written: what is wrong in them, each from above, and from its viewpoints.
//!
//! ```text
//! floor OUT_FOLDER LAYOUT... [from=FOLDER] [above] [ROOM...]
//! ```
//!
//! Reads the plans in `FOLDER` (the project's own without it), so that none is built in again after each change. Writes
//! `LAYOUT-above.png` and, for each room, `LAYOUT-ROOM.png` with its eight viewpoints; `above` or names of rooms narrow
//! that down.

use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

use cohabit_cdf::layout::{FreeFloor, Layout, Viewpoint};
use cohabit_cdf::{Catalog, RoomId};
use cohabit_render::{Camera, CpuRenderer, MeshLibrary, Planes, Renderer, Scene, furnish};

/// Height of the robot's eye, m.
const EYE_M: f32 = 1.3;
/// Radius of the robot, m.
const ROBOT_RADIUS_M: f32 = 0.25;
/// Size of a picture from a viewpoint.
const VIEW: [u32; 2] = [480, 320];
/// Pictures in a row of a sheet.
const COLUMNS: u32 = 4;
/// Pixels a metre of a picture from above.
const ABOVE_PX_M: f32 = 50.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((out, words)) = arguments.split_first() else {
        return Err("write: floor OUT_FOLDER LAYOUT... [from=FOLDER] [above] [ROOM...]".into());
    };
    let files = words.iter().find_map(|word| word.strip_prefix("from=")).map(read_plans).transpose()?;
    let catalog = Catalog::builtin();
    let rooms: Vec<RoomId> = words.iter().filter_map(|word| catalog.rooms().find(word)).collect();
    let only_above = words.iter().any(|word| word == "above");
    let is_layout = |word: &&String| catalog.rooms().find(word).is_none() && !word.contains('=') && *word != "above";
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    for id in words.iter().filter(is_layout) {
        let plan = match &files {
            Some(files) => {
                let files: Vec<(&str, &str)> =
                    files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
                Layout::parse(id, &files)?
            }
            None => Layout::builtin(id)?,
        };
        tell(&plan, &catalog);
        let mut studio = Studio::new(&plan, &catalog, &meshes);
        if rooms.is_empty() {
            studio.above().write(Path::new(out).join(format!("{id}-above.png")).as_path())?;
        }
        let all = if only_above { &[][..] } else { &plan.rooms[..] };
        for room in all.iter().map(|room| room.id).filter(|room| rooms.is_empty() || rooms.contains(room)) {
            studio.room(&plan, room).write(Path::new(out).join(format!("{id}-{}.png", room.id())).as_path())?;
        }
    }
    Ok(())
}

/// The plan files of a folder, by name and text.
fn read_plans(folder: &str) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        if name.ends_with(".toml") {
            files.push((name, fs::read_to_string(path)?));
        }
    }
    files.sort();
    Ok(files)
}

fn tell(plan: &Layout, catalog: &Catalog) {
    let area_m2 = FreeFloor::new(plan, catalog, ROBOT_RADIUS_M).area_m2();
    println!("{}: {} objects, {area_m2:.1} m² to stand on", plan.id, plan.placements.len());
    for fault in plan.faults(catalog) {
        println!("  {fault}");
    }
}

/// A plan, furnished and lit.
struct Studio {
    scene: Scene,
    renderer: CpuRenderer,
    /// `[west, south, east, north]`, m.
    bounds_m: [f32; 4],
}

impl Studio {
    fn new(plan: &Layout, catalog: &Catalog, meshes: &Arc<MeshLibrary>) -> Self {
        let mut scene = Scene::new(Arc::clone(meshes), plan);
        scene.set_instances(&furnish(catalog, plan));
        Self { scene, renderer: CpuRenderer::new(2), bounds_m: plan.bounds_m() }
    }

    fn above(&mut self) -> Picture {
        /// Where the picture is to scale, m above the floor: at the tops of the walls.
        const LEVEL_M: f32 = 2.8;
        let camera = Camera::above(self.bounds_m, LEVEL_M, ABOVE_PX_M);
        self.shoot(&camera)
    }

    fn room(&mut self, plan: &Layout, room: RoomId) -> Picture {
        let views: Vec<&Viewpoint> = plan.viewpoints.iter().filter(|view| view.room == room).collect();
        let [width, height] = VIEW;
        let rows = (views.len() as u32).div_ceil(COLUMNS);
        let mut sheet = Picture::new(width * COLUMNS, height * rows);
        for (index, view) in (0_u32..).zip(views) {
            let camera = Camera {
                position_m: [view.at_m[0], view.at_m[1], EYE_M],
                yaw_rad: view.yaw_deg.to_radians(),
                pitch_rad: -0.2,
                fov_y_rad: 60_f32.to_radians(),
                width,
                height,
                hide: None,
                for_people: true,
                ceiling: true,
            };
            let picture = self.shoot(&camera);
            sheet.paste(&picture, [index % COLUMNS * width, index / COLUMNS * height]);
        }
        sheet
    }

    fn shoot(&mut self, camera: &Camera) -> Picture {
        let mut picture = Picture::new(camera.width, camera.height);
        let mut planes = Planes { color: Some(&mut picture.rgba), depth_m: None, normals: None, ids: None };
        self.renderer.render(&self.scene, camera, &mut planes);
        picture
    }
}

struct Picture {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Picture {
    fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgba: vec![255; width as usize * height as usize * 4] }
    }

    fn paste(&mut self, other: &Self, [left, top]: [u32; 2]) {
        for (row, line) in (top as usize..).zip(other.rgba.chunks(other.width as usize * 4)) {
            let start = (row * self.width as usize + left as usize) * 4;
            self.rgba[start..start + line.len()].copy_from_slice(line);
        }
    }

    fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(&self.rgba)?;
        Ok(())
    }
}
