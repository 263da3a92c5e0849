//! What the robot remembers of what it saw, and of what it did.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    str::FromStr,
    sync::Arc,
};

use cohabit_cdf::{Action, Catalog, ObjectId, Property, StateFlag, Verb, table::Device};
use serde::{Deserialize, Serialize};

use crate::known::{
    Known, KnownGoal, KnownObject, KnownRobot,
    floor::{Floor, FloorPlan, distance_m},
    imagine,
    sight::{FLOOR_M, Gaze, Sight, TABLE_M},
};

/// No office holds more.
const MOST_THINGS: usize = 4096;
/// How near a fixed button or lever is to the machine that it is seen as a part of, m.
const PART_M: f32 = 1.2;
/// What has moved by less is where it was, m.
const SAME_PLACE_M: f32 = 0.3;

/// What the robot may know of its world.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Knows {
    /// All there is.
    Everything,
    /// The floor plan, its goals, what it has seen so far and what it did.
    #[default]
    Seen,
}

/// All that was seen and not found gone since, as it was last seen.
#[derive(Clone, Debug)]
pub struct Memory {
    robot: Option<KnownRobot>,
    goals: Vec<KnownGoal>,
    things: BTreeMap<ObjectId, KnownObject>,
    floor: Floor,
    /// What was learnt and not handed out by [`Self::take_lessons`] yet.
    fresh: BTreeSet<ObjectId>,
    fresh_cells: BTreeSet<usize>,
    fresh_low: BTreeSet<usize>,
}

/// What a robot has learnt since some moment: to be written down, and learnt again by the next one.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Lessons {
    /// Things as they were seen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    things: Vec<KnownObject>,
    /// Things that are not where they were.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    gone: Vec<ObjectId>,
    /// Cells of floor, and from how near they were seen, cm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    cells: Vec<(u32, u32)>,
    /// The same of what lies low there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    low: Vec<(u32, u32)>,
}

impl Lessons {
    /// Takes in what was learnt later.
    pub fn add(&mut self, later: Self) {
        let Self { things, gone, cells, low } = later;
        let is_new = |id: &ObjectId| things.iter().any(|thing| thing.id == *id) || gone.contains(id);
        self.things.retain(|thing| !is_new(&thing.id));
        self.gone.retain(|id| !is_new(id));
        self.things.extend(things);
        self.gone.extend(gone);
        add_cells(&mut self.cells, cells);
        add_cells(&mut self.low, low);
    }
}

impl Knows {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Everything, Self::Seen];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Everything => "everything",
            Self::Seen => "seen",
        }
    }
}

impl fmt::Display for Knows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Knows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.into_iter().find(|knows| knows.name() == text);
        known.ok_or_else(|| format!("`{text}` is neither `everything` nor `seen`"))
    }
}

impl Memory {
    /// The memory of who knows the floor plan, and has seen nothing yet.
    #[must_use]
    pub fn new(plan: Arc<FloorPlan>) -> Self {
        Self {
            robot: None,
            goals: Vec::new(),
            things: BTreeMap::new(),
            floor: Floor::new(plan),
            fresh: BTreeSet::new(),
            fresh_cells: BTreeSet::new(),
            fresh_low: BTreeSet::new(),
        }
    }

