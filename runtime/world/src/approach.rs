//! Where to stand to reach something, or to be in a room, and the way there. Never knows who walks.

use cohabit_cdf::{ObjectId, Property, RoomId, StateFlag, catalog::Stands};
use glam::Vec2;

use crate::{
    body::RADIUS_M,
    body::ROBOT_HEIGHT_M,
    facts::Facts,
    geometry::{Footprint, direction},
    navigation::{MARGIN_M, Navigation, rings},
};

/// How far, level, a body stands at most from what it was sent to, m.
const STAND_WITHIN_M: f32 = 1.3;

/// A place to stand at, and the way there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Approach {
    pub path: Vec<Vec2>,
    /// Whether what was asked for cannot be reached from there.
    pub alternate: bool,
}

impl Navigation {
    /// The way to a point; to one nearby, if it is taken.
    pub fn approach_point(&self, from: Vec2, to: Vec2) -> Option<Approach> {
        const NEARBY_M: f32 = 1.0;
        let end = self.snap(to, NEARBY_M)?;
        let (path, _) = self.path(from, end)?;
        Some(Approach { path, alternate: end.distance(to) > 0.05 })
    }

    /// The way into a room: to its first named viewpoint that can be reached, else to its middle.
    pub fn approach_room(&self, facts: &Facts<'_>, from: Vec2, room: RoomId, viewpoints: &[Vec2]) -> Option<Approach> {
        let middles = facts
            .floor
            .rects(room)
            .map(|[west, south, east, north]| Vec2::new((west + east) / 2.0, (south + north) / 2.0));
        viewpoints.iter().copied().chain(middles).find_map(|point| {
            let approach = self.approach_point(from, point)?;
            let end = approach.path.last().copied()?;
            (facts.floor.room_at(end) == Some(room)).then_some(Approach { alternate: false, ..approach })
        })
    }

    /// The way to a place from which `object` is in reach, in front of it and in sight if possible.
    pub fn approach_object(&self, facts: &Facts<'_>, from: Vec2, object: ObjectId) -> Option<Approach> {
        let sweep = Sweep::before(facts, object);
        let cost = |place| place_cost(facts, object, from, place) + sweep.cost(place);
        let mut places: Vec<(f32, Vec2)> = standing_places(facts, object)
            .filter(|place| self.is_walkable(*place) && self.is_before(facts, object, *place))
            .map(|place| (cost(place), place))
            .collect();
        let near = !self.is_walkable(from) || facts.reach_to(object, from) < STAND_WITHIN_M;
        if near && self.is_before(facts, object, from) {
            places.push((cost(from), from));
        }
        // No way is shorter than the straight line: the best place is found long before all are tried.
        const WAY_COST: f32 = 0.3;
        let mut bounded: Vec<(f32, f32, Vec2)> =
            places.into_iter().map(|(cost, place)| (cost + from.distance(place) * WAY_COST, cost, place)).collect();
        bounded.sort_by(|one, two| one.0.total_cmp(&two.0));
        let mut best: Option<(f32, Vec<Vec2>)> = None;
        for (bound, cost, place) in bounded {
            if best.as_ref().is_some_and(|(least, _)| bound >= *least) {
                break;
            }
            let Some((path, length)) = self.path(from, place) else { continue };
            let total = cost + length * WAY_COST;
            if best.as_ref().is_none_or(|(least, _)| total < *least) {
                best = Some((total, path));
            }
        }
        let (_, path) = best?;
        Some(Approach { path, alternate: false })
    }

    /// The way to the place nearest to an object that nobody can reach; none, if that is not near at all.
    pub fn approach_afar(&self, facts: &Facts<'_>, from: Vec2, object: ObjectId) -> Option<Approach> {
        const NEAR_M: f32 = 2.5;
        let (print, room) = (facts.footprint(object), facts.object(object).room);
        let mut places: Vec<(f32, Vec2)> = rings(print.center, NEAR_M + print.half.max_element())
            .filter(|place| self.is_walkable(*place) && facts.floor.room_at(*place) == Some(room))
            .map(|place| (print.distance(place), place))
            .filter(|(distance, _)| *distance < NEAR_M)
            .collect();
        places.sort_by(|one, two| one.0.total_cmp(&two.0));
        let path = places.into_iter().find_map(|(_, place)| Some(self.path(from, place)?.0))?;
        Some(Approach { path, alternate: true })
    }

    /// Whether nothing stands between a place and an object, or nothing that does not swing aside for who stands there.
    fn is_before(&self, facts: &Facts<'_>, object: ObjectId, place: Vec2) -> bool {
        let mut around = std::iter::once(object).chain(facts.state.ancestors(object));
        let swings_aside = self.pushes_leaves
            && around.any(|id| facts.leaves_at(id, 1.0).any(|leaf| leaf.print.distance(place) < RADIUS_M));
        swings_aside || !facts.walled_off(object, place)
    }
}

