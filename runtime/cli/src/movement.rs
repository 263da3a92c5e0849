//! How bodies moved in the sessions that tables are made of.

use std::sync::Arc;

use cohabit_cdf::Catalog;
use cohabit_engine::replay::movement;
use cohabit_tables::Played;

/// The same sessions; those with people are played again from their logs, to know how bodies moved in them.
pub fn with_movement(played: Vec<Played>, catalog: &Arc<Catalog>) -> Vec<Played> {
    played.into_iter().map(|one| one.with_movement(|log| movement(log, Arc::clone(catalog)))).collect()
}
