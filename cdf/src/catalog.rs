//! The object catalogue: every class of object, what it affords, what people call it and what it looks like.

pub(crate) mod files;
mod names;
mod pack;
pub mod table;

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

pub use names::ClassNames;
pub(crate) use pack::Layer;
pub use pack::{PackId, Speech};
use table::{ActionTable, TableError};

use crate::{
    builtin,
    model::Model,
    nearest::{did_you_mean, nearest},
    room::{RoomId, Rooms},
    state::{Fluid, StateFlag, StateFlags},
};

/// The index of a class in the [`Catalog`].
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
pub struct ClassId(pub u16);

/// What a class of object affords.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Property {
    /// Fits a hand.
    Pickupable,
    /// Takes other objects.
    Receptacle,
    /// Opens and closes.
    Openable,
    /// Breaks under a hammer.
    Breakable,
    /// Switches on and off.
    Toggleable,
    /// Needs its circuit.
    Powerable,
    /// Gets dirty.
    Dirtyable,
    /// Gets hot.
    Heatable,
    /// Can be eaten.
    Eatable,
    /// Gets cold.
    Chillable,
    /// Takes a fluid.
    Fillable,
    /// Can be cooked.
    Cookable,
    /// Can be cut.
    Cuttable,
    /// A virus can infect it.
    Infectable,
    /// Is a tool or a machine.
    Usable,
    /// To look at.
    Decor,
}

impl Property {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Pickupable,
        Self::Receptacle,
        Self::Openable,
        Self::Breakable,
        Self::Toggleable,
        Self::Powerable,
        Self::Dirtyable,
        Self::Heatable,
        Self::Eatable,
        Self::Chillable,
        Self::Fillable,
        Self::Cookable,
        Self::Cuttable,
        Self::Infectable,
        Self::Usable,
        Self::Decor,
    ];
}

/// One class of object.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectClass {
    /// The id missions use, such as `Bowl_01`.
    pub id: String,
    /// The name people read, such as `Bowl`.
    pub name: String,
    /// What people say, lower case, the most usual first; the name need not be repeated.
    #[serde(default)]
    pub words: Vec<String>,
    /// What it affords.
    #[serde(default)]
    pub properties: Vec<Property>,
    /// Extent along its own x (front), y (left) and z (up), m.
    pub size_m: [f32; 3],
    /// Mass, kg.
    pub mass_kg: f32,
    /// The colour people name it by: a plain word such as `red` or `light blue`.
    pub color: String,
    /// The model's id; the object's own id, if absent.
    #[serde(default)]
    pub model: Option<String>,
    /// What replaces `tint` in its model, `#rrggbb`.
    #[serde(default)]
    pub tint: Option<String>,
    /// How it takes other objects, if it does.
    #[serde(default)]
    pub receptacle: Option<Receptacle>,
    /// Where the robot must aim and reach, m in the object's frame; the middle of the object, if absent.
    #[serde(default)]
    pub handle_m: Option<[f32; 3]>,
    /// The states that one is built in, before a mission changes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub as_built: Vec<StateFlag>,
    /// Whether it hangs on a wall (back at `-x`), stands on the floor, or lies on surfaces.
    #[serde(default)]
    pub stands: Stands,
}

impl ObjectClass {
    /// Whether it affords `property`.
    #[must_use]
    pub fn has(&self, property: Property) -> bool {
        self.properties.contains(&property)
    }

    /// The states that one is built in, before a mission changes them.
    #[must_use]
    pub fn states_as_built(&self) -> StateFlags {
        self.as_built.iter().fold(StateFlags::default(), |flags, flag| flags.with(*flag))
    }

    /// What one holds as it is built.
    #[must_use]
    pub fn fluid_as_built(&self) -> Fluid {
        if self.id == "MilkCarton_01" { Fluid::Milk } else { Fluid::None }
    }
}

