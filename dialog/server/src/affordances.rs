//! What a thing affords to who stands before it with something in hand, or nothing: what a person at the controls is
//! offered. Derived from the catalogue's properties and the thing's state; the world alone rules what comes of it.

use cohabit_bus::message::{NONE, NoteRecord, ObjectRecord, StateView};
use cohabit_cdf::{
    Action, Catalog, ClassId, Fluid, ObjectClass, ObjectId, Property, Verb,
    state::{StateFlag, StateFlags},
};
use serde::Deserialize;

/// How far a hand reaches, level, m; a little less than the world allows, since what is measured here is older.
const REACH_M: f32 = 1.55;
/// How far off things can be looked at closely or scanned, m.
const LOOK_CLOSELY_M: f32 = 2.9;
/// How far somebody throws, m.
const THROW_M: f32 = 5.5;
/// Most that is offered at once.
const MOST: usize = 5;

/// What a hand does, as pages name it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Deed {
    PickUp,
    Place,
    Open,
    Close,
    Break,
    Scan,
    Pour,
    Toggle,
    Throw,
    Fill,
    Clean,
    Examine,
}

impl Deed {
    /// Its name on the wire.
    const fn name(self) -> &'static str {
        match self {
            Self::PickUp => "pick_up",
            Self::Place => "place",
            Self::Open => "open",
            Self::Close => "close",
            Self::Break => "break",
            Self::Scan => "scan",
            Self::Pour => "pour",
            Self::Toggle => "toggle",
            Self::Throw => "throw",
            Self::Fill => "fill",
            Self::Clean => "clean",
            Self::Examine => "examine",
        }
    }

    /// The command that does it to an object.
    pub const fn action(self, object: ObjectId) -> Action {
        let verb = match self {
            Self::PickUp => return Action::PickUp { object },
            Self::Place => return Action::Place { receptacle: object },
            Self::Open => Verb::Open,
            Self::Close => Verb::Close,
            Self::Break => Verb::Break,
            Self::Scan => Verb::Scan,
            Self::Pour => Verb::Pour,
            Self::Toggle => Verb::Toggle,
            Self::Throw => Verb::Throw,
            Self::Fill => Verb::Fill,
            Self::Clean => Verb::Clean,
            Self::Examine => Verb::Examine,
        };
        Action::Interact { verb, object }
    }

    /// Whether it takes more than a look or a throw.
    pub const fn is_of_the_hand(self) -> bool {
        !matches!(self, Self::Scan | Self::Examine | Self::Throw)
    }

    /// How near one has to be, m.
    const fn within_m(self) -> f32 {
        match self {
            Self::Scan | Self::Examine => LOOK_CLOSELY_M,
            Self::Throw => THROW_M,
            _ => REACH_M,
        }
    }
}

/// One thing that can be done.
#[derive(Clone, Debug, PartialEq)]
pub struct Affordance {
    /// What.
    pub deed: Deed,
    /// What a button says.
    pub label: String,
}

impl Affordance {
    fn new(deed: Deed, label: impl Into<String>) -> Self {
        Self { deed, label: label.into() }
    }

    /// As pages get it.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({ "deed": self.deed.name(), "label": self.label })
    }
}

/// What tools do: what is held, what it needs of a thing, the state that it leaves, and how it is said.
const TOOLS: [(&str, Property, StateFlag, Deed, &str); 3] = [
    ("Hammer", Property::Breakable, StateFlag::Broken, Deed::Break, "Break"),
    ("Knife_01", Property::Cuttable, StateFlag::Cut, Deed::Break, "Cut"),
    ("Cereal_Box_01", Property::Fillable, StateFlag::Cereal, Deed::Pour, "Pour cereal in"),
];

/// A thing with its class and state.
struct Thing<'a> {
    record: &'a ObjectRecord,
    class: &'a ObjectClass,
    flags: StateFlags,
}

impl<'a> Thing<'a> {
    fn new(record: &'a ObjectRecord, catalog: &'a Catalog) -> Option<Self> {
        let known = usize::from(record.class) < catalog.classes().len();
        known.then(|| Self { record, class: catalog.class(ClassId(record.class)), flags: StateFlags(record.flags) })
    }

    fn has(&self, property: Property) -> bool {
        self.class.has(property)
    }

    fn is(&self, flag: StateFlag) -> bool {
        self.flags.has(flag)
    }

    fn is_filled(&self) -> bool {
        u32::from(self.record.fluid) != Fluid::None as u32
    }

    fn is_shut(&self) -> bool {
        let enclosed = self.class.receptacle.as_ref().is_some_and(|kind| kind.enclosed);
        enclosed && self.has(Property::Openable) && !self.is(StateFlag::Opened)
    }

    /// Whether water comes from it.
    fn is_tap(&self) -> bool {
        [Property::Toggleable, Property::Fillable, Property::Receptacle].into_iter().all(|property| self.has(property))
            && !self.has(Property::Powerable)
    }

