//! What all worlds of a process share: the catalogue, and the meshes of what it lists.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use cohabit_cdf::Catalog;
use cohabit_render::{MeshLibrary, ModelError};
use pyo3::pyfunction;

/// The built-in catalogue.
pub fn catalog() -> &'static Arc<Catalog> {
    static CATALOG: OnceLock<Arc<Catalog>> = OnceLock::new();
    CATALOG.get_or_init(|| Arc::new(Catalog::builtin()))
}

/// Its meshes, built when the first camera needs them.
pub fn meshes() -> Result<Arc<MeshLibrary>, ModelError> {
    static MESHES: Mutex<Option<Arc<MeshLibrary>>> = Mutex::new(None);
    let mut meshes = MESHES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(meshes) = &*meshes {
        return Ok(Arc::clone(meshes));
    }
    let built = Arc::new(MeshLibrary::build(catalog())?);
    *meshes = Some(Arc::clone(&built));
    Ok(built)
}

/// The ids of all classes of objects, in the order of their numbers.
#[pyfunction]
pub fn class_ids() -> Vec<&'static str> {
    catalog().classes().iter().map(|class| class.id.as_str()).collect()
}

/// What people call them.
#[pyfunction]
pub fn class_names() -> Vec<&'static str> {
    catalog().classes().iter().map(|class| class.name.as_str()).collect()
}
