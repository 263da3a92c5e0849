//! What the reference renderer draws of every floor plan, by hash: nothing changes unseen.
//!
//! `hashes.txt` beside this file has a line for each view, and in it a hash for each modality. A change fails, and the
//! message names the views and modalities that changed, by how much, and pictures of before, after and the difference
//! under the target directory. What a view looked like before is known wherever this test has passed, or blessed,
//! with those hashes; elsewhere the small sheets beside this file tell, one a floor plan.
//!
//! Look at the pictures. If they are as they should be, this takes them over, hashes and sheets:
//!
//! ```text
//! BLESS=1 cargo test -p cohabit-render --test golden
//! ```

#![allow(clippy::unwrap_used)]

mod changes;
mod hashes;
mod picture;
mod sheet;
mod views;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use cohabit_cdf::Catalog;
use cohabit_cdf::layout::Layout;
use cohabit_render::{CpuRenderer, MeshLibrary};

use changes::Changes;
use hashes::Hashes;
use picture::Picture;
use views::Office;

/// What stands in the repository.
fn kept() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// Where pictures are written.
fn pictures() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("golden")
}

/// A view as it is now.
struct Drawn {
    name: String,
    picture: Picture,
}

/// All views of one floor plan.
fn draw(catalog: &Catalog, meshes: &Arc<MeshLibrary>, index: usize, id: &str) -> Vec<Drawn> {
    let mut office = Office::new(catalog, meshes, Layout::builtin(id).unwrap());
    let mut renderer = CpuRenderer::new(1);
    let views = office.views(index);
    let mut drawn = Vec::with_capacity(views.len());
    for view in views {
        office.set(view.setting);
        let picture = Picture::draw(&mut renderer, &office.scene, &view.camera);
        drawn.push(Drawn { name: format!("{id}/{}", view.name), picture });
    }
    drawn
}

#[test]
fn every_floor_plan_looks_as_ever() {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    let ids = Layout::builtin_ids();
    let bless = std::env::var_os("BLESS").is_some();
    let known = Hashes::read(&kept().join("hashes.txt"));
    let (next, changes) = (AtomicUsize::new(0), Mutex::new(Changes::default()));
    let seen = Mutex::new(Hashes::default());
    let work = || {
        while let Some(id) = ids.get(next.fetch_add(1, Ordering::Relaxed)) {
            let index = ids.iter().position(|known| known == id).unwrap();
            let drawn = draw(&catalog, &meshes, index, id);
            let found = changes::compare(id, &known, &drawn, bless);
            changes.lock().unwrap().add(found);
            drawn.iter().for_each(|view| seen.lock().unwrap().set(&view.name, view.picture.hashes()));
        }
    };
    std::thread::scope(|scope| {
        let others = std::thread::available_parallelism().map_or(1, usize::from).min(ids.len()) - 1;
        (0..others).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let (mut changes, seen) = (changes.into_inner().unwrap(), seen.into_inner().unwrap());
    changes.gone(&known, &seen);
    if bless {
        seen.write(&kept().join("hashes.txt"));
        println!("{changes}");
    } else {
        assert!(
            changes.is_empty(),
            "{changes}\nLook at them; if they are as they should be, run\n    \
             BLESS=1 cargo test -p cohabit-render --test golden\n"
        );
    }
}

/// The sheets are for people who look at a change: they may not make the repository large.
#[test]
fn sheets_are_small() {
    let sheets = std::fs::read_dir(kept()).unwrap().map(|entry| entry.unwrap());
    let bytes: u64 = sheets
        .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "png"))
        .map(|entry| entry.metadata().unwrap().len())
        .sum();
    assert!(bytes > 0 && bytes <= 1 << 20, "{bytes} bytes of sheets");
}