/// Where a class of object is normally found.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stands {
    /// On a table, a shelf, in a drawer.
    #[default]
    OnSurface,
    /// On the floor.
    OnFloor,
    /// On a wall, at a height.
    OnWall,
}

/// How a class takes other objects.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Receptacle {
    /// Where things stand.
    #[serde(rename = "surface")]
    pub surfaces: Vec<Surface>,
    /// Whether its contents are behind a door, lid or drawer front (it must be open to reach them).
    #[serde(default)]
    pub enclosed: bool,
    /// The only classes it takes, in the order of its anchors; any that fits, if empty.
    #[serde(default)]
    pub keys: Vec<String>,
    /// Classes it never takes.
    #[serde(default)]
    pub refuses: Vec<String>,
}

/// A level rectangle with a grid of anchors: places that hold one object each.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// Its middle, m in the object's frame.
    pub center_m: [f32; 3],
    /// Extent along x and y, m.
    pub size_m: [f32; 2],
    /// Anchors along x and along y.
    pub anchors: [u32; 2],
    /// Height free above it, m.
    pub clearance_m: f32,
}

/// All classes of objects, by index and by id, with their models.
#[derive(Clone, Debug)]
pub struct Catalog {
    classes: Vec<ObjectClass>,
    models: Vec<Model>,
    class_by_id: HashMap<String, ClassId>,
    model_by_class: Vec<usize>,
    names: Vec<ClassNames>,
    table: ActionTable,
    rooms: Rooms,
    layer: Layer,
}

/// Why a catalogue could not be built.
#[derive(Debug, thiserror::Error)]
pub enum CatalogError {
    /// The text is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// Two classes or models share an id.
    #[error("{file}: `{id}` is defined twice: it is in {first} already; give one of them another id")]
    Duplicate {
        /// Which file has the second.
        file: String,
        /// Which has the first.
        first: String,
        /// The id.
        id: String,
    },
    /// A class names a model that no file has.
    #[error("{file}: object `{object}` has no model: no file defines `{model}`: {remedy}")]
    NoModel {
        /// The file of the class.
        file: String,
        /// The class.
        object: String,
        /// The model it names.
        model: String,
        /// What would be right.
        remedy: String,
    },
    /// A receptacle takes or refuses a class that no file has.
    #[error("{file}: object `{object}`: receptacle: no file defines the class `{class}`: {remedy}")]
    NoClass {
        /// The file of the receptacle.
        file: String,
        /// The receptacle.
        object: String,
        /// The class that it names.
        class: String,
        /// What would be right.
        remedy: String,
    },
}

impl Catalog {
    /// The project's own catalogue.
    ///
    /// # Panics
    /// Never: the tests parse the same text.
    #[must_use]
    pub fn builtin() -> Self {
        let catalog = Self::parse(builtin::OBJECTS, builtin::MODELS).expect("invariant: the built-in catalogue parses");
        catalog.with_table(builtin::TABLE).expect("invariant: the built-in table parses")
    }

    /// Builds a catalogue from `(file name, text)` of object files and of model files, with the built-in rooms.
    ///
    /// # Errors
    /// [`CatalogError`] names the file and the id.
    pub fn parse(objects: &[(&str, &str)], models: &[(&str, &str)]) -> Result<Self, CatalogError> {
        let (catalog, errors) = Self::gather(objects, models);
        errors.into_iter().next().map_or(Ok(catalog), Err)
    }