    /// Whether nothing was seen yet.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.things.is_empty()
    }

    /// Takes in what is seen of `world`, in which all is that there is.
    pub fn take_in(&mut self, catalog: &Catalog, world: &Known, gaze: Gaze) {
        let put_away = self.robot.as_ref().and_then(|robot| robot.held).filter(|held| world.robot.held != Some(*held));
        self.robot = Some(world.robot.clone());
        self.goals.clone_from(&world.goals);
        self.see_doors(world);
        let plan = Arc::clone(&self.floor.plan);
        let sight = Sight::new(catalog, &plan, gaze, world);
        let mut seen: BTreeSet<ObjectId> = world
            .objects
            .iter()
            .filter_map(|object| {
                let is_seen = !object.is_hidden && sight.sees(object, &ancestors(world, object.id));
                is_seen.then_some(object.id)
            })
            .collect();
        add_felt(world, &mut seen, put_away);
        add_parts(catalog, world, &mut seen);
        for thing in self.things.values_mut() {
            // What runs for a moment was seen running then.
            let was_visible = std::mem::replace(&mut thing.visible, false);
            if !was_visible && thing.has(StateFlag::Toggled) && runs_for_a_moment(catalog, thing) {
                thing.flags.set(StateFlag::Toggled, false);
            }
        }
        for object in world.objects.iter().filter(|object| seen.contains(&object.id)) {
            self.learn(object, true);
        }
        self.forget_what_is_gone(catalog, &sight, &seen);
        self.look_at_floor(&sight);
    }

    /// Takes in what it knows of its own deed, which succeeded: the state of what it acted on.
    pub fn take_in_deed(&mut self, action: &Action, world: &Known) {
        let target = imagine::object_of(action).and_then(|id| world.object(id));
        let Some(target) = target.filter(|_| matches!(action, Action::Interact { .. } | Action::PickUp { .. })) else {
            return;
        };
        self.learn(target, false);
        // Who opens a thing looks into it, wherever the handle is.
        if let Action::Interact { verb: Verb::Open, .. } = action {
            world.contents(target.id).for_each(|inside| self.learn(inside, true));
        }
        // What a machine did to what it holds behind its door, its table says: the shirt is clean that it washed.
        let is_kept =
            |inside: &&KnownObject| self.things.get(&inside.id).is_some_and(|thing| thing.parent == Some(target.id));
        let kept: Vec<&KnownObject> = world.contents(target.id).filter(is_kept).collect();
        kept.into_iter().for_each(|inside| self.learn(inside, false));
        let worked = target.works.filter(|worked| self.things.contains_key(worked));
        if let Some(worked) = worked.and_then(|worked| world.object(worked)) {
            self.learn(worked, false);
        }
    }

    /// What the robot knows; nothing, as long as it has not opened its eyes.
    #[must_use]
    pub fn known(&self) -> Option<Known> {
        let robot = self.robot.clone()?;
        let objects = self.things.values().cloned().collect();
        let (goals, floor) = (self.goals.clone(), Some(self.floor.clone()));
        let (mission, rooms) = (String::new(), self.floor.plan.rooms().collect());
        Some(Known { robot, objects, mission, goals, rooms, floor, person: None })
    }

    /// Where what an action is about is remembered to be, m, if it is not there: others moved it while nobody looked.
    #[must_use]
    pub fn mistaken_place(&self, action: &Action, world: &Known) -> Option<(ObjectId, [f32; 2])> {
        let id = imagine::object_of(action).filter(|id| world.robot.held != Some(*id))?;
        let thing = self.things.get(&id)?;
        let is_there = world.object(id).is_some_and(|truth| {
            truth.parent == thing.parent && distance_m(truth.position_m, thing.position_m) < SAME_PLACE_M
        });
        let [x, y, _] = thing.position_m;
        (!is_there).then_some((id, [x, y]))
    }

    /// Forgets a thing that was not where it was remembered.
    pub fn forget(&mut self, id: ObjectId) {
        if self.things.remove(&id).is_some() {
            self.fresh.insert(id);
        }
    }

    /// What was learnt since this was last asked.
    pub fn take_lessons(&mut self) -> Option<Lessons> {
        let (fresh, cells) = (std::mem::take(&mut self.fresh), std::mem::take(&mut self.fresh_cells));
        let low = std::mem::take(&mut self.fresh_low);
        if fresh.is_empty() && cells.is_empty() && low.is_empty() {
            return None;
        }
        Some(Lessons {
            things: fresh.iter().filter_map(|id| self.things.get(id)).cloned().collect(),
            gone: fresh.iter().filter(|id| !self.things.contains_key(id)).copied().collect(),
            cells: in_centimeters(&cells, &self.floor.nearest_m),
            low: in_centimeters(&low, &self.floor.nearest_low_m),
        })
    }

    /// Learns again what another one learnt.
    pub fn study(&mut self, lessons: &Lessons) {
        for thing in lessons.things.iter().take(MOST_THINGS) {
            self.learn(thing, false);
        }
        for id in &lessons.gone {
            self.things.remove(id);
        }
        study_cells(Arc::make_mut(&mut self.floor.nearest_m).as_mut_slice(), &lessons.cells);
        study_cells(Arc::make_mut(&mut self.floor.nearest_low_m).as_mut_slice(), &lessons.low);
        self.fresh.clear();
        self.fresh_cells.clear();
        self.fresh_low.clear();
    }

    fn learn(&mut self, object: &KnownObject, visible: bool) {
        let known = KnownObject { visible, is_hidden: false, ..object.clone() };
        let before = self.things.get(&object.id);
        if before.is_none() && self.things.len() >= MOST_THINGS {
            return;
        }
        let is_new = before.is_none_or(|before| KnownObject { visible, ..before.clone() } != known);
        if is_new {
            self.fresh.insert(object.id);
        }
        self.things.insert(object.id, known);
    }

    /// The doors of the plan are known from the start; that one is open only once that was seen.
    fn see_doors(&mut self, world: &Known) {
        let plan = Arc::clone(&self.floor.plan);
        let doors = world.objects.iter().filter(|object| plan.has_door(&object.instance));
        for door in doors {
            if !self.things.contains_key(&door.id) {
                let mut door = door.clone();
                door.flags = cohabit_cdf::StateFlags::default();
                self.learn(&door, false);
            }
        }
    }

    /// Forgets what would be seen where it is remembered, and is not.
    fn forget_what_is_gone(&mut self, catalog: &Catalog, sight: &Sight<'_>, seen: &BTreeSet<ObjectId>) {
        let mut gone = Vec::new();
        for (id, thing) in self.things.iter().filter(|(id, _)| !seen.contains(id)) {
            let outer = self.ancestors(*id);
            let is_shut_in = outer.iter().any(|id| self.things.get(id).is_some_and(|outer| is_shut(catalog, outer)));
            if !is_shut_in && !self.floor.plan.has_door(&thing.instance) && sight.sees(thing, &outer) {
                gone.push(*id);
            }
        }
        gone.into_iter().for_each(|id| self.forget(id));
    }

    fn ancestors(&self, id: ObjectId) -> Vec<ObjectId> {
        outwards(id, |id| self.things.get(&id).and_then(|thing| thing.parent))
    }

    fn look_at_floor(&mut self, sight: &Sight<'_>) {
        let (nearest, nearest_low) = (&mut self.floor.nearest_m, &mut self.floor.nearest_low_m);
        note_nearer(Arc::make_mut(nearest).as_mut_slice(), sight.floor(TABLE_M), &mut self.fresh_cells);
        note_nearer(Arc::make_mut(nearest_low).as_mut_slice(), sight.floor(FLOOR_M), &mut self.fresh_low);
    }
}

