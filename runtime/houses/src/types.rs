//! Which class stands for an object of a type of AI2-THOR, by the table in `data/types.toml`.

use cohabit_cdf::{Catalog, ClassId};
use serde::Deserialize;

/// The table of types.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TypeTable {
    #[serde(rename = "type")]
    types: Vec<ObjectType>,
}

/// A type of objects, and what stands for it. Of several classes, the first that fits is taken.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ObjectType {
    /// As AI2-THOR calls it.
    pub name: String,
    /// For one that stands on the floor.
    pub floor: Vec<String>,
    /// The same for one that is `tall_from_m` or higher.
    pub tall: Vec<String>,
    pub tall_from_m: f32,
    /// For one that hangs on a wall.
    pub wall: Vec<String>,
    /// For one on furniture.
    pub surface: Vec<String>,
    /// Whether it stands with its back to a wall.
    pub backed: bool,
}

impl TypeTable {
    /// The project's own.
    pub fn builtin() -> Self {
        toml::from_str(include_str!("../data/types.toml")).expect("invariant: the table of types parses")
    }

    /// What stands for a type; nothing, if the table does not know it.
    pub fn find(&self, name: &str) -> Option<&ObjectType> {
        // Some tables of AI2-THOR write `FloorLamp`, others `Floor lamp`.
        let letters = |text: &str| text.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
        let wanted = letters(name);
        self.types.iter().find(|kind| letters(&kind.name) == wanted)
    }
}

impl ObjectType {
    /// The classes for one of a height that stands on the floor.
    pub fn on_floor(&self, height_m: f32) -> &[String] {
        if !self.tall.is_empty() && height_m >= self.tall_from_m { &self.tall } else { &self.floor }
    }

    /// Whether nothing stands for it.
    pub fn is_without_class(&self) -> bool {
        [&self.floor, &self.tall, &self.wall, &self.surface].into_iter().all(Vec::is_empty)
    }
}

/// Those of some classes that there are, which is all of them for the project's own table and the pack `homes`.
pub fn classes(ids: &[String], catalog: &Catalog) -> Vec<ClassId> {
    ids.iter().filter_map(|id| catalog.find(id)).collect()
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::catalog::Stands;

    use super::*;
    use crate::importer::homes;

    /// The types that ProcTHOR and AI2-THOR put into houses.
    const KNOWN: &str = include_str!("../tests/data/known_types.txt");

    #[test]
    fn all_types_are_in_the_table_once_and_their_classes_are_there() {
        let (world, table) = (homes(), TypeTable::builtin());
        let catalog = world.catalog();
        for name in KNOWN.lines().filter(|line| !line.starts_with('#')) {
            assert_eq!(table.types.iter().filter(|kind| kind.name == name).count(), 1, "{name}");
        }
        for kind in &table.types {
            let find = |id: &String| {
                let id = catalog.find(id).unwrap_or_else(|| panic!("{}: there is no class `{id}`", kind.name));
                catalog.class(id)
            };
            assert!(kind.wall.iter().all(|id| find(id).stands == Stands::OnWall), "{}", kind.name);
            assert!(kind.surface.iter().all(|id| find(id).stands == Stands::OnSurface), "{}", kind.name);
            assert!(kind.floor.iter().chain(&kind.tall).all(|id| find(id).stands != Stands::OnWall), "{}", kind.name);
            assert_eq!(kind.tall.is_empty(), kind.tall_from_m == 0.0, "{}", kind.name);
        }
    }

    #[test]
    fn a_type_is_found_however_it_is_written() {
        let table = TypeTable::builtin();
        for name in ["FloorLamp", "Floor lamp", "floor_lamp"] {
            assert_eq!(table.find(name).unwrap().floor, ["Floor_Lamp"], "{name}");
        }
        assert!(table.find("Portal").is_none());
        assert!(table.find("StoveKnob").unwrap().is_without_class());
    }

    #[test]
    fn a_tall_one_is_of_another_class() {
        let table = TypeTable::builtin();
        let shelves = table.find("ShelvingUnit").unwrap();
        assert_ne!(shelves.on_floor(0.6), shelves.on_floor(1.8));
    }
}
