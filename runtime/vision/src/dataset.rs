//! A data set in a folder: images side by side, each whole or not there, taken in order.

use std::{fs, path::Path};

use cohabit_demonstrate::write_whole;
use cohabit_generate::side_by_side;
use serde_json::{Map, Value, json};

use crate::{
    categories::{Category, categories, groups},
    coco::{self, Totals},
    dropped::Dropped,
    error::{VisionError, at},
    image::{self, ImageRecord, folder_of},
    look::Looks,
    maker::{Made, Maker},
    recipe::{FORMAT, Recipe},
    studio::Studio,
};

/// What is said of a data set within it.
const CARD: &str = include_str!("../data/card.md");
/// Images that each worker draws until they are looked through for duplicates; the number changes nothing.
const BATCH: usize = 16;

/// What came of it.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Summary {
    /// Images in the data set.
    pub images: usize,
    /// Those of them that were drawn now; the others were there.
    pub drawn: usize,
    /// Annotations of all images.
    pub annotations: u64,
    /// Things that have no annotation because they have too few pixels.
    pub small_things: u64,
    /// Draws that were not taken.
    pub dropped: Dropped,
    /// Bytes of all files of images, and of their annotations.
    pub bytes: u64,
}

/// Makes the first `images` images of a recipe in a folder, or goes on with them; `done` is told of each.
///
/// # Errors
/// [`VisionError`]. Whole images stay; the same call goes on from there.
pub fn make(
    images: usize,
    folder: &Path,
    recipe: &Recipe,
    workers: usize,
    done: &dyn Fn(),
) -> Result<Summary, VisionError> {
    if images == 0 {
        return Err(VisionError::NoImages);
    }
    begin(folder, recipe)?;
    let maker = Maker::new(folder, recipe)?;
    let workers = workers.clamp(1, images);
    let mut taker = Taker { folder, recipe, maker: &maker, looks: Looks::default(), summary: Summary::default() };
    let mut studios: Vec<Studio> = (0..workers).map(|_| maker.studio()).collect();
    let batch = BATCH * workers;
    for first in (0..images).step_by(batch) {
        let numbers = first..images.min(first + batch);
        for made in side_by_side(&mut studios, numbers, |studio, number| maker.make(studio, number))? {
            taker.take(made, &mut studios[0])?;
            done();
        }
    }
    let mut summary = taker.summary;
    let categories = categories(&maker.catalog);
    let totals = coco::write(folder, images, recipe, &categories)?;
    finish(folder, images, recipe, &categories, &totals)?;
    let annotations = folder.join("annotations.json");
    summary.bytes += fs::metadata(&annotations).map_err(at(&annotations))?.len();
    let Totals { annotations, small_things, dropped, .. } = totals;
    Ok(Summary { images, annotations, small_things, dropped, ..summary })
}

/// Writes the recipe, or checks that it is the one that the folder was begun with.
fn begin(folder: &Path, recipe: &Recipe) -> Result<(), VisionError> {
    let (path, text) = (folder.join("recipe.json"), recipe.text());
    let images = folder.join("images");
    fs::create_dir_all(&images).map_err(at(&images))?;
    if path.exists() {
        let known = fs::read_to_string(&path).map_err(at(&path))?;
        return if known == text { Ok(()) } else { Err(VisionError::OtherRecipe { path }) };
    }
    Ok(write_whole(folder, "recipe.json", &text)?)
}

/// Takes images in order: what an image may look like follows from those before it.
struct Taker<'a> {
    folder: &'a Path,
    recipe: &'a Recipe,
    maker: &'a Maker<'a>,
    looks: Looks,
    summary: Summary,
}

impl Taker<'_> {
    fn take(&mut self, Made { mut record, is_new }: Made, studio: &mut Studio) -> Result<(), VisionError> {
        if is_new {
            while self.has_near(&record) {
                record = self.maker.draw_anew(studio, &record)?;
            }
            self.maker.publish(record.id)?;
            self.summary.drawn += 1;
        }
        self.looks.add(&record.floor_plan, record.room, record.look);
        self.summary.bytes += image::bytes(&self.folder.join(folder_of(record.id)))?;
        Ok(())
    }

    fn has_near(&self, record: &ImageRecord) -> bool {
        self.looks.has_near(&record.floor_plan, record.room, record.look, self.recipe.filters().near_bits)
    }
}

/// Writes the groups, the card and, last, the manifest.
fn finish(
    folder: &Path,
    images: usize,
    recipe: &Recipe,
    categories: &[Category],
    totals: &Totals,
) -> Result<(), VisionError> {
    write_whole(folder, "groups.json", &format!("{:#}\n", groups(categories)))?;
    write_whole(folder, "README.md", &card(images, recipe, totals))?;
    let seen = categories.iter().zip(&totals.by_category).filter(|(_, count)| **count > 0);
    let seen: Map<String, Value> = seen.map(|(category, count)| (category.name.clone(), Value::from(*count))).collect();
    let manifest = json!({
        "format": FORMAT,
        "program": env!("CARGO_PKG_VERSION"),
        "images": images,
        "annotations": totals.annotations,
        "dropped": {
            "things_of_few_pixels": totals.small_things,
            "images_of_few_things": totals.dropped.few_things,
            "near_duplicates": totals.dropped.near_duplicates,
            "unplaceable": totals.dropped.unplaceable,
        },
        "annotations_by_category": seen,
    });
    Ok(write_whole(folder, "manifest.json", &format!("{manifest:#}\n"))?)
}

/// The data card with the figures of this data set.
fn card(images: usize, recipe: &Recipe, totals: &Totals) -> String {
    let [width, height] = recipe.lens().size();
    let seen = totals.by_category.iter().filter(|count| **count > 0).count();
    let figures = [
        ("{images}", images.to_string()),
        ("{annotations}", totals.annotations.to_string()),
        ("{classes}", seen.to_string()),
        ("{seed}", recipe.seed().to_string()),
        ("{size}", format!("{width}x{height}")),
        ("{fov}", recipe.lens().fov_y_deg().to_string()),
        ("{plans}", recipe.plans().join(", ")),
        ("{min_pixels}", recipe.filters().min_pixels.to_string()),
        ("{min_things}", recipe.filters().min_things.to_string()),
        ("{near_bits}", recipe.filters().near_bits.to_string()),
        ("{license}", env!("CARGO_PKG_LICENSE").to_owned()),
    ];
    figures.iter().fold(CARD.to_owned(), |card, (name, figure)| card.replace(*name, figure))
}