/// Takes in from how near cells are seen now.
fn note_nearer(nearest_m: &mut [f32], seen: impl Iterator<Item = (usize, f32)>, fresh: &mut BTreeSet<usize>) {
    for (cell, distance_m) in seen {
        // To a tenth of a metre: what was seen a little nearer is no news.
        if distance_m + 0.1 < nearest_m[cell] {
            nearest_m[cell] = distance_m;
            fresh.insert(cell);
        }
    }
}

/// These cells, and from how near they were seen, cm.
fn in_centimeters(cells: &BTreeSet<usize>, nearest_m: &[f32]) -> Vec<(u32, u32)> {
    let number = |cell: usize| u32::try_from(cell).unwrap_or(u32::MAX);
    cells.iter().map(|cell| (number(*cell), (nearest_m[*cell] * 100.0) as u32)).collect()
}

/// Takes in what was learnt of cells later.
fn add_cells(cells: &mut Vec<(u32, u32)>, later: Vec<(u32, u32)>) {
    cells.retain(|(cell, _)| !later.iter().any(|(nearer, _)| nearer == cell));
    cells.extend(later);
}

/// Learns again from how near cells were seen.
fn study_cells(nearest_m: &mut [f32], cells: &[(u32, u32)]) {
    for (cell, centimeters) in cells {
        if let Some(nearest) = nearest_m.get_mut(*cell as usize) {
            *nearest = nearest.min(*centimeters as f32 / 100.0);
        }
    }
}

/// Whether nothing in it can be seen.
pub(crate) fn is_shut(catalog: &Catalog, object: &KnownObject) -> bool {
    let class = catalog.class(object.class);
    let is_enclosed = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
    is_enclosed && class.has(Property::Openable) && !object.has(StateFlag::Opened)
}

/// What a thing is in or on, from the inside out.
fn outwards(id: ObjectId, parent: impl Fn(ObjectId) -> Option<ObjectId>) -> Vec<ObjectId> {
    let mut all = Vec::new();
    let mut next = parent(id);
    // A loop of parents would be the world's mistake; it must not hang the robot.
    while let Some(id) = next.filter(|id| all.len() < 8 && !all.contains(id)) {
        all.push(id);
        next = parent(id);
    }
    all
}

/// Whether a machine is off again a moment after it was turned on, by itself or by what works it.
fn runs_for_a_moment(catalog: &Catalog, thing: &KnownObject) -> bool {
    let (table, class) = (catalog.table(), &catalog.class(thing.class).id);
    let device = table.device(class);
    device.worked_by.iter().map(|worker| table.device(worker)).chain([device]).any(Device::runs_for_a_moment)
}

fn ancestors(world: &Known, id: ObjectId) -> Vec<ObjectId> {
    outwards(id, |id| world.object(id).and_then(|object| object.parent))
}

/// What is in the hand, on what is in the hand, and what was just put away.
fn add_felt(world: &Known, seen: &mut BTreeSet<ObjectId>, put_away: Option<ObjectId>) {
    let Some(held) = world.robot.held.or(put_away) else { return };
    seen.extend([Some(held), put_away].into_iter().flatten().filter(|id| world.object(*id).is_some()));
    seen.extend(world.contents(held).filter(|object| !object.is_hidden).map(|object| object.id));
}

/// What a seen thing stands on or in, and the buttons and levers of a seen machine.
fn add_parts(catalog: &Catalog, world: &Known, seen: &mut BTreeSet<ObjectId>) {
    let outer: Vec<ObjectId> = seen.iter().flat_map(|id| ancestors(world, *id)).collect();
    seen.extend(outer);
    let is_part = |object: &&KnownObject| {
        let is_fixed = !catalog.class(object.class).has(Property::Pickupable);
        let machine = object.works.or(object.parent).filter(|machine| seen.contains(machine));
        let is_near = |machine: &KnownObject| distance_m(machine.position_m, object.position_m) < PART_M;
        is_fixed && !object.is_hidden && machine.and_then(|id| world.object(id)).is_some_and(is_near)
    };
    let parts: Vec<ObjectId> = world.objects.iter().filter(is_part).map(|object| object.id).collect();
    seen.extend(parts);
}
