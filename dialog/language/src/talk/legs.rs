//! Where to look next: what speaks for each place, and how long that takes.

use cohabit_cdf::{Action, ClassId, GoToTarget, Property, RoomId, StateFlag, Verb};

use crate::{
    context::search::{Search, Spot, Target},
    known::{
        KnownObject, describe,
        floor::{Floor, distance_m},
        sight::FLOOR_FROM_M,
    },
    talk::conversation::Conversation,
    understanding::Step,
};

/// The share of what a room may show that a look must add.
const LEAST_GAIN: f32 = 0.03;
/// The same of a look with a lowered head: in a large hall the piece of floor around the robot is no more likely than the next.
const LEAST_LOWERED: f32 = 0.1;
/// The share of a room that must be looked at before doors are opened in it.
const LOOKED_AT: f32 = 0.6;
/// How much better it is to stay in a room until it is looked at than to come back.
const STAY: f32 = 3.0;
/// The pace, and how long it takes to look around and to open a door, s.
const PACE_M_S: f32 = 0.8;
const LOOK_S: f32 = 4.0;
const OPEN_S: f32 = 4.0;
/// How far the head is lowered to look for what lies low, rad, and how long it takes to lower and to raise it, s.
const LOWERED_RAD: f32 = 0.6;
const LOWER_S: f32 = 1.0;
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

/// How a thing shows: up to which distance, m, and how likely it lies low.
#[derive(Clone, Copy)]
struct Shows {
    reach_m: f32,
    low: f32,
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

    /// A look around from here, then one with a lowered head, and one from every viewpoint.
    fn looks(&self, floor: &Floor, search: &Search, target: &Target) -> Vec<Leg> {
        let (room, here) = self.stands();
        let shows = Shows { reach_m: self.reach_m(target), low: self.habits.low(self.catalog, &target.classes) };
        let plan = &floor.plan;
        let leg = |spot, room: RoomId, at_m, takes_s: f32| {
            let is_lowered = matches!(spot, Spot::Low(_));
            let gain = added(floor, (room, at_m), shows, is_lowered);
            let least = if is_lowered { LEAST_LOWERED } else { LEAST_GAIN };
            let is_open_to = target.rooms.contains(&room) && !search.unreachable.contains(&room);
            let chance = target.chance(room, self.catalog) * gain;
            (is_open_to && gain >= least).then_some(Leg { spot, room, chance, takes_s: takes_s + LOOK_S })
        };
        let is_fresh = |at_m: [f32; 2]| search.looked_m.iter().all(|before| flat_m(*before, at_m) > SAME_SPOT_M);
        let mut legs: Vec<Leg> = Vec::new();
        legs.extend(is_fresh(here).then(|| leg(Spot::Here(here), room, here, 0.0)).flatten());
        let is_low_here = |spot: &Spot| matches!(spot, Spot::Low(before) if flat_m(*before, here) <= SAME_SPOT_M);
        let was_lowered = search.tried.iter().any(is_low_here);
        if legs.is_empty() && !was_lowered {
            legs.extend(leg(Spot::Low(here), room, here, LOWER_S));
        }
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
            let is_left = |leg: &Leg| leg.room == room && !matches!(leg.spot, Spot::Low(_));
            floor.share_looked_at(room, reach_m) >= LOOKED_AT || !looks.iter().any(is_left)
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
            let takes_s = self.way_s(floor, object) + OPEN_S;
            Leg {
                spot: Spot::Thing(object.id),
                room: object.room,
                chance: inside * target.favour(object.room),
                takes_s,
            }
        };
        self.scene.objects.iter().filter(may_hold).map(leg).collect()
    }

    pub(crate) fn leg_steps(&self, leg: &Leg, target: &Target, search: &mut Search) -> Vec<Step> {
        let step = self.leg_step(leg, target, search);
        if !matches!(leg.spot, Spot::Low(_)) {
            return vec![step];
        }
        let tilt = |pitch_rad| Step { action: Action::Look { pitch_rad }, says: step.says.clone() };
        vec![tilt(-LOWERED_RAD), step.clone(), tilt(LOWERED_RAD)]
    }

    fn leg_step(&self, leg: &Leg, target: &Target, search: &mut Search) -> Step {
        search.tried.push(leg.spot);
        let says = format!("looking for {}", target.said);
        match leg.spot {
            Spot::Here(at_m) => {
                search.looked_m.push(at_m);
                Step { action: Action::LookAround, says }
            }
            Spot::Low(_) => Step { action: Action::LookAround, says },
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

/// The share of what a room may show that a look around from a place adds. Who looks straight ahead sees nothing that lies low near by; who
/// lowers the head has seen the rest before.
fn added(floor: &Floor, (room, at_m): (RoomId, [f32; 2]), shows: Shows, is_lowered: bool) -> f32 {
    let (plan, Shows { reach_m, low }) = (&floor.plan, shows);
    let adds = |cell: usize| {
        let is_high_new = !is_lowered && !floor.is_looked_at(cell, reach_m);
        let is_in_view = is_lowered || flat_m(plan.cells[cell].at_m, at_m) >= FLOOR_FROM_M;
        let is_low_new = is_in_view && !floor.is_looked_at_low(cell, reach_m);
        (if is_high_new { 1.0 - low } else { 0.0 }) + if is_low_new { low } else { 0.0 }
    };
    plan.around(room, at_m, reach_m).map(adds).sum::<f32>() / plan.count(room).max(1) as f32
}

fn flat_m(one: [f32; 2], other: [f32; 2]) -> f32 {
    distance_m([one[0], one[1], 0.0], [other[0], other[1], 0.0])
}