    /// Whether it would take another thing, as far as can be seen.
    fn takes(&self, other: &Self) -> bool {
        let Some(kind) = &self.class.receptacle else { return false };
        let keyed = kind.keys.is_empty() || kind.keys.contains(&other.class.id);
        keyed && !kind.refuses.contains(&other.class.id) && !self.is_shut()
    }

    /// How far its outline, seen from above, is from a point on the floor, m.
    fn distance_m(&self, from_m: [f32; 3]) -> f32 {
        let [x, y, z, w] = self.record.rotation;
        let yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
        let [dx, dy] = [from_m[0] - self.record.position_m[0], from_m[1] - self.record.position_m[1]];
        let (sin, cos) = yaw.sin_cos();
        let ahead = ((dx * cos + dy * sin).abs() - self.class.size_m[0] / 2.0).max(0.0);
        let aside = ((dy * cos - dx * sin).abs() - self.class.size_m[1] / 2.0).max(0.0);
        ahead.hypot(aside)
    }
}

/// What an object affords to a body, the most obvious first, and whether it has to come nearer for any of it.
pub fn afforded(state: StateView<'_>, body: u32, object: ObjectId, catalog: &Catalog) -> (Vec<Affordance>, bool) {
    let find = |index: u32| state.objects.iter().find(|record| record.object == index);
    let body = state.bodies.iter().find(|record| record.body == body);
    let (Some(body), Some(thing)) = (body, find(object.0).and_then(|record| Thing::new(record, catalog))) else {
        return (Vec::new(), false);
    };
    let held = (body.held != NONE).then(|| find(body.held)).flatten();
    let held = held.and_then(|record| Thing::new(record, catalog));
    if thing.record.held_by != NONE {
        return (Vec::new(), false);
    }
    let note = state.notes.iter().find(|note| note.object == object.0);
    let mut all = match &held {
        Some(held) => with(held, &thing, catalog),
        None => with_empty_hand(&thing),
    };
    all.extend(by_itself(&thing, note));
    if held.is_some() {
        all.push(Affordance::new(Deed::Throw, "Throw at it"));
    }
    all.push(Affordance::new(Deed::Scan, "Scan"));
    let distance_m = thing.distance_m(body.position_m);
    let (mut near, far): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| distance_m <= one.deed.within_m());
    near.truncate(MOST);
    (near, far.iter().any(|one| one.deed.within_m() == REACH_M))
}

fn with_empty_hand(thing: &Thing<'_>) -> Vec<Affordance> {
    let takes = thing.has(Property::Pickupable);
    takes.then(|| Affordance::new(Deed::PickUp, "Pick up")).into_iter().collect()
}

/// What can be done to a thing with what is held.
fn with(held: &Thing<'_>, thing: &Thing<'_>, catalog: &Catalog) -> Vec<Affordance> {
    let mut all = Vec::new();
    let name = crate::page::name(held.record, catalog).to_lowercase();
    for (class, property, leaves, deed, says) in TOOLS {
        if held.class.id == class && thing.has(property) && !thing.is(leaves) && !thing.is_tap() {
            all.push(Affordance::new(deed, says));
        }
    }
    if thing.is_tap() && thing.is(StateFlag::Toggled) {
        if held.has(Property::Dirtyable) && held.is(StateFlag::Dirty) {
            all.push(Affordance::new(Deed::Clean, format!("Wash the {name}")));
        }
        if held.has(Property::Fillable) && !held.is_filled() {
            all.push(Affordance::new(Deed::Fill, format!("Fill the {name}")));
        }
    }
    if held.is_filled() && thing.has(Property::Fillable) && !thing.is_filled() {
        let says = if thing.is_tap() { format!("Empty the {name}") } else { "Pour in".to_owned() };
        all.push(Affordance::new(Deed::Pour, says));
    }
    if thing.takes(held) {
        all.push(Affordance::new(Deed::Place, format!("Put the {name} here")));
    }
    all
}

/// What can be done whatever is held.
fn by_itself(thing: &Thing<'_>, note: Option<&NoteRecord>) -> Vec<Affordance> {
    let mut all = Vec::new();
    if note.is_some() {
        all.push(Affordance::new(Deed::Examine, "Read"));
    }
    // A tap has no door, whatever the catalogue says of its cupboard below.
    if thing.has(Property::Openable) {
        let opened = thing.is(StateFlag::Opened);
        all.push(if opened { Affordance::new(Deed::Close, "Close") } else { Affordance::new(Deed::Open, "Open") });
    }
    if thing.has(Property::Toggleable) {
        let says = if thing.is(StateFlag::Toggled) { "Switch off" } else { "Switch on" };
        let toggle = Affordance::new(Deed::Toggle, says);
        let at = if thing.is_tap() { 0 } else { all.len() };
        all.insert(at, toggle);
    }
    if note.is_none() {
        all.push(Affordance::new(Deed::Examine, "Look closely"));
    }
    all
}

