//! Lists the data files (catalogue, models, layouts, missions) so that they are built into the crate, and tells its tests
//! whether the reference data are there.

#[path = "../tests/needs.rs"]
mod needs;

use std::{fmt::Write as _, fs, path::Path};

/// The folder with the world packs that are built in, each a folder.
const PACKS: &str = "worlds";

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
        writeln!(code, "pub const {name}: &[(&str, &str)] = &[{}];", entries(Path::new(&root), folder, "", ending))
            .expect("a string takes all");
    }
    println!("cargo::rerun-if-changed={PACKS}");
    let packs = folders(&Path::new(&root).join(PACKS)).into_iter().fold(String::new(), |mut list, name| {
        let folder = format!("{PACKS}/{name}");
        let files = all_entries(Path::new(&root), &folder, "");
        write!(list, "({name:?}, &[{files}]), ").expect("a string takes all");
        list
    });
    writeln!(code, "pub const PACKS: &[(&str, &[(&str, &str)])] = &[{packs}];").expect("a string takes all");
    fs::write(Path::new(&out).join("data.rs"), code).expect("OUT_DIR is writable");
}

/// Names, with `prefix` before them, and texts, by paths that hold wherever the checkout lies.
fn entries(root: &Path, folder: &str, prefix: &str, ending: &str) -> String {
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
        let name = format!("{prefix}{name}");
        write!(list, "({name:?}, include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {path:?}))), ")
            .expect("a string takes all");
        list
    })
}

/// The names of the folders in a folder.
fn folders(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut names: Vec<String> = entries
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Paths within `folder` and texts of all files that a pack has, by paths that hold wherever the checkout lies; `inner` is
/// the path of a folder in it, with a `/` behind it.
fn all_entries(root: &Path, folder: &str, inner: &str) -> String {
    let here = format!("{folder}/{inner}");
    let here = here.trim_end_matches('/');
    let list = ["toml", "json", "script"].map(|ending| entries(root, here, inner, ending)).concat();
    let inner_folders = folders(&root.join(here));
    inner_folders.iter().fold(list, |list, name| list + &all_entries(root, folder, &format!("{inner}{name}/")))
}
