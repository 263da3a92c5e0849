//! What a thing affords to who stands before it with something in hand, or nothing: what a person at the controls is
//! offered. What is possible is read from the table of actions; the world alone rules what comes of it.

use cohabit_bus::message::{NONE, NoteRecord, ObjectRecord, StateView};
pub use cohabit_cdf::ActionKind as Deed;
use cohabit_cdf::{
    Catalog, ClassId, Fluid, ObjectClass, ObjectId, Property,
    catalog::table::View,
    state::{StateFlag, StateFlags},
};

/// How far a hand reaches, level, m; a little less than the world allows, since what is measured here is older.
const REACH_M: f32 = 1.55;
/// How far off things can be looked at closely or scanned, m.
const LOOK_CLOSELY_M: f32 = 2.9;
/// How far somebody throws, m.
const THROW_M: f32 = 5.5;
/// Most that is offered at once.
const MOST: usize = 5;

/// Whether it takes more than a look or a throw.
pub const fn is_of_the_hand(deed: Deed) -> bool {
    !matches!(deed, Deed::Scan | Deed::Examine | Deed::Throw)
}

/// How near one has to be, m.
const fn within_m(deed: Deed) -> f32 {
    match deed {
        Deed::Scan | Deed::Examine => LOOK_CLOSELY_M,
        Deed::Throw => THROW_M,
        _ => REACH_M,
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

/// The state that everybody hears, as the table of actions asks about it for one body. How far things are is told apart.
struct Seen<'a> {
    state: StateView<'a>,
    catalog: &'a Catalog,
    held: Option<ObjectId>,
}

impl<'a> Seen<'a> {
    fn record(&self, id: ObjectId) -> Option<&'a ObjectRecord> {
        let record = self.state.objects.iter().find(|record| record.object == id.0)?;
        (usize::from(record.class) < self.catalog.classes().len()).then_some(record)
    }

    fn of(&self, id: ObjectId, read: impl Fn(&ObjectRecord) -> u32) -> Option<ObjectId> {
        self.record(id).map(read).filter(|other| *other != NONE).map(ObjectId)
    }

    /// The name of the rule by which a body could do it, were it near enough.
    fn rule(&self, deed: Deed, id: ObjectId) -> Option<&'a str> {
        let judgement = self.catalog.table().judge(self, deed, id)?;
        judgement.is_allowed().then_some(judgement.rule.name.as_str())
    }

    fn is_tap(&self, id: ObjectId) -> bool {
        self.catalog.table().is_basin(&self.class(id).id)
    }

    /// How far its outline, seen from above, is from a point on the floor, m.
    fn distance_m(&self, record: &ObjectRecord, from_m: [f32; 3]) -> f32 {
        let [x, y, z, w] = record.rotation;
        let size_m = self.class(ObjectId(record.object)).size_m;
        let yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
        let [dx, dy] = [from_m[0] - record.position_m[0], from_m[1] - record.position_m[1]];
        let (sin, cos) = yaw.sin_cos();
        let ahead = ((dx * cos + dy * sin).abs() - size_m[0] / 2.0).max(0.0);
        let aside = ((dy * cos - dx * sin).abs() - size_m[1] / 2.0).max(0.0);
        ahead.hypot(aside)
    }
}

