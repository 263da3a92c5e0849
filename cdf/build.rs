//! Lists the data files (catalogue, models, layouts, missions) so that they are built into the crate, and tells its tests
//! whether the reference data are there.

#[path = "../tests/needs.rs"]
mod needs;

use std::{fmt::Write as _, fs, path::Path};

fn main() {
    needs::tell(&[needs::REFERENCE_DATA]);
    let root = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let out = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let mut code = String::new();
    for (name, folder, ending) in [
        ("ROOMS", "catalog", "toml"),
        ("OBJECTS", "catalog/objects", "toml"),
        ("MODELS", "catalog/models", "toml"),
        ("TABLE", "catalog/table", "toml"),
        ("LAYOUTS", "layouts", "toml"),
        ("MISSIONS", "missions", "json"),
    ] {
        println!("cargo::rerun-if-changed={folder}");
        writeln!(code, "pub const {name}: &[(&str, &str)] = &[{}];", entries(Path::new(&root), folder, ending))
            .expect("a string takes all");
    }
    fs::write(Path::new(&out).join("data.rs"), code).expect("OUT_DIR is writable");
}

/// Names and texts, by paths that hold wherever the checkout lies.
fn entries(root: &Path, folder: &str, ending: &str) -> String {
    let mut files: Vec<_> = fs::read_dir(root.join(folder))
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .collect();
    files.sort();
    files.iter().fold(String::new(), |mut list, path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let path = format!("/{folder}/{name}");
        write!(list, "({name:?}, include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {path:?}))), ")
            .expect("a string takes all");
        list
    })
}
