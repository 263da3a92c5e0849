//! Makes images: draws worlds and views of them until one passes the filters.

use std::{fs, path::Path, sync::Arc};

use cohabit_cdf::{Catalog, Layout, LayoutError, RoomId};
use cohabit_generate::Chance;
use cohabit_render::{Camera, MeshLibrary};
use cohabit_world::World;

use crate::{
    arrange::Arrangement,
    dropped::Dropped,
    error::{VisionError, at},
    image::{self, ImageRecord, annotate, folder_of},
    mask::masks,
    recipe::{Filters, Recipe},
    studio::Studio,
    view,
};

/// Draws of one image until it is given up: far more than any image needs whose settings make sense.
const MOST_DRAWS: u32 = 100;

/// An image, drawn or found.
#[derive(Debug)]
pub(crate) struct Made {
    pub record: ImageRecord,
    /// Whether it was drawn: its files then are in a folder that is not called as it will be.
    pub is_new: bool,
}

/// What all workers share.
pub(crate) struct Maker<'a> {
    folder: &'a Path,
    recipe: &'a Recipe,
    pub catalog: Arc<Catalog>,
    meshes: Arc<MeshLibrary>,
    layouts: Vec<Arc<Layout>>,
}

impl<'a> Maker<'a> {
    pub fn new(folder: &'a Path, recipe: &'a Recipe) -> Result<Self, VisionError> {
        let catalog = Arc::clone(recipe.catalog());
        let meshes = Arc::new(MeshLibrary::build(&catalog)?);
        let layouts: Result<Vec<Arc<Layout>>, LayoutError> =
            recipe.plans().iter().map(|plan| Layout::find(plan, &catalog).map(Arc::new)).collect();
        Ok(Self { folder, recipe, catalog, meshes, layouts: layouts? })
    }

    /// What a worker draws with.
    pub fn studio(&self) -> Studio {
        Studio::new(Arc::clone(&self.meshes))
    }

    /// An image that is there and whole, or the first draw of it that passes the filters of one image.
    pub fn make(&self, studio: &mut Studio, id: usize) -> Result<Made, VisionError> {
        let whole = self.folder.join(folder_of(id));
        if let Some(record) = image::read(&whole)? {
            return Ok(Made { record, is_new: false });
        }
        remove(&whole)?;
        Ok(Made { record: self.draw(studio, id, 0, Dropped::default())?, is_new: true })
    }

    /// Draws an image again that looks like one before it.
    pub fn draw_anew(&self, studio: &mut Studio, record: &ImageRecord) -> Result<ImageRecord, VisionError> {
        let dropped = Dropped { near_duplicates: record.dropped.near_duplicates + 1, ..record.dropped };
        self.draw(studio, record.id, record.draw + 1, dropped)
    }

    /// Has an image appear that was drawn.
    pub fn publish(&self, id: usize) -> Result<(), VisionError> {
        let name = folder_of(id);
        let (part, whole) = (self.folder.join(format!("{name}.part")), self.folder.join(&name));
        fs::rename(&part, &whole).map_err(at(&whole))
    }

    /// The first draw from this one on that passes; its files are written.
    fn draw(
        &self,
        studio: &mut Studio,
        id: usize,
        first: u32,
        mut dropped: Dropped,
    ) -> Result<ImageRecord, VisionError> {
        for draw in first..MOST_DRAWS {
            let mut chance = Chance::new(self.recipe.seed_of(id), u64::from(draw));
            let Some((world, room, camera)) = self.set_up(&mut chance) else {
                dropped.unplaceable += 1;
                continue;
            };
            let Some(record) = self.shoot(studio, &world, room, &camera, Draw { id, draw, dropped })? else {
                dropped.few_things += 1;
                continue;
            };
            return Ok(record);
        }
        Err(VisionError::Exhausted { index: id, draws: MOST_DRAWS, dropped })
    }

    /// A world and a camera in it; none if what chance chose has no place.
    fn set_up(&self, chance: &mut Chance) -> Option<(World, RoomId, Camera)> {
        let layout = chance.pick(&self.layouts)?;
        let Arrangement { room, mission, seed } = Arrangement::draw(&self.catalog, layout, chance);
        let world = World::new(Arc::clone(&self.catalog), Arc::clone(layout), Arc::new(mission), seed).ok()?;
        let camera = view::draw(&world, room, self.recipe.lens(), chance)?;
        Some((world, room, camera))
    }

    /// Draws and writes what a camera sees; none if that shows too few things.
    fn shoot(
        &self,
        studio: &mut Studio,
        world: &World,
        room: RoomId,
        camera: &Camera,
        Draw { id, draw, dropped }: Draw,
    ) -> Result<Option<ImageRecord>, VisionError> {
        let Filters { min_pixels, min_things, .. } = self.recipe.filters();
        let picture = studio.shoot(world, camera);
        let masks = masks(&picture.ids, picture.size);
        let (annotations, small_things) = annotate(world, &masks, min_pixels);
        if annotations.len() < min_things {
            return Ok(None);
        }
        let record = ImageRecord {
            id,
            width: camera.width,
            height: camera.height,
            floor_plan: world.layout().id.clone(),
            room,
            draw,
            look: picture.look(),
            dropped,
            small_things,
            annotations,
        };
        let part = self.folder.join(format!("{}.part", folder_of(id)));
        remove(&part)?;
        fs::create_dir_all(&part).map_err(at(&part))?;
        picture.write(&part)?;
        image::write(&part, &image::scene(world, room, camera, &masks), &record)?;
        Ok(Some(record))
    }
}

/// Which draw of which image it is, and what came of those before it.
#[derive(Clone, Copy, Debug)]
struct Draw {
    id: usize,
    draw: u32,
    dropped: Dropped,
}

/// Removes what an interrupted worker, or somebody else, has left of an image.
fn remove(folder: &Path) -> Result<(), VisionError> {
    if folder.exists() { fs::remove_dir_all(folder).map_err(at(folder)) } else { Ok(()) }
}