    /// The same with all that is wrong; where that is anything, the catalogue is not whole.
    pub(crate) fn gather(objects: &[(&str, &str)], models: &[(&str, &str)]) -> (Self, Vec<CatalogError>) {
        let mut catalog = Self {
            classes: Vec::new(),
            models: Vec::new(),
            class_by_id: HashMap::new(),
            model_by_class: Vec::new(),
            names: Vec::new(),
            table: ActionTable::default(),
            rooms: Rooms::builtin(),
            layer: Layer::default(),
        };
        let mut errors = Vec::new();
        let mut model_by_id: HashMap<String, (usize, &str)> = HashMap::new();
        let mut file_of_class: HashMap<String, &str> = HashMap::new();
        for (file, model) in files::models(models.iter().copied(), &mut errors, read) {
            match model_by_id.get(&model.id) {
                Some((_, first)) => errors.push(twice(file, first, model.id)),
                None => {
                    model_by_id.insert(model.id.clone(), (catalog.models.len(), file));
                    catalog.models.push(model);
                }
            }
        }
        for (file, class) in files::objects(objects.iter().copied(), &mut errors, read) {
            if let Some(first) = file_of_class.get(&class.id) {
                errors.push(twice(file, first, class.id));
                continue;
            }
            file_of_class.insert(class.id.clone(), file);
            let model = class.model.clone().unwrap_or_else(|| class.id.clone());
            let index = model_by_id.get(&model).map(|(index, _)| *index);
            if index.is_none() {
                let near = did_you_mean(&model, catalog.models.iter().map(|known| known.id.as_str()));
                let remedy = near.unwrap_or_else(|| "add a `[[model]]` with this id".to_owned());
                errors.push(CatalogError::NoModel { file: file.to_owned(), object: class.id.clone(), model, remedy });
            }
            let id = ClassId(u16::try_from(catalog.classes.len()).expect("invariant: fewer than 65536 classes"));
            catalog.class_by_id.insert(class.id.clone(), id);
            catalog.model_by_class.push(index.unwrap_or_default());
            catalog.classes.push(class);
        }
        errors.extend(catalog.unknown_in_receptacles(&file_of_class));
        catalog.names = names::of_classes(&catalog.classes);
        (catalog, errors)
    }

    /// What receptacles take or refuse by name, and is not there.
    fn unknown_in_receptacles(&self, files: &HashMap<String, &str>) -> Vec<CatalogError> {
        let mut errors = Vec::new();
        for class in &self.classes {
            let named = class.receptacle.iter().flat_map(|own| own.keys.iter().chain(&own.refuses));
            for absent in named.filter(|named| self.find(named).is_none()) {
                let file = files.get(&class.id).copied().unwrap_or_default().to_owned();
                let near = did_you_mean(absent, self.classes.iter().map(|known| known.id.as_str()));
                let remedy = near.unwrap_or_else(|| "add an `[[object]]` with this id".to_owned());
                errors.push(CatalogError::NoClass { file, object: class.id.clone(), class: absent.clone(), remedy });
            }
        }
        errors
    }

    /// The same with a table of actions and devices, from `(file name, text)`.
    ///
    /// # Errors
    /// [`TableError`] names the file and what is wrong in it.
    pub fn with_table(self, files: &[(&str, &str)]) -> Result<Self, TableError> {
        let (catalog, errors) = self.gather_table(files);
        errors.into_iter().next().map_or(Ok(catalog), Err)
    }

    /// The same with all that is wrong in the table.
    pub(crate) fn gather_table(mut self, files: &[(&str, &str)]) -> (Self, Vec<TableError>) {
        let is_class = |class: &str| match class.strip_suffix('*') {
            Some(prefix) => self.classes.iter().any(|known| known.id.starts_with(prefix)),
            None => self.find(class).is_some(),
        };
        let (table, errors) = ActionTable::gather(files, &is_class);
        let meant = |error: TableError| match error {
            TableError::NoClass { file, class, .. } => {
                let near = nearest(&class, self.classes.iter().map(|known| known.id.as_str())).map(str::to_owned);
                TableError::NoClass { file, class, near }
            }
            other => other,
        };
        let errors = errors.into_iter().map(meant).collect();
        self.table = table;
        (self, errors)
    }

    /// The same with the table of another catalogue; what that says of classes that this one lacks counts for nothing.
    #[must_use]
    pub fn with_table_of(mut self, other: &Self) -> Self {
        self.table = other.table.clone();
        self
    }

