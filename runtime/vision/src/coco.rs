//! The annotations of all images as one COCO document, written as they are read: a large set never lies in memory.

use std::{
    fs::{self, File},
    io::{BufWriter, Write as _},
    path::{Path, PathBuf},
};

use cohabit_bus::message::Plane;
use serde_json::{Value, json};

use crate::{
    categories::Category,
    dropped::Dropped,
    error::{VisionError, at},
    image::{self, Annotation, ImageRecord, folder_of},
    recipe::{FORMAT, Recipe},
    studio::file_of,
};

/// The sums of a data set.
#[derive(Clone, Debug, Default)]
pub(crate) struct Totals {
    pub annotations: u64,
    /// Things without an annotation because they have too few pixels.
    pub small_things: u64,
    pub dropped: Dropped,
    /// Annotations by the place of their category.
    pub by_category: Vec<u64>,
}

/// Writes `annotations.json` of the first `images` images; it appears once it is whole.
pub(crate) fn write(
    folder: &Path,
    images: usize,
    recipe: &Recipe,
    categories: &[Category],
) -> Result<Totals, VisionError> {
    let mut document = Document::create(folder.join("annotations.part"))?;
    let mut totals = Totals { by_category: vec![0; categories.len()], ..Totals::default() };
    document.head(recipe)?;
    document.list("categories", categories.iter().map(|category| Ok(json!(category))))?;
    document.list("images", (0..images).map(|id| record(folder, id).map(|record| image_entry(&record))))?;
    document.text(",\n\"annotations\": [\n")?;
    for id in 0..images {
        let record = record(folder, id)?;
        for annotation in &record.annotations {
            let is_first = totals.annotations == 0;
            totals.annotations += 1;
            document.entry(is_first, &annotation_entry(totals.annotations, &record, annotation))?;
        }
        totals.add(&record);
    }
    document.text("\n]}\n")?;
    document.finish(&folder.join("annotations.json"))?;
    Ok(totals)
}

impl Totals {
    fn add(&mut self, record: &ImageRecord) {
        self.small_things += u64::from(record.small_things);
        self.dropped = self.dropped.plus(record.dropped);
        for annotation in &record.annotations {
            let place = (annotation.category_id as usize).checked_sub(1);
            if let Some(count) = place.and_then(|place| self.by_category.get_mut(place)) {
                *count += 1;
            }
        }
    }
}

fn record(folder: &Path, id: usize) -> Result<ImageRecord, VisionError> {
    let path = folder.join(folder_of(id));
    let missing = || VisionError::Damaged { path: path.clone(), reason: "some of its files are gone".to_owned() };
    image::read(&path)?.ok_or_else(missing)
}

fn image_entry(record: &ImageRecord) -> Value {
    let folder = folder_of(record.id);
    let file = |plane: Plane| format!("{folder}/{}", file_of(plane));
    json!({
        "id": record.id,
        "license": 1,
        "width": record.width,
        "height": record.height,
        "file_name": file(Plane::Color),
        "depth_file_name": file(Plane::Depth),
        "normals_file_name": file(Plane::Normals),
        "ids_file_name": file(Plane::Ids),
        "scene_file_name": format!("{folder}/scene.json"),
        "floor_plan": &record.floor_plan,
        "room": record.room.id(),
    })
}

/// An annotation; COCO's tools take number 0 for none.
fn annotation_entry(number: u64, record: &ImageRecord, annotation: &Annotation) -> Value {
    json!({
        "id": number,
        "image_id": record.id,
        "category_id": annotation.category_id,
        "bbox": annotation.bbox,
        "area": annotation.area,
        "iscrowd": 0,
        "segmentation": { "size": [record.height, record.width], "counts": &annotation.counts },
        "instance_id": annotation.instance_id,
        "instance": &annotation.instance,
    })
}

/// A document in the making.
struct Document {
    path: PathBuf,
    out: BufWriter<File>,
}

impl Document {
    fn create(path: PathBuf) -> Result<Self, VisionError> {
        let out = BufWriter::new(File::create(&path).map_err(at(&path))?);
        Ok(Self { path, out })
    }

    fn text(&mut self, text: &str) -> Result<(), VisionError> {
        self.out.write_all(text.as_bytes()).map_err(at(&self.path))
    }

    fn head(&mut self, recipe: &Recipe) -> Result<(), VisionError> {
        let info = json!({
            "description": "Views of a simulated office",
            "version": FORMAT,
            "program": env!("CARGO_PKG_VERSION"),
            "seed": recipe.seed(),
        });
        let licenses = json!([{ "id": 1, "name": env!("CARGO_PKG_LICENSE"), "url": "" }]);
        self.text(&format!("{{\"info\": {info},\n\"licenses\": {licenses}"))
    }

    /// An entry of a list, on a line of its own.
    fn entry(&mut self, is_first: bool, entry: &Value) -> Result<(), VisionError> {
        let before = if is_first { "" } else { ",\n" };
        self.text(&format!("{before}{entry}"))
    }

    /// A whole list.
    fn list(
        &mut self,
        name: &str,
        entries: impl Iterator<Item = Result<Value, VisionError>>,
    ) -> Result<(), VisionError> {
        self.text(&format!(",\n\"{name}\": [\n"))?;
        for (place, entry) in entries.enumerate() {
            self.entry(place == 0, &entry?)?;
        }
        self.text("\n]")
    }

    fn finish(mut self, whole: &Path) -> Result<(), VisionError> {
        self.out.flush().map_err(at(&self.path))?;
        fs::rename(&self.path, whole).map_err(at(whole))
    }
}
