//! `cohabit gallery`: pictures of all there is to see, for reviewers.

use std::{fs, path::PathBuf, sync::Arc};

use anyhow::Context as _;
use cohabit_cdf::{Catalog, Layout, Mission, RoomId};
use cohabit_render::{
    Camera, Lens, MeshLibrary, Planes, Renderer, Scene,
    gallery::{self, Picture, Sheet},
    minimap,
};
use cohabit_world::World;
use indicatif::ProgressBar;

use crate::{failure::bad_input, png_file::write_png, rendering::Rendering, terminal::shown, world::WorldPacks};

/// Draws all objects in all their states, all floor plans from above and as maps, and a view of each room, as PNG
/// files.
#[derive(clap::Args)]
pub struct Gallery {
    /// The folder to write into
    folder: PathBuf,
    /// Draw only the classes and floor plans whose ids begin so; as often as needed
    #[arg(long, value_name = "PREFIX")]
    only: Vec<String>,
    #[command(flatten)]
    packs: WorldPacks,
    #[command(flatten)]
    rendering: Rendering,
}

/// Side of one object's picture.
const CELL_PX: u32 = 220;
/// Size of a room's picture.
const ROOM_PX: [u32; 2] = [854, 480];
/// What it takes in from its upper to its lower edge.
const ROOM_FOV_DEG: f32 = 63.0;
/// Pixels a metre of a floor plan.
const PLAN_PX_M: f32 = 50.0;
/// Pixels a metre of its schematic map.
const MAP_PX_M: f32 = 32.0;
/// Height at which floor plans are to scale, m.
const TABLE_M: f32 = 0.8;

impl Gallery {
    /// Draws them all.
    pub fn run(&self) -> anyhow::Result<()> {
        fs::create_dir_all(&self.folder).map_err(|error| bad_input(format!("{}: {error}", self.folder.display())))?;
        let catalog = Arc::clone(self.packs.read()?.catalog());
        let meshes = Arc::new(MeshLibrary::build(&catalog).context("build the models")?);
        let mut renderer = self.rendering.start()?;
        let bar = ProgressBar::new_spinner().with_message("objects");
        for sheet in self.sheets(&meshes, &catalog)? {
            let picture = sheet.paint(&mut *renderer, &meshes, CELL_PX);
            self.write(&format!("objects-{}", sheet.name), &picture.rgba, [picture.width, picture.height])?;
            bar.tick();
        }
        for id in Layout::ids(&catalog).into_iter().filter(|id| self.wants(id)) {
            bar.set_message(id.clone());
            self.floor_plan(&id, &catalog, &meshes, &mut *renderer)?;
        }
        bar.finish_and_clear();
        println!("{} pictures in {}", fs::read_dir(&self.folder)?.count(), shown(self.folder.display()));
        Ok(())
    }

    fn sheets(&self, meshes: &MeshLibrary, catalog: &Catalog) -> anyhow::Result<Vec<Sheet>> {
        if self.only.is_empty() {
            return Ok(gallery::sheets(meshes, catalog).collect());
        }
        for prefix in &self.only {
            let ids = catalog.classes().iter().map(|class| class.id.clone()).chain(Layout::ids(catalog));
            if !ids.into_iter().any(|id| id.starts_with(prefix)) {
                return Err(bad_input(format!(
                    "--only {prefix}: no class and no floor plan has an id that begins so; `cohabit catalog` lists all"
                )));
            }
        }
        let classes = catalog.class_ids().filter(|class| self.wants(&catalog.class(*class).id));
        Ok(gallery::sheets_of(meshes, catalog, classes).collect())
    }

    fn wants(&self, id: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|prefix| id.starts_with(prefix))
    }

    fn floor_plan(
        &self,
        id: &str,
        catalog: &Arc<Catalog>,
        meshes: &Arc<MeshLibrary>,
        renderer: &mut dyn Renderer,
    ) -> anyhow::Result<()> {
        let layout = Arc::new(Layout::find(id, catalog)?);
        let start_room = layout.rooms.first().map_or(RoomId::BREAK_ROOM, |room| room.id);
        let mission = Mission { layout: id.to_owned(), start_room, ..Mission::default() };
        let world = World::new(Arc::clone(catalog), Arc::clone(&layout), Arc::new(mission), 1)?;
        let mut scene = Scene::new(Arc::clone(meshes), &layout);
        scene.set_instances(&cohabit_engine::furnishings(&world).collect::<Vec<_>>());
        let mut shoot = |name: &str, camera: Camera| {
            let mut rgba = vec![255; camera.pixels() * 4];
            let mut planes = Planes { color: Some(&mut rgba), depth_m: None, normals: None, ids: None };
            renderer.render(&scene, &camera, &mut planes);
            self.write(name, &rgba, [camera.width, camera.height])
        };
        shoot(&format!("plan-{id}"), Camera::above(layout.bounds_m(), TABLE_M, PLAN_PX_M))?;
        let Picture { width, height, rgba } = minimap(&layout, catalog, MAP_PX_M).picture;
        self.write(&format!("map-{id}"), &rgba, [width, height])?;
        for room in layout.rooms.iter().map(|room| room.id) {
            if let Some(camera) = inside(&layout, room) {
                shoot(&format!("room-{id}-{}", room.id()), camera)?;
            }
        }
        Ok(())
    }

    fn write(&self, name: &str, rgba: &[u8], size: [u32; 2]) -> anyhow::Result<()> {
        let path = self.folder.join(format!("{name}.png"));
        write_png(&path, rgba, size, png::ColorType::Rgba, png::BitDepth::Eight)
            .with_context(|| path.display().to_string())
    }
}

/// A room from its first viewpoint, as a person would see it.
fn inside(layout: &Layout, room: RoomId) -> Option<Camera> {
    let viewpoint = layout.viewpoints.iter().find(|viewpoint| viewpoint.room == room)?;
    let [width, height] = ROOM_PX;
    let lens = Lens::new(width, height, ROOM_FOV_DEG).ok()?;
    Some(Camera::fixed(lens, [viewpoint.at_m[0], viewpoint.at_m[1], 1.6], viewpoint.yaw_deg.to_radians(), -0.2))
}
