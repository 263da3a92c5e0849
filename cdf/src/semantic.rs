//! What kind of thing is seen: a class of the catalogue, somebody, or a part of the building.

use crate::{
    body::BodyKind,
    catalog::{Catalog, ClassId},
};

/// The kind of thing that a pixel shows.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum SemanticClass {
    /// An object of the catalogue.
    Object(ClassId),
    /// A robot.
    Robot,
    /// A person.
    Person,
    /// What is walked on.
    Floor,
    /// What is overhead.
    Ceiling,
    /// A wall, with its skirting.
    Wall,
    /// The frame of a door, a passage or a window.
    Frame,
    /// A lamp in the ceiling.
    Lamp,
    /// What is no thing itself: what is being poured, say.
    Effect,
    /// Nothing that is known.
    Unknown,
}

impl SemanticClass {
    /// All but the objects of the catalogue, in the order of their indices.
    pub const OTHERS: [Self; 9] = [
        Self::Robot,
        Self::Person,
        Self::Floor,
        Self::Ceiling,
        Self::Wall,
        Self::Frame,
        Self::Lamp,
        Self::Effect,
        Self::Unknown,
    ];

    /// The index of the first of [`Self::OTHERS`]; the catalogue's classes have their own, lower ones.
    pub const FIRST_OTHER: u16 = 0xFF00;

    /// Its number, where numbers are needed.
    #[must_use]
    pub fn index(self) -> u16 {
        match self {
            Self::Object(class) => class.0,
            other => {
                let place = Self::OTHERS.iter().position(|known| *known == other).unwrap_or(0);
                Self::FIRST_OTHER + u16::try_from(place).unwrap_or(0)
            }
        }
    }

    /// The class with this number; [`Self::Unknown`] if there is none.
    #[must_use]
    pub fn from_index(index: u16) -> Self {
        match index.checked_sub(Self::FIRST_OTHER) {
            None => Self::Object(ClassId(index)),
            Some(place) => Self::OTHERS.get(usize::from(place)).copied().unwrap_or(Self::Unknown),
        }
    }

    /// As people call it.
    #[must_use]
    pub fn name(self, catalog: &Catalog) -> &str {
        match self {
            Self::Object(class) => catalog.classes().get(usize::from(class.0)).map_or("something", |class| &class.name),
            Self::Robot => BodyKind::Robot.name(),
            Self::Person => BodyKind::Person.name(),
            Self::Floor => "floor",
            Self::Ceiling => "ceiling",
            Self::Wall => "wall",
            Self::Frame => "frame",
            Self::Lamp => "ceiling lamp",
            Self::Effect => "effect",
            Self::Unknown => "something",
        }
    }
}

impl From<BodyKind> for SemanticClass {
    fn from(kind: BodyKind) -> Self {
        match kind {
            BodyKind::Robot => Self::Robot,
            BodyKind::Person => Self::Person,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lead_back_to_their_classes() {
        let catalog = Catalog::builtin();
        let objects = catalog.class_ids().map(SemanticClass::Object);
        for class in objects.chain(SemanticClass::OTHERS) {
            assert_eq!(SemanticClass::from_index(class.index()), class);
            assert!(!class.name(&catalog).is_empty());
        }
        assert_eq!(SemanticClass::from_index(u16::MAX), SemanticClass::Unknown);
        assert_eq!(SemanticClass::Object(ClassId(0xFE00)).name(&catalog), "something");
    }
}
