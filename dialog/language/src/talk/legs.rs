//! Where to look next: what speaks for each place, and how long that takes.

use cohabit_cdf::{Action, ClassId, GoToTarget, Property, RoomId, StateFlag, Verb};

use crate::{
    context::search::{HERE, Search, Spot, Target},
    known::{
        KnownObject, describe,
        floor::{Floor, distance_m},
    },
    talk::conversation::Conversation,
    understanding::Step,
};

/// The share of a room that a look must add.
const LEAST_GAIN: f32 = 0.03;
/// The share of a room that must be looked at before doors are opened in it.
const LOOKED_AT: f32 = 0.6;
/// How much better it is to stay in a room until it is looked at than to come back.
const STAY: f32 = 3.0;
/// The pace, and how long it takes to look around and to open a door, s.
const PACE_M_S: f32 = 0.8;
const LOOK_S: f32 = 4.0;
const OPEN_S: f32 = 4.0;
/// Two places that are closer are the same to look from, m.
const SAME_SPOT_M: f32 = 0.5;

/// A place to look, and what speaks for it.
pub(crate) struct Leg {
    spot: Spot,
    pub(crate) room: RoomId,
    /// The chance to find it there, and how long that takes, s.
    chance: f32,
    takes_s: f32,
}

impl Conversation<'_> {
    pub(crate) fn next_leg(&self, floor: &Floor, search: &Search, target: &Target) -> Option<Leg> {
        if target.is_hasty {
            return self.looks(floor, search, target).into_iter().find(|leg| matches!(leg.spot, Spot::Here(_)));
        }
        let mut legs: Vec<Leg> = self.said_leg(floor, search, target).into_iter().collect();
        if legs.is_empty() {
            legs = self.looks(floor, search, target);
            legs.extend(self.openings(floor, search, target, &legs));
        }
        let worth = |leg: &Leg| {
            let stay = if leg.room == self.scene.robot.room { STAY } else { 1.0 };
            stay * leg.chance / leg.takes_s
        };
        legs.into_iter().reduce(|best, leg| if worth(&leg) > worth(&best) { leg } else { best })
    }

    /// What it was said to be in or on, if that is known.
    fn said_leg(&self, floor: &Floor, search: &Search, target: &Target) -> Option<Leg> {
        let place = self.scene.object(target.at?)?;
        let spot = Spot::Thing(place.id);
        let is_open_to = !search.tried.contains(&spot) && !search.unreachable.contains(&place.room);
        is_open_to.then(|| Leg { spot, room: place.room, chance: 1.0, takes_s: self.way_s(floor, place) + OPEN_S })
    }

    /// A look around from here, and from every viewpoint.
    fn looks(&self, floor: &Floor, search: &Search, target: &Target) -> Vec<Leg> {
        let (room, here) = self.stands();
        let reach_m = self.reach_m(target);
        let plan = &floor.plan;
        let leg = |spot, room: RoomId, at_m, takes_s: f32| {
            let (mut new, all) = (0, plan.count(room));
            new += plan.around(room, at_m, reach_m).filter(|cell| !floor.is_looked_at(*cell, reach_m)).count();
            let gain = new as f32 / all.max(1) as f32;
            let is_open_to = target.rooms.contains(&room) && !search.unreachable.contains(&room);
            let chance = target.chance(room, self.catalog) * gain;
            (is_open_to && gain >= LEAST_GAIN).then_some(Leg { spot, room, chance, takes_s: takes_s + LOOK_S })
        };
        let is_fresh = |at_m: [f32; 2]| search.looked_m.iter().all(|before| flat_m(*before, at_m) > SAME_SPOT_M);
        let mut legs: Vec<Leg> = Vec::new();
        legs.extend(is_fresh(here).then(|| leg(Spot::Here(here), room, here, 0.0)).flatten());
        for viewpoint in &plan.viewpoints {
            let spot = Spot::Viewpoint(viewpoint.room, viewpoint.number);
            if search.tried.contains(&spot) || flat_m(viewpoint.at_m, here) < SAME_SPOT_M {
                continue;
            }
            let way_s = plan.way_m((room, here), (viewpoint.room, viewpoint.at_m)) / PACE_M_S;
            legs.extend(leg(spot, viewpoint.room, viewpoint.at_m, way_s));
        }
        legs
    }

    /// What is closed and may hold it, in rooms that were looked at.
    fn openings(&self, floor: &Floor, search: &Search, target: &Target, looks: &[Leg]) -> Vec<Leg> {
        let is_carried = |class: &ClassId| self.catalog.class(*class).has(Property::Pickupable);
        if !target.classes.iter().any(is_carried) {
            return Vec::new();
        }
        let reach_m = self.reach_m(target);
        let is_looked_at = |room: RoomId| {
            floor.share_looked_at(room, reach_m) >= LOOKED_AT || !looks.iter().any(|leg| leg.room == room)
        };
        let may_hold = |object: &&KnownObject| {
            let class = self.catalog.class(object.class);
            let encloses = class.receptacle.as_ref().is_some_and(|kind| kind.enclosed && kind.keys.is_empty());
            let is_shut = !object.has(StateFlag::Opened) && !object.has(StateFlag::Locked);
            encloses
                && is_shut
                && class.has(Property::Openable)
                && target.rooms.contains(&object.room)
                && !search.unreachable.contains(&object.room)
                && !search.tried.contains(&Spot::Thing(object.id))
                && is_looked_at(object.room)
        };
        let leg = |object: &KnownObject| {
            let same = self.scene.objects.iter().filter(|other| other.class == object.class).count();
            let inside = self.habits.inside(self.catalog, &target.classes, object.class) / same.max(1) as f32;
            let here = if object.room == target.from { HERE } else { 1.0 };
            let takes_s = self.way_s(floor, object) + OPEN_S;
            Leg { spot: Spot::Thing(object.id), room: object.room, chance: inside * here, takes_s }
        };
        self.scene.objects.iter().filter(may_hold).map(leg).collect()
    }

    pub(crate) fn leg_step(&self, leg: &Leg, target: &Target, search: &mut Search) -> Step {
        search.tried.push(leg.spot);
        let says = format!("looking for {}", target.said);
        match leg.spot {
            Spot::Here(at_m) => {
                search.looked_m.push(at_m);
                Step { action: Action::LookAround, says }
            }
            Spot::Viewpoint(room, number) => {
                Step { action: Action::GoTo { target: GoToTarget::Viewpoint(room, number) }, says }
            }
            Spot::Thing(id) => {
                let planner = self.planner(Default::default());
                if planner.is_shut(id) {
                    search.to_close = Some(id);
                    let the = describe::short(self.catalog, self.scene, id);
                    let says = format!("opening {the} to look for {}", target.said);
                    return Step { action: Action::Interact { verb: Verb::Open, object: id }, says };
                }
                Step { action: Action::GoTo { target: GoToTarget::Object(id) }, says }
            }
        }
    }

    pub(crate) fn stands(&self) -> (RoomId, [f32; 2]) {
        let [x, y, _] = self.scene.robot.position_m;
        (self.scene.robot.room, [x, y])
    }

    fn way_s(&self, floor: &Floor, object: &KnownObject) -> f32 {
        let [x, y, _] = object.position_m;
        floor.plan.way_m(self.stands(), (object.room, [x, y])) / PACE_M_S
    }
}

fn flat_m(one: [f32; 2], other: [f32; 2]) -> f32 {
    distance_m([one[0], one[1], 0.0], [other[0], other[1], 0.0])
}
