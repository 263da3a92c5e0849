//! The whole state: numbers that stand for it, what differs from another, snapshots of it.

use cohabit_cdf::{Catalog, Layout, Mission};

use super::World;
use crate::{
    difference,
    digest::{digest, digest_as_one},
    snapshot::{self, SnapshotError},
};

impl World {
    /// A number for each part of the simulated state, in the order of [`DIGEST_PARTS`](crate::DIGEST_PARTS), of
    /// [`DIGEST_PART_BYTES`](crate::DIGEST_PART_BYTES) each.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        digest(&self.state)
    }

    /// One number for all of it, as logs of format 1 have it.
    #[must_use]
    pub fn digest_as_one(&self) -> [u8; 32] {
        digest_as_one(&self.state)
    }

    /// What differs between this world and another one of the same mission: objects and bodies by name, each with what
    /// of it differs; nothing, if nothing does.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        difference::between(&self.state, &other.state)
    }

    /// All simulated state as bytes.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        snapshot::write(self.identity(), &self.state)
    }

    /// Takes up a snapshot of a world of the same catalogue, floor plan and mission, and goes on from it bit for bit.
    ///
    /// # Errors
    /// [`SnapshotError`] says why the bytes are not one; the world is then as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SnapshotError> {
        self.state = snapshot::read(self.identity(), &self.mission.name, bytes)?;
        self.renew_navigation();
        self.is_judged = false;
        Ok(())
    }

    fn identity(&self) -> &[u8; 32] {
        self.identity.get_or_init(|| identity(&self.catalog, &self.layout, &self.mission))
    }
}

/// Stands for the catalogue, the floor plan and the mission that a snapshot needs.
fn identity(catalog: &Catalog, layout: &Layout, mission: &Mission) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for class in catalog.classes() {
        hasher.update(format!("{class:?}").as_bytes());
    }
    hasher.update(format!("{layout:?}").as_bytes());
    hasher.update(format!("{mission:?}").as_bytes());
    *hasher.finalize().as_bytes()
}
