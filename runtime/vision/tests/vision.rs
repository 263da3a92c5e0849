//! Data sets, made, made again, and gone on with.

#![allow(clippy::unwrap_used)]

use std::{
    cell::Cell,
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_cdf::Catalog;
use cohabit_render::instance_of_color;
use cohabit_tests::files;
use cohabit_vision::{Filters, Recipe, Rle, Summary, VisionError, make, masks};
use serde_json::Value;

const SIZE: [u32; 2] = [64, 48];
const FILTERS: Filters = Filters { min_pixels: 6, min_things: 2, near_bits: 4 };

/// A folder that is not there yet.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cohabit-vision-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn recipe(seed: u64) -> Recipe {
    let (plans, catalog) = (["OfficeLayout1", "OfficeLayout2_mirror"].map(str::to_owned), Arc::new(Catalog::builtin()));
    Recipe::new(seed, SIZE, &plans, FILTERS, &catalog).unwrap()
}

fn made(images: usize, folder: &Path, workers: usize) -> Summary {
    make(images, folder, &recipe(5), workers, &|| {}).unwrap()
}

fn document(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The ids of a picture.
fn ids(path: &Path) -> Vec<u32> {
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    bytes.as_chunks::<3>().0.iter().map(|color| instance_of_color(*color)).collect()
}

fn numbers(value: &Value) -> Vec<u32> {
    value.as_array().unwrap().iter().map(|number| number.as_u64().unwrap() as u32).collect()
}

#[test]
fn annotations_say_what_the_pictures_of_ids_show() {
    let folder = folder("whole");
    let summary = made(4, &folder, 2);
    assert_eq!((summary.images, summary.drawn), (4, 4));
    let coco = document(&folder.join("annotations.json"));
    let (images, annotations) = (coco["images"].as_array().unwrap(), coco["annotations"].as_array().unwrap());
    assert_eq!((images.len(), annotations.len() as u64), (4, summary.annotations));
    let known: BTreeSet<u64> =
        coco["categories"].as_array().unwrap().iter().map(|category| category["id"].as_u64().unwrap()).collect();
    for image in images {
        let of = |name: &str| folder.join(image[name].as_str().unwrap());
        assert!(of("depth_file_name").is_file() && of("file_name").is_file() && of("normals_file_name").is_file());
        let masks = masks(&ids(&of("ids_file_name")), SIZE);
        let own: Vec<&Value> = annotations.iter().filter(|annotation| annotation["image_id"] == image["id"]).collect();
        assert!(own.len() >= FILTERS.min_things);
        for annotation in own {
            let mask = masks.iter().find(|mask| annotation["instance_id"] == mask.id).unwrap();
            assert_eq!(numbers(&annotation["bbox"]), mask.bbox);
            assert_eq!(annotation["area"], mask.area);
            assert!(mask.area >= FILTERS.min_pixels);
            let runs = annotation["segmentation"]["counts"].as_str().unwrap();
            assert_eq!(Rle::from_compressed(runs).as_ref(), Some(&mask.rle));
            assert_eq!(numbers(&annotation["segmentation"]["size"]), [SIZE[1], SIZE[0]]);
            assert!(known.contains(&annotation["category_id"].as_u64().unwrap()));
        }
        let scene = document(&of("scene_file_name"));
        let seen = scene["objects"].as_array().unwrap().iter().filter(|object| object["seen"] == true).count();
        assert!(seen >= FILTERS.min_things, "{scene}");
    }
    let numbers: BTreeSet<u64> = annotations.iter().map(|annotation| annotation["id"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=summary.annotations).collect::<BTreeSet<u64>>());
    let manifest = document(&folder.join("manifest.json"));
    assert_eq!(manifest["annotations"], summary.annotations);
    assert!(!fs::read_to_string(folder.join("README.md")).unwrap().contains('{'));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_same_recipe_makes_the_same_bytes_with_any_number_of_workers() {
    let (one, other) = (folder("one"), folder("other"));
    let first = made(6, &one, 1);
    assert_eq!(made(6, &other, 3), first);
    assert!(files(&one) == files(&other));
    // What is gone, broken off or half gone is made anew, and what is whole stays.
    fs::remove_file(other.join("manifest.json")).unwrap();
    let image = |id: usize| other.join(format!("images/0000/{id:07}"));
    fs::remove_dir_all(image(0)).unwrap();
    fs::rename(image(2), other.join("images/0000/0000002.part")).unwrap();
    fs::remove_file(image(4).join("depth.png")).unwrap();
    let told = Cell::new(0);
    let again = make(6, &other, &recipe(5), 2, &|| told.set(told.get() + 1)).unwrap();
    assert_eq!((again.drawn, told.get()), (3, 6));
    assert!(files(&one) == files(&other));
    // More images of a recipe begin with the same ones.
    let more = made(8, &other, 2);
    assert_eq!((more.images, more.drawn), (8, 2));
    let (few, many) = (files(&one), files(&other));
    let mut images = few.iter().filter(|(path, _)| path.starts_with("images"));
    assert!(images.all(|(path, bytes)| many.get(path) == Some(bytes)));
    // Nobody mixes two data sets.
    let error = make(6, &one, &recipe(6), 1, &|| {}).unwrap_err();
    assert!(matches!(error, VisionError::OtherRecipe { .. }) && error.is_bad_input(), "{error}");
    fs::remove_dir_all(&one).unwrap();
    fs::remove_dir_all(&other).unwrap();
}

#[test]
fn what_cannot_be_made_is_said_and_leaves_no_image() {
    let folder = folder("never");
    assert!(matches!(make(0, &folder, &recipe(1), 1, &|| {}), Err(VisionError::NoImages)));
    let filters = Filters { min_things: 500, ..FILTERS };
    let catalog = Arc::new(Catalog::builtin());
    let crowded = Recipe::new(1, [16, 16], &["OfficeLayout1".to_owned()], filters, &catalog).unwrap();
    let error = make(2, &folder, &crowded, 1, &|| {}).unwrap_err();
    assert!(matches!(error, VisionError::Exhausted { index: 0, .. }) && error.is_bad_input(), "{error}");
    assert!(files(&folder).keys().all(|path| path == Path::new("recipe.json")));
    fs::remove_dir_all(&folder).unwrap();
}