/// Points around an object where a body could stand to reach it.
fn standing_places<'a>(facts: &'a Facts<'a>, object: ObjectId) -> impl Iterator<Item = Vec2> + 'a {
    const SPOKES: u32 = 32;
    const RINGS_M: [f32; 6] = [0.35, 0.5, 0.65, 0.8, 1.0, 1.2];
    let print = facts.footprint(object);
    let aim = facts.aim_point(object).truncate();
    let around = (0..SPOKES).flat_map(move |spoke| {
        let away = direction(spoke as f32 * (std::f32::consts::TAU / SPOKES as f32));
        let rim = print.closest(print.center + away * 10.0);
        RINGS_M.into_iter().flat_map(move |ring| [aim + away * ring, rim + away * ring])
    });
    // Before a wide front there is more than the spokes from its middle find.
    let along = (-4_i8..=4).flat_map(move |side| {
        RINGS_M
            .into_iter()
            .map(move |ring| print.world(Vec2::new(print.half.x + ring, print.half.y * f32::from(side) / 4.0)))
    });
    around.chain(along).filter(move |place| facts.reach_to(object, *place) <= STAND_WITHIN_M)
}

/// The space that doors and drawers of an object take as they open.
pub(crate) struct Sweep(Vec<Footprint>);

impl Sweep {
    /// That of an object, of what reaches lower than `below_m`.
    pub fn of(facts: &Facts<'_>, id: ObjectId, below_m: f32) -> Self {
        const STAGES: u8 = 8;
        let stages = (0..=STAGES).flat_map(|stage| facts.leaves_at(id, f32::from(stage) / f32::from(STAGES)));
        Self(stages.filter(|leaf| leaf.low_m < below_m).map(|leaf| leaf.print).collect())
    }

    /// That of all around an object that is still to be opened.
    fn before(facts: &Facts<'_>, object: ObjectId) -> Self {
        let around = std::iter::once(object).chain(facts.state.ancestors(object));
        let shut = around.filter(|id| facts.has(*id, Property::Openable) && !facts.is(*id, StateFlag::Opened));
        Self(shut.flat_map(|id| Self::of(facts, id, ROBOT_HEIGHT_M).0).collect())
    }

    /// How far a point is from it, m; far, if nothing swings.
    pub fn distance(&self, point: Vec2) -> f32 {
        self.0.iter().map(|print| print.distance(point)).fold(f32::MAX, f32::min)
    }

    /// What it costs to stand in it, in metres of way.
    fn cost(&self, place: Vec2) -> f32 {
        if self.distance(place) < RADIUS_M + MARGIN_M { 2.0 } else { 0.0 }
    }
}

/// How poor a place is for a body at `from` to work on an object, in metres of way.
fn place_cost(facts: &Facts<'_>, object: ObjectId, from: Vec2, place: Vec2) -> f32 {
    const GOOD_DISTANCE_M: f32 = 0.75;
    // What an object stands in decides the side to come from.
    let front =
        facts.state.ancestors(object).find(|parent| !facts.has(*parent, Property::Pickupable)).unwrap_or(object);
    let faced = facts.footprint(front);
    let out = (place - faced.closest(place)).normalize_or_zero();
    let has_front = !facts.has(front, Property::Pickupable);
    let side = if has_front { 1.0 - facing(facts, front, from, out.dot(faced.axis)) } else { 0.0 };
    let distance = facts.aim_point(object).truncate().distance(place);
    (distance - GOOD_DISTANCE_M).abs() * 1.5 + side * if needs_front(facts, front) { 3.0 } else { 0.4 }
}

/// How well a body that comes from `from` faces an object at a place that is `ahead` of its front: 1 before it, -1 behind it. A door
/// between rooms is worked from the room where the body is, so that nobody leaves a room to shut its door; a body in neither of them
/// shuts it from the nearer one.
fn facing(facts: &Facts<'_>, object: ObjectId, from: Vec2, ahead: f32) -> f32 {
    let Some(gap) = facts.floor.gaps.iter().find(|gap| gap.door_object == Some(object)) else { return ahead };
    // Its front faces the second of the rooms that it joins.
    let [behind, before] = gap.between;
    match facts.floor.room_at(from) {
        Some(room) if room == behind => -ahead,
        Some(room) if room == before => ahead,
        _ if facts.is(object, StateFlag::Opened) => ahead.abs(),
        _ => ahead,
    }
}

/// Whether it can only be worked from its front.
fn needs_front(facts: &Facts<'_>, object: ObjectId) -> bool {
    let class = facts.class(object);
    class.has(Property::Openable) || class.has(Property::Toggleable) || class.stands == Stands::OnWall
}