impl View for Seen<'_> {
    fn catalog(&self) -> &Catalog {
        self.catalog
    }

    fn exists(&self, id: ObjectId) -> bool {
        self.record(id).is_some()
    }

    fn class(&self, id: ObjectId) -> &ObjectClass {
        self.catalog.class(self.record(id).map_or(ClassId(0), |record| ClassId(record.class)))
    }

    fn is(&self, id: ObjectId, flag: StateFlag) -> bool {
        self.record(id).is_some_and(|record| StateFlags(record.flags).has(flag))
    }

    fn fluid(&self, id: ObjectId) -> Fluid {
        let fluid = self.record(id).map_or(0, |record| record.fluid);
        Fluid::ALL.get(usize::from(fluid)).copied().unwrap_or_default()
    }

    fn held(&self) -> Option<ObjectId> {
        self.held
    }

    fn parent(&self, id: ObjectId) -> Option<ObjectId> {
        self.of(id, |record| record.parent).filter(|parent| self.exists(*parent))
    }

    fn children(&self, id: ObjectId) -> Vec<ObjectId> {
        let all = self.state.objects.iter().filter(|record| record.parent == id.0);
        all.map(|record| ObjectId(record.object)).collect()
    }

    fn is_in_another_hand(&self, id: ObjectId) -> bool {
        self.held != Some(id) && self.of(id, |record| record.held_by).is_some()
    }

    fn machine(&self, id: ObjectId) -> Option<ObjectId> {
        self.of(id, |record| record.works).filter(|machine| self.exists(*machine))
    }

    fn basin(&self) -> Option<ObjectId> {
        let mut all = self.state.objects.iter().map(|record| ObjectId(record.object));
        all.find(|id| self.is_tap(*id))
    }
}

/// What an object affords to a body, the most obvious first, and whether it has to come nearer for any of it.
pub fn afforded(state: StateView<'_>, body: u32, object: ObjectId, catalog: &Catalog) -> (Vec<Affordance>, bool) {
    let Some((all, distance_m)) = all(state, body, object, catalog) else { return (Vec::new(), false) };
    let (mut near, far): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| distance_m <= within_m(one.deed));
    near.truncate(MOST);
    (near, far.iter().any(|one| within_m(one.deed) == REACH_M))
}

/// What an object affords to a body that walks up to it first, the most obvious first.
pub fn afforded_from_afar(state: StateView<'_>, body: u32, object: ObjectId, catalog: &Catalog) -> Vec<Affordance> {
    all(state, body, object, catalog).map(|(all, _)| all).unwrap_or_default()
}

/// All that an object affords to a body, and how far it is from it, m.
fn all(state: StateView<'_>, body: u32, object: ObjectId, catalog: &Catalog) -> Option<(Vec<Affordance>, f32)> {
    let body = state.bodies.iter().find(|record| record.body == body)?;
    let mut seen = Seen { state, catalog, held: None };
    let record = seen.record(object).filter(|record| record.held_by == NONE)?;
    seen.held = (body.held != NONE).then_some(ObjectId(body.held)).filter(|held| seen.exists(*held));
    let note = state.notes.iter().find(|note| note.object == object.0);
    let mut all = match seen.held.and_then(|held| seen.record(held)) {
        Some(held) => with(&seen, held, object),
        None => with_empty_hand(&seen, object),
    };
    all.extend(by_itself(&seen, object, note));
    if seen.held.is_some() {
        all.push(Affordance::new(Deed::Throw, "Throw at it"));
    }
    all.push(Affordance::new(Deed::Scan, "Scan"));
    Some((all, seen.distance_m(record, body.position_m)))
}

fn with_empty_hand(seen: &Seen<'_>, object: ObjectId) -> Vec<Affordance> {
    let takes = seen.class(object).has(Property::Pickupable);
    takes.then(|| Affordance::new(Deed::PickUp, "Pick up")).into_iter().collect()
}

