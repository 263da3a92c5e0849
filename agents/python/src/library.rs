//! What worlds of this process share: catalogues with and without world packs, and the meshes of what they list.

use std::{
    path::Path,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use cohabit_cdf::{Catalog, WorldData, WorldPack};
use cohabit_engine::read_world_folder;
use cohabit_render::{MeshLibrary, ModelError};
use pyo3::prelude::*;

use crate::{choice::Affordances, error::bad_argument, known_rooms};

/// What is built in, perhaps with world packs on top of it.
pub struct Library {
    folders: Vec<String>,
    data: WorldData,
    affordances: Affordances,
    meshes: Mutex<Option<Arc<MeshLibrary>>>,
}

impl Library {
    fn new(folders: Vec<String>, data: WorldData) -> Self {
        let affordances = Affordances::new(Arc::clone(data.catalog()));
        Self { folders, data, affordances, meshes: Mutex::new(None) }
    }

    /// What is built in alone.
    pub fn builtin() -> &'static Arc<Self> {
        static BUILTIN: OnceLock<Arc<Library>> = OnceLock::new();
        BUILTIN.get_or_init(|| Arc::new(Self::new(Vec::new(), WorldData::builtin())))
    }

    /// The same with the world packs in these folders, in their order. As long as the folders hold the same, it is the same
    /// library.
    ///
    /// # Errors
    /// A `ValueError` that names the file and what is wrong with it.
    pub fn with_packs(folders: &[String]) -> PyResult<Arc<Self>> {
        static KNOWN: Mutex<Vec<Arc<Library>>> = Mutex::new(Vec::new());
        if folders.is_empty() {
            return Ok(Arc::clone(Self::builtin()));
        }
        let packs = folders.iter().map(|folder| read_world_folder(Path::new(folder))).collect::<Result<Vec<_>, _>>();
        let packs = packs.map_err(bad_argument)?;
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let ids = || packs.iter().map(WorldPack::id);
        let is_same = |one: &&Arc<Self>| one.folders == folders && one.data.packs().iter().map(WorldPack::id).eq(ids());
        if let Some(library) = known.iter().find(is_same) {
            return Ok(Arc::clone(library));
        }
        let data = WorldData::layered(packs).map_err(bad_argument)?;
        let library = Arc::new(Self::new(folders.to_vec(), data));
        known_rooms::note(library.catalog());
        known.push(Arc::clone(&library));
        Ok(library)
    }

    /// The folders of its world packs, in their order; none, if it has what is built in alone.
    pub fn folders(&self) -> &[String] {
        &self.folders
    }

    /// The objects, devices and floor plans that there are.
    pub const fn catalog(&self) -> &Arc<Catalog> {
        self.data.catalog()
    }

    /// All that worlds are made of.
    pub const fn data(&self) -> &WorldData {
        &self.data
    }

    /// What things afford.
    pub const fn affordances(&self) -> &Affordances {
        &self.affordances
    }

    /// The meshes of the catalogue, built when the first camera needs them.
    ///
    /// # Errors
    /// [`ModelError`], if a model is wrong.
    pub fn meshes(&self) -> Result<Arc<MeshLibrary>, ModelError> {
        let mut meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(meshes) = &*meshes {
            return Ok(Arc::clone(meshes));
        }
        let built = Arc::new(MeshLibrary::build(self.catalog())?);
        *meshes = Some(Arc::clone(&built));
        Ok(built)
    }
}

/// The ids of all classes of objects, in the order of their numbers: built-in ones, then those of the packs in these folders.
///
/// # Errors
/// A `ValueError`, if a folder is no world pack.
#[pyfunction]
#[pyo3(signature = (world=Vec::new()))]
pub fn class_ids(world: Vec<String>) -> PyResult<Vec<String>> {
    let library = Library::with_packs(&world)?;
    Ok(library.catalog().classes().iter().map(|class| class.id.clone()).collect())
}

/// The ids of all rooms, in the order of their numbers: built-in ones, then those of the packs in these folders.
///
/// # Errors
/// As [`class_ids`].
#[pyfunction]
#[pyo3(signature = (world=Vec::new()))]
pub fn room_ids(world: Vec<String>) -> PyResult<Vec<String>> {
    let library = Library::with_packs(&world)?;
    Ok(library.catalog().rooms().ids().map(|room| room.id().to_owned()).collect())
}

/// The id of the room that is called that, of what is built in or of a pack that was read.
#[pyfunction]
pub fn room_id(text: &str) -> Option<String> {
    known_rooms::find(text).map(|room| room.id().to_owned())
}

/// The missions of the packs in these folders, by file name, with their texts.
///
/// # Errors
/// As [`class_ids`].
#[pyfunction]
pub fn pack_missions(world: Vec<String>) -> PyResult<Vec<(String, String)>> {
    let library = Library::with_packs(&world)?;
    let missions = library.data().packs().iter().flat_map(WorldPack::missions);
    let named = missions.map(|(file, text)| (file.rsplit('/').next().unwrap_or(file), text));
    Ok(named.map(|(file, text)| (file.trim_end_matches(".json").to_owned(), text.to_owned())).collect())
}
