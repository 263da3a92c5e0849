//! The world that a mission begins in.

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, mission::read_mission};
use cohabit_world::World;
use serde_json::Value;

/// The world of a mission at its first tick; why there is none, in words.
pub(crate) fn world(id: &str, cdf: &Value, seed: u64, catalog: &Arc<Catalog>) -> Result<World, String> {
    let checked = read_mission(id, &cdf.to_string(), catalog).map_err(|problems| problems.to_string())?;
    let layout = Layout::builtin(&checked.mission.layout).map_err(|error| error.to_string())?;
    let world = World::new(Arc::clone(catalog), Arc::new(layout), Arc::new(checked.mission), seed);
    world.map_err(|error| error.to_string())
}
