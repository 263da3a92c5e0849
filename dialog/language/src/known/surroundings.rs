//! What is around the robot, in a few lines of text: what a rewriter reads beside what was said.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, Fluid, Property, RoomId, state::StateFlag};

use crate::known::{Known, KnownObject, describe};

/// States that people see and speak of.
const STATES: [(StateFlag, &str); 12] = [
    (StateFlag::Broken, "broken"),
    (StateFlag::Dirty, "dirty"),
    (StateFlag::Embiggenated, "large"),
    (StateFlag::Hot, "hot"),
    (StateFlag::Cold, "cold"),
    (StateFlag::Cut, "cut"),
    (StateFlag::Eaten, "eaten"),
    (StateFlag::Wet, "wet"),
    (StateFlag::Creased, "creased"),
    (StateFlag::Folded, "folded"),
    (StateFlag::Opened, "open"),
    (StateFlag::Toggled, "running"),
];

/// What stands in a room and is worth telling even where nothing stands on it or lies in it: what is of use.
const OF_USE: [Property; 5] =
    [Property::Receptacle, Property::Openable, Property::Toggleable, Property::Powerable, Property::Usable];

/// The room and what stands in it, what can be carried in other rooms and in this one, what is open or runs, and what is in the hand: parts with `; `
/// between them, what seldom changes first.
///
/// ```text
/// break room with sink, couch, 6 stool, microwave; main office: hammer; counter: banana, dirty plate; open microwave; in my hand mug with coffee
/// ```
pub(crate) fn surroundings(catalog: &Catalog, scene: &Known) -> String {
    let around = Surroundings { catalog, scene };
    let mut parts = vec![around.furnishings()];
    parts.extend(around.elsewhere());
    parts.extend(around.carried_here());
    parts.extend(around.in_other_states());
    if let Some(held) = scene.robot.held.and_then(|held| scene.object(held)) {
        parts.push(format!("in my hand {}", around.named(held, KnownName::WithState)));
    }
    parts.join("; ")
}

struct Surroundings<'a> {
    catalog: &'a Catalog,
    scene: &'a Known,
}

/// How a thing is named.
#[derive(Clone, Copy, PartialEq, Eq)]
enum KnownName {
    Bare,
    WithState,
}

impl<'a> Surroundings<'a> {
    /// What can be carried in a room, or what cannot; what nobody can see is left out, and what is in the hand.
    fn all(&self, room: RoomId, is_carried: bool) -> Vec<&'a KnownObject> {
        let is_it = |object: &&KnownObject| {
            object.room == room
                && !object.is_hidden
                && self.scene.robot.held != Some(object.id)
                && self.catalog.class(object.class).has(Property::Pickupable) == is_carried
        };
        self.scene.objects.iter().filter(is_it).collect()
    }

    /// The room, and what of use stands in it that carries nothing.
    fn furnishings(&self) -> String {
        let room = self.scene.robot.room;
        let mut told = self.all(room, false);
        told.retain(|object| {
            let class = self.catalog.class(object.class);
            OF_USE.iter().any(|property| class.has(*property)) && !self.carries(object)
        });
        format!("{} with {}", room.name_in(self.catalog), self.listed(told, KnownName::Bare))
    }

    /// Whether something lies in it or stands on it that can be carried.
    fn carries(&self, object: &KnownObject) -> bool {
        self.all(object.room, true).iter().any(|other| other.parent == Some(object.id))
    }

    /// What can be carried in each of the other rooms.
    fn elsewhere(&self) -> Vec<String> {
        let rooms = self.catalog.rooms().all().iter().filter(|room| room.id != self.scene.robot.room);
        let told = rooms.filter_map(|room| {
            let things = self.all(room.id, true);
            (!things.is_empty()).then(|| format!("{}: {}", room.name, self.listed(things, KnownName::Bare)))
        });
        told.collect()
    }

    /// What can be carried in this room, by what it stands on or lies in.
    fn carried_here(&self) -> Vec<String> {
        let mut by_parent: BTreeMap<Option<_>, Vec<&KnownObject>> = BTreeMap::new();
        for object in self.all(self.scene.robot.room, true) {
            by_parent.entry(object.parent).or_default().push(object);
        }
        let told = by_parent.into_iter().map(|(parent, things)| {
            let listed = self.listed(things, KnownName::WithState);
            match parent.and_then(|parent| self.scene.object(parent)) {
                Some(parent) => format!("{}: {listed}", self.named(parent, KnownName::Bare)),
                None => format!("floor: {listed}"),
            }
        });
        told.collect()
    }

    /// What stands in this room and is open, runs or is otherwise not as it is built.
    fn in_other_states(&self) -> Option<String> {
        let mut told = self.all(self.scene.robot.room, false);
        told.retain(|object| !self.states(object).is_empty() || object.fluid != Fluid::None);
        (!told.is_empty()).then(|| self.listed(told, KnownName::WithState))
    }

    /// Names, each once, with how many there are: `bowl, 2 apples`.
    fn listed(&self, objects: Vec<&KnownObject>, name: KnownName) -> String {
        let mut counts: Vec<(String, usize)> = Vec::new();
        for named in objects.into_iter().map(|object| self.named(object, name)) {
            match counts.iter_mut().find(|(other, _)| *other == named) {
                Some((_, count)) => *count += 1,
                None => counts.push((named, 1)),
            }
        }
        let counted = counts.into_iter().map(|(name, count)| if count > 1 { format!("{count} {name}") } else { name });
        counted.collect::<Vec<_>>().join(", ")
    }

    /// What it is that others of its class are not as they are built.
    fn states(&self, object: &KnownObject) -> Vec<&'static str> {
        let built = self.catalog.class(object.class).states_as_built();
        let is_off = built.has(StateFlag::Toggled) && !object.has(StateFlag::Toggled);
        let unusual = STATES.iter().filter(|(flag, _)| object.has(*flag) && !built.has(*flag)).map(|(_, word)| *word);
        unusual.chain(is_off.then_some("off")).collect()
    }

    fn named(&self, object: &KnownObject, name: KnownName) -> String {
        let bare = describe::bare(self.catalog, self.scene, object.id);
        if name == KnownName::Bare {
            return bare;
        }
        let states = self.states(object).into_iter().map(|state| format!("{state} "));
        let content = match object.fluid {
            _ if object.has(StateFlag::Cereal) => " with cereal",
            // `milk` is the carton.
            fluid if bare.contains(&fluid.name().to_lowercase()) => "",
            Fluid::None => "",
            Fluid::Water => " with water",
            Fluid::Milk => " with milk",
            Fluid::Coffee => " with coffee",
        };
        format!("{}{bare}{content}", states.collect::<String>())
    }
}
