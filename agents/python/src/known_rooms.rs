//! The rooms that actions can name: the built-in ones, and those of world packs that were read.

use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use cohabit_cdf::{Catalog, RoomId, Rooms};

static OF_PACKS: Mutex<Vec<Arc<Catalog>>> = Mutex::new(Vec::new());

/// The rooms of the project's own floor plans.
pub fn builtin() -> &'static Rooms {
    static BUILTIN: LazyLock<Rooms> = LazyLock::new(Rooms::builtin);
    &BUILTIN
}

/// Has actions name the rooms of a catalogue.
pub fn note(catalog: &Arc<Catalog>) {
    OF_PACKS.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::clone(catalog));
}

/// The room with this id or name.
pub fn find(text: &str) -> Option<RoomId> {
    let of_packs = || {
        let catalogs = OF_PACKS.lock().unwrap_or_else(PoisonError::into_inner);
        catalogs.iter().find_map(|catalog| catalog.rooms().find(text))
    };
    builtin().find(text).or_else(of_packs)
}