/// What the world says of a command, turned to the person who gave it: `my hand is empty` is `Your hand is empty`.
pub fn addressed(detail: &str) -> String {
    /// Words of who acts, and what they are for who is spoken to.
    const WORDS: [(&str, &str); 5] = [("I am", "you are"), ("I", "you"), ("me", "you"), ("my", "your"), ("My", "Your")];
    let mut text = String::with_capacity(detail.len() + 8);
    let mut rest = detail;
    while let Some(first) = rest.chars().next() {
        let at_word = text.chars().last().is_none_or(|last| !last.is_alphanumeric());
        let ends = |word: &str| rest[word.len()..].chars().next().is_none_or(|next| !next.is_alphanumeric());
        let found = WORDS.iter().find(|(word, _)| at_word && rest.starts_with(word) && ends(word));
        match found {
            Some((word, instead)) => {
                text.push_str(instead);
                rest = &rest[word.len()..];
            }
            None => {
                text.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().collect::<String>());
    first.unwrap_or_default() + letters.as_str()
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::{BodyRecord, StateHeader};

    use super::*;

    fn record(catalog: &Catalog, object: u32, class: &str, flags: &[StateFlag], x: f32) -> ObjectRecord {
        let mut set = StateFlags::default();
        flags.iter().for_each(|flag| set.set(*flag, true));
        ObjectRecord {
            object,
            class: catalog.find(class).unwrap().0,
            flags: set.0,
            parent: NONE,
            held_by: NONE,
            position_m: [x, 0.0, 0.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            ..ObjectRecord::default()
        }
    }

    /// What a class in some state affords to a body 1 m before it that holds a thing of another class.
    fn check(held: Option<&str>, class: &str, flags: &[StateFlag], expected: &[&str]) {
        let catalog = Catalog::builtin();
        let mut objects = vec![record(&catalog, 7, class, flags, 1.0)];
        objects.extend(held.map(|held| ObjectRecord { held_by: 1, ..record(&catalog, 8, held, &[], 0.0) }));
        let held = held.map_or(NONE, |_| 8);
        let bodies = [BodyRecord { body: 1, held, ..BodyRecord::default() }];
        let header = StateHeader::default();
        let state = StateView { header: &header, bodies: &bodies, objects: &objects, goals: &[], notes: &[] };
        let (afforded, _) = afforded(state, 1, ObjectId(7), &catalog);
        let labels: Vec<&str> = afforded.iter().map(|one| one.label.as_str()).collect();
        assert_eq!(labels, expected, "{class} with {held:?}");
    }

    #[test]
    fn the_obvious_comes_first() {
        check(None, "Bowl_01", &[], &["Pick up", "Look closely", "Scan"]);
        check(None, "Desk_01", &[], &["Look closely", "Scan"]);
        let placed = ["Put the bowl here", "Look closely", "Throw at it", "Scan"];
        check(Some("Bowl_01"), "Desk_01", &[], &placed);
        check(Some("Bowl_01"), "Microwave_01", &[], &["Open", "Switch on", "Look closely", "Throw at it", "Scan"]);
        let open = ["Put the bowl here", "Close", "Switch on", "Look closely", "Throw at it"];
        check(Some("Bowl_01"), "Microwave_01", &[StateFlag::Opened], &open);
        check(None, "Door_01", &[StateFlag::Opened], &["Close", "Look closely", "Scan"]);
        check(None, "LightSwitch_01", &[StateFlag::Toggled], &["Switch off", "Look closely", "Scan"]);
    }

    #[test]
    fn tools_are_used_on_what_they_are_for() {
        check(Some("Hammer"), "Bowl_01", &[], &["Break", "Look closely", "Throw at it", "Scan"]);
        check(Some("Hammer"), "Bowl_01", &[StateFlag::Broken], &["Look closely", "Throw at it", "Scan"]);
        check(Some("Cereal_Box_01"), "Bowl_01", &[], &["Pour cereal in", "Look closely", "Throw at it", "Scan"]);
    }

    #[test]
    fn a_key_goes_where_it_belongs() {
        let catalog = Catalog::builtin();
        let locks = catalog.classes().iter().filter_map(|class| Some((class, class.receptacle.as_ref()?)));
        let (lock, kind) = locks.into_iter().find(|(_, kind)| !kind.keys.is_empty() && !kind.enclosed).unwrap();
        let offers = |held: &str| {
            let (lock, held) = (record(&catalog, 1, &lock.id, &[], 0.0), record(&catalog, 2, held, &[], 0.0));
            Thing::new(&lock, &catalog).unwrap().takes(&Thing::new(&held, &catalog).unwrap())
        };
        assert!(offers(&kind.keys[0]) && !offers("Bowl_01"), "{}", lock.id);
    }

    #[test]
    fn what_is_said_is_said_to_the_person() {
        let check = |detail: &str, expected: &str| assert_eq!(addressed(detail), expected);
        check("I am holding the bowl", "You are holding the bowl");
        check(
            "my hand is empty: I have to pick something up first",
            "Your hand is empty: you have to pick something up first",
        );
        check("there is a wall between me and Milk", "There is a wall between you and Milk");
        check("the time machine is in my way", "The time machine is in your way");
        check("", "");
    }
}
