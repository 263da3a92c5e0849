//! World packs that come with the program, by name.

use super::{PackFile, WorldPack};
use crate::builtin::PACKS;

/// The names of the packs that are built in.
pub fn names() -> impl Iterator<Item = &'static str> {
    PACKS.iter().map(|(name, _)| *name)
}

/// The files of the pack that is built in by this name.
#[must_use]
pub fn builtin_files(name: &str) -> Option<Vec<PackFile>> {
    let (_, files) = PACKS.iter().find(|(known, _)| *known == name)?;
    let file = |(path, text): &(&str, &str)| PackFile { path: (*path).to_owned(), bytes: text.as_bytes().to_vec() };
    Some(files.iter().map(file).collect())
}

impl WorldPack {
    /// The pack that is built in by this name.
    #[must_use]
    pub fn builtin(name: &str) -> Option<Self> {
        Some(Self::parse(name, builtin_files(name)?).expect("invariant: a pack that comes with the program is sound"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, WorldData, WorldPack, mission::read_mission};

    #[test]
    fn each_pack_that_is_built_in_is_read_with_all_its_plans_and_missions() {
        assert!(names().count() > 0);
        for name in names() {
            let pack = WorldPack::builtin(name).unwrap();
            assert_eq!(pack.id().name, name);
            let world = WorldData::layered(vec![pack]).unwrap();
            let pack = &world.packs()[0];
            assert!(pack.plans().count() > 0 && pack.missions().count() > 0, "{name}");
            for plan in pack.plans() {
                Layout::find(plan, world.catalog()).unwrap();
            }
            for (mission, text) in pack.missions() {
                if let Err(problems) = read_mission(mission, text, world.catalog()) {
                    panic!("{mission}: {problems}");
                }
            }
        }
    }

    #[test]
    fn no_other_name_is_a_pack() {
        assert_eq!(builtin_files("no-such-pack"), None);
    }
}