    /// The project's own table, as `(file name, text)`: what others are put beside, or in the place of.
    #[must_use]
    pub fn builtin_table() -> &'static [(&'static str, &'static str)] {
        builtin::TABLE
    }

    /// What can be done to things, and what devices do; empty, unless a table was given.
    #[must_use]
    pub fn table(&self) -> &ActionTable {
        &self.table
    }

    /// The rooms that floor plans may have, and what each is called.
    #[must_use]
    pub const fn rooms(&self) -> &Rooms {
        &self.rooms
    }

    /// The index of a room, as messages have it; `None` for one that the world lacks.
    #[must_use]
    pub fn room_index(&self, room: RoomId) -> Option<u8> {
        self.rooms.index(room)
    }

    /// The room with this index.
    #[must_use]
    pub fn room_at(&self, index: u32) -> Option<RoomId> {
        self.rooms.at(index)
    }

    /// All classes, in the order of their [`ClassId`]s.
    #[must_use]
    pub fn classes(&self) -> &[ObjectClass] {
        &self.classes
    }

    /// The ids of all classes, in their order.
    pub fn class_ids(&self) -> impl Iterator<Item = ClassId> + use<> {
        (0..self.classes.len()).map(|index| ClassId(index as u16))
    }

    /// The class at `id`.
    ///
    /// # Panics
    /// When `id` comes from another catalogue.
    #[must_use]
    pub fn class(&self, id: ClassId) -> &ObjectClass {
        &self.classes[usize::from(id.0)]
    }

    /// What people call the class at `id`.
    ///
    /// # Panics
    /// When `id` comes from another catalogue.
    #[must_use]
    pub fn names(&self, id: ClassId) -> &ClassNames {
        &self.names[usize::from(id.0)]
    }

    /// The class with this id, such as `Bowl_01`.
    #[must_use]
    pub fn find(&self, id: &str) -> Option<ClassId> {
        self.class_by_id.get(id).copied()
    }

    /// The class of an instance id such as `Bowl_01_1`: the longest class id that it begins with, before a `_`.
    #[must_use]
    pub fn class_of_instance(&self, instance: &str) -> Option<ClassId> {
        if let Some(id) = self.find(instance) {
            return Some(id);
        }
        instance.rmatch_indices('_').find_map(|(at, _)| self.find(&instance[..at]))
    }

    /// What a misspelt class or instance may be: the nearest class, with the same number if there is one.
    #[must_use]
    pub fn near(&self, name: &str) -> Option<String> {
        let classes = || self.classes.iter().map(|class| class.id.as_str());
        if let Some(class) = nearest(name, classes()) {
            return Some(class.to_owned());
        }
        let (class, number) = name.rsplit_once('_')?;
        Some(format!("{}_{number}", nearest(class, classes())?))
    }

    /// The looks of a class.
    #[must_use]
    pub fn model(&self, id: ClassId) -> &Model {
        &self.models[self.model_by_class[usize::from(id.0)]]
    }

    /// All models.
    #[must_use]
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The index of a class's model in [`Self::models`].
    #[must_use]
    pub fn model_index(&self, id: ClassId) -> usize {
        self.model_by_class[usize::from(id.0)]
    }
}

impl RoomId {
    /// What people call it in this world.
    #[must_use]
    pub fn name_in(self, catalog: &Catalog) -> &str {
        // No floor plan has a room that its catalogue lacks.
        catalog.rooms.get(self).map_or("room", |entry| entry.name.as_str())
    }
}

fn twice(file: &str, first: &str, id: String) -> CatalogError {
    CatalogError::Duplicate { file: file.to_owned(), first: first.to_owned(), id }
}

fn read<T: serde::de::DeserializeOwned>(file: &str, text: &str) -> Result<T, CatalogError> {
    toml::from_str(text).map_err(|source| CatalogError::Syntax { file: file.to_owned(), source: Box::new(source) })
}