/// What can be done to a thing with what is held.
fn with(seen: &Seen<'_>, held: &ObjectRecord, object: ObjectId) -> Vec<Affordance> {
    let name = seen.class(ObjectId(held.object)).name.to_lowercase();
    let mut all = Vec::new();
    match seen.rule(Deed::Break, object) {
        Some("cut") => all.push(Affordance::new(Deed::Break, "Cut")),
        Some(_) => all.push(Affordance::new(Deed::Break, "Break")),
        None => {}
    }
    let is_tap = seen.is_tap(object);
    // Clean things can be washed, too; nobody is offered that.
    let is_dirty = StateFlags(held.flags).has(StateFlag::Dirty);
    if is_tap && is_dirty && seen.rule(Deed::Clean, object).is_some() {
        all.push(Affordance::new(Deed::Clean, format!("Wash the {name}")));
    }
    if is_tap && seen.rule(Deed::Fill, object).is_some() {
        all.push(Affordance::new(Deed::Fill, format!("Fill the {name}")));
    }
    match seen.rule(Deed::Pour, object) {
        Some("pour cereal") => all.push(Affordance::new(Deed::Pour, "Pour cereal in")),
        Some("pour away") => all.push(Affordance::new(Deed::Pour, format!("Empty the {name}"))),
        Some(_) => all.push(Affordance::new(Deed::Pour, "Pour in")),
        None => {}
    }
    if seen.rule(Deed::Place, object).is_some() {
        all.push(Affordance::new(Deed::Place, format!("Put the {name} here")));
    }
    all
}

/// What can be done whatever is held.
fn by_itself(seen: &Seen<'_>, object: ObjectId, note: Option<&NoteRecord>) -> Vec<Affordance> {
    let class = seen.class(object);
    let is_possible = |deed| seen.catalog.table().affords(deed, class, None);
    let mut all = Vec::new();
    if note.is_some() {
        all.push(Affordance::new(Deed::Examine, "Read"));
    }
    if is_possible(Deed::Open) {
        let opened = seen.is(object, StateFlag::Opened);
        all.push(if opened { Affordance::new(Deed::Close, "Close") } else { Affordance::new(Deed::Open, "Open") });
    }
    if is_possible(Deed::Toggle) {
        let says = if seen.is(object, StateFlag::Toggled) { "Switch off" } else { "Switch on" };
        let at = if seen.is_tap(object) { 0 } else { all.len() };
        all.insert(at, Affordance::new(Deed::Toggle, says));
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
    use cohabit_cdf::{PackFile, WorldData, WorldPack, world_pack::template};

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
        check_in(&Catalog::builtin(), held, class, flags, expected);
    }

    fn check_in(catalog: &Catalog, held: Option<&str>, class: &str, flags: &[StateFlag], expected: &[&str]) {
        let mut objects = vec![record(catalog, 7, class, flags, 1.0)];
        objects.extend(held.map(|held| ObjectRecord { held_by: 1, ..record(catalog, 8, held, &[], 0.0) }));
        let held = held.map_or(NONE, |_| 8);
        let bodies = [BodyRecord { body: 1, held, ..BodyRecord::default() }];
        let header = StateHeader::default();
        let state = StateView { header: &header, bodies: &bodies, objects: &objects, goals: &[], notes: &[] };
        let (afforded, _) = afforded(state, 1, ObjectId(7), catalog);
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
        check(Some("Laser_Tip"), "Laser", &[], &["Put the laser tip here", "Look closely", "Throw at it", "Scan"]);
        check(Some("Bowl_01"), "Laser", &[], &["Look closely", "Throw at it", "Scan"]);
    }

    #[test]
    fn a_device_of_a_pack_is_offered_by_its_entry_of_the_table() {
        let files = template("my-lab").into_iter();
        let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
        let world = WorldData::layered(vec![WorldPack::parse("my-lab", files.collect()).unwrap()]).unwrap();
        let check = |held, flags: &[StateFlag], expected: &[&str]| {
            check_in(world.catalog(), held, "Degreaser_01", flags, expected);
        };
        let offered = ["Put the wrench here", "Switch on", "Look closely", "Throw at it", "Scan"];
        check(Some("Wrench_01"), &[StateFlag::Powered], &offered);
        check(None, &[StateFlag::Powered], &["Switch on", "Look closely", "Scan"]);
        check(None, &[StateFlag::Powered, StateFlag::Toggled], &["Switch off", "Look closely", "Scan"]);
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
