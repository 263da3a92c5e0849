//! `cohabit edit`: floor plans and missions are made in a page.

mod session;

use std::{
    fmt,
    fs::File,
    io::{self, Read as _},
    path::{Path, PathBuf},
    sync::{Arc, atomic::Ordering},
};

use anyhow::Context as _;
use cohabit_cdf::{WorldData, world_pack::HEAD};
use cohabit_dialog::token;
use cohabit_edit::{Desk, Document, EditService, MissionDocument, PlanDocument, Studio};
use cohabit_render::MeshLibrary;

use crate::{failure::bad_input, rendering::Rendering, site::SiteOptions, stop, terminal::shown, world::WorldPacks};
use session::Sessions;

/// The folders of a pack's floor plans and missions.
const PLANS: &str = "layouts";
const MISSIONS: &str = "missions";
/// The floor plan of new missions, where no pack has one.
const USUAL_PLAN: &str = "OfficeLayout1";
/// The largest file that is read, bytes.
const LARGEST: u64 = 1 << 20;

/// Serves a page in which a floor plan of a world pack is drawn, or a mission is put together, by mouse or by keyboard. Each change is
/// checked, and drawn as people see it; nothing is on the disk before it is saved
#[derive(clap::Args)]
pub struct Edit {
    /// The file: a floor plan of a world pack, FOLDER/layouts/ID.toml, or a mission (CDF), such as FOLDER/missions/NAME.json of a pack. One
    /// that is not there yet begins empty
    file: PathBuf,
    #[command(flatten)]
    packs: WorldPacks,
    /// The port of the page; 0 takes any that is free
    #[arg(long, default_value_t = 8785)]
    port: u16,
    #[command(flatten)]
    site: SiteOptions,
    #[command(flatten)]
    rendering: Rendering,
}

impl Edit {
    /// Serves the page until the user ends it.
    pub fn run(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let identity = self.site.identity()?;
        let (desk, studio, sessions) = self.open()?;
        let (listener, listening) = self.site.listen("the editor", self.port, identity.as_ref())?;
        let service = EditService::new(desk, studio, Arc::new(sessions), &token::fresh()?);
        println!("Open {}{}", token::site_address(listening, identity.is_some()), service.path());
        println!("Ctrl-C ends it; what is not saved by then is lost");
        let served = service.serve(listener, self.site.hosts.clone(), identity, &|| stop.load(Ordering::Relaxed));
        served.context("serve the editor")
    }

    fn open(&self) -> anyhow::Result<(Desk, Studio, Sessions)> {
        let file = std::path::absolute(&self.file)?;
        let Opened { document, begun, world, packs } = match file.extension().and_then(|ending| ending.to_str()) {
            Some("toml") => self.plan(&file)?,
            Some("json") => self.mission(&file)?,
            _ => return Err(self.refused("name a floor plan (.toml) or a mission (.json)")),
        };
        let text = read(&file).map_err(|error| self.refused(error))?;
        let meshes = MeshLibrary::build(world.catalog()).map_err(bad_input)?;
        let studio = Studio::new(meshes, self.rendering.start()?);
        let sessions = Sessions::new(packs, self.site.clone(), self.rendering)?;
        println!("Editing {}", shown(self.file.display()));
        Ok((Desk::new(file, document, text, &begun), studio, sessions))
    }

    /// A floor plan, in a world that is read without it: one that no world would take can be mended.
    fn plan(&self, file: &Path) -> anyhow::Result<Opened> {
        let pack = pack_of(file, PLANS).ok_or_else(|| {
            self.refused(format_args!(
                "no floor plan of a world pack: name a file FOLDER/{PLANS}/ID.toml of a folder with a `{HEAD}`; \
                 `cohabit new world NAME` makes one"
            ))
        })?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let world = self.packs.read_but(&pack, &format!("{PLANS}/{name}"))?;
        let document = PlanDocument::new(&self.file.to_string_lossy(), Arc::clone(world.catalog()));
        let document = Arc::new(document.map_err(|why| self.refused(why))?);
        Ok(Opened { document, begun: PlanDocument::empty().to_owned(), world, packs: self.packs.with_once(&pack) })
    }

    /// A mission, in the world of its pack if it lies in one. A new one begins on the first floor plan of that.
    fn mission(&self, file: &Path) -> anyhow::Result<Opened> {
        let pack = pack_of(file, MISSIONS);
        let packs = pack.as_ref().map_or_else(|| self.packs.clone(), |pack| self.packs.with_once(pack));
        let world = packs.read()?;
        let document = MissionDocument::new(&self.file.to_string_lossy(), Arc::clone(world.catalog()));
        let plan = world.packs().last().and_then(|pack| pack.plans().next()).unwrap_or(USUAL_PLAN);
        let begun = document.empty(plan).map_err(|why| self.refused(why))?;
        let text = read(file).map_err(|error| self.refused(error))?;
        if let Some(why) = text.and_then(|text| document.misfit(&text)) {
            return Err(self.refused(why));
        }
        Ok(Opened { document: Arc::new(document), begun, world, packs })
    }

    fn refused(&self, why: impl fmt::Display) -> anyhow::Error {
        bad_input(format!("{}: {why}", self.file.display()))
    }
}

/// A file, with what it is of.
struct Opened {
    document: Arc<dyn Document>,
    /// What it begins with, if it is not there yet.
    begun: String,
    world: WorldData,
    /// The packs with which it is played.
    packs: WorldPacks,
}

/// The pack in whose folder of that name a file lies.
fn pack_of(file: &Path, folder: &str) -> Option<PathBuf> {
    let inner = file.parent().filter(|inner| inner.file_name().is_some_and(|name| name == folder))?;
    inner.parent().filter(|pack| pack.join(HEAD).is_file()).map(Path::to_owned)
}

/// The text of a file; none, where there is no file.
fn read(file: &Path) -> io::Result<Option<String>> {
    let mut text = String::new();
    match File::open(file) {
        Ok(opened) => {
            opened.take(LARGEST + 1).read_to_string(&mut text)?;
            if text.len() as u64 > LARGEST {
                return Err(io::Error::other(format!(
                    "the file has more than {LARGEST} bytes, the most that are read"
                )));
            }
            Ok(Some(text))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use cohabit_tests::Scratch;

    use super::*;

    #[test]
    fn a_file_is_of_the_pack_in_whose_folder_it_lies() {
        let scratch = Scratch::new("cli-edit");
        let pack = PathBuf::from(scratch.path("my-lab"));
        std::fs::create_dir_all(pack.join(PLANS)).expect("a folder");
        let file = pack.join("layouts/Flat.toml");
        assert_eq!(pack_of(&file, PLANS), None);
        std::fs::write(pack.join(HEAD), "").expect("a head");
        assert_eq!(pack_of(&file, PLANS), Some(pack.clone()));
        assert_eq!(pack_of(&pack.join("models/Flat.toml"), PLANS), None);
        assert_eq!(read(&file).expect("no file"), None);
        std::fs::write(&file, "room = []").expect("a file");
        assert_eq!(read(&file).expect("a file").as_deref(), Some("room = []"));
    }
}
